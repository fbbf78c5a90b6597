//! One step over the floor.

use glam::DVec3;

use super::events::between_events;
use super::flight::{Flight, Flown, fly};
use super::frame::Method;
use super::geometry::Corners;
use super::ground::{BodyStep, Level};
use super::projection::recover_penetration;
use super::slide::{Slide, slide};
use super::{ContactReport, ContactState, FloorContext, FloorOutcome};
use crate::force::ForceModel;
use crate::integrators::{Integrate, Integrator, IntegratorMemory, IntegratorVisitor, StepOutcome};
use crate::state::BodyState;

/// Advances `state` by `h` \[s\] over the floor, free flight included: event by event,
///
/// - **impact** if a touching corner approaches: all touching corners at once, at this instant;
/// - else **motion** until the next corner touches or the time is over, with the floor holding the
///   corners that would sink (none of them: free flight by the bare integrator);
/// - **rest** if the box lies on a face and nothing moves it: the state stays bit for bit.
///
/// `h` must be ≥ 0; 0 changes nothing. A state that is not finite is left to the integrator.
///
/// ```
/// use box_physics::floor::{ContactState, FloorContext, step_on_floor};
/// use box_physics::force::Gravity;
/// use box_physics::prelude::*;
/// use box_physics::integrators::Split;
/// // A cube is dropped from a meter, without an App.
/// let (body, floor, settings) = (RigidBox::default(), Floor::default(), ContactSettings::default());
/// let weight = Gravity(DVec3::new(0.0, -9.81, 0.0));
/// let mut state = BodyState::at(DVec3::Y * 1.5);
/// let context = FloorContext { floor: &floor, settings: &settings, body: &body, force: &weight };
/// let (mut memory, mut contact) = (IntegratorMemory::default(), ContactState::default());
/// let h = 1.0 / 60.0;
/// for _ in 0..600 {
///     step_on_floor::<Split, _>(&context, &mut state, h, &mut memory, &mut contact, None);
/// }
/// assert!(contact.is_resting(&state) && (state.position.y - 0.5).abs() < 1e-9);
/// ```
pub fn step_on_floor<S: Integrate, F: ForceModel>(
    context: &FloorContext<'_, F>,
    state: &mut BodyState,
    h: f64,
    memory: &mut IntegratorMemory,
    contact: &mut ContactState,
    report: Option<&mut ContactReport>,
) -> FloorOutcome {
    let mut outcome = FloorOutcome::default();
    if contact.still_rests(context, None, state) {
        outcome.resting = true;
        contact.ride(state, h);
        if let (Some(report), Some(rest)) = (report, &contact.rest) {
            *report = held(context, state, 0.0, h, &rest.reaction, contact.touching);
        }
        return outcome;
    }
    if h <= 0.0 || !h.is_finite() || !state.is_finite() {
        return outcome;
    }
    contact.rest = None;
    let mut flown = None;
    if contact.touching == 0 {
        match fly::<S, F>(context, state, h, memory, &mut contact.spare.0[0]) {
            Flight::Clear(flight) => {
                outcome.step = flight;
                return outcome;
            }
            Flight::Meets(mut segment) => {
                context.to_floor(&mut segment.state, h);
                flown = Some(segment);
            }
            Flight::Low => {}
        }
    }
    context.to_floor(state, 0.0);
    let mut step = BodyStep::new(state, h, memory, contact, report);
    outcome = in_floor_frame(context, &Method::of::<S>(), &mut step, flown);
    context.to_world(state, h);
    outcome.count_once();
    outcome
}

impl Integrator {
    /// [`step_on_floor`] by the chosen integrator.
    #[inline]
    pub fn step_on_floor<F: ForceModel>(
        self,
        context: &FloorContext<'_, F>,
        state: &mut BodyState,
        h: f64,
        memory: &mut IntegratorMemory,
        contact: &mut ContactState,
        report: Option<&mut ContactReport>,
    ) -> FloorOutcome {
        let step = BodyStep::new(state, h, memory, contact, report);
        self.dispatch(On(context, step))
    }
}

/// A step by the chosen integrator.
pub(super) struct On<'a, C>(pub(super) &'a C, pub(super) BodyStep<'a>);

impl<F: ForceModel> IntegratorVisitor for On<'_, FloorContext<'_, F>> {
    type Output = FloorOutcome;

    fn visit<S: Integrate>(self) -> FloorOutcome {
        let On(context, b) = self;
        step_on_floor::<S, F>(context, b.state, b.h, b.memory, b.contact, b.report)
    }
}

/// The step of a box that touches the floor or may. `flown` is the plain step, if it is known.
pub(super) fn in_floor_frame<F: ForceModel>(
    context: &FloorContext<'_, F>,
    method: &Method<F>,
    step: &mut BodyStep<'_>,
    flown: Option<Flown>,
) -> FloorOutcome {
    let (h, touching) = (step.h, step.contact.touching);
    let mut slid = None;
    if touching.count_ones() == 4 {
        slid = slide(context, method, step.state, h, touching);
        if let Some(slide) = &slid
            && slide.time == h
        {
            if let Some(report) = &mut step.report {
                **report = held(context, step.state, h, h, &slide.load, touching);
            }
            return slide.outcome();
        }
    }
    let level = Level {
        context,
        method,
        tolerance: context.tolerated_height(),
    };
    level.by_events(step, flown, slid)
}

impl Slide {
    fn outcome(&self) -> FloorOutcome {
        FloorOutcome {
            step: StepOutcome::plain(self.evaluations),
            ..FloorOutcome::default()
        }
    }
}

impl<F: ForceModel> Level<'_, F> {
    /// Event after event. `slid` is what a slide has made of the step until it stopped.
    #[inline(never)] // its large frame is not for boxes that rest or fly
    fn by_events(
        &self,
        step: &mut BodyStep<'_>,
        flown: Option<Flown>,
        slid: Option<Slide>,
    ) -> FloorOutcome {
        let (context, h) = (self.context, step.h);
        let mut outcome = slid
            .as_ref()
            .map_or_else(FloorOutcome::default, Slide::outcome);
        let mut corners = Corners::at(context.floor, context.body, step.state);
        if let Some(report) = &mut step.report {
            **report = ContactReport::default();
            if let Some(slide) = &slid {
                let center = context.world_point(step.state.position, slide.time);
                report.hold(center, &corners, slide.time, &slide.load);
            }
        }
        // A box that starts below the floor (the floor was raised, the box was put there) is lifted out; its
        // velocity stays what it was, so depth never turns into speed.
        if corners.lowest() < -self.tolerance {
            recover_penetration(context.floor, step.state, &mut corners);
        }
        let remaining = h - slid.map_or(0.0, |slide| slide.time);
        let loads = between_events(self, step, &mut corners, remaining, flown, &mut outcome);
        recover_penetration(context.floor, step.state, &mut corners);
        let now = corners.touching(2.0 * self.tolerance) as u8;
        if let Some(report) = &mut step.report {
            let center = context.world_point(step.state.position, h);
            report.end(center, &corners, now);
            report.normal = DVec3::Y;
        }
        step.contact.touching = now;
        if let Some(loads) = loads {
            step.contact
                .establish_rest(context, None, step.state, h, loads);
            outcome.resting = true;
        }
        outcome
    }
}

/// The step of corners that touched before and do now, held by these forces \[N\]. `state` is in the frame of the floor
/// `elapsed` \[s\] after the two coincided.
fn held<F>(
    context: &FloorContext<'_, F>,
    state: &BodyState,
    elapsed: f64,
    h: f64,
    load: &[f64; 8],
    touching: u8,
) -> ContactReport {
    let mut report = ContactReport::default();
    let corners = Corners::at(context.floor, context.body, state);
    let center = context.world_point(state.position, elapsed);
    report.hold(center, &corners, h, load);
    report.end(center, &corners, touching);
    report
}
