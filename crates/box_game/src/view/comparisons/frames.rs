//! Lines over the picture: the edges of the comparisons, the reference dashed, the fading trails.

use std::collections::VecDeque;

use bevy::prelude::*;
use box_physics::prelude::{BodyState, Integrator, RigidBox};

use super::shown::{Shown, color, drawn, shown, tip};
use crate::action::compare::Layout;
use crate::camera::views::{Fourth, PictureArea, Second, Third};
use crate::compare::Comparison;

/// Length of a trail \[s\], and its largest number of points.
const TRAIL: f64 = 1.5;
const TRAIL_POINTS: usize = 96;
/// Dashes along an edge of the reference.
const DASHES: usize = 6;

/// Past places of the marked point of every trajectory, newest last; the main box first.
#[derive(Resource, Default)]
pub(super) struct Trails {
    points: Vec<(Integrator, VecDeque<(f64, Vec3)>)>,
}

/// Follows a point of every trajectory: the center where the box travels, else the tip of its longest
/// edge, which shows a flip.
pub(super) fn lengthen_trails(comparison: Res<Comparison>, mut trails: ResMut<Trails>) {
    let Some(run) = &comparison.run else {
        return;
    };
    let tip = tip(run);
    let now = run.clock;
    let wanted = shown(run, comparison.settings.layout);
    trails
        .points
        .retain(|(i, _)| wanted.iter().any(|(j, ..)| i == j));
    for (integrator, state, ..) in wanted {
        let k = match trails.points.iter().position(|(i, _)| *i == integrator) {
            Some(k) => k,
            None => {
                trails.points.push((integrator, VecDeque::new()));
                trails.points.len() - 1
            }
        };
        let points = &mut trails.points[k].1;
        // A restart, or a step back.
        while points.back().is_some_and(|(t, _)| *t > now) {
            points.pop_back();
        }
        if points
            .back()
            .is_none_or(|(t, _)| now - t > TRAIL / TRAIL_POINTS as f64)
        {
            points.push_back((now, state.point(tip).as_vec3()));
        }
        while points.front().is_some_and(|(t, _)| now - t > TRAIL) {
            points.pop_front();
        }
    }
}

/// Edges of comparisons and of the reference, and the trails, each in its view.
pub(super) fn draw_frames(
    comparison: Res<Comparison>,
    trails: Res<Trails>,
    area: Option<Res<PictureArea>>,
    mut first: Gizmos,
    mut second: Gizmos<Second>,
    mut third: Gizmos<Third>,
    mut fourth: Gizmos<Fourth>,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let layout = drawn(&comparison, area.is_some());
    if layout == Layout::Solo {
        return;
    }
    for (k, comparison) in shown(run, layout).into_iter().enumerate() {
        let trail = trails.points.iter().find(|(i, _)| *i == comparison.0);
        let lines = Lines {
            body: &run.law.body,
            edges: k > 0 && layout == Layout::Overlaid,
            reference: run
                .trusted()
                .filter(|_| k == 0 || layout != Layout::Overlaid),
            trail: trail.map(|(_, points)| points),
        };
        match (layout, k) {
            (Layout::Views, 1) => lines.draw(&mut second, comparison),
            (Layout::Views, 2) => lines.draw(&mut third, comparison),
            (Layout::Views, 3) => lines.draw(&mut fourth, comparison),
            _ => lines.draw(&mut first, comparison),
        }
    }
}

/// Lines of one trajectory.
struct Lines<'a> {
    body: &'a RigidBox,
    /// The box's own edges.
    edges: bool,
    reference: Option<&'a BodyState>,
    trail: Option<&'a VecDeque<(f64, Vec3)>>,
}

impl Lines<'_> {
    fn draw<G: GizmoConfigGroup>(
        &self,
        gizmos: &mut Gizmos<G>,
        (integrator, state, _, offset, _): Shown<'_>,
    ) {
        if self.edges {
            for [a, b] in edges(self.body, state, offset) {
                gizmos.line(a, b, color(integrator, 0.95));
            }
        }
        if let Some(reference) = self.reference {
            for [a, b] in edges(self.body, reference, offset) {
                for d in 0..DASHES {
                    let part = |s: f32| a.lerp(b, s / DASHES as f32);
                    let from = d as f32;
                    gizmos.line(part(from), part(from + 0.55), Color::WHITE);
                }
            }
        }
        if let Some(points) = self.trail {
            let count = points.len().max(2) as f32;
            gizmos.linestrip_gradient(
                points.iter().enumerate().map(|(n, (_, at))| {
                    (*at + offset, color(integrator, n as f32 / (count - 1.0)))
                }),
            );
        }
    }
}

/// The twelve edges.
fn edges(body: &RigidBox, state: &BodyState, offset: Vec3) -> [[Vec3; 2]; 12] {
    let half = body.half_extents();
    let corner = |k: usize| {
        let sign = |bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
        let local = half * bevy::math::DVec3::new(sign(1), sign(2), sign(4));
        state.point(local).as_vec3() + offset
    };
    let mut found = [[Vec3::ZERO; 2]; 12];
    let mut n = 0;
    for k in 0..8 {
        for bit in [1, 2, 4] {
            if k & bit == 0 {
                found[n] = [corner(k), corner(k | bit)];
                n += 1;
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_twelve_edges_of_its_size() {
        let body = RigidBox::new(bevy::math::DVec3::new(0.5, 0.25, 0.125), 1.0).expect("valid");
        let state = BodyState::at_pose(
            bevy::math::DVec3::ZERO,
            bevy::math::DQuat::from_rotation_x(0.7),
        );
        let lengths = edges(&body, &state, Vec3::X).map(|[a, b]| a.distance(b));
        for size in [1.0, 0.5, 0.25] {
            let count = lengths.iter().filter(|l| (*l - size).abs() < 1e-5);
            assert_eq!(count.count(), 4, "{size}");
        }
    }
}
