//! Every reported contact begins once and ends once, for any cause.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::message::Messages;
use bevy::prelude::*;
use box_physics::prelude::*;

use super::{app, brick, state};

/// A brick that rests on the floor and reports contacts.
fn lying() -> (App, Entity) {
    let mut app = app();
    app.insert_resource(Floor::default());
    let state = BodyState::at(DVec3::new(0.0, 0.25, 0.0));
    let entity = app.world_mut().spawn((brick(), state, ReportContacts)).id();
    (app, entity)
}

/// The reports of so many updates, and before them: how many began, persist, and ended.
fn reports(app: &mut App, entity: Entity, updates: u32) -> [usize; 3] {
    let mut counts = [0; 3];
    for _ in 0..updates {
        app.update();
        let mut messages = app.world_mut().resource_mut::<Messages<FloorContact>>();
        for contact in messages.drain() {
            assert_eq!(contact.entity, entity);
            counts[contact.phase as usize] += 1;
        }
    }
    counts
}

type Act = fn(&mut App, Entity);

#[test]
fn every_contact_that_began_ends_once() {
    let ends: [(&str, Act); 12] = [
        ("despawned", |app, entity| {
            app.world_mut().despawn(entity);
        }),
        ("disabled", |app, entity| {
            app.world_mut().entity_mut(entity).insert(Disabled);
        }),
        ("no RigidBox", |app, entity| {
            app.world_mut().entity_mut(entity).remove::<RigidBox>();
        }),
        ("no body", |app, entity| {
            app.world_mut()
                .entity_mut(entity)
                .remove_with_requires::<RigidBox>();
        }),
        ("no longer reported", |app, entity| {
            app.world_mut()
                .entity_mut(entity)
                .remove::<ReportContacts>();
        }),
        ("no floor", |app, _| {
            app.world_mut().remove_resource::<Floor>();
        }),
        ("a floor far below", |app, _| {
            app.insert_resource(Floor {
                height: -100.0,
                ..default()
            });
        }),
        ("teleported", |app, entity| {
            app.world_mut()
                .commands()
                .queue(Teleport::to(entity, DVec3::Y * 50.0));
        }),
        ("another state", |app, entity| {
            *app.world_mut().get_mut(entity).expect("a body") = BodyState::at(DVec3::Y * 50.0);
        }),
        ("another Transform", |app, entity| {
            *app.world_mut().get_mut(entity).expect("a body") = Transform::from_xyz(0.0, 50.0, 0.0);
        }),
        ("quarantined", |app, entity| {
            let mut state = app
                .world_mut()
                .get_mut::<BodyState>(entity)
                .expect("a body");
            state.velocity.x = f64::NAN;
        }),
        ("reset", |app, entity| {
            let parts = (BodyState::at(DVec3::Y * 50.0), ContactState::default());
            app.world_mut().entity_mut(entity).insert(parts);
        }),
    ];
    for (name, end) in ends {
        let (mut app, entity) = lying();
        let [began, _, ended] = reports(&mut app, entity, 20);
        assert_eq!((began, ended), (4, 0), "{name}");
        end(&mut app, entity);
        app.world_mut().flush();
        assert_eq!(reports(&mut app, entity, 3), [0, 0, 4], "{name}");
    }
}

#[test]
fn reports_begin_when_somebody_asks_for_them() {
    let (mut app, entity) = lying();
    app.world_mut()
        .entity_mut(entity)
        .remove::<ReportContacts>();
    assert_eq!(reports(&mut app, entity, 20), [0; 3]);
    app.world_mut().entity_mut(entity).insert(ReportContacts);
    assert_eq!(reports(&mut app, entity, 1), [4, 0, 0]);
    assert_eq!(reports(&mut app, entity, 1), [0, 4, 0]);
    // Forgotten, though it lies there: nothing begins a second time.
    app.world_mut()
        .entity_mut(entity)
        .insert(ContactState::default());
    assert_eq!(reports(&mut app, entity, 1), [0, 4, 0]);
    // Disabled and enabled: it ends and begins.
    app.world_mut().entity_mut(entity).insert(Disabled);
    assert_eq!(reports(&mut app, entity, 1), [0, 0, 4]);
    app.world_mut().entity_mut(entity).remove::<Disabled>();
    assert_eq!(reports(&mut app, entity, 1), [4, 0, 0]);
}

/// Without the contact settings, the defaults and the floor apply.
#[test]
fn settings_of_the_contact_that_are_removed_are_restored() {
    let (mut app, entity) = lying();
    for _ in 0..20 {
        app.update();
    }
    let before = state(&app, entity);
    app.world_mut().remove_resource::<ContactSettings>();
    for _ in 0..20 {
        app.update();
        assert_eq!(state(&app, entity), before);
    }
    assert_eq!(
        *app.world().resource::<ContactSettings>(),
        ContactSettings::DEFAULT
    );
}

/// A body that is moved within the step has a matching bounding box, even if it was at rest.
#[test]
fn the_box_follows_a_body_that_is_moved_within_the_step() {
    let (mut app, entity) = lying();
    for _ in 0..120 {
        app.update();
    }
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
    let aabb = app.world().get::<WorldAabb>(entity).expect("required").0;
    assert!((aabb.min.y - 3.0).abs() < 1e-6, "{aabb:?}");
    let transform = app.world().get::<Transform>(entity).expect("required");
    assert!((transform.translation.y - 3.25).abs() < 1e-6);
}
