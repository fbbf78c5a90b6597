//! Sliding to a stop with steps of any length, and slopes.
use super::*;
use crate::integrators::{ExplicitEuler, Rk4, SemiImplicitEuler, Split};

fn pub17<S: Integrate>(h: f64, bound: f64) {
    let mut scene = Scene::new(DVec3::new(0.5, 0.25, 0.5), 0.0, 0.5);
    scene.state.velocity = DVec3::X * 4.0;
    let (stop, mut worst, mut stopped) = (0.8154943934760448, 0.0_f64, None);
    let n = (1.3 / h) as u32;
    for i in 1..=n {
        scene.step::<S>(h);
        let t = f64::from(i) * h;
        let s = t.min(stop);
        let x = 4.0 * s - 0.25 * G * s * s;
        worst = worst.max((scene.state.position - DVec3::new(x, 0.25, 0.0)).length());
        if scene.state.velocity == DVec3::ZERO && stopped.is_none() {
            stopped = Some(t);
        }
    }
    let stopped = stopped.expect("stops");
    assert!(worst <= bound, "{worst:e}");
    assert!((stopped - stop).abs() <= h * 1.0001, "{stopped}");
    assert!(scene.contact.is_resting(&scene.state));
}

#[test]
fn pub17_slides_to_a_stop() {
    for (h, bound) in [
        (1.0 / 240.0, 1e-13),
        (SIXTIETH, 1e-13),
        (0.05, 1e-9),
        (0.5, 1e-8),
    ] {
        pub17::<Split>(h, bound);
        pub17::<Rk4>(h, bound);
    }
    // Off by half an acceleration step, ½ µg h t, as expected for this integrator.
    pub17::<ExplicitEuler>(SIXTIETH, 0.05);
    pub17::<SemiImplicitEuler>(SIXTIETH, 0.05);
}

/// The reported impulses equal the change of momentum, with and without turning, until the box rests.
#[test]
fn a_slide_reports_its_friction() {
    for spin in [0.0, 2.0] {
        let mut scene = Scene::new(DVec3::new(0.5, 0.25, 0.5), 0.0, 0.5);
        scene.state.velocity = DVec3::X * 2.0;
        scene.spin(DVec3::Y * spin);
        let gravity = scene.gravity;
        for _ in 0..60 {
            let before = scene.state.velocity;
            let mut report = ContactReport::default();
            scene.step_under::<Split>(&gravity, SIXTIETH, Some(&mut report));
            let impulse = report.tangential_impulse + DVec3::Y * report.normal_impulse();
            let change = 3.0 * (scene.state.velocity - before + DVec3::Y * G * SIXTIETH);
            assert!((impulse - change).length() < 1e-9, "{impulse} {change}");
        }
        assert!(scene.contact.is_resting(&scene.state));
    }
}

#[test]
fn slope_holds_below_the_friction_angle_and_slides_above() {
    for mu in [0.1_f64, 0.5, 1.0] {
        for factor in [0.5, 0.9, 0.99, 1.01, 1.1, 1.5] {
            let theta = libm::atan(mu) * factor;
            let mut scene = Scene::new(DVec3::new(0.5, 0.2, 0.5), 0.0, mu).on_slope(theta);
            scene.state.rotation = about(DVec3::Y, 0.3);
            let start = scene.state;
            scene.run::<Split>(SIXTIETH, 60);
            let (s, c) = sin_cos(theta);
            let a = G * (s - mu * c);
            if factor < 1.0 {
                assert_eq!(scene.state, start, "mu {mu} factor {factor}");
                assert!(scene.contact.is_resting(&scene.state));
            } else {
                let x = scene.state.position.x - start.position.x;
                assert!(
                    (x - 0.5 * a).abs() < 1e-9,
                    "mu {mu} factor {factor}: {x} {a}"
                );
                assert!((scene.state.position.z).abs() < 1e-9);
            }
        }
    }
}

/// A box on its face slides and turns to a stop in a few segments. Corners whose slips vanish in sequence, or turn on
/// the way, do not lead to ever shorter segments.
#[test]
fn a_turning_slide_stops_in_a_few_segments() {
    let mut random = Random(3);
    let mut worst = 0;
    for _ in 0..2000 {
        let mut side = || random.range(0.2, 0.5);
        let mut scene = Scene::new(DVec3::new(side(), side(), side()), 0.0, 0.5);
        scene.state.rotation = about(DVec3::Y, random.range(0.0, 6.0));
        let speed = random.magnitude(1e-4, 0.1);
        scene.state.velocity = random.vector(speed).with_y(0.0);
        scene.spin(DVec3::Y * random.range(-3.0 * speed, 3.0 * speed));
        let energy = scene.energy();
        for _ in 0..5 {
            worst = worst.max(scene.step::<Split>(SIXTIETH).step.evaluations);
        }
        assert!(scene.contact.is_resting(&scene.state) && scene.energy() <= energy);
    }
    assert!(worst <= 400, "{worst}"); // up to five for each trial segment
}
