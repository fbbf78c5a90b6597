//! What an integrator may remember between steps.

use super::trajectory::Trajectory;
#[cfg(feature = "bevy")]
use crate::ecs::*;

/// An integrator's memory of one body. Most integrators need none and never touch it. It is checked, not
/// trusted: an integrator drops it whenever state, body or forces are not bit for bit what it last left,
/// so teleports, impulses and live switching need no notice. An empty memory is always valid.
///
/// To try several steps from one state, copy the memory into a scratch one with
/// [`clone_from`](Clone::clone_from), which reuses what the scratch has allocated.
///
/// ```
/// use box_physics::prelude::*;
/// let (body, weight) = (RigidBox::default(), Gravity(DVec3::new(0.0, -9.81, 0.0)));
/// let mut state = BodyState::default().with_angular_velocity(&body, DVec3::new(1.0, 2.0, 3.0));
/// let mut memory = IntegratorMemory::default();
/// let mut step = |state: &mut BodyState, memory: &mut IntegratorMemory| {
///     Integrator::Exact.step(&body, state, &weight, 1.0 / 60.0, memory);
/// };
/// step(&mut state, &mut memory);
/// // To go back and continue to the last bit, keep both.
/// let kept = (state, memory.clone());
/// step(&mut state, &mut memory);
/// let (mut again, mut memory) = kept;
/// step(&mut again, &mut memory);
/// assert_eq!(again, state);
/// ```
#[derive(Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(opaque),
    reflect(Component, Default, Clone, PartialEq, Debug)
)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    all(feature = "bevy", feature = "serde"),
    reflect(Serialize, Deserialize)
)]
pub struct IntegratorMemory {
    /// Of `exact`. Allocated when the integrator first runs on the body, then overwritten in place.
    pub(super) trajectory: Option<Box<Trajectory>>,
}

impl Clone for IntegratorMemory {
    fn clone(&self) -> Self {
        Self {
            trajectory: self.trajectory.clone(),
        }
    }

    fn clone_from(&mut self, source: &Self) {
        self.trajectory.clone_from(&source.trajectory);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::RigidBox;
    use crate::force::Gravity;
    use crate::integrators::Integrator;
    use crate::state::BodyState;
    use glam::DVec3;

    #[test]
    fn a_scratch_copy_keeps_its_allocation() {
        let (body, mut state) = (RigidBox::default(), BodyState::default());
        let (mut memory, mut scratch) = (IntegratorMemory::default(), IntegratorMemory::default());
        let law = Gravity(DVec3::NEG_Y);
        let address = |m: &IntegratorMemory| m.trajectory.as_deref().map(core::ptr::from_ref);
        Integrator::Exact.step(&body, &mut state, &law, 0.1, &mut memory);
        scratch.clone_from(&memory);
        let (first, own) = (address(&scratch), address(&memory));
        Integrator::Exact.step(&body, &mut state, &law, 0.1, &mut memory);
        assert!(scratch != memory);
        scratch.clone_from(&memory);
        assert!(scratch == memory && address(&scratch) == first);
        // An event overwrites in place as well.
        state.velocity = DVec3::X;
        Integrator::Exact.step(&body, &mut state, &law, 0.1, &mut memory);
        assert_eq!(address(&memory), own);
    }
}
