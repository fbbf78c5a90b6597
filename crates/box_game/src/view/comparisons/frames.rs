//! Lines on the boxes: their edges (faint where hidden), the reference dashed, pins and fading trails.

use std::collections::VecDeque;

use bevy::math::DVec3;
use bevy::prelude::*;
use box_physics::aabb::corners;
use box_physics::prelude::{BodyState, Integrator, RigidBox};
use box_scenarios::Model;
use box_scenarios::style::{Dash, style};

use super::acting;
use super::shown::{Shown, color, drawn, pin, shown, tip};
use crate::action::compare::Layout;
use crate::camera::views::{Edges, Fourth, HiddenEdges, PictureArea, Pins, Second, Third};
use crate::compare::{Comparison, Quantity};
use crate::view::marks;

/// Length of a trail \[s\], and its largest number of points.
const TRAIL: f64 = 1.5;
const TRAIL_POINTS: usize = 96;

/// Past places of the marked point of every trajectory, newest last; the main box first.
#[derive(Resource, Default)]
pub(super) struct Trails {
    points: Vec<(Integrator, VecDeque<(f64, Vec3)>)>,
}

/// Follows a point of every trajectory: the center where the box travels, else the end of its pin, which shows
/// a flip.
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

/// Opacity of an edge behind a face.
const HIDDEN: f32 = 0.3;
/// Angle to the reference from which a comparison shows the marks on its faces \[°\].
const MARKED: f64 = 2.0;

/// Edges, pins and trails of every trajectory, and the reference, each in its view.
pub(super) fn draw_frames(
    comparison: Res<Comparison>,
    trails: Res<Trails>,
    area: Option<Res<PictureArea>>,
    (mut edges, mut hidden, mut pins): (Gizmos<Edges>, Gizmos<HiddenEdges>, Gizmos<Pins>),
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
    for (k, trajectory) in shown(run, layout).into_iter().enumerate() {
        let trail = trails.points.iter().find(|(i, _)| *i == trajectory.0);
        let lines = Lines {
            law: &run.law,
            pin: pin(run),
            solid: k == 0 || layout != Layout::Overlaid,
            reference: run
                .trusted()
                .filter(|_| k == 0 || layout != Layout::Overlaid),
            trail: trail.map(|(_, points)| points),
        };
        match (layout, k) {
            (Layout::Views, 1) => lines.draw(&mut second, None, trajectory),
            (Layout::Views, 2) => lines.draw(&mut third, None, trajectory),
            (Layout::Views, 3) => lines.draw(&mut fourth, None, trajectory),
            _ => lines.draw(&mut edges, Some((&mut hidden, &mut pins)), trajectory),
        }
    }
}

/// Lines of one trajectory.
struct Lines<'a> {
    law: &'a Model,
    pin: Option<[DVec3; 2]>,
    /// It has a solid box, not edges alone.
    solid: bool,
    reference: Option<&'a BodyState>,
    trail: Option<&'a VecDeque<(f64, Vec3)>>,
}

impl Lines<'_> {
    fn draw<G: GizmoConfigGroup>(
        &self,
        gizmos: &mut Gizmos<G>,
        mut first: Option<(&mut Gizmos<HiddenEdges>, &mut Gizmos<Pins>)>,
        (integrator, state, track, offset, status): Shown<'_>,
    ) {
        // A comparison that was given up is gray.
        let own = |alpha: f32| match status.is_diverged() {
            true => Color::srgba(0.5, 0.5, 0.5, alpha),
            false => color(integrator, alpha),
        };
        let mut line = |[a, b]: [Vec3; 2], color: Color, hidden: bool| {
            gizmos.line(a, b, color);
            if let (true, Some((behind, _))) = (hidden, &mut first) {
                behind.line(a, b, color.with_alpha(HIDDEN * color.alpha()));
            }
        };
        let bright = own(1.0).mix(&Color::WHITE, 0.55);
        let edge = if self.solid { bright } else { own(1.0) };
        // A comparison's edges have the dashes of its integrator, as its curves do.
        let dash = if self.solid {
            Dash::Solid
        } else {
            style(integrator).dash
        };
        for ends in edges(&self.law.body, state, offset) {
            for piece in pieces(ends, dash) {
                line(piece, edge, !self.solid);
            }
        }
        let apart = track.now.sample.get(Quantity::Attitude);
        if !self.solid && (apart.is_nan() || apart > MARKED) {
            for ends in marks::lines(self.law.body.half_extents().as_vec3()) {
                let place = |p: Vec3| state.point(p.as_dvec3()).as_vec3() + offset;
                line(ends.map(place), own(1.0), false);
            }
        }
        if let Some(reference) = self.reference {
            for ends in edges(&self.law.body, reference, offset) {
                for piece in pieces(ends, Dash::Dashed) {
                    line(piece, Color::WHITE, true);
                }
            }
        }
        acting::draw(gizmos, self.law, state, offset, bright);
        if let Some(ends) = self.pin {
            let place = |p: DVec3| state.point(p).as_vec3() + offset;
            let [inner, outer] = ends.map(place);
            let [back, far] = ends.map(|p| place(-p));
            let ball = 0.1 * (outer - inner).length();
            match first {
                Some((_, pins)) => {
                    pins.line(inner, outer, bright);
                    pins.sphere(outer, ball, bright).resolution(8);
                    pins.line(back, far, own(1.0).darker(0.12));
                }
                None => {
                    gizmos.line(inner, outer, bright);
                    gizmos.sphere(outer, ball, bright).resolution(8);
                    gizmos.line(back, far, own(1.0).darker(0.12));
                }
            }
        }
        if let Some(points) = self.trail {
            let count = points.len().max(2) as f32;
            gizmos.linestrip_gradient(
                points
                    .iter()
                    .enumerate()
                    .map(|(n, (_, at))| (*at + offset, own(n as f32 / (count - 1.0)))),
            );
        }
    }
}

/// An edge in the dashes of a line's style.
fn pieces([a, b]: [Vec3; 2], dash: Dash) -> impl Iterator<Item = [Vec3; 2]> {
    let (count, filled) = match dash {
        Dash::Solid => (1, 1.0),
        Dash::Long => (3, 0.75),
        Dash::Dashed => (6, 0.55),
        Dash::Dotted => (14, 0.35),
    };
    let part = move |s: f32| a.lerp(b, s / count as f32);
    (0..count).map(move |k| [part(k as f32), part(k as f32 + filled)])
}

/// The twelve edges.
fn edges(body: &RigidBox, state: &BodyState, offset: Vec3) -> impl Iterator<Item = [Vec3; 2]> {
    let corners = corners(body.half_extents()).map(|c| state.point(c).as_vec3() + offset);
    let ends = (0..8).flat_map(|k| [1, 2, 4].map(|bit| (k, k | bit)));
    ends.filter(|(k, other)| k != other)
        .map(move |(k, other)| [corners[k], corners[other]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_twelve_edges_of_its_size() {
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 1.0).expect("valid");
        let state = BodyState::at_pose(DVec3::ZERO, bevy::math::DQuat::from_rotation_x(0.7));
        let lengths: Vec<_> = edges(&body, &state, Vec3::X)
            .map(|[a, b]| a.distance(b))
            .collect();
        assert_eq!(lengths.len(), 12);
        for size in [1.0, 0.5, 0.25] {
            let count = lengths.iter().filter(|l| (*l - size).abs() < 1e-5);
            assert_eq!(count.count(), 4, "{size}");
        }
    }
}
