//! Coulomb's law holds for what the solver finds.

use super::*;
use crate::body::RigidBox;
use crate::floor::Floor;
use crate::floor::geometry::{Corners, mask};
use crate::floor::tests::Random;
use crate::state::BodyState;
use glam::{DMat3, DQuat};

/// `n` random touching sets with their velocities, and the mass behind them.
fn impacts(n: usize, mut visit: impl FnMut(&DelassusOperator, &Corner3, f64)) {
    let mut random = Random(11);
    for i in 0..n {
        let mut side = || random.magnitude(0.02, 1.0);
        let half = DVec3::new(side(), side(), side());
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
            let edge = corners.lever[order[1]] - corners.lever[order[0]];
            let level = DQuat::from_rotation_arc(edge.normalize(), edge.with_y(0.0).normalize());
            state.rotation = (level * state.rotation).normalize();
            corners = Corners::at(&Floor::default(), &body, &state);
        }
        let touching = mask(|k| order[..count].contains(&k));
        let attitude = DMat3::from_quat(state.rotation);
        let operator = DelassusOperator::new(&body, attitude, &corners.lever, touching);
        let b = operator.velocities((state.velocity, state.angular_velocity(&body)));
        visit(&operator, &b, body.mass());
    }
}

fn solve(operator: &DelassusOperator, b: &Corner3, mu: f64, max_iterations: u32) -> ConeSolution {
    let settings = ContactSettings {
        max_iterations,
        ..ContactSettings::DEFAULT
    };
    Cone::new(operator, mu, &settings).solve(b, &[DVec3::ZERO; 8])
}

/// b + Wp.
fn after(operator: &DelassusOperator, b: &Corner3, s: &ConeSolution) -> Corner3 {
    Cone::new(operator, 0.0, &ContactSettings::DEFAULT).velocities(b, &s.p)
}

/// How many of `n` impacts were not solved, and how far the others are from the law.
fn examine(mu: f64, n: usize) -> (usize, f64) {
    let mut counts = Vec::new();
    let mut failed = 0;
    let mut worst = 0.0_f64;
    impacts(n, |operator, b, mass| {
        let s = solve(operator, b, mu, 20_000);
        counts.push(s.iterations);
        if s.converged {
            worst = worst.max(distance_from_the_law(operator, b, &s, mu, mass));
        } else {
            failed += 1;
        }
    });
    counts.sort_unstable();
    println!(
        "mu {mu}: failed {failed} of {n}, iterations median {} 99 % {} worst {}, law {worst:.1e}",
        counts[n / 2],
        counts[n * 99 / 100],
        counts[n - 1]
    );
    (failed, worst)
}

/// The largest violation of a condition of the law, in units of speed and momentum.
fn distance_from_the_law(
    operator: &DelassusOperator,
    b: &Corner3,
    s: &ConeSolution,
    mu: f64,
    mass: f64,
) -> f64 {
    let scale = operator.largest(b);
    let w = after(operator, b, s);
    let mut worst = 0.0_f64;
    for k in 0..operator.count {
        let (p, w) = (s.p[k], w[k]);
        let t = (p.x * p.x + p.z * p.z).sqrt();
        let slip = (w.x * w.x + w.z * w.z).sqrt();
        let against = p.x * w.x + p.z * w.z + mu * p.y * slip;
        worst = worst
            .max(-w.y / scale)
            .max(p.y * w.y / (mass * scale * scale))
            .max((t - mu * p.y) / (mass * scale))
            .max(against.abs() / ((1.0 + mu) * mass * scale * scale));
    }
    worst
}

#[test]
fn coulombs_law_holds_for_random_impacts() {
    for mu in [0.0, 0.05, 0.3, 0.8, 2.0, 10.0, 1000.0] {
        let (failed, worst) = examine(mu, 20_000);
        assert_eq!(failed, 0, "mu {mu}");
        // The solver stops at 1e-12 in w; the friction's part of the law sees µ times that.
        assert!(worst <= 1e-10_f64.max(1e-12 * mu), "mu {mu}: {worst:e}");
    }
}

/// However few iterations there may be, there are no more; what is found keeps the normal law, lies in the cones
/// and gains no energy.
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
                let w = after(operator, b, &s);
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
        println!("at most {max_iterations} iterations: {unsolved} of 8000 gave way");
        assert!(unsolved < 2000 && (unsolved > 0 || max_iterations > 10));
    }
}
