//! Forces on a box, as lines: springs to their anchors, point forces, friction cones at contacts.

use bevy::prelude::*;
use box_physics::aabb::corners;
use box_physics::force::Frame;
use box_scenarios::Model;

use super::shown::Shown;
use crate::camera::views::Everywhere;
use crate::compare::Comparison;
use crate::preferences::Preferences;

/// Number of turns of a drawn spring, and its width relative to the box's radius.
const TURNS: usize = 9;
const WIDTH: f32 = 0.09;
/// Height of a friction cone relative to the box's radius, and the largest friction drawn.
const CONE: f32 = 0.6;
const WIDEST: f32 = 2.0;
/// Height up to which a corner counts as touching, relative to the radius.
const TOUCHING: f64 = 0.02;

/// Draws the springs and point forces of `law` on a box.
pub(super) fn draw<G: GizmoConfigGroup>(
    gizmos: &mut Gizmos<G>,
    law: &Model,
    trajectory: &Shown<'_>,
    color: Color,
) {
    let radius = law.body.radius() as f32;
    for spring in &law.forces.springs {
        let anchor = spring.anchor.as_vec3() + trajectory.offset;
        let ends = [anchor, trajectory.place(spring.body_point)];
        gizmos.linestrip(zigzag(ends, WIDTH * radius), color);
        let ball = gizmos.sphere(anchor, 0.07 * radius, Color::WHITE);
        ball.resolution(8);
    }
    for force in &law.forces.point_forces {
        // A couple may act far outside the box.
        let at = force.body_point.clamp_length_max(law.body.radius());
        let direction = match force.frame {
            Frame::World => force.force,
            Frame::Body => trajectory.state.rotation * force.force,
        };
        let at = trajectory.place(at);
        let end = at + direction.normalize_or_zero().as_vec3() * radius;
        gizmos.arrow(at, end, color);
    }
}

/// The points of a spring between two ends.
fn zigzag([from, to]: [Vec3; 2], width: f32) -> impl Iterator<Item = Vec3> {
    let direction = (to - from).try_normalize();
    let aside = direction.map_or(Vec3::ZERO, |d| d.any_orthonormal_vector());
    (0..=TURNS + 2).map(move |k| {
        let side = match k {
            k if k <= 1 || k > TURNS => 0.0,
            k if k % 2 == 0 => 1.0,
            _ => -1.0,
        };
        from.lerp(to, k as f32 / (TURNS + 2) as f32) + side * width * aside
    })
}

/// Draws the friction cone at each corner of the main box that touches the floor.
pub(super) fn draw_cones(
    comparison: Res<Comparison>,
    preferences: Res<Preferences>,
    mut gizmos: Gizmos<Everywhere>,
) {
    let Some(run) = comparison
        .run
        .as_ref()
        .filter(|_| preferences.show_contacts)
    else {
        return;
    };
    let Some(floor) = run.law.floor().filter(|floor| floor.friction > 0.0) else {
        return;
    };
    let (state, body) = (run.main_box.state(), &run.law.body);
    let height = CONE * body.radius() as f32;
    let color = Color::srgb_u8(240, 228, 66);
    for corner in corners(body.half_extents()) {
        let at = state.point(corner);
        if at.y - floor.height > TOUCHING * body.radius() {
            continue;
        }
        let apex = at.as_vec3();
        let top = apex + Vec3::Y * height;
        let radius = height * (floor.friction as f32).min(WIDEST);
        let flat = Quat::from_rotation_arc(Vec3::Z, Vec3::Y);
        let rim = gizmos.circle(Isometry3d::new(top, flat), radius, color);
        rim.resolution(24);
        for side in [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z] {
            gizmos.line(apex, top + radius * side, color);
        }
    }
}
