//! The commonest step of a box near the floor: it flies by.

use glam::DVec3;

use super::FloorContext;
use super::bounds::{SWING_AHEAD, acceleration_bound, curvature_bound};
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
pub(super) fn fly<S: Integrate, F: ForceModel>(
    context: &FloorContext<'_, F>,
    state: &mut BodyState,
    h: f64,
    memory: &mut IntegratorMemory,
    spare: &mut IntegratorMemory,
) -> Flight {
    let (floor, body, force) = (context.floor, context.body, context.force);
    let margin = 2.0 * context.tolerated_height();
    let clearance = |s: &BodyState, height: f64| {
        s.position.y - height - world_half_extents(s.rotation, body.half_extents()).y
    };
    let before = clearance(state, floor.height);
    if before <= margin {
        return Flight::Low;
    }
    let mut end = *state;
    spare.clone_from(memory);
    let outcome = S::step(body, &mut end, force, h, spare);
    let after = clearance(&end, floor.height + floor.velocity.y * h);
    if after > margin && clears(body, state, force, h, before, after) {
        *state = end;
        core::mem::swap(memory, spare);
        return Flight::Clear(outcome);
    }
    Flight::Meets(Flown {
        state: end,
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
        // A larger M without a root.
        let spin = SWING_AHEAD * state.body_angular_velocity(body).length_squared();
        let curvature = spin * body.radius() + force.acceleration().y.max(0.0);
        if before + after >= 0.5 * h * h * curvature {
            return true;
        }
    }
    let pull = acceleration_bound(body, state, force);
    let curvature = curvature_bound(body, state, pull, force, DVec3::Y);
    before.sqrt() + after.sqrt() >= h * (0.5 * curvature).sqrt()
}
