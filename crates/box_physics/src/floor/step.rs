//! One step over the floor: segments of motion between events.

use glam::DVec3;

use super::bounds::{acceleration_bound, curvature_bound, normal_velocities, spin_bound};
use super::event::Search;
use super::flight::{Flight, Flown, fly};
use super::frame::Method;
use super::geometry::{Corners, has};
use super::impact::{ImpactKind, resolve_impact};
use super::projection::recover_penetration;
use super::slide::{Slide, slide};
use super::sustained::{Segment, Start, candidates, limit_energy, longest_segment};
use super::{ContactReport, ContactState, FloorContext, FloorOutcome};
use crate::force::ForceModel;
use crate::integrators::{Integrate, Integrator, IntegratorMemory, IntegratorVisitor, StepOutcome};
use crate::state::BodyState;

/// Segments of sustained motion in a step; a body that needs more gets longer ones.
pub(super) const MAX_SEGMENTS: u32 = 256;
/// Evaluations that the search for one event may take, in flight and with corners held.
pub(super) const SEARCH_BUDGET: u32 = 4096;
pub(super) const SEARCH_BUDGET_HELD: u32 = 128;
/// Dips that are looked for, over the tolerance: in flight as deep as a corner may ever be below the floor
/// (1e-9 of the scale); with corners held, where the motion itself is of second order, 1e-6.
pub(super) const DIP_FREE: f64 = 1e3;
pub(super) const DIP_HELD: f64 = 1e6;
/// Tries to find the moment at which a slip stops: one is enough where the deceleration is constant.
pub(super) const STOP_TRIES: u32 = 8;
/// Part of a segment in which such a moment need not be found any better: at a constant deceleration, whose
/// moment is found at once, that would be a way of 5e-5 of what the deceleration makes in the segment.
pub(super) const SHORTEST_STOP: f64 = 1e-2;
/// Rounds of the loop in one step.
pub(super) const MAX_ROUNDS: u32 = 4 * MAX_SEGMENTS;
/// Force evaluations in one step.
pub(super) const MAX_EVALUATIONS: u64 = 40_000;
/// Solver iterations in one step, over all events: what bounds the work when nothing converges.
pub(super) const MAX_TOTAL_ITERATIONS: u32 = 100_000;

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
    let method = Method::of::<S>();
    outcome = in_floor_frame(context, &method, state, h, memory, contact, report, flown);
    context.to_world(state, h);
    // However many segments and trials it took: one step gave way once.
    outcome.step.fallbacks = outcome.step.fallbacks.min(1);
    outcome.step.unconverged = outcome.step.unconverged.min(1);
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
        self.dispatch(StepOnFloor {
            context,
            state,
            h,
            memory,
            contact,
            report,
        })
    }
}

/// The arguments of [`Integrator::step_on_floor`].
struct StepOnFloor<'a, 'c, F> {
    context: &'a FloorContext<'c, F>,
    state: &'a mut BodyState,
    h: f64,
    memory: &'a mut IntegratorMemory,
    contact: &'a mut ContactState,
    report: Option<&'a mut ContactReport>,
}

impl<F: ForceModel> IntegratorVisitor for StepOnFloor<'_, '_, F> {
    type Output = FloorOutcome;

    fn visit<S: Integrate>(self) -> FloorOutcome {
        let (state, memory, contact) = (self.state, self.memory, self.contact);
        step_on_floor::<S, F>(self.context, state, self.h, memory, contact, self.report)
    }
}

/// The step of a box that touches the floor or may. `flown` is the plain step, if it is known.
#[allow(
    clippy::too_many_arguments,
    reason = "the arguments of `step_on_floor`"
)]
pub(super) fn in_floor_frame<F: ForceModel>(
    context: &FloorContext<'_, F>,
    method: &Method<F>,
    state: &mut BodyState,
    h: f64,
    memory: &mut IntegratorMemory,
    contact: &mut ContactState,
    report: Option<&mut ContactReport>,
    flown: Option<Flown>,
) -> FloorOutcome {
    let touching = contact.touching;
    let mut slid = None;
    if touching.count_ones() == 4 {
        slid = slide(context, method, state, h, touching);
        if let Some(slide) = &slid
            && slide.time == h
        {
            if let Some(report) = report {
                *report = held(context, state, h, h, &slide.load, touching);
            }
            let step = StepOutcome::plain(slide.evaluations);
            return FloorOutcome {
                step,
                ..FloorOutcome::default()
            };
        }
    }
    between_events(
        context, method, state, h, memory, contact, report, flown, slid,
    )
}

/// Segment after segment. `slid` is what a slide has made of the step until it stopped.
#[allow(
    clippy::too_many_arguments,
    reason = "where a step begins, and how far it has come"
)]
#[inline(never)] // its large frame is not for boxes that rest or fly
fn between_events<F: ForceModel>(
    context: &FloorContext<'_, F>,
    method: &Method<F>,
    state: &mut BodyState,
    h: f64,
    memory: &mut IntegratorMemory,
    contact: &mut ContactState,
    report: Option<&mut ContactReport>,
    mut flown: Option<Flown>,
    slid: Option<Slide>,
) -> FloorOutcome {
    let mut outcome = FloorOutcome::default();
    let &FloorContext {
        floor,
        settings,
        body,
        force,
    } = context;
    let tolerance = context.tolerated_height();
    let [first, second] = core::mem::take(&mut contact.spare.0);
    let (mut first, mut second) = (Segment::new(first), Segment::new(second));
    let mut report = report;
    if let Some(report) = &mut report {
        **report = ContactReport::default();
    }
    let mut remaining = h;
    if let Some(slide) = slid {
        remaining -= slide.time;
        outcome.step = StepOutcome::plain(slide.evaluations);
        let center = context.world_point(state.position, slide.time);
        let corners = Corners::at(floor, body, state);
        if let Some(report) = &mut report {
            report.hold(center, &corners, slide.time, &slide.load);
        }
    }
    let (mut held_segments, mut rounds, mut iterations) = (0, 0, 0);
    let mut still = None;
    let mut corners = Corners::at(floor, body, state);
    // A box that starts below the floor (the floor was raised, the box was put there) is lifted out; its
    // velocity stays what it was, so depth never turns into speed.
    if corners.lowest() < -tolerance {
        recover_penetration(floor, state, &mut corners);
    }

    while remaining > 0.0 {
        rounds += 1;
        let exhausted = rounds > MAX_ROUNDS
            || iterations > MAX_TOTAL_ITERATIONS
            || outcome.step.evaluations > MAX_EVALUATIONS
            || outcome.impacts_capped > settings.max_impacts;
        if exhausted {
            outcome.solves_capped += 1;
            remainder_of_step(context, method, state, h - remaining, remaining, memory);
            corners = Corners::at(floor, body, state);
            break;
        }
        let touching = corners.touching(2.0 * tolerance);
        let normal = normal_velocities(body, state, &corners);
        let elapsed = h - remaining;
        let mut in_world = *state;
        context.to_world(&mut in_world, elapsed);
        let pull = acceleration_bound(body, &in_world, force);
        let speed = state.velocity.length() + body.radius() * spin_bound(body, state);
        // A hop u²/2A lower than the tolerance does not count.
        let hold = 1e-10 * speed + (2.0 * pull * tolerance).sqrt();

        if (0..8).any(|k| has(touching, k) && normal[k] < -hold) {
            let kind = if outcome.impacts < settings.max_impacts {
                ImpactKind::Ordinary
            } else {
                outcome.impacts_capped += 1;
                ImpactKind::Resting
            };
            let hit = resolve_impact(context, state, &corners, touching, kind);
            if let Some(report) = &mut report {
                let fastest = (0..8).filter(|&k| has(touching, k)).map(|k| -normal[k]);
                report.strike(h - remaining, fastest.fold(0.0, f64::max));
                report.add(in_world.position, &corners.lever, &hit.impulse);
            }
            outcome.impacts += 1;
            outcome.solves_capped += u32::from(hit.capped);
            outcome.repair(hit.repaired);
            iterations += hit.iterations;
            continue;
        }

        let held = candidates(touching, &normal, hold);
        let mut time = remaining;
        if held != 0 {
            held_segments += 1;
            let left = f64::from(MAX_SEGMENTS.saturating_sub(held_segments)) + 1.0;
            time = remaining.min(longest_segment(body, state, pull).max(remaining / left));
        }
        let start = Start {
            context,
            method,
            state: *state,
            elapsed,
            memory,
            corners: &corners,
            normal,
            candidates: held,
            still_speed: hold,
            acceleration: pull,
            shortest: SHORTEST_STOP * time,
        };
        let (tau, segment) = move_until_event(
            &start,
            time,
            flown.take(),
            &mut first,
            &mut second,
            &mut outcome,
        );
        iterations += segment.iterations;
        outcome.solves_capped += u32::from(segment.capped);
        if segment.still {
            still = Some(segment.impulse.map(|p| p.y / tau));
            let whole = segment.impulse.map(|p| p * (remaining / tau));
            if let Some(report) = &mut report {
                report.add(in_world.position, &corners.lever, &whole);
            }
            break;
        }
        if held != 0 {
            start.finish(segment);
        }
        corners = segment.corners;
        outcome.repair(segment.repaired);
        if let Some(report) = &mut report {
            let center = context.world_point(segment.state.position, elapsed + tau);
            report.add(center, &corners.lever, &segment.impulse);
        }
        *state = segment.state;
        core::mem::swap(memory, &mut segment.memory);
        remaining = if tau >= remaining {
            0.0
        } else {
            remaining - tau
        };
    }

    contact.spare.0 = [first.memory, second.memory];
    recover_penetration(floor, state, &mut corners);
    let now = corners.touching(2.0 * tolerance);
    if let Some(report) = report {
        let center = context.world_point(state.position, h);
        report.end(center, &corners.lever, now);
    }
    contact.touching = now;
    if let Some(reaction) = still {
        contact.establish_rest(context, None, state, h, reaction);
        outcome.resting = true;
    }
    outcome
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
    report.end(center, &corners.lever, touching);
    report
}

/// The motion until a corner that is not held touches, a slip vanishes, or `time` is over. `flown` is the plain
/// step over `time`, if it is known, with its memory in the first of the segments, which are overwritten.
fn move_until_event<'a, F: ForceModel>(
    start: &Start<F>,
    time: f64,
    flown: Option<Flown>,
    whole: &'a mut Segment,
    other: &'a mut Segment,
    outcome: &mut FloorOutcome,
) -> (f64, &'a mut Segment) {
    let mut tau = time;
    match flown {
        Some(flown) => {
            outcome.step += flown.outcome;
            whole.fly_to(start, flown);
        }
        None => start.spent(outcome, tau, whole),
    }
    if start.candidates != 0 {
        // The part found from the whole segment is exact for a constant deceleration; otherwise the
        // next try starts from a better guess.
        let mut before = None;
        for _ in 0..STOP_TRIES {
            if whole.still || tau <= start.shortest {
                break;
            }
            let Some(next) = whole.slips.first_stop(tau, before.as_ref()) else {
                break;
            };
            before = Some((tau, whole.slips));
            tau = next.clamp(0.1 * start.shortest, time);
            start.spent(outcome, tau, whole);
        }
        if whole.still {
            return (tau, whole);
        }
    }
    let watch = u64::from(!start.candidates);
    let held = start.candidates != 0;
    let context = start.context;
    let (floor, body) = (context.floor, context.body);
    let center = start.state.position.y.max(whole.state.position.y) - floor.height;
    let mut search = Search {
        watch,
        start: start.corners.height,
        rate: start.normal,
        end_rate: [f64::NAN; 8],
        time: tau,
        curvature: curvature_bound(
            body,
            &start.state,
            start.acceleration,
            context.force,
            DVec3::Y,
        ),
        tolerance: context.tolerated_height(),
        dip: context.tolerated_height() * if held { DIP_HELD } else { DIP_FREE },
        highest: center + body.radius() + tau * start.state.velocity.length(),
        budget: if held {
            SEARCH_BUDGET_HELD
        } else {
            SEARCH_BUDGET
        },
    };
    let height = whole.corners.height;
    if search.is_over(&height) {
        return (tau, whole);
    }
    if !held {
        // With corners held it tells no more than the velocities at the start.
        search.end_rate = normal_velocities(body, &whole.state, &whole.corners);
    }
    let reached = search.run(whole, height, other, |t, segment| {
        start.spent(outcome, t, segment);
        segment.corners.height
    });
    outcome.solves_capped += u32::from(reached.capped);
    (reached.tau, reached.motion)
}

impl Segment {
    /// Free flight to where it is known to lead.
    fn fly_to<F>(&mut self, start: &Start<F>, end: Flown) {
        self.clear();
        self.outcome = end.outcome;
        self.corners = Corners::at(start.context.floor, start.context.body, &end.state);
        self.state = end.state;
    }
}

impl<F: ForceModel> Start<'_, F> {
    /// [`Start::advance`], its cost counted; a bare integrator step if nothing may be held.
    fn spent(&self, outcome: &mut FloorOutcome, tau: f64, segment: &mut Segment) {
        segment.memory.clone_from(self.memory);
        if self.candidates == 0 {
            let (context, mut state) = (self.context, self.state);
            let memory = &mut segment.memory;
            let outcome = context.in_world(&mut state, self.elapsed, tau, |state| {
                (self.method.step)(context.body, state, context.force, tau, memory)
            });
            segment.fly_to(self, Flown { state, outcome });
        } else {
            self.advance(tau, segment);
        }
        outcome.step += segment.outcome;
    }
}

/// What is left when the caps are reached: one plain step, out of the floor, no approach, no gain.
fn remainder_of_step<F: ForceModel>(
    context: &FloorContext<'_, F>,
    method: &Method<F>,
    state: &mut BodyState,
    elapsed: f64,
    remaining: f64,
    memory: &mut IntegratorMemory,
) {
    let (floor, body, force) = (context.floor, context.body, context.force);
    let start = *state;
    context.in_world(state, elapsed, remaining, |state| {
        (method.step)(body, state, force, remaining, memory)
    });
    recover_penetration(floor, state, &mut Corners::at(floor, body, state));
    state.velocity.y = state.velocity.y.max(0.0);
    limit_energy(body, &start, state, force.acceleration());
}
