//! The interface between the events of a step and the surfaces that a box may touch: the floor, or several planes.

use glam::{DMat3, DVec3};

use super::frame::Method;
use super::geometry::{Places, each, set};
use super::newton::CoulombLaw;
use super::operator::DelassusOperator;
use super::slips::Slips;
use super::{ContactReport, ContactState, Floor, FloorContext};
use crate::force::ForceModel;
use crate::integrators::{IntegratorMemory, StepOutcome};
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

impl<'a> BodyStep<'a> {
    pub(super) fn new(
        state: &'a mut BodyState,
        h: f64,
        memory: &'a mut IntegratorMemory,
        contact: &'a mut ContactState,
        report: Option<&'a mut ContactReport>,
    ) -> Self {
        Self {
            state,
            h,
            memory,
            contact,
            report,
        }
    }
}

/// A level floor, in whose frame contact is solved. Among several planes one at rest, of which only the body and the
/// forces count.
pub(super) struct Level<'a, F> {
    pub(super) context: &'a FloorContext<'a, F>,
    pub(super) method: &'a Method<F>,
    /// |c| at which a corner touches \[m\].
    pub(super) tolerance: f64,
}

/// The floor, with `N` = 8 places where the box may touch, or several planes with a place for each corner over each.
pub(super) trait Ground<const N: usize> {
    type Force: ForceModel;
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
    /// Moves the body so that no corner is below a surface; never pushes it into one.
    fn recover(&self, state: &mut BodyState, places: &mut Places<N>, elapsed: f64);
    /// The velocities at all places along the normals [m/s].
    fn normal_velocities(&self, state: &BodyState, places: &Places<N>) -> [f64; N];
    /// The largest bound of the acceleration of corners along a normal [m/s²]; `acceleration` bounds that of the forces.
    fn curvature(&self, state: &BodyState, acceleration: f64) -> f64;
    /// The largest height of the center over a surface \[m\].
    fn height(&self, center: DVec3) -> f64;

    /// Coulomb's law at the contacts of an operator, with static friction if it `grips`.
    fn law<'a>(&'a self, operator: &'a DelassusOperator<N>, grips: bool)
    -> impl CoulombLaw<N> + 'a;
    /// The energy between two solutions of an impact.
    fn way(&self, at: &Touching<N>, solutions: [&[DVec3; N]; 2]) -> Way;
    /// Those of the touching places that hold a face.
    fn on_faces(&self, touching: u64) -> u64;
    /// Applies the impulses p of an impact, and those that stop the places `stopped` along the normals. Returns their sums
    /// by place.
    fn strike(
        &self,
        state: &mut BodyState,
        at: &Touching<N>,
        p: &[DVec3; N],
        stopped: u64,
    ) -> [DVec3; N];
    /// Returns whether a place with the velocity `u` slips faster than `still` [m/s].
    fn slips(&self, k: usize, u: DVec3, still: f64) -> bool;
    /// Returns whether a body at rest stays: it is supported, and the mean velocities of the contacts or the mean twist
    /// are no faster than `still` [m/s].
    fn holds_still(
        &self,
        operator: &DelassusOperator<N>,
        mean: &[DVec3; N],
        twist: (DVec3, DVec3),
        still: f64,
    ) -> bool;
    /// Moves and turns the body so that the corners of the places `held` lie on their surfaces.
    fn project(&self, state: &mut BodyState, held: u64, elapsed: f64) -> (Places<N>, Self::Held);
    /// Removes from the end of a segment the rest of the velocities `after` along the normals, and all of it at the places
    /// in `whole`. Returns whether the held places support the body, so that a slow one is at rest.
    fn stop(
        &self,
        segment: &mut Segment<N>,
        contacts: &Self::Held,
        held: u64,
        whole: u64,
        after: &[DVec3; N],
    ) -> bool;
    /// Removes the approach from the velocity.
    fn separate(&self, state: &mut BodyState);

    /// The contacts at these places of a body whose world axes are `attitude`.
    #[inline]
    fn operator(&self, attitude: DMat3, places: u64) -> DelassusOperator<N> {
        let body = self.level().context.body;
        DelassusOperator::at(body, attitude, Self::order(places))
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

    /// Adds impulses at the places of a box, whose center is at `center` in the world, to a report. Until the end of the
    /// step its normal is the sum of those along the normals.
    fn record(
        &self,
        report: &mut ContactReport,
        center: DVec3,
        places: &Places<N>,
        impulse: &[DVec3; N],
    ) {
        for i in each(set::<N>(|i| impulse[i] != DVec3::ZERO)) {
            let (k, normal) = (i % 8, self.normal(i));
            let push = normal.dot(impulse[i]);
            report.normal += normal * push;
            report.tangential_impulse += self.along(i, impulse[i]);
            report.push(k, center + places.lever(k), push);
        }
    }
}

/// The contacts of an impact, and the motion before it.
pub(super) struct Touching<'a, const N: usize> {
    pub(super) operator: &'a DelassusOperator<N>,
    /// (v, ω).
    pub(super) twist: (DVec3, DVec3),
    /// The velocities of the contacts [m/s].
    pub(super) before: [DVec3; N],
}

/// The kinetic energy between the plastic solution p₀ and Newton's p₁. Newton's law with friction or several corners may
/// return more than the part e² of the energy, and even create some (Kane, Levinson 1985; Stronge 1990). Of p₀ + λd,
/// d = p₁ − p₀, the energy is Aλ² + Bλ + C above that before, with A = ½ d·Wd, B = d·(u⁻ + Wp₀): a quadratic. Every
/// λ in (0, 1) is inside the cones (they are convex), and not into the floor.
pub(super) struct Way {
    pub(super) a: f64,
    pub(super) b: f64,
    /// C ≤ 0 \[J\].
    pub(super) lost: f64,
    /// What p₁ adds \[J\].
    pub(super) gained: f64,
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
