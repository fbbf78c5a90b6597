//! The ground under the comparisons, and the camera far enough away to show them all.

use bevy::prelude::*;
use box_physics::prelude::Integrator;

use super::shown::{color, shown, sideways};
use crate::action::compare::Layout;
use crate::camera::orbit::OrbitCamera;
use crate::compare::Comparison;
use crate::scene::session::Session;

/// Width of a strip in radii of the box.
const STRIP: f32 = 2.3;
/// The picture goes this much farther away for each comparison beside the main box.
const STEP_BACK: f32 = 0.4;
/// Cosine of the angle between the view and the row of comparisons above which one hides the other, and how much
/// higher the camera then stands \[rad\].
const ALONG: f32 = 0.75;
const LIFT: f32 = 0.5;

/// The ground under a comparison.
#[derive(Component, Clone, Copy, Debug)]
pub(super) struct Strip(pub Integrator);

/// The ground under every comparison: along the motion over a floor, else a plate under a box that stays.
pub(super) fn place_strips(
    comparison: Res<Comparison>,
    mut strips: Query<(&Strip, &mut Transform, &mut Visibility)>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut plane: Local<Option<Handle<Mesh>>>,
    mut commands: Commands,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let layout = comparison.settings.layout;
    let side_by_side = layout == Layout::SideBySide;
    let radius = run.law.body.radius() as f32;
    let across = sideways(run);
    let start = run.start();
    let moving = start.velocity.length() > 0.1;
    let ground = match run.law.floor {
        Some(floor) => floor.height as f32 + 0.004,
        None => start.position.y as f32 - 1.5 * radius,
    };
    let size = Vec3::new(
        STRIP * radius,
        1.0,
        if moving { 40.0 } else { 3.5 } * radius,
    );
    let grounded = run.law.floor.is_some() || !moving;
    let mut missing: Vec<_> = if side_by_side && grounded {
        shown(run, layout).iter().map(|s| (s.0, s.3)).collect()
    } else {
        Vec::new()
    };
    let at = |offset: Vec3| {
        let origin = start.position.as_vec3();
        Transform::from_xyz(origin.x + offset.x, ground, origin.z + offset.z)
            .with_rotation(Quat::from_rotation_arc(Vec3::X, across))
            .with_scale(size)
    };
    for (strip, mut transform, mut visibility) in &mut strips {
        match missing.iter().position(|(i, _)| *i == strip.0) {
            Some(k) => {
                *transform = at(missing.swap_remove(k).1);
                visibility.set_if_neq(Visibility::Visible);
            }
            None => {
                visibility.set_if_neq(Visibility::Hidden);
            }
        }
    }
    for (integrator, offset) in missing {
        let plane = plane
            .get_or_insert_with(|| meshes.add(Plane3d::new(Vec3::Y, Vec2::splat(0.5))))
            .clone();
        commands.spawn((
            Strip(integrator),
            Mesh3d(plane),
            MeshMaterial3d(materials.add(StandardMaterial {
                base_color: color(integrator, 0.35),
                alpha_mode: AlphaMode::Blend,
                unlit: true,
                ..default()
            })),
            at(offset),
            bevy::light::NotShadowCaster,
        ));
    }
}

/// Change of the camera by the row, to be undone with it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Moved {
    scene: String,
    /// Times its distance.
    factor: f32,
    /// Added to its pitch \[rad\].
    lift: f32,
}

/// The camera far enough away to show every comparison, and higher where it would look along their row and see
/// the nearest alone.
pub(super) fn step_back(
    comparison: Res<Comparison>,
    session: Option<Res<Session>>,
    mut cameras: Query<&mut OrbitCamera>,
    mut moved: Local<Moved>,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let scene = session.map_or_else(String::new, |s| s.scenario.id.to_owned());
    // A new scene has just brought its own camera.
    let before = if moved.scene == scene && moved.factor > 0.0 {
        (moved.factor, moved.lift)
    } else {
        (1.0, 0.0)
    };
    let side_by_side =
        comparison.settings.layout == Layout::SideBySide && !run.comparisons.is_empty();
    let mut after = (1.0, 0.0);
    if side_by_side {
        after.0 = 1.0 + STEP_BACK * run.comparisons.len() as f32;
        let along_the_row = cameras.iter().any(|camera| {
            let view = Vec3::new(camera.yaw.sin(), 0.0, camera.yaw.cos());
            view.dot(sideways(run)).abs() > ALONG
        });
        after.1 = match (before.1 > 0.0, along_the_row) {
            (true, _) => before.1,
            (false, true) if before.0 == 1.0 => LIFT,
            _ => 0.0,
        };
    }
    if after != before {
        for mut camera in &mut cameras {
            camera.distance *= after.0 / before.0;
            camera.pitch = (camera.pitch + after.1 - before.1).clamp(-1.5, 1.5);
        }
    }
    *moved = Moved {
        scene,
        factor: after.0,
        lift: after.1,
    };
}
