//! Richardson extrapolation of a symmetric step of order 2 to order 4: S(½h)² + (S(½h)² − S(h))/3.

use glam::{DQuat, DVec3};

use crate::state::BodyState;

/// Advances `state` by two half steps. Returns the initial state and the result of one whole step.
#[inline(always)]
pub(super) fn halved(
    state: &mut BodyState,
    h: f64,
    mut step: impl FnMut(&mut BodyState, f64),
) -> (BodyState, BodyState) {
    let start = *state;
    let mut one = start;
    step(&mut one, h);
    step(state, 0.5 * h);
    step(state, 0.5 * h);
    (start, one)
}

/// Replaces position and velocity of the two half steps in `state` by the extrapolated values.
#[inline(always)]
pub(super) fn extrapolate_translation(start: &BodyState, one: &BodyState, state: &mut BodyState) {
    state.position += (state.position - one.position) * (1.0 / 3.0);
    state.velocity = extrapolated(start.velocity, one.velocity, state.velocity);
}

/// The extrapolated velocity or momentum: `start` is the initial value, `one` the result of one step and `two` of two
/// half steps.
///
/// If `one` and `two` differ by more than half of the larger of `start` and `two`, the step is too long to extrapolate,
/// and the result is `two`. Extrapolation therefore never reverses a quantity that a flow has damped.
#[inline(always)]
fn extrapolated(start: DVec3, one: DVec3, two: DVec3) -> DVec3 {
    let difference = two - one;
    let size = start.length_squared().max(two.length_squared());
    if difference.length_squared() <= 0.25 * size {
        two + difference * (1.0 / 3.0)
    } else {
        two
    }
}

/// Replaces attitude and angular momentum of the two half steps in `state` by the extrapolated values.
#[inline(always)]
pub(super) fn extrapolate_rotation(start: &BodyState, one: &BodyState, state: &mut BodyState) {
    let near = if one.rotation.dot(state.rotation) < 0.0 {
        -one.rotation
    } else {
        one.rotation
    };
    let difference: DQuat = state.rotation + near * -1.0;
    if difference.length_squared() <= 0.25 {
        let q = state.rotation + difference * (1.0 / 3.0);
        state.rotation = q * (1.0 / q.length());
    }
    state.angular_momentum = extrapolated(
        start.angular_momentum,
        one.angular_momentum,
        state.angular_momentum,
    );
}
