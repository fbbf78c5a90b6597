//! A box falls on the floor, rests and leaves it.

use bevy::prelude::*;
use box_physics::prelude::*;

use super::{Play, app, brick};

#[test]
fn a_dropped_box_comes_to_rest_and_its_pose_repeats_bit_for_bit() {
    let mut app = app();
    app.insert_resource(Floor::new(0.0, 0.3, 0.5).expect("valid"));
    let start = BodyState::at_pose(
        DVec3::new(0.0, 2.0, 0.0),
        DQuat::from_xyzw(0.2, 0.1, 0.3, 0.9),
    )
    .with_angular_velocity(&brick(), DVec3::new(1.0, -2.0, 0.5));
    let entity = app.spawn((brick(), start));
    app.play(1200);
    let rested = app.state(entity);
    assert!(rested.velocity.length() == 0.0 && rested.angular_momentum.length() == 0.0);
    assert!(rested.position.y > 0.12 && rested.position.y < 0.51);
    for _ in 0..1000 {
        app.update();
        assert_eq!(app.state(entity), rested);
    }
    // A push wakes it.
    app.send(ApplyImpulse::center(entity, DVec3::Y * 9.0));
    app.update();
    assert!(app.state(entity).velocity.y > 2.0);
}

#[test]
fn floor_contacts_are_reported_on_request() {
    let mut app = app();
    app.insert_resource(Floor::new(0.0, 0.0, 0.5).expect("valid"));
    let drop = BodyState::at(DVec3::new(0.0, 0.5, 0.0));
    let reporting = app.spawn((brick(), drop, ReportContacts));
    app.spawn((brick(), drop));
    let mut contacts = Vec::new();
    for _ in 0..60 {
        app.update();
        contacts.extend(app.drain::<FloorContact>());
    }
    let [contact] = contacts[..] else {
        panic!("a flat landing is one contact, but there are {contacts:?}");
    };
    assert_eq!(
        (contact.entity, contact.phase),
        (reporting, ContactPhase::Began)
    );
    assert_eq!(contact.report.corners.count_ones(), 4);
    assert!(contact.report.point().y.abs() < 1e-6);
    // J = m √(2 g d) with d = 0.25 m, plus the weight until the end of that step.
    let (impulse, expected) = (
        contact.report.normal_impulse(),
        3.0 * (2.0_f64 * 9.81 * 0.25).sqrt(),
    );
    assert!(impulse >= expected * (1.0 - 1e-9) && impulse <= expected + 3.0 * 9.81 / 60.0 + 1e-9);
}
