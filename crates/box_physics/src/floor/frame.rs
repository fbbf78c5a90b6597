//! The frame of a floor that moves, in which contact is solved: the floor is at rest in it, and energy is counted in
//! it. It coincides with the world at the beginning of the step. The integrator and the forces stay in the world,
//! where springs have their anchors and the air is at rest.

use glam::DVec3;

use super::FloorContext;
use crate::force::ForceModel;
use crate::integrators::{Integrate, IntegratorMemory, StepOutcome};
use crate::state::BodyState;

impl<F> FloorContext<'_, F> {
    /// Whether the two frames differ. Where they do not, no bit changes.
    #[inline]
    pub(super) fn floor_moves(&self) -> bool {
        self.floor.velocity != DVec3::ZERO
    }

    /// From the floor's frame to the world, `elapsed` \[s\] after the beginning of the step.
    #[inline]
    pub(super) fn to_world(&self, state: &mut BodyState, elapsed: f64) {
        if self.floor_moves() {
            state.position += self.floor.velocity * elapsed;
            state.velocity += self.floor.velocity;
        }
    }

    /// The opposite of [`FloorContext::to_world`].
    #[inline]
    pub(super) fn to_floor(&self, state: &mut BodyState, elapsed: f64) {
        if self.floor_moves() {
            state.position -= self.floor.velocity * elapsed;
            state.velocity -= self.floor.velocity;
        }
    }

    /// Where a point of the floor's frame is in the world.
    pub(super) fn world_point(&self, point: DVec3, elapsed: f64) -> DVec3 {
        if self.floor_moves() {
            point + self.floor.velocity * elapsed
        } else {
            point
        }
    }

    /// Advances a state of the floor's frame by `tau` \[s\] under `force`, in the world.
    #[inline(always)]
    pub(super) fn integrate<S: Integrate>(
        &self,
        state: &mut BodyState,
        force: &impl ForceModel,
        elapsed: f64,
        tau: f64,
        memory: &mut IntegratorMemory,
    ) -> StepOutcome {
        self.to_world(state, elapsed);
        let outcome = S::step(self.body, state, force, tau, memory);
        self.to_floor(state, elapsed + tau);
        outcome
    }
}

impl<F: ForceModel> FloorContext<'_, F> {
    /// Whether all forces but the floor's do no work in its frame except for a uniform acceleration, or take energy.
    /// Air that moves relative to the floor may drag the body along.
    pub(super) fn bounds_energy(&self) -> bool {
        let blown = self.floor_moves() || self.force.dissipation().wind != DVec3::ZERO;
        !(self.force.has_wrench() || blown && self.force.has_dissipation())
    }
}
