use super::*;
use crate::floor::tests::Random;
use crate::force::Gravity;
use crate::integrators::{Integrate, IntegratorMemory, Rk4};

/// Largest acceleration of a corner along the motion of a free box, relative to the bound at the start.
fn tightness(body: &RigidBox, omega: DVec3) -> f64 {
    let start = BodyState::default().with_body_angular_velocity(body, omega);
    let weightless = Gravity(DVec3::ZERO);
    let bound = curvature_bound(body, &start, 0.0, DVec3::ZERO, DVec3::Y);
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

/// Includes hollow and weighted boxes. The worst one flips like a needle that is not quite round: |ω|² doubles, and its
/// corners are at the worst places.
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
    assert!((0.9..=1.0).contains(&worst), "{worst}");
}
