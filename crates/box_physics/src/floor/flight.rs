//! The commonest step of a box near the floor: it flies by.

use glam::DVec3;

use super::bounds::{SWING_AHEAD, acceleration_bound, curvature_bound};
use super::{ContactSettings, Floor, FloorContext};
use crate::aabb::world_half_extents;
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::integrators::{Integrate, IntegratorMemory, StepOutcome};
use crate::state::BodyState;

/// A plain step from off the floor.
pub(super) enum Flight {
    /// It ends off the floor and cannot have dipped in between: it is made.
    Clear(StepOutcome),
    /// It may meet the floor: nothing has changed, and this is where it would have led.
    Meets(Flown),
    /// It did not start off the floor.
    Low,
}

/// The end of a plain step, its memory aside.
pub(super) struct Flown {
    pub(super) state: BodyState,
    pub(super) outcome: StepOutcome,
}

/// The commonest case. The lowest corner stands for all. `spare` gets the memory of what is not made.
#[inline(always)]
pub(super) fn fly<S: Integrate, F: ForceModel>(
    context: &FloorContext<'_, F>,
    state: &mut BodyState,
    h: f64,
    memory: &mut IntegratorMemory,
    spare: &mut IntegratorMemory,
) -> Flight {
    let (floor, body, force) = (context.floor, context.body, context.force);
    let margin = 2.0 * context.tolerated_height();
    let before = clearance(body, state, floor.height);
    if before <= margin {
        return Flight::Low;
    }
    let start = *state;
    spare.clone_from(memory);
    let outcome = S::step(body, state, force, h, memory);
    let after = clearance(body, state, floor.height + floor.velocity.y * h);
    if after > margin && clears(body, &start, force, h, before, after) {
        return Flight::Clear(outcome);
    }
    core::mem::swap(memory, spare);
    Flight::Meets(Flown {
        state: core::mem::replace(state, start),
        outcome,
    })
}

/// Whether no corner can have been below the floor between the heights `before` and `after` of the lowest: as in
/// the event search √c₀ + √c₁ ≥ h√(M/2), for which c₀ + c₁ ≥ h²M/2 is enough.
fn clears<F: ForceModel>(
    body: &RigidBox,
    state: &BodyState,
    force: &F,
    h: f64,
    before: f64,
    after: f64,
) -> bool {
    if !force.has_wrench() && !force.has_dissipation() {
        let least = curvature_ahead(body, state, force.acceleration());
        if before + after >= 0.5 * h * h * least {
            return true;
        }
    }
    let pull = acceleration_bound(body, state, force);
    let curvature = curvature_bound(body, state, pull, force, DVec3::Y);
    before.sqrt() + after.sqrt() >= h * (0.5 * curvature).sqrt()
}

/// Height of the lowest corner over a plane at `height` \[m\].
#[inline(always)]
fn clearance(body: &RigidBox, state: &BodyState, height: f64) -> f64 {
    state.position.y - height - world_half_extents(state.rotation, body.half_extents()).y
}

/// A bound M of the upward acceleration of every corner in free flight, larger than that of the event search, without
/// a root [m/s²].
#[inline(always)]
fn curvature_ahead(body: &RigidBox, state: &BodyState, gravity: DVec3) -> f64 {
    let spin = SWING_AHEAD * state.body_angular_velocity(body).length_squared();
    spin * body.radius() + if gravity.y > 0.0 { gravity.y } else { 0.0 }
}

/// The floor below bodies in free flight, for the loop over many of them.
#[derive(Clone, Copy, Debug)]
pub struct FloorBelow {
    /// Its height at the beginning and at the end of the step \[m\].
    start: f64,
    end: f64,
    tolerance: f64,
    /// Its distance from the origin, for the tolerance \[m\].
    distance: f64,
}

impl FloorBelow {
    /// So far below that nothing meets it.
    pub(crate) const NONE: Self = Self {
        start: -1e300,
        end: -1e300,
        tolerance: 0.0,
        distance: 0.0,
    };

    /// The floor during a step of `h` \[s\].
    pub fn new(floor: &Floor, settings: &ContactSettings, h: f64) -> Self {
        Self {
            start: floor.height,
            end: floor.height + floor.velocity.y * h,
            tolerance: settings.tolerance,
            distance: floor.height.abs(),
        }
    }

    /// Whether a body that flew from `before` to `after` under `gravity` in `h` \[s\] was clear of the floor all the time:
    /// the test of [`step_on_floor`](super::step_on_floor), but for a root. `false` means that it may have met it.
    #[inline(always)]
    pub(crate) fn is_clear(
        &self,
        body: &RigidBox,
        before: &BodyState,
        after: &BodyState,
        gravity: DVec3,
        h: f64,
    ) -> bool {
        let margin = 2.0 * self.tolerance * (body.radius() + self.distance);
        let low = clearance(body, before, self.start);
        let end = clearance(body, after, self.end);
        let least = 0.5 * h * h * curvature_ahead(body, before, gravity);
        (low > margin) & (end > margin) & (low + end >= least)
    }
}
