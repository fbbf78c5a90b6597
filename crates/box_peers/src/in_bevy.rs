//! Driving a Bevy app: every update is exactly one step of its fixed clock.

use std::time::{Duration, Instant};

use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;

/// Steps of the fixed clock that were made.
#[derive(Resource, Default)]
struct Ticks(u32);

/// Time between the two clocks, which stand round all that a plugin does in a step.
#[derive(Resource, Default)]
pub struct PhysicsTime {
    since: Option<Instant>,
    total: Duration,
}

/// Before it.
pub fn start_clock(mut time: ResMut<PhysicsTime>) {
    time.since = Some(Instant::now());
}

/// After it.
pub fn stop_clock(mut time: ResMut<PhysicsTime>) {
    if let Some(since) = time.since.take() {
        time.total += since.elapsed();
    }
}

/// Puts the clocks round `FixedPostUpdate`: into the schedules before and after it, in which nothing else is.
pub fn clock_fixed_post_update(app: &mut App) {
    app.add_systems(FixedUpdate, start_clock)
        .add_systems(FixedLast, stop_clock);
}

/// An app without window or renderer, in which every `update` is one tick of 1/`rate` s, with what `setup`
/// adds; its clock runs.
pub fn app(rate: u32, setup: impl FnOnce(&mut App)) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .insert_resource(Time::<Fixed>::from_hz(f64::from(rate)))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .init_resource::<Ticks>()
        .init_resource::<PhysicsTime>()
        .add_systems(FixedLast, |mut ticks: ResMut<Ticks>| ticks.0 += 1);
    // Nothing but clocks is in these two: no threads need be woken for them.
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

/// Time spent in physics alone since the app was made.
pub fn physics_time(app: &App) -> Duration {
    app.world().resource::<PhysicsTime>().total
}

/// Time simulated \[s\]: ticks of whole nanoseconds.
pub fn time(app: &App) -> f64 {
    let tick = app.world().resource::<Time<Fixed>>().timestep();
    f64::from(app.world().resource::<Ticks>().0) * tick.as_secs_f64()
}
