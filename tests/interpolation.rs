//! Physics at one rate and frames at another, interpolated by `bevy_transform_interpolation`: motion does not
//! stutter, and the physics is unaffected.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_transform_interpolation::prelude::*;
use box_physics::prelude::*;

mod world;

use world::{Play, brick};

fn app(physics_hz: f64, frames_hz: f64) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        PhysicsPlugins::default(),
        TransformInterpolationPlugin::default(),
    ))
    .insert_resource(WorldGravity(DVec3::ZERO))
    .insert_resource(Time::<Fixed>::from_hz(physics_hz))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
        1.0 / frames_hz,
    )));
    app.finish();
    app.cleanup();
    app.update();
    app
}

fn moving() -> BodyState {
    BodyState::at(DVec3::new(0.1, 0.2, 0.3))
        .with_velocity(DVec3::X * 3.0)
        .with_angular_velocity(&brick(), DVec3::Y * 2.0)
}

fn spawn(app: &mut App) -> [Entity; 2] {
    let smooth = app.spawn((brick(), moving(), TransformInterpolation));
    [smooth, app.spawn((brick(), moving()))]
}

fn transform(app: &App, entity: Entity) -> Transform {
    *app.world().get(entity).expect("required")
}

#[test]
fn every_frame_moves_and_turns_by_the_same() {
    for (physics, frames) in [(20.0, 144.0), (60.0, 144.0), (50.0, 60.0), (128.0, 30.0)] {
        let mut app = app(physics, frames);
        let [smooth, plain] = spawn(&mut app);
        let mut before = transform(&app, smooth);
        for frame in 0..200 {
            app.update();
            let now = transform(&app, smooth);
            if f64::from(frame) > 3.0 * frames / physics + 3.0 {
                let moved = f64::from(now.translation.x - before.translation.x) * frames / 3.0;
                // f32 at up to 20 m, over frames of 2 cm.
                assert!(
                    (moved - 1.0).abs() < 1e-3,
                    "{physics} at {frames} Hz: {moved}"
                );
                let turned = f64::from(now.rotation.angle_between(before.rotation)) * frames / 2.0;
                assert!(
                    (turned - 1.0).abs() < 3e-2,
                    "{physics} at {frames} Hz: {turned}"
                );
            }
            before = now;
        }
        assert_eq!(
            app.state(smooth),
            app.state(plain),
            "the motion itself is the same"
        );
    }
}

#[test]
fn single_steps_between_two_frames_are_no_teleports() {
    for pause_virtual_time in [false, true] {
        let mut app = app(20.0, 144.0);
        let [smooth, plain] = spawn(&mut app);
        app.play(30);
        assert_ne!(
            transform(&app, smooth),
            transform(&app, plain),
            "drawn somewhere between two steps"
        );
        if pause_virtual_time {
            app.world_mut().resource_mut::<Time<Virtual>>().pause();
        } else {
            app.pause();
        }
        for _ in 0..5 {
            for steps in [1, 3] {
                app.step(steps);
                assert_eq!(app.state(smooth), app.state(plain));
            }
            app.update();
        }
        app.world_mut().resource_mut::<Time<Virtual>>().unpause();
        app.world_mut().resource_mut::<PhysicsClock>().paused = false;
        for _ in 0..30 {
            app.update();
            assert_eq!(app.state(smooth), app.state(plain));
        }
        let steps = app.clock().steps();
        let expected = moving().position.x + 3.0 * steps as f64 / 20.0;
        assert!((app.state(smooth).position.x - expected).abs() < 1e-9);
    }
}

#[test]
fn a_teleport_is_not_interpolated() {
    let mut app = app(20.0, 144.0);
    let [smooth, _] = spawn(&mut app);
    app.play(30);
    app.edit::<Transform>(smooth).translation = Vec3::new(0.0, 100.0, 0.0);
    for _ in 0..30 {
        app.update();
        let height = transform(&app, smooth).translation.y;
        assert!((height - 100.0).abs() < 1e-3, "{height}");
    }
    assert_eq!(app.state(smooth).position.y, 100.0);
    assert_eq!(app.state(smooth).velocity, DVec3::X * 3.0);
}

/// With and without smoothing, at any rates: a teleport is displayed in its own frame, is never lost, and is
/// not interpolated. The same holds for a written state.
#[test]
fn a_teleport_is_neither_lost_nor_interpolated() {
    #[derive(Resource, Clone, Copy)]
    enum Jump {
        Teleport,
        State,
        EarlyState,
    }
    #[derive(Resource)]
    struct Now(bool);
    fn jump(
        mut bodies: Query<(Entity, &mut BodyState)>,
        kind: Res<Jump>,
        mut now: ResMut<Now>,
        mut commands: Commands,
    ) {
        if !std::mem::take(&mut now.0) {
            return;
        }
        for (entity, mut state) in &mut bodies {
            let there = state.position.with_y(50.0);
            match *kind {
                Jump::Teleport => commands.queue(Teleport::to(entity, there)),
                Jump::State | Jump::EarlyState => state.position = there,
            }
        }
    }
    for (physics, frames) in [(64.0, 60.0), (64.0, 30.0), (64.0, 144.0), (20.0, 144.0)] {
        for kind in [Jump::Teleport, Jump::State, Jump::EarlyState] {
            for start in 20..40 {
                let mut app = app(physics, frames);
                let early = matches!(kind, Jump::EarlyState);
                app.insert_resource(kind).insert_resource(Now(false));
                if early {
                    app.add_systems(PreUpdate, jump);
                } else {
                    app.add_systems(Update, jump);
                }
                let [smooth, plain] = spawn(&mut app);
                app.play(start);
                app.world_mut().resource_mut::<Now>().0 = true;
                let before = app.state(smooth);
                let mut last = transform(&app, smooth).translation.x;
                for frame in 0..30 {
                    app.update();
                    let (y, x) = {
                        let shown = transform(&app, smooth).translation;
                        (shown.y, shown.x)
                    };
                    assert!(
                        (y - 50.0).abs() < 1e-4,
                        "{physics}, {frames}, {frame}: {y} m"
                    );
                    // At most two ticks ahead, and never back by more than one.
                    let ahead = f64::from(x - last);
                    let (tick, step) = (3.0 / physics, 3.0 / frames);
                    assert!(ahead > -tick - 1e-4 && ahead < 2.0 * tick + step + 1e-4);
                    last = x;
                    assert_eq!(app.state(smooth), app.state(plain));
                }
                let after = app.state(smooth);
                assert_eq!(after.position.y, 50.0, "{physics}, {frames}");
                assert!(after.position.x > before.position.x);
                assert_eq!(after.velocity, before.velocity);
            }
        }
    }
}

/// A new body is not interpolated from the origin, even with a slow clock.
#[test]
fn a_new_body_is_not_interpolated_from_the_origin() {
    let mut app = app(30.0, 60.0);
    app.world_mut()
        .resource_mut::<Time<Virtual>>()
        .set_relative_speed(0.1);
    app.play(7);
    let start = BodyState::at(DVec3::new(3.0, 5.0, -2.0));
    let entity = app.spawn((brick(), start, TransformInterpolation));
    for _ in 0..100 {
        app.update();
        let shown = transform(&app, entity).translation;
        assert!(
            (shown - Vec3::new(3.0, 5.0, -2.0)).length() < 1e-5,
            "{shown}"
        );
    }
}

/// A body that is disabled while it is interpolated stays at the result of the last step.
#[test]
fn a_smoothed_body_that_is_disabled_does_not_move() {
    use bevy::ecs::entity_disabling::Disabled;
    for frames in 0..12 {
        let mut app = app(20.0, 144.0);
        let [smooth, _] = spawn(&mut app);
        for _ in 0..30 + frames {
            app.update();
        }
        let before = app.state(smooth);
        app.entity(smooth).insert(Disabled);
        app.play(20);
        assert_eq!(
            transform(&app, smooth).translation,
            before.position.as_vec3()
        );
        app.entity(smooth).remove::<Disabled>();
        assert_eq!(app.state(smooth), before);
        // Enabled again, it continues from there.
        let steps = app.clock().steps();
        app.play(20);
        let taken = app.clock().steps() - steps;
        let expected = before.position + before.velocity * (taken as f64 / 20.0);
        assert!((app.state(smooth).position - expected).length() < 1e-9);
    }
}
