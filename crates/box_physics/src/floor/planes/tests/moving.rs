//! Planes with a velocity: contact equals that with planes at rest, seen from a moving frame.

use super::*;
use crate::math::sin_cos;

const HALF: DVec3 = DVec3::new(0.5, 0.25, 0.4);

/// A brick at rest on a plane through the origin with the normal `turn` y. The plane's velocity is in the plane's axes.
fn lying(turn: DQuat, theta: f64, mu: f64, velocity: DVec3) -> Scene {
    let mut scene = Scene::new(HALF, 0.3, mu).on_slope(theta);
    let belt = scene.floor.with_velocity(velocity);
    scene.planes = vec![wall(DVec3::ZERO, DVec3::Y, &belt)];
    scene.turned(turn)
}

/// A box at rest on an elevator that moves along or across a slope stays at rest on it, without a hop.
#[test]
fn a_resting_box_rides() {
    let mut random = Random(32);
    for velocity in [DVec3::NEG_Y * 0.5, DVec3::new(0.7, 3.0, -0.2), DVec3::X] {
        let mut scene = lying(random.attitude(), 0.3, 0.5, velocity);
        let force = scene.gravity;
        let velocity = scene.planes[0].shape.velocity;
        scene.state.velocity = velocity;
        scene.run::<Split>(SIXTIETH, 3);
        let start = scene.state;
        for _ in 0..10_000 {
            let mut report = ContactReport::default();
            let outcome = scene.step_under::<Split>(&force, SIXTIETH, Some(&mut report));
            assert!(outcome.resting && outcome.step.evaluations == 0);
            assert!(scene.contact.is_resting(&scene.state));
            assert!(scene.state.velocity == velocity && scene.state.rotation == start.rotation);
            let load = report.normal_impulse() / (scene.body.mass() * G * SIXTIETH);
            assert!(report.corners.count_ones() == 4 && report.approach_speed == 0.0);
            assert!((load - sin_cos(0.3).1).abs() < 1e-9, "{load}");
            assert!(scene.lowest().abs() < 1e-12, "{}", scene.lowest());
        }
        let way = scene.state.position - start.position;
        assert!((way - velocity * (10_000.0 * SIXTIETH)).length() < 1e-8);
        // The plane stops, and the box then has a velocity relative to it.
        set_velocity(&mut scene.planes[0], DVec3::ZERO);
        scene.step::<Split>(SIXTIETH);
        assert!(!scene.contact.is_resting(&scene.state));
    }
}

/// A box rests in the edge, in the corner and on one plane of a moving tray. A wall that passes far away does not
/// disturb it.
#[test]
fn a_box_rests_in_a_moving_tray() {
    let mut random = Random(36);
    for i in 0..60 {
        let pull = [
            DVec3::NEG_Y,
            DVec3::new(-0.3, -1.0, 0.0),
            DVec3::splat(-1.0),
        ][i % 3];
        let surface = Floor::new(0.0, 0.3, 0.4).expect("valid");
        let mut scene = Scene::among(tray(2.0, 0.3, 0.4), HALF);
        scene.gravity.0 = pull.normalize() * G;
        scene.state.position = DVec3::new(-1.3, 0.5, -1.4);
        scene.state.rotation = random.attitude();
        scene.spin(random.vector(1.0));
        if i % 2 == 0 {
            scene = scene.turned(random.attitude());
        }
        let velocity = if i < 30 {
            random.vector(2.0)
        } else {
            DVec3::ZERO
        };
        scene.state.velocity = velocity;
        scene
            .planes
            .iter_mut()
            .for_each(|p| set_velocity(p, velocity));
        let away = scene.planes[0].shape.normal;
        let passing = surface.with_velocity(away * 0.1);
        scene.planes.push(wall(away * 1e3, -away, &passing));
        scene.run::<Split>(SIXTIETH, 600);
        assert!(
            scene.contact.is_resting(&scene.state),
            "{i} {:?}",
            scene.state
        );
        let (start, lowest) = (scene.state, scene.lowest());
        for k in 1..=1000 {
            let mut report = ContactReport::default();
            let force = scene.gravity;
            let outcome = scene.step_under::<Split>(&force, SIXTIETH, Some(&mut report));
            assert!(outcome.resting && outcome.step.evaluations == 0, "{i} {k}");
            assert_eq!(scene.state.velocity, velocity);
            // Friction supports at most µ times as much: weight ≤ √(1 + µ²) Σ N.
            let weight = scene.body.mass() * G * SIXTIETH;
            let load = report.normal_impulse() * (1.0_f64 + 0.4 * 0.4).sqrt();
            assert!(load >= weight, "{i} {load}");
        }
        let way = velocity * (1000.0 * SIXTIETH);
        let off = (scene.state.position - start.position - way).length();
        // A thousand roundings of coordinates below 60 m: 7e-12.
        assert!(
            off < 1e-11 && (scene.lowest() - lowest).abs() < 1e-11,
            "{i} {off:e}"
        );
        assert_eq!(scene.state.rotation, start.rotation);
        // One of the supporting planes gets another velocity.
        if velocity != DVec3::ZERO {
            set_velocity(&mut scene.planes[0], DVec3::ZERO);
            scene.step::<Split>(SIXTIETH);
            assert!(!scene.contact.is_resting(&scene.state), "{i}");
        } else {
            assert_eq!(scene.state, start);
        }
    }
}

fn set_velocity(plane: &mut Plane, velocity: DVec3) {
    plane.surface.velocity = velocity;
    plane.shape.velocity = velocity;
}

/// Friction carries a box up a slope, to the speed of the belt: a = g (µ cos θ − sin θ); then it rests on it.
#[test]
fn a_sloping_conveyor_carries_a_box_up() {
    let mut random = Random(33);
    let (theta, mu, speed) = (0.3, 0.6, 1.5);
    let (s, c) = sin_cos(theta);
    let a = G * (mu * c - s);
    for _ in 0..20 {
        let turn = random.attitude();
        let mut scene = lying(turn, theta, mu, DVec3::NEG_X * speed);
        let (start, up) = (scene.state.position, turn * DVec3::NEG_X);
        for i in 1..=60 {
            scene.step::<Split>(SIXTIETH);
            let (t, stop) = (f64::from(i) * SIXTIETH, speed / a);
            let way = 0.5 * a * t.min(stop).powi(2) + speed * (t - stop).max(0.0);
            let off = (scene.state.position - start - up * way).length();
            // The search locates the stop to its tolerance.
            let bound = if t < stop { 1e-12 } else { 1e-9 };
            assert!(off < bound, "{i}: {off:e}");
            assert_eq!(scene.contact.is_resting(&scene.state), t > stop);
        }
    }
}

/// A box that falls on a sloping belt comes to rest on it, in any orientation of the scene.
#[test]
fn a_box_that_falls_on_a_belt_rests_on_it() {
    let mut random = Random(35);
    for i in 0..20 {
        let mut scene = lying(random.attitude(), 0.1, 0.5, random.vector(1.5));
        scene.state.position += scene.planes[0].shape.normal * 0.2;
        scene.spin(random.vector(0.5));
        scene.run::<Split>(SIXTIETH, 240);
        assert!(scene.contact.is_resting(&scene.state), "{i}");
        assert_eq!(scene.state.velocity, scene.planes[0].shape.velocity, "{i}");
    }
}

/// Throws in a tray with a common velocity equal throws in a tray at rest, and gain no energy in its frame.
#[test]
fn a_moving_tray_is_a_tray_at_rest_in_another_frame() {
    let mut random = Random(34);
    let (mut apart, mut impacts, mut gain) = (0, 0, 0.0_f64);
    for i in 0..200 {
        let (e, mu) = (random.restitution(i), random.friction(i, 1.0));
        let mut scene = Scene::among(tray(1.0, e, mu), HALF);
        scene.state.position.y = 0.8;
        scene.throw(&mut random, 3.0, 5.0);
        if i % 2 == 0 {
            scene = scene.turned(random.attitude());
        }
        let velocity = random.vector(3.0);
        let mut moving = scene.clone();
        moving.state.velocity += velocity;
        moving
            .planes
            .iter_mut()
            .for_each(|p| set_velocity(p, velocity));
        let (mut off, mut before) = (0.0_f64, scene.energy());
        for k in 1..=20 {
            scene.step::<Split>(SIXTIETH);
            moving.step::<Split>(SIXTIETH);
            let shift = velocity * (f64::from(k) * SIXTIETH);
            let mut seen = moving.clone();
            seen.state.position -= shift;
            seen.state.velocity -= velocity;
            off = off
                .max((seen.state.position - scene.state.position).length())
                .max(seen.state.attitude_difference(&scene.state));
            gain = gain.max((seen.energy() - before) / (1.0 + before.abs()));
            before = seen.energy();
            assert!(moving.lowest() >= -1e-12, "{i} {}", moving.lowest());
        }
        impacts += moving.total.impacts;
        apart += u32::from(off > 1e-6);
    }
    println!("a moving tray: {impacts} impacts, {apart} of 200 apart, gain {gain:.1e}");
    assert!(impacts > 400 && apart == 0 && gain < 1e-12);
}

/// A wall pushes a box along the floor at the wall's speed, and turns it flat.
#[test]
fn a_wall_pushes() {
    let surface = Floor::new(0.0, 0.0, 0.3).expect("valid");
    let pusher = wall(
        DVec3::X * -2.0,
        DVec3::X,
        &surface.with_velocity(DVec3::X * 0.8),
    );
    let mut scene = Scene::among(vec![Plane::from(surface), pusher], HALF);
    scene.state.position = DVec3::new(-1.0, 0.25, 0.0);
    scene.state.rotation = about(DVec3::Y, 0.2);
    for _ in 0..400 {
        scene.step::<Split>(SIXTIETH);
        assert!(scene.lowest() >= -1e-12, "{}", scene.lowest());
    }
    let state = scene.state;
    assert!(
        (state.velocity - DVec3::X * 0.8).length() < 1e-9,
        "{state:?}"
    );
    let wall = scene.planes[1].shape().point.x;
    assert!(
        (state.position.x - wall - 0.5).abs() < 1e-9,
        "{state:?} {wall}"
    );
    assert!((state.position.y - 0.25).abs() < 1e-15);
}

/// A body thrown by a plane does not pass through another plane in the same step.
#[test]
fn a_ceiling_stops_what_the_floor_throws() {
    let surface = Floor::new(0.0, 1.0, 0.0).expect("valid");
    let rising = Plane::from(surface.with_velocity(DVec3::Y * 2.0));
    for gap in [0.03, 0.04, 0.046] {
        let ceiling = wall(DVec3::Y * (0.51 + gap), DVec3::NEG_Y, &surface);
        let mut scene = Scene::among(vec![rising, ceiling], HALF);
        scene.state.position.y = 0.26;
        scene.step::<Split>(SIXTIETH);
        let over = Gaps::over(&scene.planes[1..], &scene.body, &scene.state).lowest();
        assert!(scene.total.impacts > 1 && over >= -1e-12, "{gap}: {over}");
    }
}
