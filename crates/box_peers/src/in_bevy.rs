//! A Bevy app in which every update is exactly one step of the fixed clock.

use std::time::{Duration, Instant};

use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;

/// Number of steps of the fixed clock.
#[derive(Resource, Default)]
struct Ticks(u32);

/// Time between the two clock systems, which enclose the work of a plugin in a step.
#[derive(Resource, Default)]
pub struct PhysicsTime {
    since: Option<Instant>,
    total: Duration,
}

/// Runs before the physics.
pub fn start_clock(mut time: ResMut<PhysicsTime>) {
    time.since = Some(Instant::now());
}

/// Runs after the physics.
pub fn stop_clock(mut time: ResMut<PhysicsTime>) {
    if let Some(since) = time.since.take() {
        time.total += since.elapsed();
    }
}

/// Adds the clock systems around `FixedPostUpdate`: in the schedules before and after it, which contain nothing else.
pub fn clock_fixed_post_update(app: &mut App) {
    app.add_systems(FixedUpdate, start_clock)
        .add_systems(FixedLast, stop_clock);
}

/// Creates an app without window or renderer in which every `update` is one tick of 1/`rate` s, with the additions of
/// `setup`. Its clock is started.
pub fn app(rate: u32, setup: impl FnOnce(&mut App)) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .insert_resource(Time::<Fixed>::from_hz(f64::from(rate)))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .init_resource::<Ticks>()
        .init_resource::<PhysicsTime>()
        .add_systems(FixedLast, |mut ticks: ResMut<Ticks>| ticks.0 += 1);
    // These two contain only the clock systems, so no threads need to be woken for them.
    for label in [FixedUpdate.intern(), FixedLast.intern()] {
        app.edit_schedule(label, |schedule| {
            schedule.set_executor(SingleThreadedExecutor::new());
        });
    }
    setup(&mut app);
    app.finish();
    app.cleanup();
    // The first update only starts the clock.
    app.update();
    app.world_mut().resource_mut::<Ticks>().0 = 0;
    app
}

/// Time spent in physics since the app was created.
pub fn physics_time(app: &App) -> Duration {
    app.world().resource::<PhysicsTime>().total
}

/// Simulated time \[s\]: ticks of whole nanoseconds.
pub fn time(app: &App) -> f64 {
    let tick = app.world().resource::<Time<Fixed>>().timestep();
    f64::from(app.world().resource::<Ticks>().0) * tick.as_secs_f64()
}
