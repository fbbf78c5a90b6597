//! Snapshots: every integrator repeats the same future bit for bit.

use bevy::ecs::message::Messages;
use bevy::prelude::*;
use box_physics::prelude::*;

use super::{Play, app, brick, tumbling};

fn scene(integrator: Integrator) -> (App, Vec<Entity>) {
    let mut app = app();
    app.insert_resource(Floor::default())
        .insert_resource(GlobalIntegrator(integrator));
    let world = app.world_mut();
    let mut bodies = Vec::new();
    for k in 0_u8..6 {
        let spin = DVec3::new(1.0, 2.0, 0.5) * f64::from(k);
        let height = DVec3::Y * (0.25 + 0.3 * f64::from(k));
        let start = BodyState::at(height).with_angular_velocity(&brick(), spin);
        bodies.push(world.spawn((brick(), start, ReportContacts)).id());
    }
    let pulled = (
        Springs(vec![Spring {
            stiffness: 20.0,
            damping: 0.3,
            ..default()
        }]),
        OneShotForce::default(),
        LinearDrag(0.1),
    );
    bodies.push(world.spawn((brick(), tumbling(), pulled)).id());
    (app, bodies)
}

/// All states, landings and settlings of the next ticks, and the clock.
fn future(app: &mut App, bodies: &[Entity], ticks: u32) -> Vec<String> {
    let mut seen = Vec::new();
    for _ in 0..ticks {
        app.update();
        let states: Vec<_> = bodies.iter().map(|&body| app.state(body)).collect();
        let rest: Vec<_> = bodies
            .iter()
            .map(|&b| app.get::<RestingSince>(b).0)
            .collect();
        let world = app.world_mut();
        let landed: Vec<_> = world.resource_mut::<Messages<Landed>>().drain().collect();
        let clock = *world.resource::<PhysicsClock>();
        seen.push(format!("{states:?} {rest:?} {landed:?} {clock:?}"));
    }
    seen
}

#[test]
fn the_same_future_under_every_integrator() {
    for &integrator in Integrator::ALL {
        let (mut app, bodies) = scene(integrator);
        // In flight, in the middle of a landing, at rest.
        for ticks in [3, 14, 15, 150] {
            future(&mut app, &bodies, ticks);
            app.send(ApplyImpulse::center(bodies[1], DVec3::new(0.3, 4.0, 0.1)));
            app.edit::<OneShotForce>(bodies[6]).force = DVec3::X;
            let snapshot = PhysicsSnapshot::take(app.world_mut());
            let first = future(&mut app, &bodies, 60);
            assert_eq!(snapshot.restore(app.world_mut()), []);
            let second = future(&mut app, &bodies, 60);
            for (step, (first, second)) in first.iter().zip(&second).enumerate() {
                assert_eq!(
                    first,
                    second,
                    "{integrator}, step {step} from {}",
                    snapshot.time()
                );
            }
        }
    }
}

/// Moving floors and planes return to their positions.
#[test]
fn the_same_future_among_moving_planes() {
    let (mut app, bodies) = scene(Integrator::Split);
    app.world_mut().resource_mut::<Floor>().velocity = DVec3::new(0.2, -0.1, 0.0);
    let pusher = StaticPlane::new(DVec3::X * -0.8, DVec3::X).expect("valid");
    let pusher = app.spawn(pusher.with_velocity(DVec3::X * 0.6));
    let belt = StaticPlane::new(DVec3::Y * -0.3, DVec3::new(0.6, 0.8, 0.0)).expect("valid");
    app.spawn(belt.with_velocity(DVec3::new(-0.8, 0.6, 0.0)));
    future(&mut app, &bodies, 40);
    let snapshot = PhysicsSnapshot::take(app.world_mut());
    let first = future(&mut app, &bodies, 90);
    let height = app.world().resource::<Floor>().height;
    let place = *app.get::<StaticPlane>(pusher);
    let time = 130.0 * crate::tick().as_secs_f64();
    assert!((place.point.x - (time * 0.6 - 0.8)).abs() < 1e-12);
    assert_eq!(snapshot.restore(app.world_mut()), []);
    assert_eq!(future(&mut app, &bodies, 90), first);
    assert_eq!(*app.get::<StaticPlane>(pusher), place);
    assert_eq!(app.world().resource::<Floor>().height, height);
}

/// Spawning and despawning bodies in between does not affect the others. A body that is respawned from its snapshot
/// repeats its future.
#[test]
fn the_same_future_whoever_came_and_went() {
    let (mut app, mut bodies) = scene(Integrator::Split);
    future(&mut app, &bodies, 17);
    let snapshot = PhysicsSnapshot::take(app.world_mut());
    let states = |app: &App, bodies: &[Entity]| -> Vec<_> {
        bodies.iter().map(|&body| app.state(body)).collect()
    };
    app.play(60);
    let first = states(&app, &bodies);
    assert_eq!(snapshot.restore(app.world_mut()), []);
    app.play(5);
    app.world_mut().despawn(bodies[3]);
    let new: Vec<_> = (0..3).map(|_| app.spawn((brick(), tumbling()))).collect();
    app.play(20);
    assert_eq!(snapshot.restore(app.world_mut()), [bodies[3]]);
    app.world_mut().despawn(new[1]);
    let saved = snapshot.bodies().find(|(entity, _)| *entity == bodies[3]);
    let (_, moment) = saved.expect("in the snapshot");
    bodies[3] = app.spawn((brick(), moment.clone(), ReportContacts));
    app.play(60);
    assert_eq!(states(&app, &bodies), first);
}

/// A restore is displayed in the same frame and ends a quarantine. It keeps the user's settings and new
/// bodies, and reports the bodies that no longer exist.
#[test]
fn what_a_restore_leaves_alone() {
    let (mut app, bodies) = scene(Integrator::Split);
    future(&mut app, &bodies, 5);
    let snapshot = PhysicsSnapshot::take(app.world_mut());
    assert_eq!(snapshot.bodies().len(), 7);
    let then = app.state(bodies[2]);
    future(&mut app, &bodies, 20);
    app.edit::<BodyState>(bodies[2]).velocity = DVec3::NAN;
    app.update();
    assert!(app.world().get::<Quarantined>(bodies[2]).is_some());
    app.world_mut().despawn(bodies[0]);
    let new = app.spawn((brick(), BodyState::at(DVec3::Y * 9.0)));
    app.pause();
    app.world_mut().resource_mut::<PhysicsClock>().substeps = 2;
    app.insert_resource(WorldGravity(DVec3::X));
    assert_eq!(snapshot.restore(app.world_mut()), [bodies[0]]);
    assert_eq!(app.state(bodies[2]), then);
    let shown = app.get::<Transform>(bodies[2]).translation;
    assert_eq!(shown, then.position.as_vec3());
    assert!(app.world().get::<Quarantined>(bodies[2]).is_none());
    assert_eq!(app.state(new).position, DVec3::Y * 9.0);
    let clock = app.clock();
    assert!(clock.paused && clock.substeps == 2 && clock.time() == snapshot.time());
    assert_eq!(app.world().resource::<WorldGravity>().0, DVec3::X);
}
