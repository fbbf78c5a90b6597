//! The lanes as pictures: translucent boxes over the hero or boxes in strips beside it, the reference as
//! a dashed white frame, fading trails, and a tag with name and error for each.
//!
//! Nothing here is simulated or read back: in the lanes layout only the picture is shifted.

mod frames;
mod strips;
mod tags;
pub mod views;

use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy_egui::EguiPrimaryContextPass;
use box_physics::prelude::{BodyState, Integrator};

use crate::compare::track::Track;
use crate::compare::{Comparison, Layout, Run};
use crate::view::style;
use crate::view::visuals::{box_color, shaded_cuboid};
pub use strips::Strip;

/// Opacity of a ghost.
const GHOST: f32 = 0.16;
/// Distance of two lanes in radii of the box.
const PITCH: f32 = 2.7;

/// Draws the lanes of a [`Comparison`] over the picture of the first 3-D camera. Needs a renderer and
/// [`ComparePlugin`](crate::compare::ComparePlugin); tags need `EguiPlugin`.
pub struct GhostPlugin;

impl Plugin for GhostPlugin {
    fn build(&self, app: &mut App) {
        views::add_gizmos(app);
        app.init_resource::<frames::Trails>().add_systems(
            Update,
            (
                place_ghosts,
                strips::place_strips,
                strips::step_back,
                frames::lengthen_trails,
                frames::draw_frames,
            )
                .chain(),
        );
        if app.is_plugin_added::<bevy_egui::EguiPlugin>() {
            app.add_systems(EguiPrimaryContextPass, tags::draw_tags);
        }
    }
}

/// The box of a lane; once spawned it stays, and is hidden when it is not wanted.
#[derive(Component, Clone, Copy, Debug)]
pub struct Ghost(pub Integrator);

/// A trajectory that is drawn: integrator, state, books, by how much its picture is shifted.
type Shown<'a> = (Integrator, &'a BodyState, &'a Track, Vec3);

/// Every trajectory that is drawn, the hero's first.
fn shown(run: &Run, layout: Layout) -> Vec<Shown<'_>> {
    let hero = (
        run.hero.integrator,
        &run.hero.state,
        &run.hero.track,
        Vec3::ZERO,
    );
    let side = sideways(run) * PITCH * run.law.body.radius() as f32;
    let lanes = run.lanes.iter().enumerate().map(|(k, r)| {
        let offset = match layout {
            Layout::Lanes => side * place(k),
            Layout::Solo | Layout::Ghosts | Layout::Views => Vec3::ZERO,
        };
        (r.lane.integrator, &r.lane.state, &r.track, offset)
    });
    let beside = match layout {
        Layout::Solo => 0,
        Layout::Ghosts | Layout::Lanes => run.lanes.len(),
        Layout::Views => run.lanes.len().min(views::MOST - 1),
    };
    [hero].into_iter().chain(lanes.take(beside)).collect()
}

/// Right, left, right, left of the hero.
fn place(k: usize) -> f32 {
    let ring = (k / 2 + 1) as f32;
    if k.is_multiple_of(2) { ring } else { -ring }
}

/// Across the motion over the floor, horizontally.
fn sideways(run: &Run) -> Vec3 {
    let v = run.start().velocity.as_vec3();
    let along = Vec3::new(v.x, 0.0, v.z);
    if along.length() > 0.1 && run.law.floor.is_some() {
        along.cross(Vec3::Y).normalize()
    } else {
        Vec3::X
    }
}

fn color(integrator: Integrator, alpha: f32) -> Color {
    let [r, g, b] = style::of(integrator).rgb;
    Color::srgb_u8(r, g, b).with_alpha(alpha)
}

/// A box for every lane, where the lane is.
fn place_ghosts(
    comparison: Res<Comparison>,
    mut ghosts: Query<(
        &Ghost,
        &mut Transform,
        &mut Visibility,
        &mut Mesh3d,
        &mut MeshMaterial3d<StandardMaterial>,
        &mut RenderLayers,
    )>,
    area: Option<Res<views::PictureArea>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut made: Local<Option<(Vec3, [Handle<Mesh>; 2])>>,
    mut tints: Local<Vec<(Integrator, [Handle<StandardMaterial>; 2])>>,
    mut commands: Commands,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let half = run.law.body.half_extents().as_vec3();
    let fits = made.as_ref().is_some_and(|(size, ..)| *size == half);
    if !fits {
        let plain = meshes.add(Cuboid::from_size(half * 2.0));
        let shaded = meshes.add(shaded_cuboid(half));
        *made = Some((half, [plain, shaded]));
    }
    let Some((_, [plain, shaded])) = &*made else {
        return;
    };
    let layout = drawn(&comparison, area.is_some());
    let wanted = shown(run, layout);
    let mut tint = |i: Integrator| match tints.iter().find(|(s, _)| *s == i) {
        Some((_, tint)) => tint.clone(),
        None => {
            let clear = materials.add(StandardMaterial {
                base_color: color(i, GHOST),
                alpha_mode: AlphaMode::Blend,
                unlit: true,
                ..default()
            });
            let solid = materials.add(StandardMaterial {
                base_color: box_color(i),
                perceptual_roughness: 0.6,
                ..default()
            });
            tints.push((i, [clear.clone(), solid.clone()]));
            [clear, solid]
        }
    };
    // With the view that it is seen in alone.
    let mut missing: Vec<_> = wanted[1..].iter().zip(1..).collect();
    for (ghost, mut transform, mut visibility, mut mesh, mut material, mut layers) in &mut ghosts {
        let found = missing.iter().position(|((i, ..), _)| *i == ghost.0);
        let Some(n) = found else {
            visibility.set_if_neq(Visibility::Hidden);
            continue;
        };
        let ((integrator, state, _, offset), k) = missing.swap_remove(n);
        *transform = pose(state, *offset);
        visibility.set_if_neq(Visibility::Visible);
        let [clear, solid] = tint(*integrator);
        let (shape, look, view) = match layout {
            Layout::Lanes => (shaded, solid, 0),
            Layout::Views => (shaded, solid, k),
            Layout::Solo | Layout::Ghosts => (plain, clear, 0),
        };
        if mesh.0 != *shape {
            mesh.0 = shape.clone();
        }
        if material.0 != look {
            material.0 = look;
        }
        layers.set_if_neq(views::only(view));
    }
    for ((integrator, state, _, offset), _) in missing {
        commands.spawn((
            Ghost(*integrator),
            Mesh3d(plain.clone()),
            MeshMaterial3d(tint(*integrator)[0].clone()),
            pose(state, *offset),
            views::only(0),
            bevy::light::NotShadowCaster,
        ));
    }
}

/// The layout as it is drawn: without a room of its own for the picture, views are ghosts.
fn drawn(comparison: &Comparison, area: bool) -> Layout {
    match comparison.settings.layout {
        Layout::Views if !area => Layout::Ghosts,
        layout => layout,
    }
}

fn pose(state: &BodyState, offset: Vec3) -> Transform {
    Transform::from_translation(state.position.as_vec3() + offset)
        .with_rotation(state.rotation.as_quat())
}

/// The point that trails and tags follow, body axes \[m\].
fn tip(run: &Run) -> bevy::math::DVec3 {
    let start = run.start();
    let travels = start.velocity.length() > 0.1
        || run.law.floor.is_some()
        || run.law.forces.gravity.length() > 0.0;
    let half = run.law.body.half_extents();
    if travels {
        bevy::math::DVec3::ZERO
    } else if half.x >= half.y && half.x >= half.z {
        bevy::math::DVec3::X * half.x
    } else if half.y >= half.z {
        bevy::math::DVec3::Y * half.y
    } else {
        bevy::math::DVec3::Z * half.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_scenarios::Scenario;

    /// Only the picture is shifted: the states drawn are those simulated.
    #[test]
    fn lanes_stand_side_by_side_in_the_picture_alone() {
        let setup = Scenario::find("slide").expect("a scene").setup;
        let mut run = Run::new(&setup, None, Integrator::Split, 1.0 / 60.0);
        run.choose([
            Integrator::Rk4,
            Integrator::ExplicitEuler,
            Integrator::Midpoint,
        ]);
        let places: Vec<_> = shown(&run, Layout::Lanes);
        assert_eq!(places.len(), 4);
        for (k, a) in places.iter().enumerate() {
            assert_eq!(a.1, &setup.initial);
            // Across the slide, and apart.
            assert!(a.3.x.abs() < 1e-6 && a.3.y == 0.0);
            let apart = PITCH * setup.body.radius() as f32 * 0.99;
            assert!(places[..k].iter().all(|b| a.3.distance(b.3) > apart));
        }
        assert!(
            shown(&run, Layout::Ghosts)
                .iter()
                .all(|s| s.3 == Vec3::ZERO)
        );
        assert_eq!(shown(&run, Layout::Solo).len(), 1);
    }
}
