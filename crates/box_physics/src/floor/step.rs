//! One step over the floor.

use super::events::between_events;
use super::flight::{Flight, Flown, fly};
use super::frame::{Frame, Level, Method};
use super::ground::{BodyStep, Ground};
use super::{ContactReport, ContactState, FloorContext, FloorOutcome};
use crate::force::ForceModel;
use crate::integrators::{Integrate, Integrator, IntegratorMemory, IntegratorVisitor, StepOutcome};
use crate::state::BodyState;

/// Advances `state` by `h` \[s\] over the floor, including free flight, event by event:
///
/// - **impact** if a touching corner approaches: all touching corners at once, at this instant;
/// - otherwise **motion** until the next corner touches or the step ends; the floor holds corners that would sink;
/// - **rest** if the box is on a face and nothing moves it: no bit of the state changes.
///
/// `h` must be ≥ 0; 0 changes nothing. A state that is not finite is unchanged.
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
    mut report: Option<&mut ContactReport>,
) -> FloorOutcome {
    let mut outcome = FloorOutcome::default();
    if let Some(report) = &mut report {
        **report = ContactReport::default();
    }
    if contact.still_rests(context, None, state) {
        outcome.resting = true;
        contact.ride(state, h);
        contact.report_rest(context.body, state, h, report);
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
            Flight::Meets(segment) => flown = Some(segment),
            Flight::Low => {}
        }
    }
    if S::MULTISTEP {
        memory.invalidate();
        outcome.step += flown
            .take()
            .map_or(StepOutcome::default(), |tried| tried.outcome);
    }
    let method = Method::of::<S>();
    let level = Level::new(context, &method, Frame::new(context.floor.velocity, None));
    let mut step = BodyStep {
        state,
        h,
        memory,
        contact,
        report,
    };
    let loads = level.step(&mut step, flown, &mut outcome);
    outcome.count_once();
    if let Some(loads) = loads {
        outcome.resting = true;
        contact.establish_rest(context, None, state, h, loads);
    }
    outcome
}

impl Integrator {
    /// [`step_on_floor`] with the chosen integrator.
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

/// A step with the chosen integrator.
pub(super) struct On<'a, C>(pub(super) &'a C, pub(super) BodyStep<'a>);

impl<F: ForceModel> IntegratorVisitor for On<'_, FloorContext<'_, F>> {
    type Output = FloorOutcome;

    fn visit<S: Integrate>(self) -> FloorOutcome {
        let On(context, b) = self;
        step_on_floor::<S, F>(context, b.state, b.h, b.memory, b.contact, b.report)
    }
}

impl<F: ForceModel> Level<'_, F> {
    /// Steps a box that touches the surface or may touch it. `flown` is the plain step, if known. Returns the forces at the
    /// corners \[N\] if the step ends at rest.
    pub(super) fn step(
        &self,
        step: &mut BodyStep<'_>,
        flown: Option<Flown>,
        outcome: &mut FloorOutcome,
    ) -> Option<[f64; 8]> {
        let frame = &self.frame;
        if frame.is_world() {
            return self.in_frame(step, flown, outcome);
        }
        let world = *step.state;
        frame.to_surface(step.state, 0.0);
        let start = *step.state;
        let flown = flown.map(|mut flown| {
            frame.to_surface(&mut flown.state, step.h);
            flown
        });
        let loads = self.in_frame(step, flown, outcome);
        if let Some(report) = &mut step.report {
            report.tangential_impulse = frame.vector(report.tangential_impulse);
        }
        if frame.is_turned() && !frame.moves() && *step.state == start {
            *step.state = world; // exact to the last bit
        } else {
            frame.to_world(step.state, step.h);
            if frame.is_turned() {
                step.state.renormalize();
            }
        }
        loads
    }

    /// The step in the frame of the surface.
    #[inline]
    fn in_frame(
        &self,
        step: &mut BodyStep<'_>,
        flown: Option<Flown>,
        outcome: &mut FloorOutcome,
    ) -> Option<[f64; 8]> {
        let (h, touching) = (step.h, step.contact.touching);
        let mut remaining = h;
        if let Some(time) = self.slide(step, h, touching.into(), outcome) {
            remaining = h - time;
            if remaining == 0.0 {
                if let Some(report) = &mut step.report {
                    let corners = self.places(step.state, h);
                    report.end(|k| self.point(step.state, &corners, k, h), touching);
                }
                return None;
            }
        }
        self.by_events(step, remaining, flown, outcome)
    }

    /// Takes the last `remaining` \[s\] of the step event by event.
    #[inline(never)] // its frame is too large for boxes at rest or in flight
    fn by_events(
        &self,
        step: &mut BodyStep<'_>,
        remaining: f64,
        flown: Option<Flown>,
        outcome: &mut FloorOutcome,
    ) -> Option<[f64; 8]> {
        let mut corners = self.places(step.state, 0.0);
        // Penetration recovery keeps the velocity, so depth never becomes speed.
        if corners.lowest() < -self.tolerance {
            self.recover(step.state, &mut corners, 0.0);
        }
        let loads = between_events(self, step, &mut corners, remaining, flown, outcome);
        self.recover(step.state, &mut corners, step.h);
        let now = corners.touching(2.0 * self.tolerance) as u8;
        if let Some(report) = &mut step.report {
            report.end(|k| self.point(step.state, &corners, k, step.h), now);
            report.normal = glam::DVec3::Y;
        }
        step.contact.touching = now;
        loads
    }
}
