//! Digests of the motion, to compare two simulations bit for bit.

use glam::{DQuat, DVec3};

use crate::body::RigidBox;
use crate::floor::{ContactSettings, ContactState, Floor, FloorContext};
use crate::force::{Dissipation, Forces, Frame, PointForce, Spring};
use crate::integrators::{Integrator, IntegratorMemory};
use crate::state::BodyState;

const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// Computes the 64-bit FNV-1a hash (Fowler, Noll, Vo) of `bytes`, which is the same in every version and on every
/// machine.
pub fn fnv_1a(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes.into_iter().fold(BASIS, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(PRIME)
    })
}

/// Computes a digest of `states`, in this order.
///
/// The digest is FNV-1a over the bits of position, attitude, velocity and angular momentum of each body. Equal digests
/// mean equal bits, except for one chance in 1.8e19. Use it to compare runs, builds, machines, lock-step peers and
/// replays.
///
/// 0 and −0 have different bits, and so have q and −q.
///
/// ```
/// use box_physics::{digest::state_digest, force::Gravity, prelude::*};
/// let run = |steps| {
///     let (body, mut memory) = (RigidBox::default(), IntegratorMemory::default());
///     let mut state = BodyState::default().with_angular_velocity(&body, DVec3::new(1.0, 2.0, 3.0));
///     for _ in 0..steps {
///         Integrator::Split.step(&body, &mut state, &Gravity::default(), 1.0 / 60.0, &mut memory);
///     }
///     state_digest([&state])
/// };
/// assert_eq!(run(100), run(100));
/// assert_ne!(run(100), run(101));
/// ```
pub fn state_digest<'a>(states: impl IntoIterator<Item = &'a BodyState>) -> u64 {
    let numbers = states.into_iter().flat_map(BodyState::to_array);
    fnv_1a(numbers.flat_map(f64::to_le_bytes))
}

/// Computes the digest of a fixed scene, simulated by this build under `integrator`.
///
/// The scene lasts 1.5 s; its bodies tumble, bounce, slide, have drag and hang on a spring. A difference in any part of
/// a step changes the digest, so lock-step peers compare it before they start.
///
/// ```
/// use box_physics::{digest::fingerprint, prelude::*};
/// // What the other player's machine sent:
/// let theirs = fingerprint(Integrator::Split);
/// assert_eq!(fingerprint(Integrator::Split), theirs, "another version: its game would drift from ours");
/// assert_ne!(fingerprint(Integrator::Exact), theirs);
/// ```
pub fn fingerprint(integrator: Integrator) -> u64 {
    state_digest(&fixed_scene(integrator))
}

/// Steps of the fixed scene, and their size \[s\]: a power of two, so that n·dt is exact.
const STEPS: u32 = 96;
const DT: f64 = 1.0 / 64.0;

fn fixed_body() -> RigidBox {
    RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0)
        .expect("in range: a test computes every fingerprint")
}

fn fixed_start(body: &RigidBox, k: usize) -> BodyState {
    let k = k as f64;
    BodyState::at_pose(
        DVec3::new(3.0 * k, 1.0 + 0.25 * k, -0.5),
        DQuat::from_xyzw(0.25, 0.125 * k, -0.5, 1.0),
    )
    .with_velocity(DVec3::new(0.75, 0.5 - k, 1.25))
    .with_angular_velocity(body, DVec3::new(1.5, 2.5 - k, 1.0))
}

/// Three bodies over a floor. Each has different terms in its force model, so that every part of a step runs.
fn fixed_scene(integrator: Integrator) -> [BodyState; 3] {
    let body = fixed_body();
    let springs = [Spring {
        body_point: DVec3::new(0.5, 0.25, 0.125),
        anchor: DVec3::new(6.0, 2.0, 0.0),
        stiffness: 30.0,
        damping: 0.25,
    }];
    let thrusters = [PointForce {
        body_point: DVec3::new(0.25, 0.0, 0.125),
        force: DVec3::new(0.0, 0.5, 1.0),
        frame: Frame::Body,
    }];
    let weight = Forces {
        acceleration: DVec3::new(0.0, -9.81, 0.0),
        ..Forces::default()
    };
    let laws = [
        weight,
        Forces {
            dissipation: Dissipation {
                linear_drag: 0.25,
                quadratic_drag: 0.0625,
                angular_damping: 0.125,
                angular_drag: 0.015_625,
                ..Dissipation::NONE
            },
            ..weight
        },
        Forces {
            springs: &springs,
            point_forces: &thrusters,
            body_torque: DVec3::new(0.125, 0.0, 0.0),
            world_torque: DVec3::new(0.0, 0.0625, 0.0),
            ..weight
        },
    ];
    core::array::from_fn(|k| {
        let mut state = fixed_start(&body, k);
        let (mut memory, mut contact) = (IntegratorMemory::default(), ContactState::default());
        let context = FloorContext {
            floor: &Floor::default(),
            settings: &ContactSettings::DEFAULT,
            body: &body,
            force: &laws[k],
        };
        for _ in 0..STEPS {
            integrator.step_on_floor(&context, &mut state, DT, &mut memory, &mut contact, None);
        }
        state
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The states are valid, because the bits of a NaN are not specified. Every body must move, or the digest
    /// would prove nothing.
    #[test]
    fn the_fixed_scene_is_valid_and_moves_under_every_integrator() {
        let body = fixed_body();
        for &integrator in Integrator::ALL {
            let states = fixed_scene(integrator);
            for (k, state) in states.iter().enumerate() {
                assert!(state.is_valid(), "{integrator}, body {k}");
                let start = fixed_start(&body, k);
                assert_ne!(start.rotation, state.rotation, "{integrator}, body {k}");
                // In free fall it would be 11 m below.
                assert!(state.position.y > 0.0, "{integrator}, body {k}");
            }
            let others = Integrator::ALL.iter().filter(|o| **o != integrator);
            for &other in others {
                assert_ne!(
                    fingerprint(integrator),
                    fingerprint(other),
                    "{integrator}, {other}"
                );
            }
        }
    }

    #[test]
    fn every_bit_counts_and_so_does_the_order() {
        let a = BodyState::default();
        let mut b = a;
        b.velocity.z = f64::from_bits(1);
        let mut c = a;
        c.position.x = -0.0;
        let digests = [
            state_digest([&a]),
            state_digest([&b]),
            state_digest([&c]),
            state_digest([&a, &b]),
            state_digest([&b, &a]),
            state_digest([]),
        ];
        for (i, x) in digests.iter().enumerate() {
            assert!(digests[..i].iter().all(|y| x != y));
        }
    }

    /// A known vector. FNV-1a of 104 zero bytes is BASIS · PRIME¹⁰⁴: nothing is xored.
    #[test]
    fn it_is_fnv_1a() {
        assert_eq!(fnv_1a(*b"foobar"), 0x8594_4171_f739_67e8);
        let mut zero = BodyState::at(DVec3::ZERO);
        zero.rotation = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        let expected = (0..104).fold(BASIS, |h, _| h.wrapping_mul(PRIME));
        assert_eq!(state_digest([&zero]), expected);
    }
}
