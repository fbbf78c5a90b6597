//! Rest and friction in edges and corners.

use super::*;
use crate::math::sin_cos;

/// A cube of 1 m in the corner of a tray, or at its edge, with gravity into it.
fn in_corner(pull: DVec3, e: f64, mu: f64) -> Scene {
    let mut scene = Scene::among(tray(2.0, e, mu), DVec3::splat(0.5));
    scene.gravity.0 = pull.normalize() * G;
    scene.state.position = DVec3::new(-1.5, 0.5, -1.5);
    scene
}

/// Rest in an edge, in a corner and against a wall holds to the bit, with and without friction, in any orientation of
/// the scene.
#[test]
fn rest_in_edges_and_corners_holds_to_the_bit() {
    let mut random = Random(21);
    for i in 0..100 {
        let mu = [0.0, 0.3, 1.0][i % 3];
        let pull = [
            DVec3::new(-0.3, -1.0, -0.2),
            DVec3::new(-1.0, -1.0, -1.0),
            DVec3::new(-1.0, -0.1, 0.0),
        ][i / 3 % 3];
        let mut scene = in_corner(pull, 0.3, mu);
        if i >= 50 {
            scene = scene.turned(random.attitude());
        }
        scene.step::<Split>(SIXTIETH);
        let start = scene.state;
        assert!(scene.contact.is_resting(&start), "{i} {start:?}");
        assert!(scene.lowest() >= -1e-15);
        scene.run::<Split>(SIXTIETH, 1000);
        assert_eq!(scene.state, start);
        // Its support is removed.
        let wide = tray(3.0, 0.3, mu);
        if i < 50 && mu == 0.0 {
            scene.planes = wide;
            scene.step::<Split>(SIXTIETH);
            assert!(!scene.contact.is_resting(&scene.state) && scene.state != start);
        }
    }
}

/// A cube thrown into the corner comes to rest there.
#[test]
fn a_cube_settles_in_the_corner() {
    let mut random = Random(22);
    for i in 0..100 {
        let mut scene = in_corner(DVec3::new(-0.5, -1.0, -0.5), 0.3, 0.2);
        scene.state.position += DVec3::new(0.5, 0.5, 0.5);
        scene.state.rotation = random.attitude();
        scene.state.velocity = random.vector(2.0);
        scene.run::<Split>(SIXTIETH, 600);
        assert!(
            scene.contact.is_resting(&scene.state),
            "{i} {:?}",
            scene.state
        );
    }
}

/// A cube hits floor and wall flat at the same time: the impacts are independent.
#[test]
fn a_flat_impact_in_an_edge() {
    for e in [0.0, 0.5, 1.0] {
        let mut scene = in_corner(DVec3::NEG_Y, e, 0.0);
        scene.gravity.0 = DVec3::ZERO;
        scene.state.position += DVec3::new(0.1, 0.1, 1.0);
        scene.state.velocity = DVec3::new(-10.0, -10.0, 0.0);
        scene.step::<Split>(SIXTIETH);
        let wanted = DVec3::new(10.0 * e, 10.0 * e, 0.0);
        assert!(
            (scene.state.velocity - wanted).length() < 1e-12,
            "{:?}",
            scene.state
        );
        assert!(scene.state.angular_momentum.length() < 1e-12);
        let along = DVec3::new(-1.5, 0.5, -0.5) + wanted * (SIXTIETH - 0.01);
        assert!((scene.state.position - along).length() < 1e-12);
    }
}

/// Floor and wall both slow down a box that gravity presses against them. It stops after v²/2µ(g₁ + g₂).
#[test]
fn sliding_along_a_wall_to_rest() {
    for mu in [0.1, 0.3] {
        let (down, aside) = (8.0, 4.0);
        let mut scene = in_corner(DVec3::NEG_Y, 0.0, mu);
        scene.gravity.0 = DVec3::new(0.0, -down, -aside);
        scene.state.position.x = -1.0;
        scene.state.velocity.x = 1.3;
        scene.run::<Split>(SIXTIETH, 120);
        assert!(scene.contact.is_resting(&scene.state));
        let way = 1.3 * 1.3 / (2.0 * mu * (down + aside));
        let error = (scene.state.position - DVec3::new(-1.0 + way, 0.5, -1.5)).length();
        println!("along floor and wall to rest, mu {mu}: off by {error:.1e} m");
        assert!(error < 1e-9);
    }
}

/// A plank against a wall holds up to the angle that statics gives, with friction at both ends, and slips beyond. Its
/// center is off the line between its ends by half of its thickness:
/// (h_x cos θ − h_y sin θ)/2h_x ≤ µ(sin θ + µ cos θ)/(1 + µ²).
#[test]
fn a_plank_leans_or_slips() {
    for theta in [0.6, 0.9, 1.1] {
        let (s, c) = sin_cos(theta);
        let half = DVec3::new(1.0, 0.02, 0.2);
        let (mut low, mut high) = (0.0, 2.0);
        while high - low > 1e-9 {
            let mu = 0.5 * (low + high);
            let needed = (half.x * c - half.y * s) / (2.0 * half.x);
            if needed <= mu * (s + mu * c) / (1.0 + mu * mu) {
                high = mu;
            } else {
                low = mu;
            }
        }
        for (part, holds) in [(1.01, true), (0.99, false)] {
            let mut scene = Scene::among(tray(2.0, 0.0, high * part), half);
            let (x, y) = (half.x * c + half.y * s, half.x * s + half.y * c);
            scene.state.position = DVec3::new(2.0 - x, y, 0.0);
            scene.state.rotation = about(DVec3::Z, theta);
            scene.run::<Split>(SIXTIETH, 5);
            let start = scene.state;
            assert_eq!(
                scene.contact.is_resting(&start),
                holds,
                "{theta} {part} {start:?}"
            );
            scene.run::<Split>(SIXTIETH, 100);
            assert_eq!(scene.state == start, holds);
        }
    }
}

/// The contact of several planes equals that of the floor if a wall is near but not touched.
#[test]
fn a_wall_that_is_not_touched_changes_nothing() {
    let mut random = Random(23);
    let (mut worst, mut impacts) = (0.0_f64, 0);
    for _ in 0..50 {
        let floor = Floor::new(0.0, 0.4, 0.3).expect("valid");
        let mut alone = Scene::among(vec![Plane::from(floor)], DVec3::new(0.5, 0.3, 0.4));
        alone.state.position.y = 2.0;
        alone.state.rotation = random.attitude();
        alone.state.velocity = DVec3::new(0.5, -8.0, 0.0);
        let mut beside = alone.clone();
        beside.planes.push(wall(DVec3::X * -0.8, DVec3::X, &floor));
        for _ in 0..20 {
            alone.step::<Split>(SIXTIETH);
            beside.step::<Split>(SIXTIETH);
            let (planes, body) = (&beside.planes[1..], &beside.body);
            if Gaps::over(planes, body, &beside.state).lowest() < 0.15 {
                break; // it may touch in the next step
            }
            worst = worst.max((alone.state.position - beside.state.position).length());
        }
        impacts += alone.total.impacts;
    }
    println!("near a wall: apart by {worst:.1e} m in {impacts} impacts");
    assert!(worst < 1e-9 && impacts > 50);
}

/// A box comes to rest in the groove between two ramps. Between walls that are too close, nothing diverges.
#[test]
fn grooves_and_chimneys() {
    let surface = Floor::new(0.0, 0.3, 0.4).expect("valid");
    let (mut random, mut rested) = (Random(24), 0);
    for i in 0..50 {
        let tilt = random.range(0.5, 2.0);
        let ramps =
            [-1.0, 1.0].map(|side| wall(DVec3::ZERO, DVec3::new(side * tilt, 1.0, 0.0), &surface));
        let mut scene = Scene::among(ramps.to_vec(), DVec3::new(0.3, 0.2, 0.4));
        scene.state.position.y = 3.0;
        scene.state.rotation = random.attitude();
        scene.run::<Split>(SIXTIETH, 600);
        // A box on two opposite corners continues to turn about them, because no friction acts there.
        assert!(scene.state.velocity.length() < 1e-9, "{i} {tilt}");
        rested += u32::from(scene.contact.is_resting(&scene.state));

        let gap = [0.0, -1e-13, -1e-3, 1e-6][i % 4];
        let mut scene = Scene::among(tray(0.5 + gap, 0.3, 0.4), DVec3::splat(0.5));
        scene.state.position.y = 1.0;
        scene.state.velocity = random.vector(1.0);
        scene.spin(random.vector(1.0));
        let start = scene.energy();
        scene.run::<Split>(SIXTIETH, 120);
        let end = scene.state;
        assert!(
            end.is_finite() && (end.position - DVec3::Y * 0.75).length() < 1.0,
            "{end:?}"
        );
        assert!(scene.energy() <= start + 0.1 || gap < -1e-6);
    }
    println!("{rested} of 50 rest in the groove");
    assert!(rested > 30);
}
