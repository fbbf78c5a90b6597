//! A step as a sequence of impacts and segments of motion.

use super::bounds::{acceleration_bound, spin_bound};
use super::flight::Flown;
use super::geometry::{Places, each, has, set};
use super::ground::{BodyStep, Ground, Segment, Start};
use super::impact::resolve_impact;
use super::motion::{limit_energy, longest_segment};
use super::search::Search;
use super::{FloorContext, FloorOutcome};

/// Maximum number of segments of sustained motion in a step; beyond it, segments become longer.
const MAX_SEGMENTS: u32 = 256;
/// Smallest depth of a dip that the search finds, relative to the tolerance, and maximum number of evaluations per search.
/// In flight the depth is 1e-9 of the scale; with held corners, where the motion has order 2, 1e-6.
const FREE: (f64, u32) = (1e3, 4096);
const HELD: (f64, u32) = (1e6, 128);
/// Trials for the end of a slip; one suffices for a constant deceleration.
const STOP_TRIES: u32 = 8;
/// Shortest trial, relative to the segment: 5e-5 of the distance covered under a constant deceleration.
const SHORTEST_STOP: f64 = 1e-2;
/// Maximum number of rounds in one step.
const MAX_ROUNDS: u32 = 4 * MAX_SEGMENTS;
/// Maximum number of solver iterations in one step.
const MAX_TOTAL_ITERATIONS: u32 = 100_000;

/// Takes the last `remaining` \[s\] of a step event by event, from the corners at `places`. `flown` is the plain step, if
/// known. Returns the normal forces at the corners \[N\] if the step ends at rest.
#[inline(never)] // its frame is too large for boxes at rest or in flight
pub(super) fn between_events<G: Ground<N>, const N: usize>(
    ground: &G,
    step: &mut BodyStep<'_>,
    places: &mut Places<N>,
    mut remaining: f64,
    mut flown: Option<Flown>,
    outcome: &mut FloorOutcome,
) -> Option<[f64; 8]> {
    let (level, tolerance) = (ground.level(), ground.level().tolerance);
    let &FloorContext {
        settings,
        body,
        force,
        ..
    } = level.context;
    let [first, mut spare] = core::mem::take(&mut step.contact.spare.0);
    let (mut first, mut second) = (Segment::new(first), None);
    let (mut held_segments, mut rounds, mut iterations) = (0, 0, 0);
    let mut loads = None;

    while remaining > 0.0 {
        rounds += 1;
        let elapsed = step.h - remaining;
        let exhausted = rounds > MAX_ROUNDS
            || iterations > MAX_TOTAL_ITERATIONS
            || outcome.step.evaluations > G::MAX_EVALUATIONS
            || outcome.impacts_capped > settings.max_impacts;
        if exhausted {
            *places = give_way(ground, step, remaining, outcome);
            break;
        }
        let touching = places.touching(2.0 * tolerance);
        let twist = ground.twist(step.state);
        let normal = ground.normal_velocities(twist, places);
        let mut in_world = *step.state;
        level.frame.to_world(&mut in_world, elapsed);
        let pull = acceleration_bound(body, &in_world, force);
        let speed = step.state.velocity.length() + level.radius * spin_bound(body, step.state);
        // Normal speeds whose hop u²/2A is below the tolerance count as zero.
        let hold = 1e-10 * speed + (2.0 * pull * tolerance).sqrt();

        if touching & set::<N>(|i| normal[i] < -hold) != 0 {
            let ordinary = outcome.impacts < settings.max_impacts;
            outcome.impacts_capped += u32::from(!ordinary);
            let hit = resolve_impact(ground, step.state, twist, touching, ordinary);
            if let Some(report) = &mut step.report {
                let fastest = each(touching).fold(0.0, |a: f64, i| a.max(-normal[i]));
                report.strike(elapsed, fastest);
                ground.record(report, (step.state, elapsed), places, &hit.impulse);
            }
            outcome.impacts += 1;
            outcome.solves_capped += u32::from(hit.capped);
            outcome.repair(hit.repaired);
            iterations += hit.iterations;
            flown = None;
            continue;
        }

        let held = touching & set::<N>(|i| normal[i] <= hold);
        if held == touching
            && let Some(time) = ground.slide(step, remaining, touching, outcome)
        {
            remaining = (remaining - time).max(0.0);
            *places = ground.places(step.state, step.h - remaining);
            flown = None;
            continue;
        }
        let mut time = remaining;
        if held != 0 {
            held_segments += 1;
            let left = f64::from(MAX_SEGMENTS.saturating_sub(held_segments)) + 1.0;
            time = remaining.min(longest_segment(body, step.state, pull).max(remaining / left));
        }
        let start = Start {
            ground,
            state: *step.state,
            elapsed,
            memory: step.memory,
            places,
            twist,
            normal,
            candidates: held,
            order: G::order(held),
            still_speed: hold,
            acceleration: pull,
            shortest: SHORTEST_STOP * time,
        };
        let flown = flown.take();
        let (tau, segment) = start.until_event(
            time,
            flown,
            &mut first,
            || second.get_or_insert_with(|| Segment::new(core::mem::take(&mut spare))),
            outcome,
        );
        iterations += segment.iterations;
        outcome.solves_capped += u32::from(segment.capped);
        if segment.still {
            let mut load = [0.0; 8];
            for i in each(held) {
                load[i % 8] += ground.normal(i).dot(segment.impulse[i]) / tau;
            }
            loads = Some(load);
            let whole = segment.impulse.map(|p| p * (remaining / tau));
            if let Some(report) = &mut step.report {
                ground.record(report, (step.state, elapsed), places, &whole);
            }
            break;
        }
        if held != 0 {
            start.finish(segment, tau);
        }
        outcome.repair(segment.repaired);
        if let Some(report) = &mut step.report {
            let end = (&segment.state, elapsed + tau);
            ground.record(report, end, &segment.places, &segment.impulse);
        }
        *places = segment.places;
        *step.state = segment.state;
        core::mem::swap(step.memory, &mut segment.memory);
        remaining = (remaining - tau).max(0.0);
    }
    let spare = second.map_or(spare, |second| second.memory);
    step.contact.spare.0 = [first.memory, spare];
    loads
}

/// Fallback when a cap is reached: one plain step with penetration recovery, without approach and gain of energy.
pub(super) fn give_way<G: Ground<N>, const N: usize>(
    ground: &G,
    step: &mut BodyStep<'_>,
    remaining: f64,
    outcome: &mut FloorOutcome,
) -> Places<N> {
    let level = ground.level();
    let (start, elapsed) = (*step.state, step.h - remaining);
    outcome.solves_capped += 1;
    level.fly(step.state, elapsed, remaining, step.memory);
    let end = elapsed + remaining;
    let mut places = ground.places(step.state, end);
    ground.recover(step.state, &mut places, end);
    ground.separate(step.state);
    if ground.is_fixed() {
        limit_energy(level.context.body, &start, step.state, level.pull);
    }
    ground.places(step.state, step.h)
}

impl<G: Ground<N>, const N: usize> Start<'_, G, N> {
    /// The motion until a free corner touches, a slip ends, or `time` is over. `flown` is the plain step over `time`, if
    /// known, with its memory in `whole`; both `whole` and `other` are overwritten.
    fn until_event<'a>(
        &self,
        time: f64,
        flown: Option<Flown>,
        whole: &'a mut Segment<N>,
        other: impl FnOnce() -> &'a mut Segment<N>,
        outcome: &mut FloorOutcome,
    ) -> (f64, &'a mut Segment<N>) {
        let (ground, held) = (self.ground, self.candidates != 0);
        let mut tau = time;
        match flown {
            Some(flown) => {
                outcome.step += flown.outcome;
                self.fly_to(flown, tau, whole);
            }
            None => self.spent(outcome, tau, whole),
        }
        if held {
            // Exact for a constant deceleration; otherwise each trial improves the guess.
            let mut before = None;
            for _ in 0..STOP_TRIES {
                if whole.still || tau <= self.shortest {
                    break;
                }
                let Some(next) = whole
                    .slips
                    .first_stop(self.candidates, tau, before.as_ref())
                else {
                    break;
                };
                before = Some((tau, whole.slips));
                tau = next.clamp(0.1 * self.shortest, time);
                self.spent(outcome, tau, whole);
            }
            if whole.still {
                return (tau, whole);
            }
        }
        let (radius, tolerance) = (ground.level().radius, ground.level().tolerance);
        let [low, high] = [&self.state, &whole.state].map(|s| ground.height(s.position));
        let (dip, budget) = if held { HELD } else { FREE };
        let mut search = Search {
            watch: set::<N>(|k| !has(self.candidates, k)),
            start: self.places.height,
            rate: self.normal,
            end_rate: [f64::NAN; N],
            time: tau,
            curvature: ground.curvature(&self.state, self.acceleration),
            tolerance,
            dip: tolerance * dip,
            highest: low.max(high) + radius + tau * self.state.velocity.length(),
            budget,
        };
        let height = whole.places.height;
        if search.is_over(&height) {
            return (tau, whole);
        }
        if !held {
            // With held corners it would not improve the first guess.
            search.end_rate = ground.normal_velocities(ground.twist(&whole.state), &whole.places);
        }
        let (tau, segment, capped) = search.run(whole, height, other(), |t, segment| {
            self.spent(outcome, t, segment);
            segment.places.height
        });
        outcome.solves_capped += u32::from(capped);
        (tau, segment)
    }

    /// [`Start::advance`] with its cost counted, or a plain integrator step if no corner may be held.
    fn spent(&self, outcome: &mut FloorOutcome, tau: f64, segment: &mut Segment<N>) {
        segment.memory.clone_from(self.memory);
        if self.candidates == 0 {
            let mut state = self.state;
            let memory = &mut segment.memory;
            let outcome = self
                .ground
                .level()
                .fly(&mut state, self.elapsed, tau, memory);
            self.fly_to(Flown { state, outcome }, tau, segment);
        } else {
            self.advance(tau, segment);
        }
        outcome.step += segment.outcome;
    }

    /// Stores the known end of a free flight of `tau` \[s\].
    fn fly_to(&self, end: Flown, tau: f64, segment: &mut Segment<N>) {
        segment.clear();
        segment.outcome = end.outcome;
        segment.places = self.ground.places(&end.state, self.elapsed + tau);
        segment.state = end.state;
    }
}
