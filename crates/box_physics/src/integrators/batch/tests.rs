use super::super::{Exact, Split, Split4};
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
    (half, 0.5..5.0_f64).prop_map(|(h, m)| RigidBox::new(DVec3::from_array(h), m).expect("valid"))
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
    state.to_array().map(f64::to_bits)
}

/// A step over a floor, by an integrator without branches, and the bodies that may touch the floor.
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
        let count = self.bodies.len();
        let (own, mut meets) = (vec![gravity; count], vec![false; count]);
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
        let (bodies, start): (Vec<_>, Vec<_>) = set.iter().copied().unzip();
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

/// Checks three steps of bodies under separate forces: the bits, faults and outcomes equal those of the plain steps.
fn expect_forced<S: Integrate>(
    bodies: &[RigidBox],
    start: &[BodyState],
    forces: &[Forces<'_>],
    h: f64,
) {
    let (mut states, mut expected) = (start.to_vec(), start.to_vec());
    let mut memories = vec![IntegratorMemory::default(); bodies.len()];
    let mut own = memories.clone();
    for _ in 0..3 {
        let (mut faults, mut expected_faults) = (Vec::new(), Vec::new());
        let columns = (bodies, &mut *states, &mut *memories);
        let outcome = ForcedGroup::step_each::<S>(columns, |i| forces[i], h, &mut faults);
        let mut total = StepOutcome::default();
        for (i, (body, state)) in bodies.iter().zip(&mut expected).enumerate() {
            let before = *state;
            total += S::step(body, state, &forces[i], h, &mut own[i]);
            if !state.is_valid() {
                *state = before;
                expected_faults.push(i);
            }
        }
        assert_eq!((outcome, faults), (total, expected_faults));
        for (a, b) in states.iter().zip(&expected) {
            assert_eq!(bits(a), bits(b), "{}", S::INFO.id);
        }
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

    /// Over a floor, every integrator skips the bodies that may touch it, and steps the others as without a floor, bit
    /// for bit. None of them has an impact.
    #[test]
    fn over_a_floor_the_bits_are_those_of_free_flight(
        set in prop::collection::vec(moving(), 1..150),
        height in -1.0..0.0_f64,
        each in any::<bool>(),
        h in prop_oneof![Just(1.0 / 60.0), 0.001..0.1_f64],
    ) {
        let (floor, settings) = (Floor { height, ..Floor::default() }, ContactSettings::DEFAULT);
        let force = Gravity(DVec3::NEG_Y * 9.81);
        let (bodies, start): (Vec<_>, Vec<_>) = set.iter().copied().unzip();
        for &integrator in Integrator::ALL {
            let (mut states, mut free) = (start.clone(), start.clone());
            let mut memories = vec![IntegratorMemory::default(); bodies.len()];
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

    /// The same for bodies under separate forces: none, torques, point forces, springs and drag in any order.
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
        expect_forced::<Split>(&bodies, &start, &forces, h);
        expect_forced::<Split4>(&bodies, &start, &forces, h);
        expect_forced::<Exact>(&bodies, &start, &forces, h);
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
        let (bodies, mut start): (Vec<_>, Vec<_>) = set.iter().copied().unzip();
        if let Some(state) = start.get_mut(broken) {
            state.angular_momentum.y = f64::INFINITY;
        }
        let law = Gravity(gravity);
        for &integrator in Integrator::ALL {
            let (mut states, mut expected) = (start.clone(), start.clone());
            let mut memories = vec![IntegratorMemory::default(); bodies.len()];
            let mut own = memories.clone();
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
