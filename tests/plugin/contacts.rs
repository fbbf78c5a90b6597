//! Every reported contact begins once and ends once, for any cause.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::message::Messages;
use bevy::prelude::*;
use box_physics::math::sin_cos;
use box_physics::prelude::*;

use super::{Play, app, brick};

/// A brick at rest on the floor that reports contacts.
fn lying() -> (App, Entity) {
    let mut app = app();
    app.insert_resource(Floor::default());
    let state = BodyState::at(DVec3::new(0.0, 0.25, 0.0));
    let entity = app.spawn((brick(), state, ReportPersisting));
    (app, entity)
}

/// Counts the reports before and during `updates` updates: begun, persisting and ended.
fn reports(app: &mut App, entity: Entity, updates: u32) -> [usize; 3] {
    let mut counts = [0; 3];
    for _ in 0..updates {
        app.update();
        for contact in app.drain::<FloorContact>() {
            assert_eq!(contact.entity, entity);
            counts[contact.phase as usize] += 1;
        }
    }
    counts
}

type Act = fn(&mut App, Entity);

#[test]
fn every_contact_that_began_ends_once() {
    #[rustfmt::skip]
    let ends: [(&str, Act); 13] = [
        ("thrown far", |app, body| app.send(ApplyImpulse::center(body, DVec3::Y * 3000.0))),
        ("despawned", |app, body| { app.world_mut().despawn(body); }),
        ("disabled", |app, body| { app.entity(body).insert(Disabled); }),
        ("no RigidBox", |app, body| { app.entity(body).remove::<RigidBox>(); }),
        ("no body", |app, body| { app.entity(body).remove_with_requires::<RigidBox>(); }),
        ("no longer reported", |app, body| { app.entity(body).remove::<ReportContacts>(); }),
        ("no floor", |app, _| { app.world_mut().remove_resource::<Floor>(); }),
        ("a floor far below", |app, _| { app.insert_resource(Floor { height: -100.0, ..default() }); }),
        ("teleported", |app, body| app.queue(Teleport::to(body, DVec3::Y * 50.0))),
        ("another state", |app, body| *app.edit(body) = BodyState::at(DVec3::Y * 50.0)),
        ("another Transform", |app, body| *app.edit(body) = Transform::from_xyz(0.0, 50.0, 0.0)),
        ("quarantined", |app, body| app.edit::<BodyState>(body).velocity.x = f64::NAN),
        ("reset", |app, body| {
            app.entity(body).insert((BodyState::at(DVec3::Y * 50.0), ContactState::default()));
        }),
    ];
    for (name, end) in ends {
        let (mut app, entity) = lying();
        let [began, _, ended] = reports(&mut app, entity, 20);
        assert_eq!((began, ended), (1, 0), "{name}");
        end(&mut app, entity);
        app.world_mut().flush();
        assert_eq!(reports(&mut app, entity, 3), [0, 0, 1], "{name}");
    }
}

#[test]
fn reports_begin_when_somebody_asks_for_them() {
    let (mut app, entity) = lying();
    app.entity(entity).remove::<ReportContacts>();
    assert_eq!(reports(&mut app, entity, 20), [0; 3]);
    app.entity(entity).insert(ReportContacts);
    assert_eq!(reports(&mut app, entity, 1), [1, 0, 0]);
    assert_eq!(reports(&mut app, entity, 1), [0, 1, 0]);
    // A reset contact state of a resting body does not begin a second contact.
    app.entity(entity).insert(ContactState::default());
    assert_eq!(reports(&mut app, entity, 1), [0, 1, 0]);
    // Disabling ends the contact, enabling begins it.
    app.entity(entity).insert(Disabled);
    assert_eq!(reports(&mut app, entity, 1), [0, 0, 1]);
    app.entity(entity).remove::<Disabled>();
    assert_eq!(reports(&mut app, entity, 1), [1, 0, 0]);
}

/// A body that is moved within the step has a matching bounding box, even if it was at rest.
#[test]
fn the_box_follows_a_body_that_is_moved_within_the_step() {
    let (mut app, entity) = lying();
    app.play(120);
    let lift = |mut bodies: Query<&mut BodyState>| {
        for mut state in &mut bodies {
            state.position.y += 3.0;
        }
    };
    app.add_systems(
        PhysicsSchedule,
        lift.after(PhysicsSystems::Contact)
            .before(PhysicsSystems::Refit),
    );
    app.update();
    let aabb = app.get::<WorldAabb>(entity).0;
    assert!((aabb.min.y - 3.0).abs() < 1e-6, "{aabb:?}");
    let transform = app.get::<Transform>(entity);
    assert!((transform.translation.y - 3.25).abs() < 1e-6);
}

/// Events of a body, as its observers received them.
#[derive(Resource, Default, Debug)]
struct Seen {
    landed: Vec<Landed>,
    settled: Vec<Settled>,
    woken: Vec<Woken>,
}

fn observed<M>(floor: Floor, bodies: impl FnOnce(&mut World) -> M) -> (App, M) {
    let mut app = app();
    app.insert_resource(floor)
        .init_resource::<Seen>()
        .add_observer(|landed: On<Landed>, mut seen: ResMut<Seen>| seen.landed.push(*landed))
        .add_observer(|settled: On<Settled>, mut seen: ResMut<Seen>| seen.settled.push(*settled))
        .add_observer(|woken: On<Woken>, mut seen: ResMut<Seen>| seen.woken.push(*woken));
    let spawned = bodies(app.world_mut());
    (app, spawned)
}

fn tilted(degrees: f64, gap: f64) -> BodyState {
    let (sin, cos) = sin_cos(degrees.to_radians());
    let (s, c) = sin_cos(0.5 * degrees.to_radians());
    let lowest = 0.5 * (sin + cos);
    BodyState::at_pose(DVec3::Y * (lowest + gap), DQuat::from_xyzw(0.0, 0.0, s, c))
}

/// A cube that falls with a tilt of 3° strikes with one edge, then the other, and rattles: one landing, with
/// the momentum of the fall.
#[test]
fn a_tilted_cube_lands_once() {
    let floor = Floor::new(0.0, 0.0, 0.5).expect("valid");
    for degrees in [0.0, 3.0, 20.0] {
        let (mut app, cube) = observed(floor, |world| {
            let body = (RigidBox::default(), tilted(degrees, 0.5), ReportContacts);
            world.spawn(body).id()
        });
        let mut messages = 0;
        for _ in 0..120 {
            app.update();
            messages += app.drain::<Landed>().len();
        }
        let seen = app.world().resource::<Seen>();
        // At 20° it rocks to the other edge for 0.18 s: two landings.
        let count = if degrees < 5.0 { 1 } else { 2 };
        assert_eq!(
            (seen.landed.len(), messages),
            (count, count),
            "{degrees}: {seen:?}"
        );
        let landed = seen.landed[0];
        let (fall, speed) = ((2.0_f64 * 0.5 / 9.81).sqrt(), (2.0_f64 * 9.81 * 0.5).sqrt());
        // The fall starts at the first tick.
        assert_eq!(landed.entity, cube);
        assert!(
            (landed.time - fall).abs() < 1e-6,
            "{degrees}: {} {fall}",
            landed.time
        );
        assert!(landed.point.y.abs() < 0.05 && landed.point.length() < 0.6);
        assert!(landed.approach_speed > 0.999 * speed);
        // 1 kg that stops. The flat cube stops at once, the others when the second edge is down.
        let share = landed.normal_impulse / speed;
        if degrees < 5.0 {
            assert!(share > 0.9 && share < 1.4, "{degrees}: {share}");
        }
        assert_eq!((seen.settled.len(), seen.woken.len()), (1, 0), "{degrees}");
        let rested = app.get::<RestingSince>(cube).0;
        assert_eq!(rested, Some(seen.settled[0].time));
        assert!(seen.settled[0].time > landed.time && seen.settled[0].time < 2.0);
    }
}

/// Every bounce that takes more than 0.1 s is a landing, e times as fast. A sliding landing also reports
/// friction.
#[test]
fn bounces_are_landings_of_their_own() {
    let floor = Floor::new(0.0, 0.5, 0.5).expect("valid");
    let (mut app, _) = observed(floor, |world| {
        let start = BodyState::at(DVec3::Y * 2.5).with_velocity(DVec3::X);
        world
            .spawn((RigidBox::default(), start, ReportContacts))
            .id()
    });
    app.play(200);
    let landed = &app.world().resource::<Seen>().landed;
    assert!((3..=5).contains(&landed.len()), "{landed:?}");
    let first = landed[0];
    assert!((first.approach_speed - (4.0_f64 * 9.81).sqrt()).abs() < 1e-6);
    assert!((first.normal_impulse - 1.5 * first.approach_speed).abs() < 0.01);
    assert!(first.tangential_impulse.x < 0.0 && first.tangential_impulse.y == 0.0);
    let friction = first.tangential_impulse.length();
    assert!(friction <= 0.5 * first.normal_impulse + 1e-12);
    // Resetting the clock does not suppress landings.
    let count = landed.len();
    let mut bodies = app.world_mut().query::<&mut BodyState>();
    for mut state in bodies.iter_mut(app.world_mut()) {
        *state = BodyState::at(DVec3::Y * 0.7).with_velocity(DVec3::NEG_Y);
    }
    app.world_mut().resource_mut::<PhysicsClock>().reset();
    app.play(20);
    assert!(app.world().resource::<Seen>().landed.len() > count);
}

/// Bodies that start on the floor do not land, come to rest at once and send nothing while at rest.
#[test]
fn a_body_on_the_floor_does_not_thud() {
    let (mut app, body) = observed(Floor::default(), |world| {
        for k in 1_u8..40 {
            // Rounded to the f32 of `Transform`: a little above or below the floor.
            let place = Transform::from_xyz(f32::from(k), 0.5 + 1e-7 * f32::from(k % 5), 0.0);
            world.spawn((RigidBox::default(), place, ReportContacts));
        }
        world
            .spawn((brick(), BodyState::at(DVec3::Y * 0.25), ReportContacts))
            .id()
    });
    app.play(1);
    let began = app.drain::<FloorContact>().len();
    assert!(began >= 40, "{began}");
    app.play(60);
    assert!(app.world().resource::<Messages<FloorContact>>().is_empty());
    let seen = app.world_mut().remove_resource::<Seen>().expect("there");
    assert!(seen.landed.is_empty() && seen.woken.is_empty());
    assert_eq!(seen.settled.len(), 40);
    assert!(app.get::<RestingSince>(body).0 < Some(0.1));
}

/// Any cause that moves a resting body wakes it, with one event; it settles again.
#[test]
fn woken_once_and_settled_again() {
    let lower = |app: &mut App| {
        app.insert_resource(Floor {
            height: -0.5,
            ..default()
        });
    };
    #[rustfmt::skip]
    let wakes: [(&str, &dyn Fn(&mut App, Entity)); 6] = [
        ("pushed", &|app, body| app.send(ApplyImpulse::center(body, DVec3::new(0.5, 3.0, 0.0)))),
        ("teleported", &|app, body| app.queue(Teleport::to(body, DVec3::Y * 2.0))),
        ("state", &|app, body| *app.edit(body) = BodyState::at(DVec3::Y)),
        ("gravity", &|app, _| {
            // With half the load, the brick gains in one tick the speed that friction removes in one and a half.
            app.insert_resource(WorldGravity(DVec3::new(9.81, -4.905, 0.0)));
            app.update();
            app.insert_resource(WorldGravity::default());
        }),
        ("floor", &|app, _| lower(app)),
        ("floor gone", &|app, _| {
            app.world_mut().remove_resource::<Floor>();
            app.update();
            lower(app);
        }),
    ];
    for (what, wake) in wakes {
        let (mut app, body) = observed(Floor::default(), |world| {
            world.spawn((brick(), BodyState::at(DVec3::Y * 0.25))).id()
        });
        app.play(10);
        wake(&mut app, body);
        app.world_mut().flush();
        app.play(1);
        let since = |app: &App| app.get::<RestingSince>(body).0;
        assert_eq!(app.world().resource::<Seen>().woken.len(), 1, "{what}");
        assert_eq!(since(&app), None, "{what}");
        app.play(200);
        let seen = app.world().resource::<Seen>();
        assert_eq!(
            (seen.settled.len(), seen.woken.len()),
            (2, 1),
            "{what}: {seen:?}"
        );
        assert_eq!(since(&app), Some(seen.settled[1].time), "{what}");
    }
}
