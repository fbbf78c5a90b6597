//! Bounds of how fast corners may move and how strongly they are accelerated.

use glam::DVec3;

use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel};
use crate::state::BodyState;

/// |L| max(1/I): no free motion spins faster [rad/s].
pub(super) fn spin_bound(body: &RigidBox, state: &BodyState) -> f64 {
    state.angular_momentum.length() * body.inverse_inertia().max_element()
}

/// How strongly the law accelerates any corner now, the rotation's own part left out [m/s²].
/// `state` is in the world.
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

/// Largest |ω̇ × r + ω × (ω × r)| of a free body over |ω|²|r|. Of a solid box 1.06, of a hollow or weighted one,
/// whose moments may be (c, c, small) with its corners anywhere, 1.253.
const SWING: f64 = 1.26;

/// Largest acceleration of a corner of a free body, now or later, over the present |ω|²|r|: |ω|² at most doubles.
pub(super) const SWING_AHEAD: f64 = 2.0 * SWING;

/// A bound of every corner's acceleration along `normal`, upwards: that of the rotation at the largest |ω|² that its
/// energy allows (and at most twice the present one), and whatever the force model
/// adds. The uniform acceleration `pull` downwards adds nothing when nothing is held: free fall is concave.
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
