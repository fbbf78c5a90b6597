//! The drawn trajectories, and their positions.

use std::iter;

use bevy::math::{DQuat, DVec3};
use bevy::prelude::*;
use bevy_egui::egui;
use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::Status;

use crate::action::compare::Layout;
use crate::camera::views;
use crate::compare::Run;
use crate::compare::runner::Runner;
use crate::compare::track::Track;
use crate::view::style;

/// Distance between two comparisons in radii of the box.
const PITCH: f32 = 2.7;

#[derive(Clone, Copy)]
pub(super) struct Shown<'a> {
    pub integrator: Integrator,
    pub state: BodyState,
    pub track: &'a Track,
    /// Shift of its picture.
    pub offset: Vec3,
    pub status: Status,
}

impl Shown<'_> {
    /// The position in the picture of a point in body axes \[m\].
    pub(super) fn place(&self, point: DVec3) -> Vec3 {
        self.state.point(point).as_vec3() + self.offset
    }
}

/// The picture of the first camera, and its content.
pub(super) struct Seen<'a> {
    pub run: &'a Run,
    pub layout: Layout,
    pub trajectories: Vec<Shown<'a>>,
    /// The point that labels follow, body axes \[m\].
    pub tip: DVec3,
    pub camera: &'a Camera,
    pub eye: &'a GlobalTransform,
    /// Points of the panel per logical pixel.
    pub scale: f32,
    /// The picture \[points\].
    pub view: egui::Rect,
}

impl Seen<'_> {
    /// Screen position of a world point.
    pub(super) fn at(&self, world: Vec3) -> Option<egui::Pos2> {
        let at = self.camera.world_to_viewport(self.eye, world).ok()?;
        Some(egui::pos2(at.x * self.scale, at.y * self.scale))
    }
}

/// An area of the screen, in points of the panel.
pub(super) fn points(rect: Rect, scale: f32) -> egui::Rect {
    let corner = |v: Vec2| egui::Pos2::from((scale * v).to_array());
    egui::Rect::from_min_max(corner(rect.min), corner(rect.max))
}

/// Every drawn trajectory, starting with the main box.
pub(super) fn shown(run: &Run, layout: Layout) -> Vec<Shown<'_>> {
    let side = sideways(run) * PITCH * run.law.body.radius() as f32;
    let runners: Vec<&Runner> = match layout {
        Layout::Solo => vec![&run.main_box],
        Layout::Overlaid | Layout::SideBySide => run.trajectories().collect(),
        Layout::Views => iter::once(&run.main_box).chain(in_views(run)).collect(),
    };
    let shown = runners.into_iter().enumerate().map(|(k, r)| Shown {
        integrator: r.integrator(),
        state: at_the_clock(run, r),
        track: &r.track,
        offset: match layout {
            Layout::SideBySide => side * place(k),
            Layout::Solo | Layout::Overlaid | Layout::Views => Vec3::ZERO,
        },
        status: r.simulation.status(),
    });
    shown.collect()
}

/// The comparisons in views, smallest error first. If there are too many: those with the smallest, the median and the
/// largest error.
fn in_views(run: &Run) -> Vec<&Runner> {
    let ranked = run.ranked();
    let last = views::MAX_VIEWS - 2;
    if ranked.len() < views::MAX_VIEWS {
        return ranked;
    }
    let nth = |k: usize| ranked[k * (ranked.len() - 1) / last];
    (0..=last).map(nth).collect()
}

/// The state of a comparison at the clock's time. A step longer than the clock's may end before it; the state is then
/// extrapolated from that end.
fn at_the_clock(run: &Run, runner: &Runner) -> BodyState {
    let driver = &runner.simulation.driver;
    let (mut state, ahead) = (driver.state, run.clock - driver.time);
    let between = 0.0..runner.factor * run.step;
    if between.contains(&ahead) && !runner.simulation.status().is_diverged() {
        let turn = state.angular_velocity(&run.law.body) * ahead;
        state.position += state.velocity * ahead;
        state.rotation = DQuat::from_scaled_axis(turn) * state.rotation;
    }
    state
}

/// Index of a place: the main box at 0, then alternately right and left of it.
fn place(k: usize) -> f32 {
    let ring = k.div_ceil(2) as f32;
    if k.is_multiple_of(2) { -ring } else { ring }
}

/// Horizontal direction perpendicular to the motion over the floor.
pub(super) fn sideways(run: &Run) -> Vec3 {
    let v = run.start().velocity.as_vec3();
    let along = Vec3::new(v.x, 0.0, v.z);
    if along.length() > 0.1 && run.law.floor().is_some() {
        along.cross(Vec3::Y).normalize()
    } else {
        Vec3::X
    }
}

pub(super) fn color(integrator: Integrator, alpha: f32) -> Color {
    style::of(integrator).srgb().with_alpha(alpha)
}

/// Length of a pin outside the box, relative to the box's radius.
const PIN: f64 = 0.35;

/// The ends of the pin through the box, body axes \[m\], along the spin axis, which a flip reverses. `None` for a box
/// that travels.
pub(super) fn pin(run: &Run) -> Option<[DVec3; 2]> {
    let start = run.start();
    let travels = start.velocity.length() > 0.1
        || run.law.floor().is_some()
        || run.law.forces.gravity.length() > 0.0;
    let half = run.law.body.half_extents();
    let axis = run.reference_flips.axis().unwrap_or(half.max_position());
    let inner = DVec3::AXES[axis] * half[axis];
    let outer = inner + DVec3::AXES[axis] * PIN * run.law.body.radius();
    (!travels).then_some([inner, outer])
}

/// The point that trails and labels follow, body axes \[m\].
pub(super) fn tip(run: &Run) -> DVec3 {
    pin(run).map_or(DVec3::ZERO, |[_, outer]| outer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_scenarios::Scenario;

    /// Only the picture is shifted: the drawn states are the simulated ones.
    #[test]
    fn comparisons_stand_side_by_side_in_the_picture_alone() {
        let setup = Scenario::find("slide").expect("a scene").setup;
        let mut run = Run::new(&setup, None, Integrator::Split, 1.0 / 60.0);
        run.choose([
            Integrator::Rk4,
            Integrator::ExplicitEuler,
            Integrator::Midpoint,
        ]);
        let places = shown(&run, Layout::SideBySide);
        assert_eq!(places.len(), 4);
        for (k, a) in places.iter().enumerate() {
            assert_eq!(a.state, setup.initial);
            // Across the slide, and apart.
            assert!(a.offset.x.abs() < 1e-6 && a.offset.y == 0.0);
            let apart = PITCH * setup.body.radius() as f32 * 0.99;
            let far = |b: &Shown<'_>| a.offset.distance(b.offset) > apart;
            assert!(places[..k].iter().all(far));
        }
        let overlaid = shown(&run, Layout::Overlaid);
        assert!(overlaid.iter().all(|s| s.offset == Vec3::ZERO));
        assert_eq!(shown(&run, Layout::Solo).len(), 1);
    }

    /// With more comparisons than views, the smallest, the median and the largest error are shown.
    #[test]
    fn views_show_the_range_of_errors() {
        let setup = Scenario::find("throw").expect("a scene").setup;
        let mut run = Run::new(&setup, None, Integrator::Split, 1.0 / 60.0);
        for (compared, wanted) in [(2, vec![0, 1]), (3, vec![0, 1, 2]), (7, vec![0, 3, 6])] {
            let others = || {
                Integrator::ALL
                    .iter()
                    .copied()
                    .filter(|i| *i != Integrator::Split)
            };
            run.choose(others().take(compared));
            let views = shown(&run, Layout::Views);
            let views: Vec<_> = views.iter().map(|t| t.integrator).collect();
            let others: Vec<_> = others().collect();
            let wanted = wanted.into_iter().map(|k: usize| others[k]);
            assert!([Integrator::Split].into_iter().chain(wanted).eq(views));
        }
    }

    /// A comparison with longer steps is drawn at the same time as all others.
    #[test]
    fn all_are_drawn_at_one_time() {
        let setup = Scenario::find("throw").expect("a scene").setup;
        let mut run = Run::new(&setup, None, Integrator::Split, 1.0 / 60.0);
        run.choose([Integrator::Rk4]);
        run.comparisons[0].factor = 3.0;
        run.clock = 2.0 / 60.0;
        let drawn = shown(&run, Layout::Overlaid)[1].state;
        let start = &setup.initial;
        let moved = drawn.position - start.position;
        assert!((moved - start.velocity * run.clock).length() < 1e-12);
        let turned = drawn.attitude_difference(start);
        let spin = start.angular_velocity(&setup.body).length();
        assert!((turned - spin * run.clock).abs() < 1e-9);
        // A comparison that catches up is drawn at its current state.
        run.clock = 1.0;
        assert_eq!(shown(&run, Layout::Overlaid)[1].state, *start);
    }
}
