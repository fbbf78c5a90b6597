//! Pause, single step, slow motion, and the return to a snapshot. `cargo run --release --example pause_step_back`

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(Floor::default())
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)); // not for a game: one tick per update
    let start = BodyState::at(DVec3::Y * 3.0).with_velocity(DVec3::X);
    let entity = app.world_mut().spawn((RigidBox::default(), start)).id();
    let state = |app: &App| *app.world().get::<BodyState>(entity).expect("a body");
    let run = |app: &mut App, updates: u32| {
        for _ in 0..updates {
            app.update();
        }
    };
    run(&mut app, 40);

    // Pause: frames continue, the physics does not.
    app.world_mut().resource_mut::<PhysicsClock>().paused = true;
    let paused = state(&app);
    run(&mut app, 10);
    assert_eq!(state(&app), paused);

    // A single step, even while paused; it runs immediately.
    app.world_mut().commands().queue(StepPhysics(1));
    app.world_mut().flush();
    assert!(state(&app) != paused);
    println!(
        "one step from {:.4} to {:.4}",
        paused.position,
        state(&app).position
    );

    // Takes a snapshot, runs a second, and restores it: the second run repeats the first bit for bit, including the
    // landing.
    let snapshot = PhysicsSnapshot::take(app.world_mut());
    let future = |app: &mut App| {
        app.world_mut().commands().queue(StepPhysics(60));
        app.world_mut().flush();
        state(app)
    };
    let first = future(&mut app);
    let missing = snapshot.restore(app.world_mut());
    assert!(missing.is_empty(), "no body was despawned since");
    let second = future(&mut app);
    assert_eq!(first, second);
    println!(
        "stepped back and forth: y = {:.4} m both times",
        second.position.y
    );

    // Slow motion: the game clock runs at a quarter of the speed; the step size does not change.
    app.world_mut().resource_mut::<PhysicsClock>().paused = false;
    app.world_mut()
        .resource_mut::<Time<Virtual>>()
        .set_relative_speed(0.25);
    let before = app.world().resource::<PhysicsClock>().steps();
    run(&mut app, 40);
    let taken = app.world().resource::<PhysicsClock>().steps() - before;
    println!("{taken} steps in 40 frames");
    assert_eq!(taken, 10);
}
