//! The interface between the events of a step and the surfaces that a box may touch: the floor, or several planes.

use glam::{DMat3, DVec3};

use super::frame::Level;
use super::geometry::{Places, each, set};
use super::law::Law;
use super::operator::DelassusOperator;
use super::slips::Slips;
use super::{ContactReport, ContactState, Floor};
use crate::force::ForceModel;
use crate::integrators::{IntegratorMemory, StepOutcome};
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// A step of one body: the columns that it changes, its length and its report.
pub(super) struct BodyStep<'a> {
    pub(super) state: &'a mut BodyState,
    /// \[s\]
    pub(super) h: f64,
    pub(super) memory: &'a mut IntegratorMemory,
    pub(super) contact: &'a mut ContactState,
    pub(super) report: Option<&'a mut ContactReport>,
}

/// The floor, with `N` = 8 places where the box may touch, or several planes with a place for each corner over each.
pub(super) trait Ground<const N: usize>: Sized {
    type Force: ForceModel;
    /// What direct solutions of Coulomb's law need.
    type Blocks;
    /// The held contacts at the end of a segment.
    type Held;
    /// Force evaluations in one step.
    const MAX_EVALUATIONS: u64;

    /// The body, its forces, and the frame of its motion.
    fn level(&self) -> &Level<'_, Self::Force>;
    /// The number of these places, and the places in the order of their contacts.
    fn order(places: u64) -> (usize, [u8; N]);
    /// The normal at a place.
    fn normal(&self, k: usize) -> DVec3;
    /// The coefficients at a place.
    fn surface(&self, k: usize) -> &Floor;
    /// The velocity of the surface at a place, in the frame of the motion [m/s].
    fn drift(&self, k: usize) -> DVec3;
    /// Returns whether nothing drifts: contact does no work then.
    fn is_fixed(&self) -> bool;

    /// The positions of the corners `elapsed` \[s\] after the beginning of the step.
    fn places(&self, state: &BodyState, elapsed: f64) -> Places<N>;
    /// Corrects them after a change of the position alone.
    fn shift(&self, places: &mut Places<N>, state: &BodyState, elapsed: f64);
    /// The velocities at all places along the normals for the twist (v, ω) [m/s].
    fn normal_velocities(&self, twist: (DVec3, DVec3), places: &Places<N>) -> [f64; N];
    /// The largest bound of the acceleration of corners along a normal [m/s²]; `acceleration` bounds that of the forces.
    fn curvature(&self, state: &BodyState, acceleration: f64) -> f64;
    /// The largest height of the center over a surface \[m\].
    fn height(&self, center: DVec3) -> f64;
    /// Removes the approach from the velocity.
    fn separate(&self, state: &mut BodyState);
    /// Those of the touching places that hold a face.
    fn on_faces(&self, touching: u64) -> u64;
    /// Returns whether a body that is held at these places and does not move stays.
    fn supports(&self, places: &Places<N>, held: u64) -> bool;

    /// What direct solutions of the law need of W.
    fn blocks(&self, operator: &DelassusOperator<N>) -> Self::Blocks;
    /// Sets the impulses `p`, which are zero, to those that obey the law to |w| within `target`, if one of the likely
    /// cases fits; `near` solves a similar problem, or is zero.
    fn direct(
        &self,
        law: &Law<'_, Self, N>,
        problem: (&[DVec3; N], &[DVec3; N]),
        target: f64,
        p: &mut [DVec3; N],
    ) -> Option<()>;
    /// The smallest impulses p with u + Wp = 0 along the normals, and altogether at the places in `whole`.
    fn cancel(&self, operator: &DelassusOperator<N>, u: &[DVec3; N], whole: u64) -> [DVec3; N];
    /// Moves and turns the body so that the corners of the places `held` lie on their surfaces.
    fn project(&self, state: &mut BodyState, held: u64, elapsed: f64) -> (Places<N>, Self::Held);
    /// Removes from the end of a segment what is left of the velocities `after` along the normals, if that can be done by
    /// what is known of the contacts.
    fn stop(&self, segment: &mut Segment<N>, contacts: &Self::Held, after: &[DVec3; N]) -> bool;

    /// The contacts at these places of a body whose world axes are `attitude`.
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

    /// Where corner `k` of a state of the frame is in the world.
    fn point(&self, state: &BodyState, places: &Places<N>, k: usize, elapsed: f64) -> DVec3 {
        let frame = &self.level().frame;
        frame.point(state.position, elapsed) + frame.vector(places.lever(k))
    }

    /// Moves the body out of the deepest surface, until it is in none; never pushes it into one. Between planes that leave
    /// no room for it that does not end.
    fn recover(&self, state: &mut BodyState, places: &mut Places<N>, elapsed: f64) {
        for _ in 0..N {
            if places.lowest() >= 0.0 {
                break;
            }
            let (place, gap) = places.deepest();
            if !gap.is_finite() {
                break;
            }
            state.position -= self.normal(place) * gap;
            self.shift(places, state, elapsed);
        }
    }

    /// A step of Newton's method that brings the corners of the places `held`, which are at these heights \[m\], onto their
    /// surfaces. The angular momentum keeps its body components.
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

    /// Adds impulses at the places of a box in this state to a report. Until the end of the step its normal is the sum of
    /// those along the normals.
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

/// The start of a segment, and the bounds that hold for it.
pub(super) struct Start<'a, G, const N: usize> {
    pub(super) ground: &'a G,
    pub(super) state: BodyState,
    /// Since the beginning of the step \[s\].
    pub(super) elapsed: f64,
    pub(super) memory: &'a IntegratorMemory,
    pub(super) places: &'a Places<N>,
    /// The velocities at the places along the normals [m/s].
    pub(super) normal: [f64; N],
    /// The places that may be held: touching, with no normal velocity to speak of.
    pub(super) candidates: u64,
    /// Slower than this is not moving [m/s].
    pub(super) still_speed: f64,
    /// Bound of the acceleration that acts [m/s²].
    pub(super) acceleration: f64,
    /// Shortest segment \[s\] that is tried for the moment at which a slip vanishes.
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
    /// The box is at rest: the state equals that at the start.
    pub(super) still: bool,
    pub(super) outcome: StepOutcome,
    pub(super) iterations: u32,
    pub(super) capped: bool,
    /// Energy taken because the errors of integrator and projection had added it \[J\].
    pub(super) repaired: Option<f64>,
}

impl<const N: usize> Segment<N> {
    /// Yet to be made, with this memory to write to.
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

    /// Forgets what was reported of it.
    pub(super) fn clear(&mut self) {
        self.impulse = [DVec3::ZERO; N];
        self.slips = Slips::NONE;
        self.still = false;
        self.iterations = 0;
        self.capped = false;
        self.repaired = None;
    }
}
