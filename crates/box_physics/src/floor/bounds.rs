//! Bounds of how fast corners may move and how strongly they are accelerated.

use super::geometry::Corners;
use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel};
use crate::state::BodyState;

/// u_kn of all corners [m/s].
pub(super) fn normal_velocities(body: &RigidBox, state: &BodyState, corners: &Corners) -> [f64; 8] {
    let omega = state.angular_velocity(body);
    corners.lever.map(|r| state.velocity.y + omega.cross(r).y)
}

/// |L| max(1/I): no free motion spins faster [rad/s].
pub(super) fn spin_bound(body: &RigidBox, state: &BodyState) -> f64 {
    state.angular_momentum.length() * body.inverse_inertia().max_element()
}

/// How strongly the law accelerates any corner now, the rotation's own part left out [m/s²].
pub(super) fn acceleration_bound<F: ForceModel>(
    body: &RigidBox,
    state: &BodyState,
    force: &F,
) -> f64 {
    let mut bound = force.acceleration().length();
    let d = force.dissipation();
    if d != Dissipation::NONE {
        let speed = state.velocity.length();
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

/// A bound of the upward acceleration of every corner: 1.06 Ω²|r| for the rotation (Ω² the largest
/// |ω|² that the rotational energy allows; for a box at most twice the present one), and whatever the
/// law adds. Plain gravity downwards adds nothing when nothing is held: free fall is concave.
pub(super) fn curvature_bound<F: ForceModel>(
    body: &RigidBox,
    state: &BodyState,
    acceleration: f64,
    force: &F,
) -> f64 {
    let omega = state.body_angular_velocity(body);
    let energy = 2.0 * state.rotational_energy(body) * body.inverse_inertia().max_element();
    let spin = (2.0 * omega.length_squared()).min(energy);
    let up = acceleration - force.acceleration().length() + force.acceleration().y.max(0.0);
    1.06 * spin * body.radius() + up.max(0.0)
}
