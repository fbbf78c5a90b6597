//! A floor with a velocity: contact equals that with a floor at rest, seen from a moving frame.
use super::super::may_touch;
use super::*;
use crate::force::{Dissipation, Forces};
use crate::integrators::{Rk4, Split};

const BRICK: DVec3 = DVec3::new(0.5, 0.25, 0.375);

fn riding(velocity: DVec3) -> Scene {
    let mut scene = Scene::new(BRICK, 0.3, 0.5);
    scene.floor.velocity = velocity;
    scene.state.velocity = velocity;
    scene.run::<Split>(SIXTIETH, 3);
    assert!(scene.contact.is_resting(&scene.state));
    scene
}

/// u⁺ = V − e (u⁻ − V), at any time within the step.
#[test]
fn restitution_is_relative_to_the_floor() {
    for fraction in [0.0, 0.3, 0.9] {
        let mut scene = Scene::new(BRICK, 0.3, 0.5);
        scene.gravity.0 = DVec3::ZERO;
        scene.floor.velocity.y = 2.0;
        scene.state.velocity.y = -4.0;
        scene.state.position.y += fraction * SIXTIETH * 6.0;
        scene.run::<Split>(SIXTIETH, 2);
        assert_eq!(scene.total.impacts, 1);
        assert!((scene.state.velocity - DVec3::Y * 3.8).length() < 1e-12);
        // Starts at the point of impact.
        let (met, t) = (2.0 * fraction * SIXTIETH, (2.0 - fraction) * SIXTIETH);
        assert!((scene.state.position.y - (0.25 + met + 3.8 * t)).abs() < 1e-12);
    }
}

/// A box on an elevator has the height of the elevator to the last bit, and contact continues.
#[test]
fn a_resting_box_rides() {
    for velocity in [DVec3::NEG_Y * 0.5, DVec3::new(0.7, 3.0, -0.2), DVec3::X] {
        let mut scene = riding(velocity);
        let (start, gravity) = (scene.state, scene.gravity);
        for _ in 0..10_000 {
            let mut report = ContactReport::default();
            let outcome = scene.step_under::<Split>(&gravity, SIXTIETH, Some(&mut report));
            assert!(outcome.resting && outcome.step.evaluations == 0);
            assert!(scene.contact.is_resting(&scene.state));
            assert!(scene.state.velocity == velocity && scene.state.rotation == start.rotation);
            let height = scene.floor.height;
            assert_eq!(scene.state.position.y, height + 0.25);
            assert!(report.corners.count_ones() == 4 && report.approach_speed == 0.0);
            assert!((report.point().y - height).abs() < 1e-15 * (1.0 + height.abs()));
        }
        let way = scene.state.position - start.position;
        assert!((way - velocity * (10_000.0 * SIXTIETH)).length() < 1e-9);
    }
}

/// A box on an elevator that suddenly sinks separates from it by V²/2g, and then bounces a few times.
#[test]
fn a_sudden_start_is_a_hop_and_no_storm() {
    let mut scene = riding(DVec3::ZERO);
    scene.floor.velocity.y = -0.5;
    let (mut began, mut highest) = (0, 0.0_f64);
    for _ in 0..60 {
        let before = scene.contact.touching();
        scene.step::<Split>(SIXTIETH);
        began += (scene.contact.touching() & !before).count_ones();
        highest = highest.max(scene.lowest());
    }
    assert!(scene.contact.is_resting(&scene.state) && scene.state.velocity.y == -0.5);
    let hop = 0.25 / (2.0 * G);
    assert!(
        highest <= hop + 1e-12 && highest > 0.9 * hop,
        "{highest} {hop}"
    );
    assert!(began <= 12, "{began} corners began to touch");
}

/// Friction carries a box up to the speed of a conveyor belt: at v = µgt, and then it rests on it.
#[test]
fn a_conveyor_carries_a_box_up_to_its_speed() {
    for turn in [0.0, 0.4] {
        let velocity = DVec3::new(2.0, 0.0, -1.0);
        let mut scene = Scene::new(DVec3::new(0.5, 0.2, 0.5), 0.3, 0.5);
        scene.state.rotation = about(DVec3::Y, turn);
        scene.run::<Split>(SIXTIETH, 3);
        scene.floor.velocity = velocity;
        let (start, speed) = (scene.state.position, velocity.length());
        let along = velocity / speed;
        let stop = speed / (0.5 * G);
        for i in 1..=60 {
            scene.step::<Split>(SIXTIETH);
            let t = f64::from(i) * SIXTIETH;
            let s = t.min(stop);
            let expected = start + along * (0.25 * G * s * s) + velocity * (t - s);
            let off = (scene.state.position - expected).length();
            assert!(off < 1e-12, "{i}: {off:e}");
            assert_eq!(scene.contact.is_resting(&scene.state), t > stop);
        }
        assert_eq!(scene.state.velocity, velocity);
    }
}

/// A drop over a moving floor equals a drop over a floor at rest in another frame, under several integrators.
#[test]
fn a_moving_floor_is_a_floor_at_rest_in_another_frame() {
    fn compare<S: Integrate>() {
        let mut random = Random(23);
        let (mut apart, mut impacts) = (0, 0);
        for _ in 0..300 {
            let half = random.half_extents(0.1, 1.0);
            let mut scene = Scene::new(half, random.range(0.0, 0.9), random.range(0.0, 1.0));
            scene.state.position.y = scene.body.radius() + random.range(0.0, 0.1);
            scene.throw(&mut random, 2.0, 5.0);
            let velocity = random.vector(3.0);
            let mut moving = scene.clone();
            moving.floor.velocity = velocity;
            moving.state.velocity += velocity;
            let mut off = 0.0_f64;
            for i in 1..=20 {
                scene.step::<S>(SIXTIETH);
                moving.step::<S>(SIXTIETH);
                let shift = velocity * (f64::from(i) * SIXTIETH);
                off = off
                    .max((moving.state.position - scene.state.position - shift).length())
                    .max((moving.state.velocity - scene.state.velocity - velocity).length())
                    .max(moving.state.attitude_difference(&scene.state));
                assert!(moving.lowest() >= -1e-14);
            }
            impacts += moving.total.impacts;
            assert!(off < 1e-2, "{off:e}");
            apart += u32::from(off > 1e-9);
        }
        // The exceptions land in ever smaller impacts on alternating corners.
        assert!(impacts > 300 && apart <= 6, "{impacts} {apart}");
    }
    compare::<Split>();
    compare::<Rk4>();
}

/// The air is at rest. Its drag acts on a box on the belt; friction holds the box or lets it slip.
#[test]
fn drag_is_relative_to_the_air_and_not_to_the_floor() {
    let limit = |scene: &Scene| 0.5 * scene.body.mass() * G;
    let forces = |drag| Forces {
        acceleration: DVec3::NEG_Y * G,
        dissipation: Dissipation {
            linear_drag: drag,
            ..Dissipation::NONE
        },
        ..Forces::default()
    };
    // Held by friction: dragged along and at rest on the belt.
    let mut scene = Scene::new(DVec3::new(0.5, 0.2, 0.5), 0.3, 0.5);
    scene.floor.velocity.x = 2.0;
    let held = forces(0.9 * limit(&scene) / 2.0);
    // Drag stronger than friction: the box slips at the speed at which both are equal.
    let blown = forces(limit(&scene));
    for (force, steps, speed, bound) in [(held, 600, 2.0, 1e-12), (blown, 1200, 1.0, 1e-9)] {
        for _ in 0..steps {
            scene.step_under::<Split>(&force, SIXTIETH, None);
        }
        let error = (scene.state.velocity.x - speed).abs();
        assert!(error < bound, "{:?}", scene.state);
    }
}

/// A body over a rising floor takes the contact step if the floor can reach it.
#[test]
fn a_rising_floor_is_not_missed() {
    let scene = Scene::new(BRICK, 0.3, 0.5);
    let state = BodyState::at(DVec3::Y * 2.0);
    let touches = |velocity: f64| {
        let floor = scene.floor.with_velocity(DVec3::Y * velocity);
        may_touch(&floor, &scene.body, &state, &scene.gravity, SIXTIETH)
    };
    assert!(!touches(0.0) && !touches(-200.0) && touches(200.0));
    let mut scene = scene.with_state(state);
    scene.floor.velocity.y = 200.0;
    scene.step::<Split>(SIXTIETH);
    assert!(scene.total.impacts == 1 && scene.lowest() > 0.0);
    assert!(scene.state.velocity.y > 250.0);
}

/// A change of the floor's velocity wakes a box. If the floor stops, the box keeps its velocity.
#[test]
fn a_change_of_the_velocity_wakes() {
    let mut scene = riding(DVec3::X);
    scene.floor.velocity = DVec3::ZERO;
    scene.step::<Split>(SIXTIETH);
    assert!((scene.state.velocity.x - (1.0 - 0.5 * G * SIXTIETH)).abs() < 1e-12);
    let mut scene = riding(DVec3::Y);
    scene.floor.velocity = DVec3::ZERO;
    scene.step::<Split>(SIXTIETH);
    assert!((scene.state.velocity.y - (1.0 - G * SIXTIETH)).abs() < 1e-12);
    assert!(scene.contact.touching() == 0);
}
