//! Interface between the events of a step and the surfaces: the floor, or several planes.

use glam::{DMat3, DVec3};

use super::cone::Blocks;
use super::frame::Level;
use super::geometry::{Places, each, set, spans_face};
use super::law::Law;
use super::operator::DelassusOperator;
use super::slips::Slips;
use super::{ContactReport, ContactState, Floor, FloorOutcome};
use crate::force::ForceModel;
use crate::integrators::{IntegratorMemory, StepOutcome};
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// A step of one body: its mutable parts, its length and its contact report.
pub(super) struct BodyStep<'a> {
    pub(super) state: &'a mut BodyState,
    /// \[s\]
    pub(super) h: f64,
    pub(super) memory: &'a mut IntegratorMemory,
    pub(super) contact: &'a mut ContactState,
    pub(super) report: Option<&'a mut ContactReport>,
}

/// A surface: the floor, with `N` = 8 places where the box may touch, or several planes with eight places each.
pub(super) trait Ground<const N: usize>: Sized {
    type Force: ForceModel;
    /// The held contacts at the end of a segment.
    type Held;
    /// Force evaluations in one step.
    const MAX_EVALUATIONS: u64;

    /// The body, its forces, and the frame of its motion.
    fn level(&self) -> &Level<'_, Self::Force>;
    /// Number of these places, and the places in the order of their contacts.
    fn order(places: u64) -> (usize, [u8; N]);
    /// The normal at a place.
    fn normal(&self, k: usize) -> DVec3;
    /// The coefficients at a place.
    fn surface(&self, k: usize) -> &Floor;
    /// The velocity of the surface at a place, in the frame of the motion [m/s].
    #[inline(always)]
    fn drift(&self, _k: usize) -> DVec3 {
        DVec3::ZERO
    }
    /// Returns `true` if nothing drifts, so that contact does no work.
    fn is_fixed(&self) -> bool {
        true
    }

    /// Sets the heights of the corners `elapsed` \[s\] after the start of the step, at the attitude of `state`.
    fn shift(&self, places: &mut Places<N>, state: &BodyState, elapsed: f64);
    /// The positions of the corners `elapsed` \[s\] after the beginning of the step.
    fn places(&self, state: &BodyState, elapsed: f64) -> Places<N> {
        let attitude = DMat3::from_quat(state.rotation);
        let mut places = Places::turned(self.level().context.body, attitude);
        self.shift(&mut places, state, elapsed);
        places
    }
    /// The velocities at all places along the normals for the twist (v, ω) [m/s].
    fn normal_velocities(&self, twist: (DVec3, DVec3), places: &Places<N>) -> [f64; N];
    /// The largest bound of the acceleration of corners along a normal [m/s²]; `acceleration` bounds that of the forces.
    fn curvature(&self, state: &BodyState, acceleration: f64) -> f64;
    /// The largest height of the center over a surface \[m\].
    fn height(&self, center: DVec3) -> f64;
    /// Slides a body that touches only at these places for at most `remaining` \[s\], the rest of the step, if that is
    /// a problem in the plane. Returns the duration \[s\].
    fn slide(
        &self,
        _step: &mut BodyStep<'_>,
        _remaining: f64,
        _touching: u64,
        _outcome: &mut FloorOutcome,
    ) -> Option<f64> {
        None
    }
    /// Removes the approach velocity from `state`.
    fn separate(&self, state: &mut BodyState);
    /// The touching places that hold a face.
    fn on_faces(&self, touching: u64) -> u64 {
        touching & set::<N>(|i| spans_face((touching >> (8 * (i / 8))) as u8))
    }
    /// Returns `true` if a body at rest that is held at these places stays at rest.
    fn supports(&self, places: &Places<N>, held: u64) -> bool;

    /// Computes the data for direct solutions of the law.
    fn blocks(&self, _operator: &DelassusOperator<N>) -> Blocks {
        Blocks::More
    }
    /// Sets `p`, initially zero, to impulses that obey Coulomb's law to |w| within `target`, if a likely case applies.
    /// The second part of `problem` is the solution of a similar problem, or zero.
    fn direct(
        &self,
        _law: &Law<'_, Self, N>,
        _problem: (&[DVec3; N], &[DVec3; N]),
        _target: f64,
        _p: &mut [DVec3; N],
    ) -> Option<()> {
        None
    }
    /// The smallest impulses p with u + Wp = 0 along the normals, and in all components at the places in `whole`.
    fn cancel(&self, operator: &DelassusOperator<N>, u: &[DVec3; N], whole: u64) -> [DVec3; N];
    /// Moves and turns the body so that the corners at the places `held` are on their surfaces.
    fn project(&self, state: &mut BodyState, held: u64, elapsed: f64) -> (Places<N>, Self::Held);
    /// Removes the normal components of the velocities `after` at the end of a segment, if `held` suffices for it.
    fn stop(&self, _segment: &mut Segment<N>, _held: &Self::Held, _after: &[DVec3; N]) -> bool {
        false
    }

    /// The operator of a body with the world axes `attitude` and contacts at these places.
    #[inline]
    fn operator(&self, attitude: DMat3, places: u64) -> DelassusOperator<N> {
        let body = self.level().context.body;
        DelassusOperator::at(body, attitude, Self::order(places))
    }

    /// The motion (v, ω) of a state.
    #[inline]
    fn twist(&self, state: &BodyState) -> (DVec3, DVec3) {
        let body = self.level().context.body;
        (state.velocity, state.angular_velocity(body))
    }

    /// The part of a vector along the surface at a place.
    #[inline(always)]
    fn along(&self, k: usize, u: DVec3) -> DVec3 {
        let normal = self.normal(k);
        u - normal * normal.dot(u)
    }

    /// The velocity of the corner at a place relative to its surface, for the twist (v, ω).
    #[inline(always)]
    fn relative(&self, k: usize, places: &Places<N>, (v, omega): (DVec3, DVec3)) -> DVec3 {
        v + omega.cross(places.lever(k % 8)) - self.drift(k)
    }

    /// The velocities of the contacts relative to their surfaces, for the twist (v, ω).
    #[inline]
    fn velocities(&self, operator: &DelassusOperator<N>, twist: (DVec3, DVec3)) -> [DVec3; N] {
        let mut u = operator.velocities(twist);
        for i in 0..operator.count {
            u[i] -= self.drift(usize::from(operator.place[i]));
        }
        u
    }

    /// World position of corner `k` of a state of the frame.
    fn point(&self, state: &BodyState, places: &Places<N>, k: usize, elapsed: f64) -> DVec3 {
        let frame = &self.level().frame;
        frame.point(state.position, elapsed) + frame.vector(places.lever(k))
    }

    /// Penetration recovery: moves the body out of the deepest surface, at most `N` times, until it penetrates none.
    fn recover(&self, state: &mut BodyState, places: &mut Places<N>, elapsed: f64) {
        for _ in 0..N {
            let (place, gap) = places.deepest();
            if gap >= 0.0 || !gap.is_finite() {
                break;
            }
            state.position -= self.normal(place) * gap;
            self.shift(places, state, elapsed);
        }
    }

    /// One step of Newton's method toward corner heights of zero at the places `held`. The angular momentum keeps its body
    /// components.
    fn lower(&self, state: &mut BodyState, held: u64, height: &[f64; N]) {
        let operator = self.operator(DMat3::from_quat(state.rotation), held);
        let mut gap = [DVec3::ZERO; N];
        for i in 0..operator.count {
            let place = usize::from(operator.place[i]);
            gap[i] = self.normal(place) * height[place];
        }
        let (shift, turn) = operator.twist(&self.cancel(&operator, &gap, 0));
        state.position += shift;
        if turn != DVec3::ZERO {
            // World turn: q ← exp(turn)∘q.
            state.rotation = compose(exponential_map(turn), state.rotation);
            state.renormalize();
        }
    }

    /// Adds impulses, by place, to a report. During a step, the report's normal is the sum of the normal impulses.
    fn record(
        &self,
        report: &mut ContactReport,
        (state, elapsed): (&BodyState, f64),
        places: &Places<N>,
        impulse: &[DVec3; N],
    ) {
        for i in each(set::<N>(|i| impulse[i] != DVec3::ZERO)) {
            let (k, normal) = (i % 8, self.normal(i));
            let push = normal.dot(impulse[i]);
            report.normal += normal * push;
            report.tangential_impulse += self.along(i, impulse[i]);
            report.push(k, self.point(state, places, k, elapsed), push);
        }
    }
}

/// The start of a segment, and the bounds that are valid during it.
pub(super) struct Start<'a, G, const N: usize> {
    pub(super) ground: &'a G,
    pub(super) state: BodyState,
    /// Time since the start of the step \[s\].
    pub(super) elapsed: f64,
    pub(super) memory: &'a IntegratorMemory,
    pub(super) places: &'a Places<N>,
    /// (v, ω)
    pub(super) twist: (DVec3, DVec3),
    /// The velocities at the places along the normals [m/s].
    pub(super) normal: [f64; N],
    /// The places that may be held: touching, with negligible normal velocity.
    pub(super) candidates: u64,
    /// Number of candidates, and the candidates in the order of their contacts.
    pub(super) order: (usize, [u8; N]),
    /// Largest speed of a corner at rest [m/s].
    pub(super) still_speed: f64,
    /// Upper bound of the acceleration [m/s²].
    pub(super) acceleration: f64,
    /// Shortest segment in the search for the end of a slip \[s\].
    pub(super) shortest: f64,
}

/// A segment of motion, free or sustained.
pub(super) struct Segment<const N: usize> {
    pub(super) state: BodyState,
    pub(super) memory: IntegratorMemory,
    pub(super) places: Places<N>,
    /// Impulses over the segment, by place \[N s\].
    pub(super) impulse: [DVec3; N],
    pub(super) slips: Slips<N>,
    /// `true` if the box is at rest: its state equals that at the start.
    pub(super) still: bool,
    pub(super) outcome: StepOutcome,
    pub(super) iterations: u32,
    pub(super) capped: bool,
    /// Removed energy, which errors of integrator and projection had added \[J\].
    pub(super) repaired: Option<f64>,
}

impl<const N: usize> Segment<N> {
    /// An empty segment that writes to this memory.
    pub(super) fn new(memory: IntegratorMemory) -> Self {
        Self {
            state: BodyState::default(),
            memory,
            places: Places::NONE,
            impulse: [DVec3::ZERO; N],
            slips: Slips::NONE,
            still: false,
            outcome: StepOutcome::default(),
            iterations: 0,
            capped: false,
            repaired: None,
        }
    }

    /// Clears the results.
    pub(super) fn clear(&mut self) {
        self.impulse = [DVec3::ZERO; N];
        self.slips = Slips::NONE;
        self.still = false;
        self.iterations = 0;
        self.capped = false;
        self.repaired = None;
    }
}
