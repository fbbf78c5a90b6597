//! Entities and components that appear, disappear or have the wrong parent, between steps and within a step.

use bevy::prelude::*;
use box_physics::floor::ContactState;
use box_physics::force::Gravity;
use box_physics::prelude::*;

use super::{Log, Play, app, brick, tumbling};

#[test]
fn bodies_despawned_between_message_and_step() {
    let log = Log::start();
    let mut app = app();
    for _ in 0..5 {
        let gone = app.spawn((brick(), tumbling()));
        app.send(ApplyImpulse::center(gone, DVec3::X));
        app.world_mut().despawn(gone);
        app.update();
    }
    log.says_once("is not a body");
}

#[test]
fn bodies_despawned_during_the_step() {
    let log = Log::start();
    use PhysicsSystems::{Contact, First, Forces, Impulses, Integrate, Last, Refit, Writeback};
    for set in [
        First, Impulses, Forces, Integrate, Contact, Refit, Writeback, Last,
    ] {
        let mut app = app();
        app.insert_resource(Floor::default());
        // Bodies that are being quarantined are despawned as well.
        app.add_systems(
            PhysicsSchedule,
            (|bodies: Query<Entity, With<GravityScale>>, mut commands: Commands| {
                for entity in &bodies {
                    commands.entity(entity).despawn();
                }
            })
            .in_set(set),
        );
        for _ in 0..3 {
            let lying = BodyState::at(DVec3::Y * 0.25);
            for state in [tumbling(), lying] {
                for scale in [1.0, f64::NAN] {
                    app.spawn((brick(), state, ReportContacts, GravityScale(scale)));
                }
            }
            let stays = app.spawn((brick(), tumbling()));
            app.play(3);
            assert!(app.state(stays).is_valid());
        }
        let mut doomed = app.world_mut().query::<&GravityScale>();
        assert_eq!(doomed.iter(app.world()).count(), 0);
    }
    log.take();
}

#[test]
fn components_removed_in_flight() {
    let log = Log::start();
    #[rustfmt::skip]
    let removals: [fn(&mut EntityWorldMut); 5] = [
        |e| { e.remove::<ContactState>(); },
        |e| { e.remove::<WorldAabb>(); },
        |e| { e.remove::<BodyState>(); },
        |e| { e.remove::<IntegratorMemory>(); },
        |e| { e.remove::<Transform>(); },
    ];
    for remove in removals {
        for with_floor in [false, true] {
            let mut app = app();
            if with_floor {
                app.insert_resource(Floor::default());
            }
            let entity = app.spawn((brick(), tumbling()));
            app.play(10);
            for _ in 0..3 {
                remove(&mut app.entity(entity));
                app.update();
                let one = app.state(entity);
                app.update();
                assert_ne!(app.state(entity), one, "it goes on");
            }
            assert!(app.world().get::<ContactState>(entity).is_some());
            assert!(app.world().get::<WorldAabb>(entity).is_some());
            log.says_once("restored");
        }
    }
    // A lost state restarts at the displayed pose of the body.
    let mut app = app();
    let entity = app.spawn((brick(), tumbling()));
    app.play(10);
    let shown = *app.get::<Transform>(entity);
    app.entity(entity).remove::<BodyState>();
    app.update();
    let after = app.state(entity).position.as_vec3();
    assert!((after - shown.translation).length() < 0.01, "{after}");
    log.take();
}

#[test]
fn without_its_rigid_box_a_body_is_left_alone() {
    let log = Log::start();
    let mut app = app();
    let entity = app.spawn((brick(), tumbling()));
    app.play(10);
    app.entity(entity).remove::<RigidBox>();
    let mine = Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(Quat::from_rotation_x(0.3));
    *app.edit(entity) = mine;
    let frozen = app.state(entity);
    app.play(10);
    assert_eq!(app.state(entity), frozen);
    assert_eq!(*app.get::<Transform>(entity), mine);
    app.entity(entity).insert(brick());
    app.update();
    assert!((app.state(entity).position - DVec3::new(1.0, 2.0, 3.0)).length() < 0.1);
    log.is_silent();
}

#[test]
fn parents_that_displace_their_bodies_are_reported_once() {
    let log = Log::start();
    let spawn_under = |app: &mut App, parent: Entity| {
        let child = app.spawn((brick(), tumbling()));
        app.entity(parent).add_child(child);
        child
    };
    // A parent at the origin, unrotated and unscaled, is a folder and needs no message.
    let mut app = app();
    let parent = app.spawn(Transform::IDENTITY);
    spawn_under(&mut app, parent);
    app.play(5);
    log.is_silent();
    // … until it moves.
    *app.edit(parent) = Transform::from_xyz(1.0, 0.0, 0.0);
    app.play(5);
    log.says_once("top of the hierarchy");
    // A scaled grandparent.
    let mut app = super::app();
    let grandparent = app.spawn(Transform::from_scale(Vec3::splat(2.0)));
    let parent = app.spawn(Transform::IDENTITY);
    app.entity(grandparent).add_child(parent);
    let child = spawn_under(&mut app, parent);
    app.play(5);
    log.says_once(&grandparent.to_string());
    // A grandparent that is scaled later.
    let mut later = super::app();
    let [grandparent, parent] = [(), ()].map(|()| later.spawn(Transform::IDENTITY));
    later.entity(grandparent).add_child(parent);
    spawn_under(&mut later, parent);
    later.play(5);
    log.is_silent();
    later.edit::<Transform>(grandparent).scale = Vec3::splat(2.0);
    later.play(5);
    log.says_once(&grandparent.to_string());
    // A parent that moves below a displaced entity.
    let mut moved = super::app();
    let far = moved.spawn(Transform::from_xyz(0.0, 1.0, 0.0));
    let parent = moved.spawn(Transform::IDENTITY);
    spawn_under(&mut moved, parent);
    moved.play(5);
    log.is_silent();
    moved.entity(far).add_child(parent);
    moved.play(5);
    log.says_once(&far.to_string());
    // It is still simulated in world coordinates.
    let mut expected = tumbling();
    let mut memory = IntegratorMemory::default();
    let h = Time::<Fixed>::from_hz(60.0).timestep().as_secs_f64();
    for _ in 0..5 {
        let gravity = Gravity(DVec3::new(0.0, -9.81, 0.0));
        Integrator::Split.step(&brick(), &mut expected, &gravity, h, &mut memory);
    }
    assert_eq!(app.state(child), expected);
    // A body below a body.
    let mut app = super::app();
    let parent = app.spawn((brick(), BodyState::default()));
    spawn_under(&mut app, parent);
    app.play(5);
    log.says_once("top of the hierarchy");
}
