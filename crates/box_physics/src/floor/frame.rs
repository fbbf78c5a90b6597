//! The frame of a floor that moves, in which contact is solved: the floor is at rest in it, and energy is counted in
//! it. It coincides with the world at the beginning of the step. The integrator and the forces stay in the world,
//! where springs have their anchors and the air is at rest.

use glam::DVec3;

use super::FloorContext;
use super::motion::Supported;
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::integrators::{Integrate, IntegratorMemory, Order, StepOutcome};
use crate::state::BodyState;

/// [`Integrate::step`] under the forces `F`.
type Step<F> = fn(&RigidBox, &mut BodyState, &F, f64, &mut IntegratorMemory) -> StepOutcome;

/// An integrator as the floor uses it: a value instead of a type parameter, so that the floor is compiled once for all.
pub(super) struct Method<F> {
    /// A step without the floor.
    pub(super) step: Step<F>,
    /// A step with corners held.
    pub(super) supported: for<'s> fn(
        &RigidBox,
        &mut BodyState,
        &Supported<'s, F>,
        f64,
        &mut IntegratorMemory,
    ) -> StepOutcome,
    /// Whether it is of first order in uniform gravity. A closed form would hide that error.
    pub(super) errs_in_gravity: bool,
}

impl<F: ForceModel> Method<F> {
    pub(super) fn of<S: Integrate>() -> Self {
        Self {
            step: S::step::<F>,
            supported: |body, state, force, h, memory| S::step(body, state, force, h, memory),
            errs_in_gravity: matches!(S::INFO.orders.gravity, Order::Of(1)),
        }
    }
}

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

    /// Advances a state of the floor's frame by `tau` \[s\] by `step`, in the world.
    pub(super) fn in_world(
        &self,
        state: &mut BodyState,
        elapsed: f64,
        tau: f64,
        step: impl FnOnce(&mut BodyState) -> StepOutcome,
    ) -> StepOutcome {
        self.to_world(state, elapsed);
        let outcome = step(state);
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
