//! Driving a Bevy app: every update is exactly one step of its fixed clock.

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;

/// Steps of the fixed clock that were made.
#[derive(Resource, Default)]
struct Ticks(u32);

/// An app without window or renderer, in which every `update` is one tick of 1/`rate` s, with what `setup`
/// adds; its clock runs.
pub fn app(rate: u32, setup: impl FnOnce(&mut App)) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .insert_resource(Time::<Fixed>::from_hz(f64::from(rate)))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .init_resource::<Ticks>()
        .add_systems(FixedLast, |mut ticks: ResMut<Ticks>| ticks.0 += 1);
    setup(&mut app);
    app.finish();
    app.cleanup();
    // The first update only starts the clock.
    app.update();
    app.world_mut().resource_mut::<Ticks>().0 = 0;
    app
}

/// Time simulated \[s\]: ticks of whole nanoseconds.
pub fn time(app: &App) -> f64 {
    let tick = app.world().resource::<Time<Fixed>>().timestep();
    f64::from(app.world().resource::<Ticks>().0) * tick.as_secs_f64()
}
