//! New bodies and written states are displayed in their frame, for any state of the clock.

use std::time::Duration;

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

use super::{Play, app, brick, tumbling};

/// An app with frames of 10 ms, ten per tick, that propagates transforms.
fn slow_app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, PhysicsPlugins::default()))
        .insert_resource(Time::<Fixed>::from_hz(10.0))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
            10,
        )));
    app
}

fn posed() -> BodyState {
    BodyState::at_pose(
        DVec3::new(3.0, 5.0, -2.0),
        DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5),
    )
    .with_velocity(DVec3::X)
}

/// Asserts that the body displays exactly this state.
#[track_caller]
fn assert_shown(app: &App, entity: Entity, expected: &BodyState) {
    let body = app.world().entity(entity);
    let transform = body.get::<Transform>().expect("required");
    assert_eq!(transform.translation, expected.position.as_vec3());
    assert_eq!(transform.rotation, expected.rotation.as_quat());
    let global = body.get::<GlobalTransform>().expect("required");
    assert_eq!(*global, GlobalTransform::from(*transform));
    let half = *body.get::<RigidBox>().expect("a body");
    let aabb = body.get::<WorldAabb>().expect("required").0;
    let fitted = WorldAabb::of(&half, expected).0;
    assert_eq!((aabb.min, aabb.max), (fitted.min, fitted.max));
    assert_eq!(app.state(entity), *expected, "no step was taken for it");
}

#[derive(Resource)]
struct Spawned(Entity);

#[derive(Event)]
struct Come;

fn come(mut commands: Commands) {
    let entity = commands.spawn((brick(), posed())).id();
    commands.insert_resource(Spawned(entity));
}

#[test]
fn a_new_body_is_shown_in_the_frame_in_which_it_comes() {
    use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
    #[rustfmt::skip]
    let schedules: [InternedScheduleLabel; 9] = [
        Startup.intern(), PostStartup.intern(), First.intern(), PreUpdate.intern(), RunFixedMainLoop.intern(),
        Update.intern(), PostUpdate.intern(), Last.intern(),
        // These frames have no tick; the tick of the first one below spawns the body.
        FixedUpdate.intern(),
    ];
    for schedule in schedules {
        for stop in [false, true] {
            let mut app = slow_app();
            app.add_systems(schedule, come.run_if(not(resource_exists::<Spawned>)));
            app.world_mut().resource_mut::<PhysicsClock>().paused = stop;
            let ticks = if schedule == FixedUpdate.intern() {
                13
            } else {
                1
            };
            app.play(ticks);
            let entity = app.world().resource::<Spawned>().0;
            if schedule == FixedUpdate.intern() && !stop {
                // The next tick is the body's first.
                assert_eq!(app.clock().steps(), 1);
                assert_shown(&app, entity, &app.state(entity));
            } else {
                assert_shown(&app, entity, &posed());
            }
        }
    }
}

#[test]
fn observers_commands_and_late_parts_make_bodies_as_well() {
    let mut app = slow_app();
    app.add_observer(|_: On<Come>, commands: Commands| come(commands));
    app.update();
    app.world_mut().trigger(Come);
    app.world_mut().flush();
    let entity = app.world().resource::<Spawned>().0;
    assert_shown(&app, entity, &posed());
    // Parts that are added later in the same frame count.
    app.add_systems(Update, |mut commands: Commands, mut done: Local<bool>| {
        if !std::mem::replace(&mut *done, true) {
            let late_state = commands.spawn(brick()).insert(posed()).id();
            let place = posed().position.as_vec3();
            let turned = posed().rotation.as_quat();
            let late_transform = commands
                .spawn(brick())
                .insert(Transform::from_translation(place).with_rotation(turned))
                .id();
            commands.insert_resource(Late([late_state, late_transform]));
        }
    });
    app.update();
    let [late_state, late_transform] = app.world().resource::<Late>().0;
    assert_shown(&app, late_state, &posed());
    let at_rest = posed().with_velocity(DVec3::ZERO);
    assert_shown(&app, late_transform, &at_rest);
    // A child follows its parent.
    let parent = app.spawn(Transform::IDENTITY);
    let child = app.spawn((brick(), posed(), ChildOf(parent)));
    app.update();
    assert_shown(&app, child, &posed());
}

#[derive(Resource)]
struct Late([Entity; 2]);

/// A written state is displayed in that frame, however the clock is stopped or slowed.
#[test]
fn a_written_state_is_shown_however_the_clock_is_stopped() {
    #[rustfmt::skip]
    let stops: [(&str, fn(&mut World)); 5] = [
        ("running", |_| ()),
        ("PhysicsClock", |world| world.resource_mut::<PhysicsClock>().paused = true),
        ("Time<Virtual>", |world| world.resource_mut::<Time<Virtual>>().pause()),
        ("a tenth", |world| world.resource_mut::<Time<Virtual>>().set_relative_speed(0.1)),
        ("speed 0", |world| world.resource_mut::<Time<Virtual>>().set_relative_speed(0.0)),
    ];
    for (name, stop) in stops {
        let mut app = slow_app();
        let entity = app.spawn((brick(), BodyState::at(DVec3::X)));
        app.update();
        stop(app.world_mut());
        for k in 0..3 {
            let written = BodyState {
                position: posed().position + DVec3::Z * f64::from(k),
                ..posed()
            };
            *app.edit(entity) = written;
            app.update();
            println!("{name}, {k}");
            assert_shown(&app, entity, &written);
        }
        // The same holds for another size.
        app.entity(entity)
            .insert(RigidBox::cube(3.0, 1.0).expect("valid"));
        app.update();
        let last = app.state(entity);
        assert_shown(&app, entity, &last);
    }
}

/// Changes to a body while it is disabled or has no `RigidBox` take effect when it returns.
#[test]
fn changes_to_an_absent_body_take_effect_when_it_returns() {
    #[rustfmt::skip]
    let away: [(&str, fn(&mut EntityWorldMut), fn(&mut EntityWorldMut)); 2] = [
        ("Disabled", |body| { body.insert(Disabled); }, |body| { body.remove::<Disabled>(); }),
        ("no RigidBox", |body| { body.remove::<RigidBox>(); }, |body| { body.insert(brick()); }),
    ];
    for (name, leave, come_back) in away {
        for touch_neighbor in [false, true] {
            for teleport in [false, true] {
                let mut app = app();
                app.insert_resource(WorldGravity(DVec3::ZERO));
                let start = BodyState::at(DVec3::ONE).with_velocity(DVec3::Z);
                let body = app.spawn((brick(), start));
                let neighbor = app.spawn((brick(), start));
                app.play(3);
                let before = app.state(body);
                leave(&mut app.entity(body));
                app.play(5);
                assert_eq!(app.state(body), before, "{name}: it stays");
                let mut expected = before;
                if teleport {
                    let mut transform = app.edit::<Transform>(body);
                    transform.translation = Vec3::new(7.0, 8.0, 9.0);
                    expected.position = DVec3::new(7.0, 8.0, 9.0);
                }
                app.play(5);
                if touch_neighbor {
                    let mut other = app.edit::<Transform>(neighbor);
                    other.translation.x += 1.0;
                }
                come_back(&mut app.entity(body));
                app.update();
                expected.position += DVec3::Z * super::tick().as_secs_f64();
                let found = app.state(body);
                assert!(
                    (found.position - expected.position).length() < 1e-12
                        && found.velocity == before.velocity,
                    "{name}, {touch_neighbor}, {teleport}: {found:?}, not {expected:?}"
                );
            }
        }
    }
}

#[test]
fn a_body_that_is_spawned_disabled_starts_where_its_transform_says() {
    for moved in [false, true] {
        let mut app = app();
        app.insert_resource(WorldGravity(DVec3::ZERO));
        let place = Transform::from_xyz(1.0, 5.0, 2.0);
        let body = app.spawn((brick(), place, Disabled));
        app.play(10);
        let mut expected = DVec3::new(1.0, 5.0, 2.0);
        if moved {
            expected = DVec3::new(-1.0, 5.0, 2.0);
            *app.edit(body) = Transform::from_translation(expected.as_vec3());
            app.update();
        }
        app.entity(body).remove::<Disabled>();
        for _ in 0..3 {
            app.update();
            assert_eq!(app.state(body).position, expected, "{moved}");
        }
    }
}

/// An impulse sent during a pause waits for the next step or is dropped, as its sender chose.
#[test]
fn impulses_during_a_pause_are_kept_or_dropped_as_chosen() {
    let stops: [fn(&mut World, bool); 3] = [
        |world, stop| world.resource_mut::<PhysicsClock>().paused = stop,
        |world, stop| match stop {
            true => world.resource_mut::<Time<Virtual>>().pause(),
            false => world.resource_mut::<Time<Virtual>>().unpause(),
        },
        |world, stop| {
            let mut time = world.resource_mut::<Time<Virtual>>();
            time.set_relative_speed(if stop { 0.0 } else { 1.0 });
        },
    ];
    for stop in stops {
        let mut app = app();
        app.insert_resource(WorldGravity(DVec3::ZERO))
            .insert_resource(TimeUpdateStrategy::ManualDuration(super::tick()));
        let [kept, dropped] = [(), ()].map(|()| app.spawn((brick(), BodyState::default())));
        app.update();
        stop(app.world_mut(), true);
        app.update();
        for _ in 0..30 {
            let push = ApplyImpulse::center(kept, DVec3::X * 3.0);
            app.send(push);
            let entity = dropped;
            app.send(ApplyImpulse { entity, ..push }.dropped_while_paused());
            app.update();
        }
        assert_eq!(app.state(kept).velocity, DVec3::ZERO);
        stop(app.world_mut(), false);
        app.play(3);
        assert!((app.state(kept).velocity.x - 30.0).abs() < 1e-12);
        assert_eq!(app.state(dropped).velocity, DVec3::ZERO);
        app.send(ApplyImpulse::center(dropped, DVec3::X * 3.0).dropped_while_paused());
        app.play(3);
        assert_eq!(app.state(dropped).velocity, DVec3::X);
    }
}

#[test]
fn a_pending_teleport_is_not_overwritten_by_a_state_written_while_paused() {
    let mut app = app();
    let entity = app.spawn((brick(), tumbling()));
    app.update();
    app.pause();
    app.edit::<Transform>(entity).translation.x = -1.0;
    app.edit::<BodyState>(entity).velocity = DVec3::Z;
    app.update();
    let shown = app.get::<Transform>(entity);
    assert_eq!(shown.translation.x, -1.0);
    app.step(1);
    let after = app.state(entity);
    assert_eq!((after.position.x, after.velocity.z), (-1.0, 1.0));
}
