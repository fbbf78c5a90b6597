//! For any input: no gain of energy, nothing below the floor, no endless loop.

use super::*;
use crate::floor::StaticPlane;
use crate::force::{Dissipation, Forces, Frame, PointForce, Spring};
use crate::integrators::{ExplicitEuler, Heun2012, Integrator, Rk4, SemiImplicitEuler, Split};

/// Shapes to drop.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shapes {
    Cubes,
    /// From 0.1 mm to 5 m with ratios up to 50; every third box is hollow or weighted.
    Any,
}

/// `n` random drops of `steps` steps each.
fn storm(seed: u64, n: u32, steps: u32, shapes: Shapes) -> Worst {
    let mut random = Random(seed);
    let mut worst = Worst::default();
    for i in 0..n {
        let size = random.magnitude(0.005, 5.0);
        let mut half = size * random.half_extents(0.02, 1.0);
        if shapes == Shapes::Cubes {
            half = DVec3::splat(size);
        }
        let (e, mu) = (random.restitution(i), random.friction(i, 5.0));
        let mut scene = Scene::new(half, e, mu);
        if shapes == Shapes::Any && i % 3 == 0 {
            let solid = scene.body.inertia();
            let small = random.magnitude(0.01, 1.0);
            let weighted = DVec3::new(small, 1.0, 1.0 + 0.95 * small) * solid.max_element();
            scene.body = scene.body.with_inertia(weighted).expect("valid");
        }
        scene.state.position.y = scene.body.radius() * random.range(0.5, 2.0);
        scene.state.rotation = random.attitude();
        let fast = random.magnitude(0.01, 300.0);
        scene.state.velocity = random.vector(fast);
        let spin = random.magnitude(0.01, 1000.0);
        let omega = random.vector(spin);
        let h = random.magnitude(1e-5, 0.5);
        scene.spin(omega);
        // Energy is counted from the state after penetration recovery.
        scene.state.position.y -= scene.lowest().min(0.0);
        worst.follow::<Split>(i, scene, None, h, steps);
    }
    worst
}

#[test]
fn random_drops_gain_nothing_and_stay_above() {
    for (seed, shapes) in [(1, Shapes::Cubes), (2, Shapes::Any)] {
        storm(seed, 5000, 30, shapes).check(&format!("{shapes:?}"));
    }
}

/// With every integrator and every kind of force, the state is finite and above the floor, and the work is bounded.
/// (Compact boxes, because explicit integrators diverge for needles even in free flight.)
#[test]
fn any_integrator_and_force_stays_above() {
    fn check<S: Integrate>(seed: u64) {
        let mut random = Random(seed);
        for i in 0..200 {
            let half = random.half_extents(0.3, 1.0);
            let mut scene = Scene::new(half, random.range(0.0, 1.0), random.range(0.0, 1.5));
            scene.state.position.y = 1.5;
            scene.state.rotation = random.attitude();
            scene.spin(random.vector(5.0));
            let springs = [Spring {
                body_point: scene.body.half_extents(),
                anchor: DVec3::new(1.0, 0.5, 0.0),
                stiffness: 30.0,
                damping: 1.0,
            }];
            let points = [PointForce {
                body_point: DVec3::X * 0.3,
                force: random.vector(5.0),
                frame: Frame::Body,
            }];
            let law = Forces {
                acceleration: scene.gravity.0,
                dissipation: Dissipation {
                    linear_drag: 0.1,
                    quadratic_drag: 0.1,
                    angular_damping: 0.2,
                    angular_drag: 0.01,
                    ..Dissipation::NONE
                },
                body_torque: random.vector(0.05),
                springs: &springs[..i % 2],
                point_forces: &points[..i / 2 % 2],
                ..Default::default()
            };
            for _ in 0..100 {
                let outcome = scene.step_under::<S>(&law, SIXTIETH, None);
                let low = scene.lowest();
                assert!(
                    scene.state.is_finite() && low >= -1e-12,
                    "{} {i} {low:e}",
                    S::INFO.id
                );
                assert!(outcome.step.evaluations < 80_000);
            }
            let speed = scene.state.velocity.length();
            assert!(speed < 60.0, "{} {i}: {speed}", S::INFO.id);
        }
    }
    check::<Split>(1);
    check::<Rk4>(2);
    check::<Heun2012>(3);
    check::<SemiImplicitEuler>(4);
    check::<ExplicitEuler>(5);
}

/// Manual run: `cargo test --release -- --ignored storm_by_hand --nocapture`.
#[test]
#[ignore = "a million drops take minutes; a seeded part of them runs with every test"]
fn storm_by_hand() {
    for shapes in [Shapes::Cubes, Shapes::Any] {
        let mut all = Worst::default();
        for seed in 10..27 {
            let worst = storm(seed, 30_000, 30, shapes);
            all.gain = all.gain.max(worst.gain);
            all.depth = all.depth.max(worst.depth);
            all.total += worst.total;
        }
        all.check(&format!("{shapes:?}: 510 000 drops of 30 steps"));
    }
}

/// Manual run: `cargo test --release -- --ignored which_case_answers_by_hand --nocapture`.
#[test]
#[ignore = "prints the counts of docs/contact.md and asserts none"]
fn which_case_answers_by_hand() {
    use super::super::law::ANSWERS;
    for storms in [false, true] {
        ANSWERS.take();
        if storms {
            storm(2, 5000, 30, Shapes::Any);
        } else {
            settle(300);
        }
        let answers = ANSWERS.take();
        let all: u32 = answers.values().sum();
        println!("{} problems:", all);
        for (case, count) in answers {
            let part = 100.0 * f64::from(count) / f64::from(all);
            println!("{case:40} {part:6.2} %");
        }
    }
}

/// Drops `n` boxes and lets them settle for 3 s.
fn settle(n: u32) {
    let mut random = Random(5);
    for _ in 0..n {
        let mut half = || random.range(0.2, 0.5);
        let mut scene = Scene::new(DVec3::new(half(), half(), half()), 0.3, 0.5);
        let height = scene.body.radius() + random.range(0.5, 2.0);
        scene.state = BodyState::at_pose(DVec3::Y * height, random.attitude());
        scene.spin(random.vector(3.0));
        scene.run::<Split>(SIXTIETH, 180);
    }
}

/// Every integrator locates the time of an impact in a few trials, including one that stores derivatives. The whole
/// step and its parts belong to one motion.
#[test]
fn every_integrator_finds_an_impact_in_a_few_trials() {
    let plane = |x, normal| {
        let shape = StaticPlane::new(DVec3::X * x, normal).expect("valid");
        Plane::new(shape, 0.5, 0.5).expect("valid")
    };
    let (floor, ramp) = (plane(0.0, DVec3::Y), plane(0.0, DVec3::new(0.1, 1.0, 0.0)));
    let wall = plane(-0.9, DVec3::X);
    for &integrator in Integrator::ALL {
        for planes in [vec![], vec![ramp], vec![floor, wall]] {
            let mut scene = Scene::new(DVec3::new(0.5, 0.4, 0.3), 0.5, 0.5);
            scene.planes = planes;
            scene.state = BodyState::at(DVec3::Y * 3.0).with_velocity(DVec3::NEG_X * 0.3);
            scene.spin(DVec3::new(0.3, 0.2, 0.1));
            let each = (0..300).map(|_| scene.step_by(integrator).step.evaluations);
            let worst = each.max().unwrap_or_default();
            assert!(scene.total.impacts > 5, "{integrator}: it bounces");
            // Up to 130 in steps with several impacts; implicit integrators iterate.
            assert!(
                worst < 1000,
                "{integrator}: {worst} evaluations in a step; does it need MULTISTEP?"
            );
        }
    }
}
