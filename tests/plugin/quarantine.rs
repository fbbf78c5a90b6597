//! Bodies with non-finite values, and rejected non-finite inputs.

use box_physics::prelude::*;

use super::{FREE, Play, WEIGHT, app, brick, core, tumbling};

#[test]
fn a_body_that_is_not_finite_is_quarantined_and_its_neighbors_are_unaffected() {
    let run = |poison: bool| {
        let mut app = app();
        let left = app.spawn((brick(), tumbling()));
        let bad = app.spawn((brick(), tumbling()));
        let right = app.spawn((brick(), tumbling()));
        for step in 0..20 {
            if poison && step == 10 {
                app.edit::<BodyState>(bad).velocity.x = f64::NAN;
            }
            app.update();
        }
        (app, [left, bad, right])
    };
    let (clean, ids) = run(false);
    let (app, [left, bad, right]) = run(true);
    assert_eq!(app.state(left), clean.state(ids[0]));
    assert_eq!(app.state(right), clean.state(ids[2]));
    let frozen = app.state(bad);
    assert!(frozen.is_valid());
    let mut at_ten = tumbling();
    core(Integrator::Split, &mut at_ten, &WEIGHT, 10);
    assert_eq!(frozen.position.as_vec3(), at_ten.position.as_vec3());
    assert!(app.world().get::<Quarantined>(bad).is_some());
}

#[test]
fn quarantine_is_reported_once_and_can_be_left() {
    let mut app = app();
    let entity = app.spawn((
        brick(),
        tumbling(),
        ExternalForce {
            force: DVec3::splat(f64::INFINITY),
            torque: DVec3::ZERO,
        },
    ));
    let good = app.state(entity);
    let mut told = 0;
    for _ in 0..5 {
        app.update();
        for message in app.drain::<BodyQuarantined>() {
            assert_eq!(
                (message.entity, message.integrator),
                (entity, Integrator::Split)
            );
            told += 1;
        }
    }
    assert_eq!(told, 1);
    assert_eq!(app.state(entity), good, "frozen at its last good state");
    app.entity(entity).remove::<(Quarantined, ExternalForce)>();
    app.update();
    assert!(
        app.state(entity).position.y != good.position.y,
        "and it goes on"
    );
}

#[test]
fn an_impulse_that_is_not_finite_is_refused() {
    let mut app = app();
    app.insert_resource(WorldGravity(DVec3::ZERO));
    let entity = app.spawn((brick(), tumbling()));
    app.send(ApplyImpulse::center(entity, DVec3::splat(f64::NAN)));
    app.send(ApplyImpulse::at_body_point(
        entity,
        DVec3::X,
        DVec3::splat(f64::INFINITY),
    ));
    app.update();
    let mut expected = tumbling();
    core(Integrator::Split, &mut expected, &FREE, 1);
    assert_eq!(app.state(entity), expected);
    assert!(app.world().get::<Quarantined>(entity).is_none());
}
