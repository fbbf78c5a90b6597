//! Planes as entities: walls, ramps, trays.

use std::sync::{Arc, Mutex};

use super::*;
use box_physics::floor::{ContactState, Plane, PlanesContext};

fn plane(point: DVec3, normal: DVec3) -> StaticPlane {
    StaticPlane::new(point, normal).expect("valid")
}

/// Four walls, `half` \[m\] from the middle.
fn walls(half: f64) -> [StaticPlane; 4] {
    [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z].map(|n| plane(-half * n, n))
}

fn die() -> RigidBox {
    RigidBox::cube(0.016, 0.004).expect("valid")
}

fn thrown(k: u32) -> BodyState {
    let k = f64::from(k);
    BodyState::at(DVec3::new(0.01 * k - 0.03, 0.05, 0.01))
        .with_velocity(DVec3::new(1.0 - 0.3 * k, -0.5, 0.7))
        .with_angular_velocity(&die(), DVec3::new(20.0, 7.0 * k, -11.0))
}

/// Dice stay in the tray and settle, and the steps equal those of the core.
#[test]
fn dice_settle_in_a_tray() {
    let mut app = app();
    let floor = Floor::new(0.0, 0.3, 0.4).expect("valid");
    app.insert_resource(floor);
    let surface = (
        Friction::new(0.2).expect("valid"),
        Restitution::new(0.5).expect("valid"),
    );
    app.world_mut()
        .spawn_batch(walls(0.06).map(|wall| (wall, surface.0, surface.1)));
    let settled = Arc::new(Mutex::new(Vec::new()));
    let heard = settled.clone();
    app.add_observer(move |on: On<Settled>| heard.lock().expect("one thread").push(on.entity));
    let mut dice: Vec<_> = (0..6).map(|k| app.spawn((die(), thrown(k)))).collect();

    let mut planes = vec![Plane::from(floor)];
    planes.extend(walls(0.06).map(|wall| Plane::new(wall, 0.5, 0.2).expect("valid")));
    let (body, settings) = (die(), ContactSettings::default());
    let weight = Gravity(DVec3::NEG_Y * 9.81);
    let context = PlanesContext {
        planes: &planes,
        settings: &settings,
        body: &body,
        force: &weight,
    };
    let mut alone = thrown(1);
    let (mut memory, mut contact) = (IntegratorMemory::default(), ContactState::default());
    for _ in 0..240 {
        app.update();
        let h = tick().as_secs_f64();
        Integrator::Split.step_on_planes(&context, &mut alone, h, &mut memory, &mut contact, None);
        assert_eq!(app.state(dice[1]), alone);
        for &die in &dice {
            let place = app.state(die).position;
            assert!(place.x.abs().max(place.z.abs()) < 0.0521 && place.y > 0.0079);
        }
    }
    let mut settled = settled.lock().expect("one thread").clone();
    settled.sort_unstable();
    dice.sort_unstable();
    settled.dedup();
    assert_eq!(settled, dice);
}

/// A box rests on a ramp without a floor, and on a wall to which gravity presses it. Either may be removed.
#[test]
fn what_rests_falls_when_the_plane_goes() {
    let mut app = app();
    let ramp = plane(DVec3::ZERO, DVec3::new(0.6, 0.8, 0.0));
    let rough = Friction::new(0.8).expect("valid");
    let ramp = app.spawn((ramp, rough));
    let turn = DQuat::from_xyzw(0.0, 0.0, -(0.1_f64.sqrt()), 0.9_f64.sqrt());
    let lying = BodyState::at_pose(turn * DVec3::Y * 0.25, turn);
    let body = app.spawn((brick(), lying, ReportContacts));
    app.play(30);
    let rest = app.state(body);
    assert!((rest.position - lying.position).length() < 1e-15);
    let resting = |app: &App| app.get::<RestingSince>(body).0;
    assert!(resting(&app).is_some());
    // A smoother ramp does not hold it, and without a ramp it falls.
    app.entity(ramp).insert(Friction::new(0.7).expect("valid"));
    app.update();
    assert!(resting(&app).is_none());
    app.entity(ramp).despawn();
    let before = app.state(body).velocity;
    app.play(60);
    let fallen = app.state(body).velocity - before;
    assert!((fallen - DVec3::NEG_Y * 9.81).length() < 1e-6, "{fallen}");
    let touches = app.get::<ContactState>(body);
    assert_eq!(touches.touching(), 0);
}

/// A belt carries a box to a wall that moves toward it, step by step as in the core.
#[test]
fn planes_with_a_velocity() {
    let mut app = app();
    let belt = plane(DVec3::ZERO, DVec3::new(0.1, 1.0, 0.0));
    let along = DVec3::new(1.0, -0.1, 0.0).normalize();
    let belt = belt.with_velocity(2.0 * along);
    let wall = plane(DVec3::X * 8.0, DVec3::NEG_X).with_velocity(DVec3::X * -0.9);
    let [_, wall_entity] = [belt, wall].map(|shape| app.spawn(shape));
    let start = BodyState::at(DVec3::Y * 0.5);
    let body = app.spawn((brick(), start));
    let (mut planes, mut state) = (
        [belt, wall].map(|shape| Plane::of(shape, None, None).expect("valid")),
        start,
    );
    let (box_, settings) = (brick(), ContactSettings::default());
    let weight = Gravity(DVec3::NEG_Y * 9.81);
    let (mut memory, mut contact) = (IntegratorMemory::default(), ContactState::default());
    let mut rode = false;
    for _ in 0..300 {
        app.update();
        let context = PlanesContext {
            planes: &planes,
            settings: &settings,
            body: &box_,
            force: &weight,
        };
        let h = tick().as_secs_f64();
        Integrator::Split.step_on_planes(&context, &mut state, h, &mut memory, &mut contact, None);
        planes.iter_mut().for_each(|plane| plane.advance(h));
        assert_eq!(app.state(body), state);
        assert_eq!(
            app.get::<StaticPlane>(wall_entity).point,
            planes[1].shape().point
        );
        rode |= contact.is_resting(&state);
        let resting = app.get::<RestingSince>(body).0;
        assert_eq!(resting.is_some(), contact.is_resting(&state));
    }
    assert!(rode, "it was at rest on the belt");
    let wall = app.get::<StaticPlane>(wall_entity).point.x;
    let time = 300.0 * tick().as_secs_f64();
    assert!((wall - (8.0 - 0.9 * time)).abs() < 1e-12);
    assert!(state.position.x < wall, "{state:?}");
}

/// An invalid plane has no effect, and a plane that is moved to a body wakes it.
#[test]
fn planes_may_be_invalid_and_may_move() {
    let mut app = app();
    app.insert_resource(Floor::default());
    let body = app.spawn((brick(), BodyState::at(DVec3::Y * 0.25)));
    let mut wall = plane(DVec3::X * 4.0, DVec3::NEG_X);
    wall.normal = DVec3::ZERO;
    let wall = app.spawn(wall);
    app.play(30);
    assert_eq!(app.state(body), BodyState::at(DVec3::Y * 0.25));
    assert!(app.clock().fault().is_none());
    let pushing = plane(DVec3::X * 0.4, DVec3::NEG_X);
    *app.edit::<StaticPlane>(wall) = pushing;
    app.update();
    let pushed = app.state(body).position;
    assert!(
        (pushed - DVec3::new(-0.1, 0.25, 0.0)).length() < 1e-12,
        "{pushed}"
    );
}

/// A landing on a wall reports the normal of the wall.
#[test]
fn a_landing_tells_the_normal() {
    let mut app = app();
    app.insert_resource(WorldGravity(DVec3::ZERO));
    let normal = DVec3::new(-0.6, 0.0, 0.8);
    app.spawn(plane(-normal, normal));
    let state = BodyState::at(DVec3::ZERO).with_velocity(-4.0 * normal);
    app.spawn((brick(), state, ReportContacts));
    let heard = Arc::new(Mutex::new(Vec::new()));
    let landings = heard.clone();
    app.add_observer(move |on: On<Landed>| landings.lock().expect("one thread").push(*on.event()));
    app.play(30);
    let heard = heard.lock().expect("one thread");
    // One edge strikes first, then the other.
    assert_eq!(heard.len(), 2);
    assert!(
        heard
            .iter()
            .all(|landed| (landed.normal - normal).length() < 1e-15)
    );
    assert!(heard[0].approach_speed > 3.0 && heard[0].normal_impulse > 0.0);
}
