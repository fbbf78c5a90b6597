//! One step among several planes: segments of motion between events, as over the floor.

use glam::DVec3;

use super::contacts::{Each, Gaps, NONE, PAIRS, each, normal_velocities, pairs};
use super::held::Start;
use super::impact::strike;
use super::{Plane, PlanesContext};
use crate::floor::bounds::{acceleration_bound, curvature_bound, spin_bound};
use crate::floor::event::Search;
use crate::floor::frame::Method;
use crate::floor::slips::Slips;
use crate::floor::step::{
    DIP_FREE, DIP_HELD, MAX_EVALUATIONS, MAX_ROUNDS, MAX_SEGMENTS, MAX_TOTAL_ITERATIONS,
    SEARCH_BUDGET, SEARCH_BUDGET_HELD, SHORTEST_STOP, STOP_TRIES,
};
use crate::floor::sustained::{limit_energy, longest_segment};
use crate::floor::{ContactReport, ContactState, Floor, FloorContext, FloorOutcome};
use crate::force::ForceModel;
use crate::integrators::{IntegratorMemory, StepOutcome};
use crate::state::BodyState;

/// The body among the planes.
pub(super) struct Among<'a, F> {
    /// The world as the frame of a floor at rest, of which only the body and the forces count.
    pub(super) world: FloorContext<'a, F>,
    pub(super) planes: &'a [Plane],
    pub(super) method: &'a Method<F>,
    tolerance: f64,
}

impl<F: ForceModel> Among<'_, F> {
    /// Whether a box may rest: no plane moves.
    pub(super) fn may_rest(&self) -> bool {
        let mut velocities = self.planes.iter().map(|plane| plane.surface.velocity);
        velocities.all(|v| v == DVec3::ZERO)
    }

    /// Whether what is not contact does no work but that of a uniform acceleration, and contact none at all.
    pub(super) fn bounds_energy(&self) -> bool {
        self.may_rest() && self.world.bounds_energy()
    }
}

/// A segment of motion.
pub(super) struct Segment {
    pub(super) state: BodyState,
    pub(super) memory: IntegratorMemory,
    pub(super) gaps: Gaps,
    /// Impulses over the segment, by pair \[N s\].
    pub(super) impulse: Each,
    pub(super) slips: Slips<PAIRS>,
    /// The box is at rest: the state equals that at the start.
    pub(super) still: bool,
    pub(super) outcome: StepOutcome,
    pub(super) iterations: u32,
    pub(super) capped: bool,
    /// Energy taken because errors had added it \[J\].
    pub(super) repaired: Option<f64>,
}

impl Segment {
    fn new(memory: IntegratorMemory) -> Self {
        Self {
            state: BodyState::default(),
            memory,
            gaps: Gaps::NONE,
            impulse: NONE,
            slips: Slips::NONE,
            still: false,
            outcome: StepOutcome::default(),
            iterations: 0,
            capped: false,
            repaired: None,
        }
    }

    /// Forgets what was reported of it.
    pub(super) fn clear(&mut self) {
        self.impulse = NONE;
        self.slips = Slips::NONE;
        (self.still, self.capped) = (false, false);
        self.iterations = 0;
        self.repaired = None;
    }
}

/// The step, and the normal forces at the corners \[N\] with the direction of their sum if it ends at rest.
#[allow(
    clippy::too_many_arguments,
    reason = "the arguments of `step_on_planes`"
)]
pub(super) fn step<F: ForceModel>(
    context: &PlanesContext<'_, F>,
    planes: &[Plane],
    method: &Method<F>,
    state: &mut BodyState,
    h: f64,
    memory: &mut IntegratorMemory,
    contact: &mut ContactState,
    report: Option<&mut ContactReport>,
) -> (FloorOutcome, Option<([f64; 8], DVec3)>) {
    let mut outcome = FloorOutcome::default();
    let &PlanesContext {
        settings,
        body,
        force,
        ..
    } = context;
    let tolerances = planes.iter().map(|plane| context.tolerance(state, plane));
    let tolerance = tolerances.fold(0.0, f64::max);
    let level = Floor::default();
    let among = Among {
        world: FloorContext {
            floor: &level,
            settings,
            body,
            force,
        },
        planes,
        method,
        tolerance,
    };
    let [first, second] = core::mem::take(&mut contact.spare.0);
    let (mut first, mut second) = (Segment::new(first), Segment::new(second));
    let mut impulses = ContactReport::default();
    let mut push = DVec3::ZERO;
    let mut remaining = h;
    let (mut held_segments, mut rounds, mut iterations) = (0, 0, 0);
    let mut still = None;
    let mut gaps = Gaps::at(planes, body, state, 0.0);
    gaps.recover(planes, state, 0.0);
    // Planes that leave no room for the box do not hold it.
    let no_room = gaps.lowest().1 < -tolerance;

    while remaining > 0.0 {
        rounds += 1;
        let elapsed = h - remaining;
        let exhausted = no_room
            || rounds > MAX_ROUNDS
            || iterations > MAX_TOTAL_ITERATIONS
            || outcome.step.evaluations > MAX_EVALUATIONS / 10
            || outcome.impacts_capped > settings.max_impacts;
        if exhausted {
            outcome.solves_capped += 1;
            remainder_of_step(&among, state, elapsed, remaining, memory);
            gaps = Gaps::at(planes, body, state, h);
            break;
        }
        let touching = gaps.touching(2.0 * tolerance);
        let normal = normal_velocities(planes, body, state, &gaps);
        let pull = acceleration_bound(body, state, force);
        let speed = state.velocity.length() + body.radius() * spin_bound(body, state);
        // A hop u²/2A lower than the tolerance does not count.
        let hold = 1e-10 * speed + (2.0 * pull * tolerance).sqrt();

        if each(touching).any(|i| normal[i] < -hold) {
            let ordinary = outcome.impacts < settings.max_impacts;
            outcome.impacts_capped += u32::from(!ordinary);
            let fastest = each(touching).fold(0.0, |a: f64, i| a.max(-normal[i]));
            impulses.strike(elapsed, fastest);
            let hit = strike(&among, state, &gaps, touching, ordinary);
            impulses.add_pairs(planes, state.position, &gaps, &hit.impulse, &mut push);
            outcome.impacts += 1;
            outcome.solves_capped += u32::from(hit.capped);
            outcome.repair(hit.repaired);
            iterations += hit.iterations;
            continue;
        }

        let held = touching & pairs(|i| normal[i] <= hold);
        let mut time = remaining;
        if held != 0 {
            held_segments += 1;
            let left = f64::from(MAX_SEGMENTS.saturating_sub(held_segments)) + 1.0;
            time = remaining.min(longest_segment(body, state, pull).max(remaining / left));
        }
        let start = Start {
            among: &among,
            state: *state,
            elapsed,
            memory,
            gaps: &gaps,
            normal,
            candidates: held,
            still_speed: hold,
            acceleration: pull,
            shortest: SHORTEST_STOP * time,
        };
        let (tau, segment) = move_until_event(&start, time, &mut first, &mut second, &mut outcome);
        iterations += segment.iterations;
        outcome.solves_capped += u32::from(segment.capped);
        if segment.still {
            let whole = segment.impulse.map(|p| p * (remaining / tau));
            impulses.add_pairs(planes, state.position, &gaps, &whole, &mut push);
            let mut reaction = [0.0; 8];
            for i in each(held) {
                reaction[i % 8] += planes[i / 8].shape.normal.dot(segment.impulse[i]) / tau;
            }
            still = Some(reaction);
            break;
        }
        if held != 0 {
            start.finish(segment, tau);
        }
        gaps = segment.gaps;
        outcome.repair(segment.repaired);
        impulses.add_pairs(
            planes,
            segment.state.position,
            &gaps,
            &segment.impulse,
            &mut push,
        );
        *state = segment.state;
        core::mem::swap(memory, &mut segment.memory);
        remaining = if tau >= remaining {
            0.0
        } else {
            remaining - tau
        };
    }

    contact.spare.0 = [first.memory, second.memory];
    if still.is_none() {
        gaps.recover(planes, state, h);
    }
    let now = each(gaps.touching(2.0 * tolerance)).fold(0, |set, i| set | 1 << (i % 8));
    let lowest = planes[gaps.lowest().0 / 8].shape.normal;
    let direction = push.try_normalize().unwrap_or(lowest);
    if let Some(report) = report {
        impulses.end(state.position, &gaps.lever, now);
        impulses.normal = direction;
        *report = impulses;
    }
    contact.touching = now;
    (outcome, still.map(|reaction| (reaction, direction)))
}

/// The motion until a contact that is not held begins, a slip vanishes, or `time` is over.
fn move_until_event<'a, F: ForceModel>(
    start: &Start<F>,
    time: f64,
    whole: &'a mut Segment,
    other: &'a mut Segment,
    outcome: &mut FloorOutcome,
) -> (f64, &'a mut Segment) {
    let mut tau = time;
    let held = start.candidates != 0;
    start.spent(outcome, tau, whole);
    if held {
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
    let (among, planes) = (start.among, start.among.planes);
    let (body, force) = (among.world.body, among.world.force);
    let curvature = |plane: &Plane| {
        let normal = plane.shape.normal;
        curvature_bound(body, &start.state, start.acceleration, force, normal)
    };
    let height = |plane: &Plane| {
        let ends = [start.state.position, whole.state.position].map(|x| plane.height(x));
        ends[0].max(ends[1])
    };
    let over_all = |f: &dyn Fn(&Plane) -> f64| planes.iter().map(f).fold(0.0, f64::max);
    let search = Search {
        watch: !start.candidates & pairs(|i| i < 8 * planes.len()),
        start: start.gaps.gap,
        rate: start.normal,
        end_rate: if held {
            [f64::NAN; PAIRS]
        } else {
            normal_velocities(planes, body, &whole.state, &whole.gaps)
        },
        time: tau,
        curvature: over_all(&curvature),
        tolerance: among.tolerance,
        dip: among.tolerance * if held { DIP_HELD } else { DIP_FREE },
        highest: over_all(&height) + body.radius() + tau * start.state.velocity.length(),
        budget: if held {
            SEARCH_BUDGET_HELD
        } else {
            SEARCH_BUDGET
        },
    };
    let gap = whole.gaps.gap;
    let reached = search.run(whole, gap, other, |t, segment| {
        start.spent(outcome, t, segment);
        segment.gaps.gap
    });
    outcome.solves_capped += u32::from(reached.capped);
    (reached.tau, reached.motion)
}

impl<F: ForceModel> Start<'_, F> {
    /// [`Start::advance`], its cost counted; a bare integrator step if nothing may be held.
    fn spent(&self, outcome: &mut FloorOutcome, tau: f64, segment: &mut Segment) {
        segment.memory.clone_from(self.memory);
        if self.candidates == 0 {
            let (among, body) = (self.among, self.among.world.body);
            let (mut state, memory) = (self.state, &mut segment.memory);
            let spent = (among.method.step)(body, &mut state, among.world.force, tau, memory);
            segment.clear();
            segment.outcome = spent;
            segment.gaps = Gaps::at(among.planes, body, &state, self.elapsed + tau);
            segment.state = state;
        } else {
            self.advance(tau, segment);
        }
        outcome.step += segment.outcome;
    }
}

/// What is left when the caps are reached: one plain step, out of the planes, no approach, no gain.
fn remainder_of_step<F: ForceModel>(
    among: &Among<'_, F>,
    state: &mut BodyState,
    elapsed: f64,
    remaining: f64,
    memory: &mut IntegratorMemory,
) {
    let (planes, body, force) = (among.planes, among.world.body, among.world.force);
    let start = *state;
    (among.method.step)(body, state, force, remaining, memory);
    let end = elapsed + remaining;
    Gaps::at(planes, body, state, end).recover(planes, state, end);
    // Two planes after one another may bring the first one back.
    for plane in planes.iter().chain(planes) {
        let normal = plane.shape.normal;
        let approach = (state.velocity - plane.surface.velocity).dot(normal);
        state.velocity -= normal * approach.min(0.0);
    }
    if among.may_rest() {
        limit_energy(body, &start, state, force.acceleration());
    }
}

impl ContactReport {
    /// Adds impulses at the pairs of a box whose center is at `center`; `push` sums those along the normals.
    fn add_pairs(
        &mut self,
        planes: &[Plane],
        center: DVec3,
        gaps: &Gaps,
        impulse: &Each,
        push: &mut DVec3,
    ) {
        for i in each(pairs(|i| impulse[i] != DVec3::ZERO)) {
            let (k, normal) = (i % 8, planes[i / 8].shape.normal);
            let n = normal.dot(impulse[i]);
            *push += normal * n;
            self.normal_impulses[k] += n;
            self.tangential_impulse += impulse[i] - normal * n;
            self.points[k] = center + gaps.lever[k];
            self.corners |= 1 << k;
        }
    }
}
