//! The picture: renderer, boxes, floor, comparisons, labels.

mod ghosts;
mod lattice;
pub mod renderer;
pub mod style;
mod visuals;

use bevy::prelude::*;
use box_physics::plugin::{BodyGizmos, BodyGizmosPlugin, BodyGizmosSystems};

use crate::camera::orbit::move_camera;
use crate::preferences::Preferences;
use crate::scene::session::Hero;

/// Draws boxes, floor and comparisons. Needs a renderer and the cameras.
pub struct ViewPlugin;

impl Plugin for ViewPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((BodyGizmosPlugin, ghosts::GhostPlugin))
            .add_systems(Startup, visuals::set_up)
            .add_systems(
                Update,
                (
                    lattice::draw_lattice.after(move_camera),
                    visuals::dress_boxes,
                    visuals::tint_hero,
                    visuals::place_floor,
                    switch_gizmos.before(BodyGizmosSystems),
                ),
            );
    }
}

/// The switches of the panel: boxes of all bodies, the rest of the main box alone.
fn switch_gizmos(
    preferences: Res<Preferences>,
    hero: Query<Entity, With<Hero>>,
    mut gizmos: ResMut<GizmoConfigStore>,
) {
    let hero = hero.iter().next();
    *gizmos.config_mut::<BodyGizmos>().1 = BodyGizmos {
        aabbs: preferences.show_aabb,
        axes: preferences.show_axes && hero.is_some(),
        contacts: preferences.show_contacts && hero.is_some(),
        only: hero,
    };
}
