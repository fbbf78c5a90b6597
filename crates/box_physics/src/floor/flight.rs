//! The most frequent steps of a box near the floor: out of reach, or in free flight.

use glam::DVec3;

use super::bounds::{SWING_AHEAD, acceleration_bound, curvature_bound};
use super::{ContactSettings, Floor, FloorContext};
use crate::aabb::world_half_extents;
use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel};
use crate::integrators::{Integrate, IntegratorMemory, StepOutcome};
use crate::state::BodyState;

/// Returns `false` if the box cannot reach the floor within `h` \[s\], so that a plain integrator step is safe.
///
/// The test is conservative and cheap: the center's height, minus the extent of the box at any attitude of the step, minus
/// the largest drop. Use [`step_on_floor`](super::step_on_floor) for a box that touched the floor at the end of the last
/// step, so that the end of its contact is reported.
#[inline]
pub fn may_touch<F: ForceModel>(
    floor: &Floor,
    body: &RigidBox,
    state: &BodyState,
    force: &F,
    h: f64,
) -> bool {
    let plane = (DVec3::Y, state.position.y - floor.height, floor.velocity.y);
    let reach = || world_half_extents(state.rotation, body.half_extents()).y;
    may_touch_plane(plane, reach, body, state, force, h)
}

/// The same for a plane with this normal, height of the center over it \[m\] and velocity along the normal [m/s]. `reach`
/// is the extent of the box from its center against the normal \[m\].
#[inline(always)]
pub(super) fn may_touch_plane<F: ForceModel>(
    (normal, clearance, rise): (DVec3, f64, f64),
    reach: impl FnOnce() -> f64,
    body: &RigidBox,
    state: &BodyState,
    force: &F,
    h: f64,
) -> bool {
    let mut drop = h * (rise - state.velocity.dot(normal)).max(0.0);
    let mut pull = (-force.acceleration().dot(normal)).max(0.0);
    let wrench = force.has_wrench();
    if wrench {
        // Spring forces grow along the path: twice the larger of the forces here and at the end of the center's path.
        let mut ahead = *state;
        ahead.position += h * state.velocity;
        let here = force.wrench(body, state).force.length();
        let there = force.wrench(body, &ahead).force.length();
        pull += 2.0 * body.inverse_mass() * here.max(there);
    }
    let d = force.dissipation();
    if d.wind != DVec3::ZERO {
        // Sinking air drags the body down.
        let drag = drag_coefficient(&d, state) * (state.velocity - d.wind).length();
        pull += body.inverse_mass() * drag;
    }
    drop += 0.5 * h * h * pull * if wrench { 2.0 } else { 1.0 };
    // A semi-implicit integrator falls by a whole a h² in its step.
    drop += 0.5 * h * h * pull;
    let radius = body.radius();
    if clearance - radius > drop {
        // Beyond its stable range, an explicit integrator lets drag reverse the motion.
        return d != Dissipation::NONE && h * drag_coefficient(&d, state) > body.mass();
    }
    if wrench || force.dissipation() != Dissipation::NONE {
        return true;
    }
    // |ω| ≤ |L| max(1/I): the corners move by at most that times the radius.
    let turn = h * state.angular_momentum.length() * body.inverse_inertia().max_element();
    !(turn < 0.5 && clearance - (reach() + turn * radius) > drop)
}

/// c₁ + k₂ |v − w| [N s/m].
#[inline]
fn drag_coefficient(d: &Dissipation, state: &BodyState) -> f64 {
    d.linear_drag + d.quadratic_drag * (state.velocity - d.wind).length()
}

/// Result of a plain step from above the floor.
pub(super) enum Flight {
    /// The step was taken: it ends above the floor and cannot have dipped in between.
    Clear(StepOutcome),
    /// The step may touch the floor. Nothing has changed; this is its end.
    Meets(Flown),
    /// The box was not above the floor.
    Low,
}

/// End of a plain step, without its memory.
pub(super) struct Flown {
    pub(super) state: BodyState,
    pub(super) outcome: StepOutcome,
}

/// Takes a plain step if its lowest corner stays clear of the floor. `spare` receives the memory of a rejected step.
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

/// Returns `true` if no corner can have been below the floor between the heights `before` and `after` of the lowest
/// one. As in the event search, √c₀ + √c₁ ≥ h√(M/2) is required, for which c₀ + c₁ ≥ h²M/2 suffices.
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
    let bound = acceleration_bound(body, state, force);
    let curvature = curvature_bound(body, state, bound, force.acceleration(), DVec3::Y);
    before.sqrt() + after.sqrt() >= h * (0.5 * curvature).sqrt()
}

/// Height of the lowest corner over a plane at `height` \[m\].
#[inline(always)]
fn clearance(body: &RigidBox, state: &BodyState, height: f64) -> f64 {
    state.position.y - height - world_half_extents(state.rotation, body.half_extents()).y
}

/// An upper bound M of the upward acceleration of every corner in free flight [m/s²]. It needs no square root and is
/// larger than that of the event search.
#[inline(always)]
fn curvature_ahead(body: &RigidBox, state: &BodyState, gravity: DVec3) -> f64 {
    let spin = SWING_AHEAD * state.body_angular_velocity(body).length_squared();
    spin * body.radius() + if gravity.y > 0.0 { gravity.y } else { 0.0 }
}

/// The floor below bodies in free flight, for the loop over many of them.
#[derive(Clone, Copy, Debug)]
pub struct FloorBelow {
    /// Height at the beginning and at the end of the step \[m\].
    start: f64,
    end: f64,
    tolerance: f64,
    /// Distance from the origin, for the tolerance \[m\].
    distance: f64,
}

impl FloorBelow {
    /// A floor out of reach.
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

    /// Returns `false` if a body that moved from `before` to `after` under `gravity` in `h` \[s\] may have touched the
    /// floor. The test is that of [`step_on_floor`](super::step_on_floor) without a square root.
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
