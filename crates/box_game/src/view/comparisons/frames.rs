//! Lines on the boxes: their edges (faint where hidden), the reference dashed, pins and fading trails.

use std::collections::VecDeque;

use bevy::math::DVec3;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use box_physics::aabb::corners;
use box_physics::prelude::Integrator;
use box_scenarios::style::{Dash, style};

use super::acting;
use super::shown::{Shown, color, pin, shown, tip};
use crate::action::compare::Layout;
use crate::camera::views::{Edges, Fourth, HiddenEdges, Pins, Second, Third};
use crate::compare::{Comparison, Quantity, Run};
use crate::view::marks;

/// Length of a trail \[s\], and its maximum number of points.
const TRAIL: f64 = 1.5;
const TRAIL_POINTS: usize = 96;
/// Opacity of an edge behind a face.
const HIDDEN: f32 = 0.3;
/// Angle to the reference above which a comparison shows the marks on its faces \[°\].
const MIN_MARKED_ANGLE: f64 = 2.0;

/// Past positions of the marked point of every trajectory, with their times \[s\], newest last.
#[derive(Resource, Default)]
pub(super) struct Trails(HashMap<Integrator, VecDeque<(f64, Vec3)>>);

/// Records a point of every trajectory: the center of a box that travels, otherwise the end of its pin, which shows a
/// flip.
pub(super) fn lengthen_trails(comparison: Res<Comparison>, mut trails: ResMut<Trails>) {
    let Some(run) = &comparison.run else {
        return;
    };
    let (tip, now) = (tip(run), run.clock);
    let wanted = shown(run, comparison.settings.layout);
    let is_wanted = |i: &Integrator| wanted.iter().any(|t| t.integrator == *i);
    trails.0.retain(|integrator, _| is_wanted(integrator));
    for trajectory in wanted {
        let points = trails.0.entry(trajectory.integrator).or_default();
        // After a restart, or a step back.
        while points.back().is_some_and(|(t, _)| *t > now) {
            points.pop_back();
        }
        let last = points.back().map_or(f64::NEG_INFINITY, |(t, _)| *t);
        if now - last > TRAIL / TRAIL_POINTS as f64 {
            points.push_back((now, trajectory.state.point(tip).as_vec3()));
        }
        while points.front().is_some_and(|(t, _)| now - t > TRAIL) {
            points.pop_front();
        }
    }
}

/// Draws edges, pins and trails of every trajectory, and the reference, each in its view.
pub(super) fn draw_frames(
    comparison: Res<Comparison>,
    trails: Res<Trails>,
    (mut edges, mut hidden, mut pins): (Gizmos<Edges>, Gizmos<HiddenEdges>, Gizmos<Pins>),
    mut second: Gizmos<Second>,
    mut third: Gizmos<Third>,
    mut fourth: Gizmos<Fourth>,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let layout = comparison.settings.layout;
    if layout == Layout::Solo {
        return;
    }
    for (k, trajectory) in shown(run, layout).into_iter().enumerate() {
        let lines = Lines {
            run,
            solid: k == 0 || layout != Layout::Overlaid,
            trail: trails.0.get(&trajectory.integrator),
            trajectory,
        };
        match (layout, k) {
            (Layout::Views, 1) => lines.draw(&mut second, None),
            (Layout::Views, 2) => lines.draw(&mut third, None),
            (Layout::Views, 3) => lines.draw(&mut fourth, None),
            _ => lines.draw(&mut edges, Some((&mut hidden, &mut pins))),
        }
    }
}

struct Lines<'a> {
    run: &'a Run,
    /// `true` if it has a solid box in addition to edges.
    solid: bool,
    trail: Option<&'a VecDeque<(f64, Vec3)>>,
    trajectory: Shown<'a>,
}

impl Lines<'_> {
    fn draw<G: GizmoConfigGroup>(
        &self,
        gizmos: &mut Gizmos<G>,
        mut first: Option<(&mut Gizmos<HiddenEdges>, &mut Gizmos<Pins>)>,
    ) {
        let (run, trajectory) = (self.run, &self.trajectory);
        let half = run.law.body.half_extents();
        // A diverged comparison is gray.
        let own = |alpha: f32| match trajectory.status.is_diverged() {
            true => Color::srgba(0.5, 0.5, 0.5, alpha),
            false => color(trajectory.integrator, alpha),
        };
        let mut line = |[a, b]: [Vec3; 2], color: Color, hidden: bool| {
            gizmos.line(a, b, color);
            if let (true, Some((behind, _))) = (hidden, &mut first) {
                behind.line(a, b, color.with_alpha(HIDDEN * color.alpha()));
            }
        };
        let bright = own(1.0).mix(&Color::WHITE, 0.55);
        // A comparison's edges have the dash pattern of its integrator, like its curves.
        let (edge, dash) = match self.solid {
            true => (bright, Dash::Solid),
            false => (own(1.0), style(trajectory.integrator).dash),
        };
        for ends in edges(half) {
            for piece in pieces(ends.map(|p| trajectory.place(p)), dash) {
                line(piece, edge, !self.solid);
            }
        }
        let apart = trajectory.track.now.sample.get(Quantity::Attitude);
        if !self.solid && (apart.is_nan() || apart > MIN_MARKED_ANGLE) {
            for ends in marks::lines(half.as_vec3()) {
                line(
                    ends.map(|p| trajectory.place(p.as_dvec3())),
                    own(1.0),
                    false,
                );
            }
        }
        if let Some(&state) = run.trusted().filter(|_| self.solid) {
            let reference = Shown {
                state,
                ..*trajectory
            };
            for ends in edges(half) {
                for piece in pieces(ends.map(|p| reference.place(p)), Dash::Dashed) {
                    line(piece, Color::WHITE, true);
                }
            }
        }
        acting::draw(gizmos, &run.law, trajectory, bright);
        if let Some(ends) = pin(run) {
            match first {
                Some((_, pins)) => draw_pin(pins, trajectory, ends, bright, own(1.0)),
                None => draw_pin(gizmos, trajectory, ends, bright, own(1.0)),
            }
        }
        if let Some(points) = self.trail {
            let last = (points.len().max(2) - 1) as f32;
            let point = |(n, (_, at)): (usize, &(f64, Vec3))| {
                (*at + trajectory.offset, own(n as f32 / last))
            };
            gizmos.linestrip_gradient(points.iter().enumerate().map(point));
        }
    }
}

/// Draws the pin through a box: a bright end with a ball, and a dark end.
fn draw_pin<G: GizmoConfigGroup>(
    gizmos: &mut Gizmos<G>,
    trajectory: &Shown<'_>,
    ends: [DVec3; 2],
    bright: Color,
    own: Color,
) {
    let [inner, outer] = ends.map(|p| trajectory.place(p));
    let [back, far] = ends.map(|p| trajectory.place(-p));
    gizmos.line(inner, outer, bright);
    let ball = 0.1 * (outer - inner).length();
    gizmos.sphere(outer, ball, bright).resolution(8);
    gizmos.line(back, far, own.darker(0.12));
}

/// Splits an edge into the dashes of a line's style.
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

/// The twelve edges, body axes \[m\].
fn edges(half: DVec3) -> impl Iterator<Item = [DVec3; 2]> {
    let corners = corners(half);
    let ends = (0..8).flat_map(|k| [1, 2, 4].map(|bit| (k, k | bit)));
    ends.filter(|(k, other)| k != other)
        .map(move |(k, other)| [corners[k], corners[other]])
}
