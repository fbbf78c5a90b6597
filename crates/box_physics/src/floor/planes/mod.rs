//! Contact with several planes: walls, ramps, trays.
//!
//! ```text
//! reach: the planes that the box can come near in this step, after any impacts
//!   none                → the integrator's plain step
//!   one                 → step_on_floor, in the axes of that plane
//!   several             → the same events, with the contacts of all planes (among)
//! ```
//!
//! A *contact* is a corner at a plane. Over several planes everything is in world axes, and each contact has its own
//! normal, friction and restitution.

mod among;
mod plane;
mod ride;

#[cfg(test)]
mod tests;

pub use plane::{Plane, StaticPlane};

use glam::{DMat3, DVec3};

use super::bounds::{acceleration_bound, curvature_bound};
use super::flight::may_touch_plane;
use super::frame::{Level, Method};
use super::ground::BodyStep;
use super::step::On;
use super::{ContactReport, ContactSettings, ContactState, Floor, FloorOutcome, step_on_floor};
use crate::body::RigidBox;
use crate::force::{ForceModel, fingerprint};
use crate::integrators::{Integrate, Integrator, IntegratorMemory, IntegratorVisitor, StepOutcome};
use crate::state::BodyState;
#[cfg(test)]
pub(super) use among::Gaps;
use among::PLANES;

/// The inputs of a step among planes. Of the planes within reach, only the six nearest are used.
#[derive(Clone, Copy, Debug)]
pub struct PlanesContext<'a, F> {
    /// The planes.
    pub planes: &'a [Plane],
    /// The contact settings.
    pub settings: &'a ContactSettings,
    /// The box.
    pub body: &'a RigidBox,
    /// The force model of the box, without contact.
    pub force: &'a F,
}

/// The planes within reach.
struct Near {
    count: usize,
    planes: [Plane; PLANES],
    /// Heights of the lowest corners over these planes at the start \[m\].
    gap: [f64; PLANES],
}

impl Near {
    fn planes(&self) -> &[Plane] {
        &self.planes[..self.count]
    }

    /// Adds a plane. If there are too many, the farthest is dropped.
    fn add(&mut self, plane: &Plane, gap: f64) {
        let farther = |far: usize, k: usize| if self.gap[k] > self.gap[far] { k } else { far };
        let mut place = self.count;
        if self.count < PLANES {
            self.count += 1;
        } else {
            place = (0..PLANES).fold(0, farther);
            if gap >= self.gap[place] {
                return;
            }
        }
        (self.planes[place], self.gap[place]) = (*plane, gap);
    }
}

/// The common velocity of all planes, or zero [m/s].
fn common_velocity(planes: &[Plane]) -> DVec3 {
    let mut velocities = planes.iter().map(|plane| plane.shape.velocity);
    let first = velocities.next().unwrap_or(DVec3::ZERO);
    match velocities.all(|v| v == first) {
        true => first,
        false => DVec3::ZERO,
    }
}

impl<F: ForceModel> PlanesContext<'_, F> {
    /// The planes that the box can come near within `h` \[s\], including after impacts, which add no energy.
    fn near(&self, state: &BodyState, h: f64) -> Near {
        let (body, radius) = (self.body, self.body.radius());
        // Relative to planes with a common velocity.
        let common = common_velocity(self.planes);
        let mut seen = *state;
        seen.velocity -= common;
        let twice = 2.0 * seen.kinetic_energy(body);
        let pull = 2.0 * h * acceleration_bound(body, state, self.force);
        let turn = h * (twice * body.inverse_inertia().max_element()).sqrt() + h * pull / radius;
        let way = h * ((twice * body.inverse_mass()).sqrt() + pull);
        let attitude = DMat3::from_quat(state.rotation);
        let mut thrown = 0.0;
        loop {
            let mut near = Near {
                count: 0,
                planes: [Plane::from(Floor::default()); PLANES],
                gap: [f64::INFINITY; PLANES],
            };
            for plane in self.planes {
                let height = plane.height(state.position);
                let now = reach(body, &attitude, plane.shape.normal);
                let turned = (now + turn * radius).min(radius);
                let speed = (plane.shape.velocity - common).length();
                let carried = h * 2.0 * speed.max(thrown);
                if height - turned <= way + carried + 4.0 * self.tolerance(state, plane) {
                    near.add(plane, height - now);
                }
            }
            // A moving plane may throw the body at others.
            let planes = near.planes().iter();
            let speeds = planes.map(|p| (p.shape.velocity - common).length());
            let fastest = speeds.fold(0.0, f64::max);
            if fastest <= thrown {
                return near;
            }
            thrown = fastest;
        }
    }

    /// Largest height of a corner that touches a plane \[m\].
    fn tolerance(&self, state: &BodyState, plane: &Plane) -> f64 {
        self.settings.tolerance * (self.body.radius() + plane.scale(state))
    }
}

/// Extent of the box from its center against `normal` \[m\].
fn reach(body: &RigidBox, attitude: &DMat3, normal: DVec3) -> f64 {
    let half = body.half_extents();
    attitude.x_axis.dot(normal).abs() * half.x
        + attitude.y_axis.dot(normal).abs() * half.y
        + attitude.z_axis.dot(normal).abs() * half.z
}

/// Returns `true` if the box may touch a plane within `h` \[s\]: [`may_touch`](super::may_touch) for any of them.
pub fn may_touch_planes<F: ForceModel>(
    planes: &[Plane],
    body: &RigidBox,
    state: &BodyState,
    force: &F,
    h: f64,
) -> bool {
    planes.iter().any(|plane| {
        let normal = plane.shape.normal;
        let reach = || reach(body, &DMat3::from_quat(state.rotation), normal);
        let height = plane.height(state.position);
        may_touch_plane((normal, height, plane.rise()), reach, body, state, force, h)
    })
}

/// Advances `state` by `h` \[s\] among planes, including free flight. A box that can reach only one plane in the step is
/// stepped by [`step_on_floor`] in the axes of that plane. The contacts with several planes are solved together.
///
/// The planes are those at the beginning of the step. Call [`Plane::advance`] after the step of all bodies.
pub fn step_on_planes<S: Integrate, F: ForceModel>(
    context: &PlanesContext<'_, F>,
    state: &mut BodyState,
    h: f64,
    memory: &mut IntegratorMemory,
    contact: &mut ContactState,
    mut report: Option<&mut ContactReport>,
) -> FloorOutcome {
    let mut outcome = FloorOutcome::default();
    if let Some(report) = &mut report {
        **report = ContactReport::default();
    }
    let (body, force) = (context.body, context.force);
    let level = Floor::default();
    let world = context.over(&level);
    let all = || fingerprint(context.planes.iter().copied().flat_map(Plane::numbers));
    if contact.is_resting(state) && contact.still_rests(&world, Some(all()), state) {
        outcome.resting = true;
        contact.report_rest(body, state, h, report);
        return outcome;
    }
    if h <= 0.0 || !h.is_finite() || !state.is_finite() {
        return outcome;
    }
    let near = context.near(state, h);
    if let [plane] = near.planes()
        && plane.axes.is_none()
    {
        let floor = context.over(&plane.surface);
        return step_on_floor::<S, F>(&floor, state, h, memory, contact, report);
    }
    let carried = common_velocity(near.planes());
    // Moving planes out of reach do not end the rest.
    if contact.rides(context, near.planes(), carried, state, h) {
        outcome.resting = true;
        contact.report_rest(body, state, h, report);
        return outcome;
    }
    contact.rest = None;
    let mut tried = StepOutcome::default();
    if contact.touching == 0 || near.count == 0 {
        let (mut end, spare) = (*state, &mut contact.spare.0[0]);
        spare.clone_from(memory);
        outcome.step = S::step(body, &mut end, force, h, spare);
        if near.count == 0 || context.clears(near.planes(), state, &end, h) {
            *state = end;
            core::mem::swap(memory, spare);
            contact.touching = 0;
            return outcome;
        }
        tried = outcome.step;
    }
    if S::MULTISTEP {
        memory.invalidate();
    }
    let method = Method::of::<S>();
    let mut step = BodyStep {
        state,
        h,
        memory,
        contact,
        report,
    };
    let reaction = match near.planes() {
        [plane] => {
            let (floor, frame) = plane.level(step.state);
            let floor = context.over(&floor);
            let level = Level::new(&floor, &method, frame);
            outcome = FloorOutcome::default();
            let loads = level.step(&mut step, None, &mut outcome);
            let normal = plane.shape.normal;
            if let Some(report) = step.report {
                report.normal = normal;
            }
            loads.map(|loads| (loads, normal))
        }
        planes => {
            let reaction;
            (outcome, reaction) = among::step(context, planes, carried, &method, step);
            reaction
        }
    };
    outcome.step += tried;
    outcome.count_once();
    if let Some((reaction, normal)) = reaction {
        outcome.resting = true;
        let (floor, planes) = if context.planes.iter().all(Plane::is_fixed) {
            (level, all())
        } else {
            let (on, _) = context.support(near.planes(), state, h);
            (level.with_velocity(carried), on)
        };
        state.velocity = carried;
        let floor = context.over(&floor);
        contact.establish_rest(&floor, Some((planes, normal)), state, 0.0, reaction);
    }
    outcome
}

impl<F: ForceModel> PlanesContext<'_, F> {
    /// Returns `true` if no corner touches one of these planes between `start` and `end`, `h` \[s\] later.
    fn clears(&self, planes: &[Plane], start: &BodyState, end: &BodyState, h: f64) -> bool {
        let body = self.body;
        let bound = acceleration_bound(body, start, self.force);
        let pull = self.force.acceleration();
        let axes = [start, end].map(|s| DMat3::from_quat(s.rotation));
        planes.iter().all(|plane| {
            let normal = plane.shape.normal;
            let margin = 2.0 * self.tolerance(start, plane);
            let before = plane.height(start.position) - reach(body, &axes[0], normal);
            let after =
                plane.height(end.position) - plane.rise() * h - reach(body, &axes[1], normal);
            let curvature = curvature_bound(body, start, bound, pull, normal);
            before > margin
                && after > margin
                && before.sqrt() + after.sqrt() >= h * (0.5 * curvature).sqrt()
        })
    }
}

impl Integrator {
    /// [`step_on_planes`] with the chosen integrator.
    pub fn step_on_planes<F: ForceModel>(
        self,
        context: &PlanesContext<'_, F>,
        state: &mut BodyState,
        h: f64,
        memory: &mut IntegratorMemory,
        contact: &mut ContactState,
        report: Option<&mut ContactReport>,
    ) -> FloorOutcome {
        let step = BodyStep {
            state,
            h,
            memory,
            contact,
            report,
        };
        self.dispatch(On(context, step))
    }
}

impl<F: ForceModel> IntegratorVisitor for On<'_, PlanesContext<'_, F>> {
    type Output = FloorOutcome;

    fn visit<S: Integrate>(self) -> FloorOutcome {
        let On(context, b) = self;
        step_on_planes::<S, F>(context, b.state, b.h, b.memory, b.contact, b.report)
    }
}
