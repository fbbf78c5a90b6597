//! Bounds of the velocity and acceleration of corners.

use glam::DVec3;

use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel};
use crate::state::BodyState;

/// Upper bound of the spin in free motion: |L| max(1/I) [rad/s].
pub(super) fn spin_bound(body: &RigidBox, state: &BodyState) -> f64 {
    state.angular_momentum.length() * body.inverse_inertia().max_element()
}

/// Upper bound of the acceleration of any corner due to the present forces, without the rotational part [m/s²]. `state`
/// is in world coordinates.
pub(super) fn acceleration_bound<F: ForceModel>(
    body: &RigidBox,
    state: &BodyState,
    force: &F,
) -> f64 {
    let mut bound = force.acceleration().length();
    let d = force.dissipation();
    if d != Dissipation::NONE {
        let speed = (state.velocity - d.wind).length();
        bound += (d.linear_drag + d.quadratic_drag * speed) * speed * body.inverse_mass();
        let spin = spin_bound(body, state);
        let angular = d.angular_damping + d.angular_drag * body.inverse_inertia().max_element();
        bound += angular * spin * body.radius();
    }
    if force.has_wrench() {
        let w = force.wrench(body, state);
        bound += w.force.length() * body.inverse_mass();
        bound += (w.torque * body.inverse_inertia()).length() * body.radius();
    }
    bound
}

/// Largest |ω̇ × r + ω × (ω × r)| of a free body over |ω|²|r|: 1.06 for a solid box. It is 1.253 for a hollow or
/// weighted one, whose moments may be (c, c, small) with its corners anywhere.
const SWING: f64 = 1.26;

/// Largest acceleration of a corner of a free body, now or later, over the present |ω|²|r|. At most, |ω|² doubles.
pub(super) const SWING_AHEAD: f64 = 2.0 * SWING;

/// Upper bound of every corner's upward acceleration along `normal`. It is the sum of two parts: rotation at the
/// largest |ω|² for its energy (at most twice the present one), and the force model. A downward part of the uniform
/// acceleration `pull` does not count, because free fall is concave.
pub(super) fn curvature_bound(
    body: &RigidBox,
    state: &BodyState,
    acceleration: f64,
    pull: DVec3,
    normal: DVec3,
) -> f64 {
    let omega = state.body_angular_velocity(body);
    let energy = 2.0 * state.rotational_energy(body) * body.inverse_inertia().max_element();
    let spin = (2.0 * omega.length_squared()).min(energy);
    let up = acceleration - pull.length() + pull.dot(normal).max(0.0);
    SWING * spin * body.radius() + up.max(0.0)
}

#[cfg(test)]
mod tests;
