//! Physics at 20 Hz and frames at 144 Hz without stutter: `bevy_transform_interpolation` interpolates between
//! the steps, with one component per body. `cargo run --release --example other_rate_interpolation`

use core::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_transform_interpolation::prelude::*;
use box_physics::prelude::*;

fn main() {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        PhysicsPlugins::default(),
        TransformInterpolationPlugin::default(),
    ))
    .insert_resource(Time::<Fixed>::from_hz(20.0))
    .insert_resource(WorldGravity(DVec3::ZERO))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
        1.0 / 144.0,
    )));
    // `App::run` does this. The example calls `update` itself to check every frame.
    app.finish();
    app.cleanup();
    let moving = BodyState::default().with_velocity(DVec3::X * 3.0);
    let world = app.world_mut();
    let smooth = world
        .spawn((RigidBox::default(), moving, TransformInterpolation))
        .id();
    let stepping = world.spawn((RigidBox::default(), moving)).id();

    let x = |app: &App, entity| {
        let transform = app.world().get::<Transform>(entity).expect("required");
        transform.translation.x
    };
    let (mut before, mut widest, mut narrowest) = ([0.0; 2], [0.0_f32; 2], [f32::MAX; 2]);
    for frame in 0..144 {
        app.update();
        let now = [x(&app, smooth), x(&app, stepping)];
        // The first two steps fill the interpolation.
        if frame > 20 {
            for k in 0..2 {
                widest[k] = widest[k].max(now[k] - before[k]);
                narrowest[k] = narrowest[k].min(now[k] - before[k]);
            }
        }
        before = now;
    }
    println!(
        "a frame moves it by {:.4} to {:.4} m; without interpolation by {:.4} to {:.4} m",
        narrowest[0], widest[0], narrowest[1], widest[1]
    );
    // Each frame moves by the same 3/144 m, although the physics steps in only one frame of seven.
    assert!((widest[0] * 144.0 / 3.0 - 1.0).abs() < 1e-3);
    assert!((narrowest[0] * 144.0 / 3.0 - 1.0).abs() < 1e-3);
    assert!(narrowest[1] == 0.0 && widest[1] > 0.1);
    // The physics is unaffected by writes to its Transform in every frame.
    let world = app.world();
    assert_eq!(
        world.get::<BodyState>(smooth),
        world.get::<BodyState>(stepping)
    );
}
