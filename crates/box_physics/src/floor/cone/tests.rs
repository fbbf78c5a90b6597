//! The solver's solutions obey Coulomb's law.

use super::*;
use crate::body::RigidBox;
use crate::floor::frame::Level;
use crate::floor::frame::{Frame, Method};
use crate::floor::geometry::{Corners, mask};
use crate::floor::law::{Law, Solution};
use crate::floor::tests::{Random, Solver};
use crate::floor::{ContactSettings, Floor, FloorContext};
use crate::force::Gravity;
use crate::integrators::Split;
use crate::state::BodyState;
use glam::{DMat3, DQuat};

/// Visits `n` random touching sets with their velocities and the mass of the body.
fn impacts(n: usize, mut visit: impl FnMut(&DelassusOperator, &Corner3, f64)) {
    let mut random = Random(11);
    for i in 0..n {
        let half = random.half_extents(0.02, 1.0);
        let body = RigidBox::new(half, 3.0).expect("valid");
        let flat = i % 3 == 0;
        let mut state = BodyState::at(DVec3::ZERO);
        state.rotation = if flat {
            crate::floor::tests::about(DVec3::Y, random.range(0.0, 6.0))
        } else {
            random.attitude()
        };
        state.velocity = random.vector(1.0);
        let omega = random.vector(2.0 / body.radius());
        state.set_angular_velocity(&body, omega);
        let mut corners = Corners::at(&Floor::default(), &body, &state);
        let mut order: Vec<usize> = (0..8).collect();
        order.sort_by(|&a, &b| corners.height[a].total_cmp(&corners.height[b]));
        let count = if flat { 4 } else { 1 + i % 2 };
        if count == 2 {
            // An edge that touches is level.
            let edge = corners.lever(order[1]) - corners.lever(order[0]);
            let level = DQuat::from_rotation_arc(edge.normalize(), edge.with_y(0.0).normalize());
            state.rotation = (level * state.rotation).normalize();
            corners = Corners::at(&Floor::default(), &body, &state);
        }
        let touching = mask(|k| order[..count].contains(&k));
        let attitude = DMat3::from_quat(state.rotation);
        let operator = DelassusOperator::new(&body, attitude, touching);
        let b = operator.velocities((state.velocity, state.angular_velocity(&body)));
        visit(&operator, &b, body.mass());
    }
}

fn solve(operator: &DelassusOperator, b: &Corner3, mu: f64, max_iterations: u32) -> Solution {
    let settings = ContactSettings {
        max_iterations,
        ..ContactSettings::DEFAULT
    };
    let context = FloorContext {
        floor: &Floor::new(0.0, 0.0, mu).expect("valid"),
        settings: &settings,
        body: &RigidBox::default(),
        force: &Gravity(DVec3::ZERO),
    };
    let method = Method::of::<Split>();
    let level = Level::new(&context, &method, Frame::new(DVec3::ZERO, None));
    Law::new(&level, operator, false).solve(b, &[DVec3::ZERO; 8])
}

#[test]
fn coulombs_law_holds_for_random_impacts() {
    for mu in [0.0, 0.05, 0.3, 0.8, 2.0, 10.0, 1000.0] {
        let mut solver = Solver::default();
        impacts(20_000, |operator, b, _| {
            solver.note(operator, b, &solve(operator, b, mu, 20_000), |_| {
                (DVec3::Y, mu)
            });
        });
        // The solver stops at 1e-12 in w; the error in the friction part of the law is µ times that.
        solver.check(mu, 1e-10_f64.max(1e-12 * mu));
    }
}

/// The solver never exceeds its maximum number of iterations, however small. The solution obeys the normal law, is in
/// the cones and gains no energy.
#[test]
fn the_cap_is_the_cap() {
    for max_iterations in [1, 3, 10, 100] {
        let mut unsolved = 0;
        for mu in [0.0, 0.3, 10.0, 1000.0] {
            impacts(2000, |operator, b, mass| {
                let s = solve(operator, b, mu, max_iterations);
                assert!(s.iterations <= max_iterations, "mu {mu}: {}", s.iterations);
                unsolved += u32::from(!s.converged);
                let scale = operator.largest(b);
                let w = operator.after(b, &s.p);
                for k in 0..operator.count {
                    let (p, w) = (s.p[k], w[k]);
                    assert!(p.y >= 0.0 && w.y >= -1e-11 * scale);
                    assert!(p.y * w.y <= 1e-9 * mass * scale * scale);
                    assert!(libm::hypot(p.x, p.z) <= mu * p.y + 1e-12 * mass * scale);
                }
                let gain =
                    operator.dot(&s.p, b) + 0.5 * operator.dot(&s.p, &operator.response(&s.p));
                assert!(gain <= 1e-12 * mass * scale * scale);
            });
        }
        let enough = unsolved < 2000 && (unsolved > 0 || max_iterations > 10);
        assert!(enough, "{unsolved} of 8000 gave way at {max_iterations}");
    }
}
