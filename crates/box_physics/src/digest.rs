//! A digest of the motion: whether two simulations agree, to the last bit.

use crate::state::BodyState;

/// FNV-1a, 64 bit (Fowler, Noll, Vo): its basis and its prime.
const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// A digest of these states in this order: FNV-1a over the bits of every number, position, attitude,
/// velocity and angular momentum of one body after the other. Equal digests mean, but for one chance in
/// 1.8e19, equal bits: for comparing runs, builds and machines, lock-step peers, replays.
///
/// 0 and −0 are different bits, and so are q and −q.
///
/// ```
/// use box_physics::{digest::state_digest, prelude::*};
/// let run = |steps| {
///     let (body, mut memory) = (RigidBox::default(), SchemeMemory::default());
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
    let mut hash = BASIS;
    for state in states {
        let numbers = [
            &state.position.to_array()[..],
            &state.rotation.to_array(),
            &state.velocity.to_array(),
            &state.angular_momentum.to_array(),
        ];
        for byte in numbers.into_iter().flatten().flat_map(|x| x.to_le_bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(PRIME);
        }
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

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

    /// FNV-1a of 104 zero bytes is BASIS · PRIME¹⁰⁴: nothing is xored.
    #[test]
    fn it_is_fnv_1a() {
        let mut zero = BodyState::at(DVec3::ZERO);
        zero.rotation = glam::DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        let expected = (0..104).fold(BASIS, |h, _| h.wrapping_mul(PRIME));
        assert_eq!(state_digest([&zero]), expected);
    }
}
