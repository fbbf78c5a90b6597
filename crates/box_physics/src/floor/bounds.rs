//! Bounds of how fast corners may move and how strongly they are accelerated.

use glam::DVec3;

use super::geometry::Corners;
use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel};
use crate::state::BodyState;

/// u_kn of all corners [m/s].
pub(super) fn normal_velocities(body: &RigidBox, state: &BodyState, corners: &Corners) -> [f64; 8] {
    let omega = state.angular_velocity(body);
    core::array::from_fn(|k| state.velocity.y + omega.cross(corners.lever(k)).y)
}

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
/// adds. Plain gravity downwards adds nothing when nothing is held: free fall is concave.
pub(super) fn curvature_bound<F: ForceModel>(
    body: &RigidBox,
    state: &BodyState,
    acceleration: f64,
    force: &F,
    normal: DVec3,
) -> f64 {
    let omega = state.body_angular_velocity(body);
    let energy = 2.0 * state.rotational_energy(body) * body.inverse_inertia().max_element();
    let spin = (2.0 * omega.length_squared()).min(energy);
    let pull = force.acceleration();
    let up = acceleration - pull.length() + pull.dot(normal).max(0.0);
    SWING * spin * body.radius() + up.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    use crate::floor::tests::Random;
    use crate::force::Gravity;
    use crate::integrators::{Integrate, IntegratorMemory, Rk4};

    /// Largest acceleration of a corner on the way of a free box over its bound at the start.
    fn tightness(body: &RigidBox, omega: DVec3) -> f64 {
        let start = BodyState::default().with_body_angular_velocity(body, omega);
        let weightless = Gravity(DVec3::ZERO);
        let bound = curvature_bound(body, &start, 0.0, &weightless, DVec3::Y);
        let (mut state, mut memory) = (start, IntegratorMemory::default());
        let mut worst = 0.0_f64;
        for _ in 0..1000 {
            let omega = state.body_angular_velocity(body);
            let turn = state.angular_momentum.cross(omega) * body.inverse_inertia();
            for r in crate::aabb::corners(body.half_extents()) {
                let a = turn.cross(r) + omega.cross(omega.cross(r));
                worst = worst.max(a.length());
            }
            Rk4::step(body, &mut state, &weightless, 0.02, &mut memory);
        }
        worst / bound
    }

    /// Of hollow and weighted boxes as well, the worst of which turns over like a needle that is not quite round,
    /// |ω|² doubling on the way, with its corners wherever they are worst.
    #[test]
    fn no_corner_is_accelerated_more() {
        let mut random = Random(17);
        let mut worst = 0.0_f64;
        for i in 0..400 {
            let mut side = || random.magnitude(0.01, 1.0);
            let half = DVec3::new(side(), side(), side());
            let solid = RigidBox::new(half, 3.0).expect("valid");
            let inertia = match i % 4 {
                0 => solid.inertia(),
                1 => {
                    let (x, y) = (side(), side());
                    DVec3::new(x, y, (x - y).abs() + 0.99 * (x + y - (x - y).abs()))
                }
                _ => {
                    let small = 0.1 * side();
                    DVec3::new(small, 1.0, 1.0 + random.range(0.9, 0.99) * small)
                }
            };
            let body = solid.with_inertia(inertia).expect("valid");
            let near_middle = DVec3::Y + random.vector(1e-2);
            let omega = if i % 2 == 0 {
                near_middle
            } else {
                random.vector(1.0)
            };
            worst = worst.max(tightness(&body, omega));
        }
        println!("the largest is {worst:.3} of its bound");
        assert!((0.9..=1.0).contains(&worst), "{worst}");
    }
}
