//! Physics at one rate, frames at another, drawn between the steps by `bevy_transform_interpolation`:
//! no stutter, and the physics does not notice.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_transform_interpolation::prelude::*;
use box_physics::prelude::*;

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

fn brick() -> RigidBox {
    RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid")
}

fn moving() -> BodyState {
    BodyState::at(DVec3::new(0.1, 0.2, 0.3))
        .with_velocity(DVec3::X * 3.0)
        .with_angular_velocity(&brick(), DVec3::Y * 2.0)
}

fn spawn(app: &mut App) -> [Entity; 2] {
    let world = app.world_mut();
    let smooth = world
        .spawn((brick(), moving(), TransformInterpolation))
        .id();
    [smooth, world.spawn((brick(), moving())).id()]
}

fn transform(app: &App, entity: Entity) -> Transform {
    *app.world().get(entity).expect("required")
}

fn state(app: &App, entity: Entity) -> BodyState {
    *app.world().get(entity).expect("a body")
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
            state(&app, smooth),
            state(&app, plain),
            "the motion itself is the same"
        );
    }
}

#[test]
fn single_steps_between_two_frames_are_no_teleports() {
    for pause_virtual_time in [false, true] {
        let mut app = app(20.0, 144.0);
        let [smooth, plain] = spawn(&mut app);
        for _ in 0..30 {
            app.update();
        }
        assert_ne!(
            transform(&app, smooth),
            transform(&app, plain),
            "drawn somewhere between two steps"
        );
        if pause_virtual_time {
            app.world_mut().resource_mut::<Time<Virtual>>().pause();
        } else {
            app.world_mut().resource_mut::<PhysicsClock>().paused = true;
        }
        for _ in 0..5 {
            for steps in [1, 3] {
                app.world_mut().commands().queue(StepPhysics(steps));
                app.world_mut().flush();
                assert_eq!(state(&app, smooth), state(&app, plain));
            }
            app.update();
        }
        app.world_mut().resource_mut::<Time<Virtual>>().unpause();
        app.world_mut().resource_mut::<PhysicsClock>().paused = false;
        for _ in 0..30 {
            app.update();
            assert_eq!(state(&app, smooth), state(&app, plain));
        }
        let steps = app.world().resource::<PhysicsClock>().steps();
        let expected = moving().position.x + 3.0 * steps as f64 / 20.0;
        assert!((state(&app, smooth).position.x - expected).abs() < 1e-9);
    }
}

#[test]
fn a_teleport_is_taken_and_not_drawn_as_a_flight() {
    let mut app = app(20.0, 144.0);
    let [smooth, _] = spawn(&mut app);
    for _ in 0..30 {
        app.update();
    }
    app.world_mut()
        .get_mut::<Transform>(smooth)
        .expect("required")
        .translation = Vec3::new(0.0, 100.0, 0.0);
    for _ in 0..30 {
        app.update();
        let height = transform(&app, smooth).translation.y;
        assert!((height - 100.0).abs() < 1e-3, "{height}");
    }
    assert_eq!(state(&app, smooth).position.y, 100.0);
    assert_eq!(state(&app, smooth).velocity, DVec3::X * 3.0);
}
