use super::super::testing::{brick, on, run};
use super::super::{Integrator, IntegratorMemory, Limit, Order, Split};
use super::*;
use crate::force::{Forces, Spring};

fn damper(body_point: DVec3, damping: f64) -> Spring {
    Spring {
        body_point,
        damping,
        ..Spring::default()
    }
}

fn springs(damping: f64) -> [Spring; 2] {
    [
        damper(DVec3::new(0.5, 0.25, 0.125), damping),
        damper(DVec3::new(-0.5, 0.0, 0.1), 0.3 * damping),
    ]
}

fn moving() -> BodyState {
    BodyState::at_pose(DVec3::ZERO, glam::DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7))
        .with_velocity(DVec3::new(1.0, -2.0, 0.5))
        .with_body_angular_velocity(&brick(), DVec3::new(3.0, 1.0, -2.0))
}

/// A damper at the center multiplies the velocity by 1/(1 + z + z²/2), and a force ends at F/d.
#[test]
fn one_mode() {
    let body = brick();
    for z in [1e-6, 0.1, 1.0, 10.0, 1e6] {
        let springs = [damper(DVec3::ZERO, z * body.mass())];
        let law = Forces {
            acceleration: DVec3::NEG_Y,
            ..on(&springs)
        };
        let mut state = BodyState::default().with_velocity(DVec3::X);
        damped_kick(&body, &mut state, &law, 1.0);
        let e = 1.0 / (1.0 + z + 0.5 * z * z);
        let phi = (1.0 + 0.5 * z) * e;
        assert!((state.velocity.x - e).abs() < 1e-15, "{z}");
        assert!((state.velocity.y + phi).abs() < 1e-15, "{z}");
    }
}

/// Dampers at two points with drag and damping: energy decreases at any rate, and to first order the
/// change is the wrench.
#[test]
fn energy_only_falls() {
    let (body, start) = (brick(), moving());
    let dissipation = Dissipation {
        linear_drag: 0.3,
        angular_damping: 0.1,
        angular_drag: 0.2,
        ..Dissipation::NONE
    };
    for d in [1e-3, 1.0, 1e3, 1e6] {
        let springs = springs(d);
        let law = Forces {
            dissipation,
            ..on(&springs)
        };
        let mut state = start;
        let mut energy = start.kinetic_energy(&body);
        for _ in 0..20 {
            damped_kick(&body, &mut state, &law, 0.1);
            let now = state.kinetic_energy(&body);
            assert!(now < energy, "{d}");
            energy = now;
        }
        let (mut state, h) = (start, 1e-4 / d.max(1.0));
        damped_kick(&body, &mut state, &law, h);
        let (dv, torque) = crate::force::applied_rates(&body, &start, &law);
        let v = (state.velocity - start.velocity) / h - dv;
        let l = (state.angular_momentum - start.angular_momentum) / h - torque;
        assert!(
            v.length() < 1e-2 * d.max(1.0) && l.length() < 1e-2 * d.max(1.0),
            "{d}"
        );
    }
}

/// A stiff damper holds its point at rest and does not affect rotation about that point.
#[test]
fn undamped_rotation_is_unchanged() {
    let (body, start) = (brick(), moving());
    let springs = [springs(1e9)[0]];
    let law = on(&springs);
    let (mut once, h) = (start, 1e-3);
    damped_kick(&body, &mut once, &law, h);
    // At rest except for half of the curvature of its path until the next kick.
    let (r, omega) = (springs[0].body_point, once.body_angular_velocity(&body));
    let alpha = body.inverse_inertia() * once.angular_momentum.cross(omega);
    let curved = once.rotation * (alpha.cross(r) + omega.cross(omega.cross(r)));
    let u = once.point_velocity(&body, r);
    assert!((u + 0.5 * h * curved).length() < 1e-3 * h);
    let mut twice = once;
    damped_kick(&body, &mut twice, &law, h);
    assert!((twice.angular_momentum - once.angular_momentum).length() < 1e-4);
}

/// A die on a damped spring, released at rest away from its anchor. A stronger damper makes it return
/// more slowly. The expected positions after half a second are those of the overdamped oscillator.
#[test]
fn more_damping_is_more_damped() {
    let body = RigidBox::cube(0.016, 0.005).expect("valid");
    for (d, answer) in [
        (1.0, 0.0016),
        (3.0, 0.0565),
        (10.0, 0.1820),
        (100.0, 0.2854),
        (1e9, 0.3),
    ] {
        for &integrator in Integrator::ALL {
            if integrator.info().stability.damper != Limit::None {
                continue;
            }
            let springs = [Spring {
                stiffness: 10.0,
                ..damper(DVec3::ZERO, d)
            }];
            let law = on(&springs);
            let energy =
                |s: &BodyState| s.kinetic_energy(&body) + 5.0 * s.position.length_squared();
            let mut s = BodyState::at(DVec3::X * 0.3);
            let mut memory = IntegratorMemory::default();
            for _ in 0..32 {
                let before = s;
                integrator.step(&body, &mut s, &law, 1.0 / 64.0, &mut memory);
                assert!(s.position.x > 0.0, "{integrator}, d = {d}");
                assert!(
                    energy(&s) <= energy(&before) * (1.0 + 1e-12),
                    "{integrator}, d = {d}"
                );
            }
            let order1 = integrator.info().orders.spring == Order::Of(1);
            let bound = if order1 { 0.01 } else { 0.0012 };
            let error = (s.position.x - answer).abs();
            assert!(error < bound, "{integrator}, d = {d}: {} m", s.position.x);
        }
    }
}

/// Rotation about a corner that a damper holds. Without gravity energy only falls. With it the energy of the
/// discrete motion oscillates, as that of a heavy top does without a damper, by an error of second order.
#[test]
fn a_held_corner_gains_nothing() {
    for half in [DVec3::splat(0.5), DVec3::new(0.5, 0.25, 0.125)] {
        let body = RigidBox::new(half, 3.0).expect("valid");
        let rise = |damping: f64, gravity: f64, rate: u32| {
            let springs = [damper(half, damping)];
            let law = Forces {
                acceleration: DVec3::NEG_Y * gravity,
                ..on(&springs)
            };
            let energy = |s: &BodyState| s.kinetic_energy(&body) + 3.0 * gravity * s.position.y;
            let mut s =
                BodyState::at(-half).with_body_angular_velocity(&body, DVec3::new(2.0, 6.0, 4.0));
            s.velocity = s.angular_velocity(&body).cross(s.rotation * -half);
            let start = s.kinetic_energy(&body);
            let (mut lowest, mut rise) = (energy(&s), 0.0_f64);
            for _ in 0..10 * rate {
                s = run::<Split>(&body, s, &law, 1.0 / f64::from(rate), 1);
                rise = rise.max((energy(&s) - lowest) / start);
                lowest = lowest.min(energy(&s));
            }
            rise
        };
        for damping in [1.0, 1e2, 1e4, 1e6, 1e9] {
            let free = rise(damping, 0.0, 60);
            assert!(free < 1e-14, "{half} {damping}: {free:e}");
            let (coarse, fine) = (rise(damping, 9.81, 60), rise(damping, 9.81, 120));
            assert!(
                coarse < 5e-3 && fine <= 0.3 * coarse,
                "{half} {damping}: {coarse:e} {fine:e}"
            );
        }
    }
}

/// Springs and dampers at corners, with gravity and an initial spin: energy stays below its start plus 1 %, and
/// the body reaches equilibrium.
#[test]
fn dampers_at_corners_settle() {
    let body = RigidBox::cube(0.016, 0.005).expect("valid");
    let corner = |x: f64, y: f64, z: f64, damping: f64| Spring {
        body_point: DVec3::new(x, y, z) * 0.008,
        anchor: DVec3::new(x, y, z) * 0.02,
        stiffness: 4.0,
        damping,
    };
    for d in [0.05, 1.0, 30.0, 1e4] {
        let one = [corner(1.0, 1.0, 1.0, d)];
        let three = [
            corner(1.0, 1.0, 1.0, d),
            corner(-1.0, 1.0, 0.0, 0.2 * d),
            corner(0.0, -1.0, -1.0, 3.0 * d),
        ];
        for springs in [&one[..], &three[..]] {
            let law = Forces {
                acceleration: DVec3::NEG_Y * 9.81,
                ..on(springs)
            };
            let energy = |s: &BodyState| {
                let stretch = |p: &Spring| (s.point(p.body_point) - p.anchor).length_squared();
                let elastic: f64 = springs.iter().map(|p| 0.5 * p.stiffness * stretch(p)).sum();
                s.kinetic_energy(&body) + elastic + 9.81 * body.mass() * s.position.y
            };
            for id in ["split", "split4", "symmetric-top", "dmv6", "exact"] {
                let integrator: Integrator = id.parse().expect("there");
                let mut s = BodyState::at(DVec3::new(0.05, -0.03, 0.02))
                    .with_body_angular_velocity(&body, DVec3::new(5.0, -3.0, 8.0));
                let mut memory = IntegratorMemory::default();
                let (start, mut highest) = (energy(&s), f64::MIN);
                for _ in 0..640 {
                    integrator.step(&body, &mut s, &law, 1.0 / 64.0, &mut memory);
                    highest = highest.max(energy(&s));
                }
                // Undamped rotation about a point that a damper holds. The point creeps as far as the
                // curvature of its path varies within a step.
                let bound = 0.01 * start;
                assert!(
                    highest <= start + bound,
                    "{id} d {d}: {start:e} {highest:e}"
                );
                assert!(
                    d > 100.0 || energy(&s) < 0.9 * start,
                    "{id} d {d}: {:e}",
                    energy(&s)
                );
            }
        }
    }
}
