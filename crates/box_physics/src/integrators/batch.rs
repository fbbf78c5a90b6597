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
//! flight ([`Integrate::step_forced`]). Then the free flight of many bodies is stepped in lanes.

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

/// Either kind of gravity, selected before the loop.
trait Field: Copy {
    /// The field of the first `count` bodies, at least one.
    fn first(self, count: usize) -> Self;
    /// Gravity of body `i` [m/s²].
    fn at(self, i: usize) -> DVec3;
    /// Whether body `i` was clear of the floor on its way.
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
    /// The floor below them, and whether each body may meet it: that body is left unchanged. Only for an integrator
    /// without branches.
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
            let law = Gravity(match gravity {
                GravityField::Uniform(gravity) => gravity,
                GravityField::Each(gravity) => gravity[row.start + k],
            });
            total += S::step(body, state, &law, h, memory);
        }
        for (k, (state, before)) in states.iter_mut().zip(before).enumerate() {
            let i = row.start + k;
            if !state.is_valid() {
                *state = before;
                self.faults.push(i);
            } else if let Some((below, meets)) = &mut self.floor {
                let gravity = match gravity {
                    GravityField::Uniform(gravity) => gravity,
                    GravityField::Each(gravity) => gravity[i],
                };
                meets[i] = !below.is_clear(&bodies[k], &before, state, gravity, h);
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

/// What `refused` holds of a body that may meet the floor.
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
        let (law, mut none) = (Gravity(gravity.at(i)), MemorySlot::none());
        S::advance(&bodies[i], &mut after, &law, h, &mut none, &mut small);
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
mod tests {
    use super::super::Split;
    use super::*;
    use crate::floor::{ContactSettings, Floor, FloorContext};
    use crate::force::{Dissipation, Forces, Frame, PointForce, Spring};
    use crate::integrators::ForcedGroup;
    use crate::rotation::exponential_map;
    use proptest::prelude::*;

    /// Numbers of all kinds: ordinary, both zeros, tiny, large, non-finite.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            8 => -3.0..3.0_f64,
            1 => Just(0.0),
            1 => Just(-0.0),
            1 => Just(1e-300),
            1 => -500.0..500.0_f64,
        ]
    }

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(number()).prop_map(DVec3::from_array)
    }

    fn body() -> impl Strategy<Value = RigidBox> {
        let half = prop_oneof![
            3 => prop::array::uniform3(0.1..1.0_f64),
            1 => (0.1..1.0_f64).prop_map(|a| [a; 3]),
            1 => (0.1..1.0_f64, 0.1..1.0_f64).prop_map(|(a, b)| [a, b, a]),
        ];
        (half, 0.5..5.0_f64)
            .prop_map(|(h, m)| RigidBox::new(DVec3::from_array(h), m).expect("valid"))
    }

    fn moving() -> impl Strategy<Value = (RigidBox, BodyState)> {
        let turned = prop_oneof![1 => Just(DVec3::ZERO), 4 => vector()];
        (body(), vector(), turned, vector(), vector()).prop_map(|(body, x, turn, v, spin)| {
            let state = BodyState::at_pose(x, exponential_map(turn))
                .with_velocity(v)
                .with_body_angular_velocity(&body, spin);
            (body, state)
        })
    }

    fn bits(state: &BodyState) -> [u64; 13] {
        let (x, q) = (state.position, state.rotation);
        let (v, l) = (state.velocity, state.angular_momentum);
        [
            x.x, x.y, x.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, l.x, l.y, l.z,
        ]
        .map(f64::to_bits)
    }

    /// A step over a floor, by an integrator without branches. Which bodies may meet the floor.
    struct OverAFloor<'a> {
        bodies: &'a [RigidBox],
        states: &'a mut [BodyState],
        memories: &'a mut [IntegratorMemory],
        below: FloorBelow,
        each: bool,
        h: f64,
    }

    impl IntegratorVisitor for OverAFloor<'_> {
        type Output = Option<Vec<bool>>;

        fn visit<S: Integrate>(self) -> Option<Vec<bool>> {
            let gravity = DVec3::NEG_Y * 9.81;
            let (own, mut meets) = (
                vec![gravity; self.bodies.len()],
                vec![false; self.bodies.len()],
            );
            let mut group = Group {
                bodies: self.bodies,
                states: self.states,
                memories: self.memories,
                gravity: if self.each {
                    GravityField::Each(&own)
                } else {
                    GravityField::Uniform(gravity)
                },
                faults: &mut Vec::new(),
                floor: Some((self.below, &mut meets)),
            };
            (!S::BRANCHES)
                .then(|| S::step_group(&mut group, self.h))
                .map(|_| meets)
        }
    }

    /// One step by the loop compiled for every x86-64, and by the loop compiled for this processor.
    struct ByInstructionSets<'a> {
        set: &'a [(RigidBox, BodyState)],
        gravity: DVec3,
        h: f64,
    }

    impl IntegratorVisitor for ByInstructionSets<'_> {
        type Output = ();

        fn visit<S: Integrate>(self) {
            if S::BRANCHES {
                return;
            }
            let Self { set, gravity, h } = self;
            let bodies: Vec<_> = set.iter().map(|(body, _)| *body).collect();
            let start: Vec<_> = set.iter().map(|(_, state)| *state).collect();
            let (mut plain, mut refused) = (start.clone(), [0.0; BLOCK]);
            step_each::<S>(&bodies, &mut plain, gravity, h, &mut refused);
            let (mut best, mut refused_there) = (start, [0.0; BLOCK]);
            vectorized(LaneLoop {
                bodies: &bodies,
                states: &mut best,
                gravity,
                h,
                refused: &mut refused_there,
                integrator: PhantomData::<S>,
            });
            for (plain, best) in plain.iter().zip(&best) {
                assert_eq!(bits(plain), bits(best), "{}", S::INFO.id);
            }
            assert_eq!(refused, refused_there, "{}", S::INFO.id);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// The instruction set changes neither bits nor the set of bodies that the loop refuses.
        #[test]
        fn instruction_sets_agree(
            set in prop::collection::vec(moving(), 1..=BLOCK),
            gravity in vector(),
            h in prop_oneof![Just(1.0 / 60.0), Just(-0.1), 0.001..0.5_f64],
        ) {
            for integrator in Integrator::ALL {
                integrator.dispatch(ByInstructionSets { set: &set, gravity, h });
            }
        }

        /// Over a floor every integrator leaves alone the bodies that may meet it, and steps the others as without one,
        /// bit for bit. None of them has an impact.
        #[test]
        fn over_a_floor_the_bits_are_those_of_free_flight(
            set in prop::collection::vec(moving(), 1..150),
            height in -1.0..0.0_f64,
            each in any::<bool>(),
            h in prop_oneof![Just(1.0 / 60.0), 0.001..0.1_f64],
        ) {
            let (floor, settings) = (Floor { height, ..Floor::default() }, ContactSettings::DEFAULT);
            let force = Gravity(DVec3::NEG_Y * 9.81);
            let bodies: Vec<_> = set.iter().map(|(body, _)| *body).collect();
            let start: Vec<_> = set.iter().map(|(_, state)| *state).collect();
            for &integrator in Integrator::ALL {
                let (mut states, mut free) = (start.clone(), start.clone());
                let mut memories: Vec<_> = bodies.iter().map(|_| IntegratorMemory::default()).collect();
                let Some(meets) = integrator.dispatch(OverAFloor {
                    bodies: &bodies,
                    states: &mut states,
                    memories: &mut memories,
                    below: FloorBelow::new(&floor, &settings, h),
                    each,
                    h,
                }) else {
                    continue;
                };
                integrator.step_all(&bodies, &mut free, &mut memories, &force, h);
                for (i, body) in bodies.iter().enumerate() {
                    let expected = if meets[i] { &start[i] } else { &free[i] };
                    prop_assert_eq!(bits(&states[i]), bits(expected), "{}", integrator);
                    if !meets[i] {
                        let context = FloorContext { floor: &floor, settings: &settings, body, force: &force };
                        let (mut memory, mut contact) = Default::default();
                        let outcome = integrator.step_on_floor(
                            &context, &mut start[i].clone(), h, &mut memory, &mut contact, None,
                        );
                        prop_assert_eq!((outcome.impacts, contact.touching()), (0, 0), "{}", integrator);
                    }
                }
            }
        }

        /// The same for bodies under forces of their own: none, torques, point forces, springs and drag in any order.
        #[test]
        fn forced_at_once_is_one_by_one(
            set in prop::collection::vec((moving(), 0..7_usize), 1..150),
            torque in vector(),
            broken in 0_usize..300,
            h in prop_oneof![Just(1.0 / 60.0), Just(0.0), Just(-0.1), 0.001..0.5_f64],
        ) {
            let point = |frame| [PointForce { body_point: DVec3::X, force: torque, frame }];
            let points = [point(Frame::World), point(Frame::Body)];
            let spring = |damping| [Spring { body_point: DVec3::Y, stiffness: 9.0, damping, ..Default::default() }];
            let springs = [spring(0.0), spring(1.0)];
            let gravity = Forces { acceleration: DVec3::NEG_Y * 9.81, ..Default::default() };
            let drag = Dissipation { linear_drag: 0.5, ..Dissipation::NONE };
            let kinds = [
                gravity,
                Forces { world_torque: torque, ..gravity },
                Forces { point_forces: &points[0], ..gravity },
                Forces { body_torque: torque, point_forces: &points[1], ..gravity },
                Forces { springs: &springs[0], ..gravity },
                Forces { springs: &springs[1], ..gravity },
                Forces { world_torque: torque, dissipation: drag, ..gravity },
            ];
            let bodies: Vec<_> = set.iter().map(|((body, _), _)| *body).collect();
            let mut start: Vec<_> = set.iter().map(|((_, state), _)| *state).collect();
            // Long runs of one kind as well.
            let long = broken % 2 == 0;
            let forces: Vec<_> = set.iter().map(|(_, k)| kinds[if long { broken % 7 } else { *k }]).collect();
            if let Some(state) = start.get_mut(broken) {
                state.angular_momentum.y = f64::INFINITY;
            }
            let mut states = start.clone();
            let mut memories: Vec<_> = bodies.iter().map(|_| IntegratorMemory::default()).collect();
            for _ in 0..3 {
                let (mut faults, mut expected_faults) = (Vec::new(), Vec::new());
                let mut group = ForcedGroup {
                    bodies: &bodies,
                    states: &mut states,
                    memories: &mut memories,
                    forces: &forces,
                    faults: &mut faults,
                };
                let outcome = Split::step_forced(&mut group, h);
                let mut total = StepOutcome::default();
                for (i, (body, state)) in bodies.iter().zip(&mut start).enumerate() {
                    let before = *state;
                    let mut memory = IntegratorMemory::default();
                    total += Split::step(body, state, &forces[i], h, &mut memory);
                    if !state.is_valid() {
                        *state = before;
                        expected_faults.push(i);
                    }
                }
                prop_assert_eq!(outcome, total);
                prop_assert_eq!(faults, expected_faults);
                for (a, b) in states.iter().zip(&start) {
                    prop_assert_eq!(bits(a), bits(b));
                }
            }
        }

        /// Every integrator, any number of bodies, zeros of both signs, turns beyond the kernels' range and
        /// one non-finite state. Over several steps the results equal those of the plain steps bit for bit.
        #[test]
        fn all_at_once_is_one_by_one(
            set in prop::collection::vec(moving(), 1..150),
            gravity in vector(),
            broken in 0_usize..300,
            h in prop_oneof![Just(1.0 / 60.0), Just(0.0), Just(-0.1), 0.001..0.5_f64],
        ) {
            let bodies: Vec<_> = set.iter().map(|(body, _)| *body).collect();
            let mut start: Vec<_> = set.iter().map(|(_, state)| *state).collect();
            if let Some(state) = start.get_mut(broken) {
                state.angular_momentum.y = f64::INFINITY;
            }
            let law = Gravity(gravity);
            for &integrator in Integrator::ALL {
                let (mut states, mut expected) = (start.clone(), start.clone());
                let mut memories: Vec<_> = bodies.iter().map(|_| IntegratorMemory::default()).collect();
                let mut own: Vec<_> = bodies.iter().map(|_| IntegratorMemory::default()).collect();
                for _ in 0..3 {
                    let outcome = integrator.step_all(&bodies, &mut states, &mut memories, &law, h);
                    let mut total = StepOutcome::default();
                    for ((body, state), memory) in bodies.iter().zip(&mut expected).zip(&mut own) {
                        let before = *state;
                        total += integrator.step(body, state, &law, h, memory);
                        if !state.is_valid() {
                            *state = before;
                        }
                    }
                    prop_assert_eq!(outcome, total);
                    for (a, b) in states.iter().zip(&expected) {
                        prop_assert_eq!(bits(a), bits(b), "{}", integrator);
                    }
                }
            }
        }
    }
}
