//! The picture: renderer, boxes, floor, comparisons, labels.

mod backdrop;
mod comparisons;
mod marks;
pub mod renderer;
pub mod style;
mod visuals;

use bevy::camera::visibility::VisibilitySystems;
use bevy::prelude::*;
use bevy::shader::load_shader_library;
use box_physics::plugin::{BodyGizmos, BodyGizmosPlugin, BodyGizmosSystems};

use crate::camera::orbit::move_camera;
use crate::preferences::Preferences;
use crate::scene::session::MainBox;

/// Draws boxes, floor and comparisons. Needs a renderer and the cameras.
pub fn plugin(app: &mut App) {
    load_shader_library!(app, "sky.wgsl");
    app.add_plugins((
        BodyGizmosPlugin,
        comparisons::plugin,
        MaterialPlugin::<backdrop::SkyMaterial>::default(),
    ))
    .add_systems(Startup, (visuals::set_up, backdrop::spawn_backdrop))
    .add_systems(
        Update,
        (
            backdrop::draw_lattice.after(move_camera),
            backdrop::draw_walls,
            backdrop::place_backdrop.after(move_camera),
            visuals::place_floor,
            switch_gizmos.before(BodyGizmosSystems),
        ),
    );
    add_dressing(app);
}

/// Adds systems that run after all systems that spawn boxes or switch integrators in this frame.
fn add_dressing(app: &mut App) {
    app.add_systems(
        PostUpdate,
        (visuals::dress_boxes, visuals::tint_main_box)
            .chain()
            .before(VisibilitySystems::CalculateBounds),
    );
}

/// Applies the switches of the panel: bounding boxes of all bodies, the other gizmos only of the main box.
fn switch_gizmos(
    preferences: Res<Preferences>,
    main_box: Query<Entity, With<MainBox>>,
    mut gizmos: ResMut<GizmoConfigStore>,
) {
    let main_box = main_box.iter().next();
    *gizmos.config_mut::<BodyGizmos>().1 = BodyGizmos {
        aabbs: preferences.show_aabb,
        axes: preferences.show_axes && main_box.is_some(),
        contacts: preferences.show_contacts && main_box.is_some(),
        only: main_box,
    };
}
