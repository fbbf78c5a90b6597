//! Exact corrections: held corners exactly on the floor, and exactly without the velocity that the
//! contact forbids. Both are the smallest correction in the body's own metric (kinetic energy), so
//! the velocity one can only take energy.

use glam::{DMat3, DVec3};

use super::Floor;
use super::geometry::{ContactSet, Corner3, Corners};
use crate::body::RigidBox;
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// Impulses p, of the components that `mask` (0 or 1) lets through, with masked (u + Wp) = 0: of
/// least norm, by conjugate gradients from zero (Hestenes, Stiefel 1952). W has rank six at most, so
/// six steps are exact but for rounding; the rest of the twelve polish.
pub(super) fn cancel(set: &ContactSet, u: &Corner3, mask: &Corner3) -> Corner3 {
    let n = set.count;
    let mut p = [DVec3::ZERO; 8];
    let mut residual = p;
    for i in 0..n {
        residual[i] = -(u[i] * mask[i]);
    }
    let mut direction = residual;
    let mut square = set.dot(&residual, &residual);
    let floor = square * 1e-34;
    if square <= floor {
        return p;
    }
    let null = 1e-12 * set.stiffness_bound();
    for _ in 0..12 {
        if square <= floor {
            break;
        }
        let mut image = set.response(&direction);
        for i in 0..n {
            image[i] *= mask[i];
        }
        let curvature = set.dot(&direction, &image);
        // Four coplanar corners have one distribution that does nothing, and rounding leaves a residual
        // along it: there is nothing to gain there, and a step would be noise over noise.
        if curvature <= null * set.dot(&direction, &direction) {
            break;
        }
        let step = square / curvature;
        for i in 0..n {
            p[i] += step * direction[i];
            residual[i] -= step * image[i];
        }
        let next = set.dot(&residual, &residual);
        let beta = next / square;
        for i in 0..n {
            direction[i] = residual[i] + beta * direction[i];
        }
        square = next;
    }
    p
}

/// Moves and turns the body so that the corners `held` lie on the floor: Newton's method on their
/// heights. The centre moves along the normal only.
pub(super) fn place_on_floor(floor: &Floor, body: &RigidBox, state: &mut BodyState, held: u8) {
    for _ in 0..3 {
        let corners = Corners::at(floor, body, state);
        let attitude = DMat3::from_quat(state.rotation);
        let set = ContactSet::new(body, attitude, &corners.lever, held);
        let mut gap = [DVec3::ZERO; 8];
        let mut worst = 0.0_f64;
        for i in 0..set.count {
            let c = corners.height[usize::from(set.corner[i])];
            gap[i] = DVec3::Y * c;
            worst = worst.max(c.abs());
        }
        if worst <= 4.0 * f64::EPSILON * (body.radius() + state.position.y.abs()) {
            return;
        }
        let (shift, turn) = set.twist(&cancel(&set, &gap, &[DVec3::Y; 8]));
        state.position += shift;
        if turn != DVec3::ZERO {
            // World turn: q ← exp(turn)∘q. The angular momentum keeps its body components.
            state.rotation = compose(exponential_map(turn), state.rotation);
            state.renormalise();
        }
    }
}

/// Lifts the body so that no corner is below the floor; never pushes it down. Returns the lift \[m\].
pub(super) fn lift_out(floor: &Floor, body: &RigidBox, state: &mut BodyState) -> f64 {
    let mut total = 0.0;
    // Rounding may leave the last bit below: a second pass takes it.
    for _ in 0..2 {
        let depth = -Corners::at(floor, body, state).lowest();
        if depth <= 0.0 || !depth.is_finite() {
            break;
        }
        state.position.y += depth;
        total += depth;
    }
    total
}
