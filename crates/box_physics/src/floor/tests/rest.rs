//! Rest and balance: cases 26 and 27.
use super::*;
use crate::schemes::{Rk4, Split};

/// From any attitude to flat on a face, resting.
#[test]
fn any_drop_ends_flat_and_resting() {
    let mut random = Random(7);
    let (mut longest, mut steps) = (0, 0);
    let mut total = FloorOutcome::default();
    for i in 0..300 {
        let half = DVec3::new(
            random.magnitude(0.1, 1.0),
            random.magnitude(0.1, 1.0),
            random.magnitude(0.1, 1.0),
        );
        let mut scene = Scene::new(half, random.range(0.0, 0.7), random.range(0.05, 1.0));
        scene.state.position.y = random.range(0.0, 3.0) + scene.body.radius();
        scene.state.rotation = random.attitude();
        let spin = random.vector(5.0);
        scene.state.set_angular_velocity(&scene.body, spin);
        let mut n = 0;
        while !scene.contact.is_resting() && n < 6000 {
            scene.step::<Split>(SIXTIETH);
            n += 1;
        }
        longest = longest.max(n);
        total += scene.total;
        steps += n;
        assert!(
            scene.contact.is_resting(),
            "{i} {half} {:?} {:?}",
            scene.state,
            scene.floor
        );
        let corners = super::super::geometry::Corners::at(&scene.floor, &scene.body, &scene.state);
        assert_eq!(corners.touching(1e-12).count_ones(), 4, "{i}");
    }
    println!("longest settling {longest} of {steps} steps, {total:?}");
}

#[test]
fn the_resting_pose_repeats_bit_for_bit() {
    let half = DVec3::new(0.5, 0.25, 0.375);
    let quarter = 0.5 * core::f64::consts::PI;
    for (axis, angle) in [
        (DVec3::X, 0.0),
        (DVec3::X, quarter),
        (DVec3::X, 2.0 * quarter),
        (DVec3::X, 3.0 * quarter),
        (DVec3::Z, quarter),
        (DVec3::Z, 3.0 * quarter),
    ] {
        let mut scene = Scene::new(half, 0.3, 0.5);
        scene.state.position.y = 1.0;
        scene.state.rotation = about(DVec3::Y, 0.7) * about(axis, angle);
        scene.run::<Rk4>(SIXTIETH, 200);
        assert!(scene.contact.is_resting());
        let pose = scene.state;
        scene.run::<Split>(SIXTIETH, 1_000_000);
        assert_eq!(scene.state, pose);
        // And without the memory: re-examined, it is found at rest again.
        scene.contact = ContactState::default();
        scene.run::<Split>(SIXTIETH, 10);
        assert_eq!(scene.state, pose);
    }
}

/// Time to fall from tilt θ₀ off balance on an edge to θ₁, by quadrature of the closed θ̇(θ).
fn fall_time(rate: impl Fn(f64) -> f64, theta0: f64, theta1: f64) -> f64 {
    // θ = θ₀ + s²: the square-root singularity at θ₀ becomes smooth.
    let (n, top) = (20_000, (theta1 - theta0).sqrt());
    let ds = top / f64::from(n);
    (0..n)
        .map(|i| {
            let s = (f64::from(i) + 0.5) * ds;
            2.0 * s * ds / rate(theta0 + s * s)
        })
        .sum()
}

/// Case 27: an edge falls in the closed form's time, with and without friction.
#[test]
fn edge_falls_in_time() {
    let half = DVec3::new(0.5, 0.5, 0.5);
    let d = (0.5_f64).sqrt();
    for (mu, name) in [(1e3, "no slip"), (0.0, "frictionless")] {
        for theta0 in [1e-1, 1e-2, 1e-4, 1e-8] {
            let mut scene = Scene::new(half, 0.0, mu);
            scene.state.rotation = about(DVec3::Z, core::f64::consts::FRAC_PI_4 + theta0);
            scene.state.position.y = 0.0;
            let low = scene.lowest();
            scene.state.position.y = -low;
            let mut t = 0.0;
            let fall = 0.7;
            let tilt = |s: &BodyState| {
                2.0 * libm::atan2(s.rotation.z, s.rotation.w) - core::f64::consts::FRAC_PI_4
            };
            let mut before = tilt(&scene.state);
            while tilt(&scene.state) < fall && t < 20.0 {
                before = tilt(&scene.state);
                scene.step::<Split>(SIXTIETH);
                t += SIXTIETH;
            }
            let after = tilt(&scene.state);
            t -= SIXTIETH * (after - fall) / (after - before);
            // cos θ₀ − cos θ without cancellation.
            let drop = |a: f64| 2.0 * libm::sin(0.5 * (a + theta0)) * libm::sin(0.5 * (a - theta0));
            let expected = if mu > 0.0 {
                fall_time(|a| (1.5 * G / d * drop(a)).sqrt(), theta0, fall)
            } else {
                fall_time(
                    |a| (2.0 * G * drop(a) / (d * (1.0 / 3.0 + libm::sin(a).powi(2)))).sqrt(),
                    theta0,
                    fall,
                )
            };
            println!("{name} from {theta0:.0e}: {t:.4} expected {expected:.4}");
            assert!(
                (t - expected).abs() < 0.01 * expected,
                "{name} {theta0}: {t} {expected}"
            );
        }
    }
}

/// Balanced on an edge or a corner it stays as long as rounding allows, and is not held up for ever.
#[test]
fn balance_lasts_as_long_as_rounding_allows() {
    let edge = about(DVec3::Z, core::f64::consts::FRAC_PI_4);
    // The diagonal (1, 1, 1) upright: a turn about (−1, 0, 1)/√2 … of the angle whose cosine is 1/√3.
    let axis = DVec3::new(-1.0, 0.0, 1.0) / 2.0_f64.sqrt();
    let corner = about(axis, libm::acos(1.0 / 3.0_f64.sqrt()));
    for (name, rotation) in [("edge", edge), ("corner", corner)] {
        let mut scene = Scene::new(DVec3::splat(0.5), 0.0, 10.0);
        scene.state.rotation = rotation;
        scene.state.position.y = 0.0;
        scene.state.position.y = -scene.lowest();
        let height = scene.state.position.y;
        let mut seconds = 0;
        while scene.state.position.y > height - 0.05 && seconds < 60 {
            scene.run::<Split>(SIXTIETH, 60);
            seconds += 1;
        }
        println!("{name} balanced for {seconds} s");
        assert!((3..60).contains(&seconds), "{name}: {seconds} s");
    }
}
