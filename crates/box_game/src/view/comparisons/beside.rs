//! The comparisons side by side with the main box: solid boxes, the ground under them, and a camera far enough away to
//! show them all.

use bevy::camera::visibility::RenderLayers;
use bevy::light::NotShadowCaster;
use bevy::prelude::*;
use box_physics::prelude::Integrator;

use super::shown::{Shown, color, shown, sideways};
use crate::action::compare::Layout;
use crate::camera::orbit::OrbitCamera;
use crate::camera::views;
use crate::compare::{Comparison, Run};
use crate::scene::session::Session;
use crate::view::marks::cuboid;

/// Width of a strip of ground in radii of the box.
const STRIP: f32 = 2.3;
/// Increase of the camera distance for each comparison, relative to the distance.
const STEP_BACK: f32 = 0.4;
/// Cosine of the angle between the view and the row of comparisons above which one hides the other, and the additional
/// elevation of the camera in that case \[rad\].
const ALONG: f32 = 0.75;
const LIFT: f32 = 0.5;

/// The box of a comparison, or the ground under it. It is spawned once, and hidden if not needed.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    integrator: Integrator,
    ground: bool,
}

/// A solid box for every comparison in the side-by-side layout (edges in the overlaid one), and the ground under it.
pub(super) fn place_pieces(
    comparison: Res<Comparison>,
    mut pieces: Query<(
        &Piece,
        &mut Transform,
        &mut Visibility,
        &mut Mesh3d,
        &mut RenderLayers,
    )>,
    (mut meshes, mut materials): (ResMut<Assets<Mesh>>, ResMut<Assets<StandardMaterial>>),
    mut made: Local<Option<(Vec3, [Handle<Mesh>; 2])>>,
    mut commands: Commands,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let half = run.law.body.half_extents().as_vec3();
    let [solid, plane] = match &*made {
        Some((size, meshes)) if *size == half => meshes.clone(),
        _ => {
            let plane = Plane3d::new(Vec3::Y, Vec2::splat(0.5));
            let new = [meshes.add(cuboid(half, true)), meshes.add(plane)];
            *made = Some((half, new.clone()));
            new
        }
    };
    let mesh = |piece: Piece| if piece.ground { &plane } else { &solid };
    let mut missing = wanted(run, comparison.settings.layout);
    for (piece, mut transform, mut visibility, mut shape, mut layers) in &mut pieces {
        let Some(n) = missing.iter().position(|(p, ..)| p == piece) else {
            visibility.set_if_neq(Visibility::Hidden);
            continue;
        };
        let (_, place, view) = missing.swap_remove(n);
        *transform = place;
        visibility.set_if_neq(Visibility::Visible);
        if shape.0 != *mesh(*piece) {
            shape.0 = mesh(*piece).clone();
        }
        layers.set_if_neq(view);
    }
    for (piece, place, view) in missing {
        let material = if piece.ground {
            StandardMaterial {
                base_color: color(piece.integrator, 0.35),
                alpha_mode: AlphaMode::Blend,
                unlit: true,
                ..default()
            }
        } else {
            StandardMaterial {
                base_color: color(piece.integrator, 1.0),
                perceptual_roughness: 0.6,
                ..default()
            }
        };
        let look = (
            Mesh3d(mesh(piece).clone()),
            MeshMaterial3d(materials.add(material)),
        );
        let mut spawned = commands.spawn((piece, look, place, view));
        if piece.ground {
            spawned.insert(NotShadowCaster);
        }
    }
}

/// Every visible piece, its transform, and its view.
fn wanted(run: &Run, layout: Layout) -> Vec<(Piece, Transform, RenderLayers)> {
    let trajectories = match layout {
        Layout::SideBySide | Layout::Views => shown(run, layout),
        Layout::Solo | Layout::Overlaid => Vec::new(),
    };
    let comparisons = trajectories.iter().enumerate().skip(1);
    // A diverged comparison has only gray edges.
    let going_on = comparisons.filter(|(_, t)| !t.status.is_diverged());
    let boxes = going_on.map(|(k, t)| {
        let place = Transform::from_translation(t.state.position.as_vec3() + t.offset)
            .with_rotation(t.state.rotation.as_quat());
        let view = if layout == Layout::Views { k } else { 0 };
        (piece(t, false), place, views::only(view))
    });
    let mut wanted: Vec<_> = boxes.collect();
    // A strip of the floor along the motion.
    let (start, radius) = (run.start(), run.law.body.radius() as f32);
    let moving = start.velocity.length() > 0.1;
    if let (Layout::SideBySide, Some(floor)) = (layout, run.law.floor()) {
        let origin = start.position.as_vec3();
        let height = floor.height as f32 + 0.004;
        let length = if moving { 40.0 } else { 3.5 };
        wanted.extend(trajectories.iter().map(|t| {
            let place = Transform::from_translation((origin + t.offset).with_y(height))
                .with_rotation(Quat::from_rotation_arc(Vec3::X, sideways(run)))
                .with_scale(Vec3::new(STRIP * radius, 1.0, length * radius));
            (piece(t, true), place, views::only(0))
        }));
    }
    wanted
}

fn piece(shown: &Shown<'_>, ground: bool) -> Piece {
    Piece {
        integrator: shown.integrator,
        ground,
    }
}

/// Moves the camera far enough away to show every comparison, and higher if it would look along their row. Later
/// restores the factor of the distance and the elevation \[rad\].
pub(super) fn step_back(
    comparison: Res<Comparison>,
    session: Res<Session>,
    mut camera: Single<&mut OrbitCamera>,
    mut moved: Local<(&'static str, (f32, f32))>,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let scene = session.scenario.id;
    // A new scene has just set its camera.
    let before = if moved.0 == scene {
        moved.1
    } else {
        (1.0, 0.0)
    };
    let side_by_side = comparison.settings.layout == Layout::SideBySide;
    let mut after = (1.0, 0.0);
    if side_by_side && !run.comparisons.is_empty() {
        after.0 = 1.0 + STEP_BACK * run.comparisons.len() as f32;
        let view = Vec3::new(camera.yaw.sin(), 0.0, camera.yaw.cos());
        let along_the_row = view.dot(sideways(run)).abs() > ALONG;
        after.1 = match (before.1 > 0.0, along_the_row) {
            (true, _) => before.1,
            (false, true) if before.0 == 1.0 => LIFT,
            _ => 0.0,
        };
    }
    if after != before {
        camera.distance *= after.0 / before.0;
        camera.pitch = (camera.pitch + after.1 - before.1).clamp(-1.5, 1.5);
    }
    *moved = (scene, after);
}
