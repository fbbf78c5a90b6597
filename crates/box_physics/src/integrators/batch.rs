//! Many bodies at once, in free flight under gravity alone, the most common case.
//!
//! An integrator whose step has no branch ([`Integrate::BRANCHES`]) runs over a group of bodies in one plain
//! loop, which the compiler vectorizes. It takes two bodies at a time on any x86-64, and four if the
//! processor has AVX2, detected at run time. The layout of the bodies in memory does not change; the compiler
//! shuffles them into SIMD lanes in registers. Vector and scalar additions, multiplications, divisions and
//! square roots round alike, and nothing is contracted or reordered. The bits are therefore the same for
//! every instruction set and every lane.
//!
//! The loop does not apply to a body whose turn is beyond the polynomials' range, or which has a non-finite
//! number. Such a body is left unchanged and takes the integrator's plain step, which gives the same bits
//! where both apply. With a floor below, a body that may meet it in the step is left unchanged as well.
//!
//! Bodies with other forces are stepped one by one, unless the integrator composes its step of kicks and free
//! flight ([`ForcedGroup`](super::ForcedGroup)). Then the free flight of many bodies is stepped in lanes.

use core::marker::PhantomData;
use core::ops::Range;

use glam::{DQuat, DVec3};

use super::{Integrate, Integrator, IntegratorMemory, IntegratorVisitor, MemorySlot, StepOutcome};
use crate::body::RigidBox;
use crate::floor::FloorBelow;
use crate::force::Gravity;
use crate::math::{SmallArguments, VectorLoop, vectorized};
use crate::state::BodyState;

/// Number of bodies in a block of the loop. Bodies to which the loop did not apply are recorded and stepped
/// after the block.
pub(super) const BLOCK: usize = 64;

/// Number of bodies that are stepped one by one before they are checked.
const ROW: usize = 8;

/// Groups with fewer bodies than this are stepped one by one.
const FEW: usize = 4;

/// Gravity, the only force on a group [m/s²].
#[derive(Clone, Copy, Debug)]
pub enum GravityField<'a> {
    /// The same for all bodies.
    Uniform(DVec3),
    /// One value per body.
    Each(&'a [DVec3]),
}

impl GravityField<'_> {
    /// Gravity of body `i` [m/s²].
    #[inline(always)]
    fn at(&self, i: usize) -> DVec3 {
        match self {
            Self::Uniform(gravity) => *gravity,
            Self::Each(gravity) => gravity[i],
        }
    }
}

/// Either kind of gravity, selected before the loop.
trait Field: Copy {
    /// The field of the first `count` bodies, at least one.
    fn first(self, count: usize) -> Self;
    /// Gravity of body `i` [m/s²].
    fn at(self, i: usize) -> DVec3;
    /// Returns `true` if body `i` stayed clear of the floor during the step.
    #[inline(always)]
    fn clears(self, _: usize, _: &RigidBox, _: &BodyState, _: &BodyState, _: f64) -> bool {
        true
    }
}

impl Field for DVec3 {
    #[inline(always)]
    fn first(self, _: usize) -> Self {
        self
    }

    #[inline(always)]
    fn at(self, _: usize) -> DVec3 {
        self
    }
}

impl Field for &[DVec3] {
    #[inline(always)]
    fn first(self, count: usize) -> Self {
        &self[..count]
    }

    #[inline(always)]
    fn at(self, i: usize) -> DVec3 {
        self[i]
    }
}

/// Gravity with a floor below.
#[derive(Clone, Copy)]
struct Over<G>(G, FloorBelow);

impl<G: Field> Field for Over<G> {
    #[inline(always)]
    fn first(self, count: usize) -> Self {
        Self(self.0.first(count), self.1)
    }

    #[inline(always)]
    fn at(self, i: usize) -> DVec3 {
        self.0.at(i)
    }

    #[inline(always)]
    fn clears(
        self,
        i: usize,
        body: &RigidBox,
        before: &BodyState,
        after: &BodyState,
        h: f64,
    ) -> bool {
        self.1.is_clear(body, before, after, self.at(i), h)
    }
}

/// Consecutive bodies of a table, all in free flight. The slices have equal lengths; elements beyond the
/// shortest are ignored.
pub struct Group<'a> {
    /// The bodies.
    pub bodies: &'a [RigidBox],
    /// Their states. A state that would become invalid in the step is left unchanged.
    pub states: &'a mut [BodyState],
    /// Their integrators' memories.
    pub memories: &'a mut [IntegratorMemory],
    /// Gravity, the only force.
    pub gravity: GravityField<'a>,
    /// Receives the indices of bodies whose states would become invalid.
    pub faults: &'a mut Vec<usize>,
    /// The floor below the bodies, and a flag for each body that may meet it and is left unchanged. Only for an
    /// integrator without branches.
    pub floor: Option<(FloorBelow, &'a mut [bool])>,
}

impl Group<'_> {
    fn len(&self) -> usize {
        let most = match self.gravity {
            GravityField::Uniform(_) => usize::MAX,
            GravityField::Each(gravity) => gravity.len(),
        };
        let most = most.min(self.floor.as_ref().map_or(most, |(_, meets)| meets.len()));
        let shortest = self.bodies.len().min(self.states.len());
        shortest.min(self.memories.len()).min(most)
    }

    /// The integrator's plain step, body by body.
    #[inline]
    pub fn one_by_one<S: Integrate>(&mut self, h: f64) -> StepOutcome {
        let mut total = StepOutcome::default();
        let count = self.len();
        for start in (0..count).step_by(ROW) {
            total += self.step_row::<S>(start..count.min(start + ROW), h);
        }
        total
    }

    /// Validity is checked after the last step, because numbers just written one by one are slow to read back
    /// as whole vectors.
    #[inline(always)]
    fn step_row<S: Integrate>(&mut self, row: Range<usize>, h: f64) -> StepOutcome {
        let mut total = StepOutcome::default();
        let (bodies, gravity) = (&self.bodies[row.clone()], self.gravity);
        let states = &mut self.states[row.clone()];
        let memories = &mut self.memories[row.clone()];
        let before: [BodyState; ROW] = core::array::from_fn(|k| states[k.min(states.len() - 1)]);
        for (k, ((body, state), memory)) in
            bodies.iter().zip(&mut *states).zip(memories).enumerate()
        {
            let force = Gravity(gravity.at(row.start + k));
            total += S::step(body, state, &force, h, memory);
        }
        for (k, (state, before)) in states.iter_mut().zip(before).enumerate() {
            let i = row.start + k;
            if !state.is_valid() {
                *state = before;
                self.faults.push(i);
            } else if let Some((below, meets)) = &mut self.floor {
                meets[i] = !below.is_clear(&bodies[k], &before, state, gravity.at(i), h);
                if meets[i] {
                    *state = before;
                }
            }
        }
        total
    }

    /// The step of `S` in SIMD lanes: the same bits as [`one_by_one`](Self::one_by_one), several bodies at a
    /// time.
    pub(super) fn in_lanes<S: Integrate>(&mut self, h: f64) -> StepOutcome {
        let count = self.len();
        if h == 0.0 || count < FEW {
            return self.one_by_one::<S>(h);
        }
        let mut total = StepOutcome::default();
        let mut start = 0;
        while start < count {
            let block = start..count.min(start + BLOCK);
            let mut refused = [0.0; BLOCK];
            let below = self.floor.as_ref().map(|(below, _)| *below);
            match (self.gravity, below) {
                (GravityField::Uniform(gravity), None) => {
                    self.block_in_lanes::<S>(block.clone(), gravity, h, &mut refused);
                }
                (GravityField::Uniform(gravity), Some(below)) => {
                    let over = Over(gravity, below);
                    self.block_in_lanes::<S>(block.clone(), over, h, &mut refused);
                }
                (GravityField::Each(gravity), below) => {
                    let over = Over(&gravity[block.clone()], below.unwrap_or(FloorBelow::NONE));
                    self.block_in_lanes::<S>(block.clone(), over, h, &mut refused);
                }
            }
            let refused = &refused[..block.len()];
            let exceptions = refused.iter().filter(|&&refused| refused != 0.0).count() as u64;
            total +=
                StepOutcome::plain(S::INFO.evaluations.free) * (block.len() as u64 - exceptions);
            if exceptions > 0 {
                total += self.step_refused::<S>(start, refused, h);
            }
            start += BLOCK;
        }
        total
    }

    fn block_in_lanes<S: Integrate>(
        &mut self,
        block: Range<usize>,
        gravity: impl Field,
        h: f64,
        refused: &mut [f64],
    ) {
        vectorized(LaneLoop {
            bodies: &self.bodies[block.clone()],
            states: &mut self.states[block],
            gravity,
            h,
            refused,
            integrator: PhantomData::<S>,
        });
    }

    /// In a separate function, because it is the exception.
    #[cold]
    #[inline(never)]
    fn step_refused<S: Integrate>(&mut self, start: usize, refused: &[f64], h: f64) -> StepOutcome {
        let mut total = StepOutcome::default();
        for (k, &refused) in refused.iter().enumerate() {
            match &mut self.floor {
                _ if refused == 0.0 => {}
                Some((_, meets)) if refused >= MEETS => meets[start + k] = true,
                _ => total += self.step_row::<S>(start + k..start + k + 1, h),
            }
        }
        total
    }
}

/// Value of `refused` for a body that may meet the floor.
const MEETS: f64 = 2.0;

/// Steps all bodies. Writes 1 to `refused` for a body that was left unchanged because the loop does not
/// apply, and [`MEETS`] for one that may meet the floor.
struct LaneLoop<'a, S, G> {
    bodies: &'a [RigidBox],
    states: &'a mut [BodyState],
    gravity: G,
    h: f64,
    refused: &'a mut [f64],
    integrator: PhantomData<S>,
}

impl<S: Integrate, G: Field> VectorLoop for LaneLoop<'_, S, G> {
    #[inline(always)]
    fn run(self) {
        step_each::<S>(self.bodies, self.states, self.gravity, self.h, self.refused);
    }
}

#[inline(always)]
fn step_each<S: Integrate>(
    bodies: &[RigidBox],
    states: &mut [BodyState],
    gravity: impl Field,
    h: f64,
    refused: &mut [f64],
) {
    // Slices of one known length, so that the loop needs no bounds checks.
    let count = bodies.len().min(states.len()).min(refused.len());
    let (bodies, gravity) = (&bodies[..count], gravity.first(count));
    let (states, refused) = (&mut states[..count], &mut refused[..count]);
    for i in 0..count {
        let before = states[i];
        let mut after = before;
        let mut small = SmallArguments::default();
        let (force, mut none) = (Gravity(gravity.at(i)), MemorySlot::none());
        S::advance(&bodies[i], &mut after, &force, h, &mut none, &mut small);
        let applies = small.all_small() & is_valid(&after);
        let clears = gravity.clears(i, &bodies[i], &before, &after, h);
        let reason = if clears { 0.0 } else { MEETS };
        refused[i] = if applies { reason } else { 1.0 };
        states[i] = choose(applies & clears, &after, &before);
    }
}

/// Accepts no more than [`BodyState::is_valid`], in fewer operations. A non-finite number makes the sum
/// non-finite.
#[inline(always)]
fn is_valid(state: &BodyState) -> bool {
    let (x, v, l) = (state.position, state.velocity, state.angular_momentum);
    let sum = (x.x.abs() + x.y.abs() + x.z.abs())
        + (v.x.abs() + v.y.abs() + v.z.abs())
        + (l.x.abs() + l.y.abs() + l.z.abs());
    let square = state.rotation.length_squared();
    (sum < 1e38) & ((square - 1.0).abs() < 0.5e-3)
}

/// Selects `a` or `b`, number by number.
#[inline(always)]
fn choose(a_is_it: bool, a: &BodyState, b: &BodyState) -> BodyState {
    let one = |a: f64, b: f64| if a_is_it { a } else { b };
    let three = |a: DVec3, b: DVec3| DVec3::new(one(a.x, b.x), one(a.y, b.y), one(a.z, b.z));
    let (q, p) = (a.rotation, b.rotation);
    BodyState {
        position: three(a.position, b.position),
        rotation: DQuat::from_xyzw(one(q.x, p.x), one(q.y, p.y), one(q.z, p.z), one(q.w, p.w)),
        velocity: three(a.velocity, b.velocity),
        angular_momentum: three(a.angular_momentum, b.angular_momentum),
    }
}

impl Integrator {
    /// Advances many bodies in free flight by one step of `h` \[s\]. Each result equals that of
    /// [`Integrator::step`] under `gravity` bit for bit, but several bodies are stepped at a time if the
    /// integrator allows it. A body whose new state would be invalid stays unchanged. The three slices have
    /// equal lengths; elements beyond the shortest are ignored.
    pub fn step_all(
        self,
        bodies: &[RigidBox],
        states: &mut [BodyState],
        memories: &mut [IntegratorMemory],
        gravity: &Gravity,
        h: f64,
    ) -> StepOutcome {
        let mut faults = Vec::new();
        let group = Group {
            bodies,
            states,
            memories,
            gravity: GravityField::Uniform(gravity.0),
            faults: &mut faults,
            floor: None,
        };
        self.dispatch(All { group, h })
    }
}

struct All<'a> {
    group: Group<'a>,
    h: f64,
}

impl IntegratorVisitor for All<'_> {
    type Output = StepOutcome;

    fn visit<S: Integrate>(mut self) -> StepOutcome {
        S::step_group(&mut self.group, self.h)
    }
}

#[cfg(test)]
mod tests;
