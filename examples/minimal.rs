//! One box falls on the floor, without a window. `cargo run --release --example minimal`

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(Floor::default())
        .add_systems(Startup, |mut commands: Commands| {
            commands.spawn((RigidBox::default(), Transform::from_xyz(0.0, 3.0, 0.0)));
        })
        // Not for a game: every update is exactly one tick, so the example does not wait.
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));

    for _ in 0..3 {
        for _ in 0..64 {
            app.update();
        }
        let mut boxes = app.world_mut().query::<(&Transform, &BodyState)>();
        for (transform, state) in boxes.iter(app.world()) {
            println!(
                "y = {:.3} m, v = {:.3} m/s",
                transform.translation.y, state.velocity.y
            );
        }
    }
    // A cube of 1 m that fell 2.5 m rests on the floor after three seconds.
    let mut boxes = app.world_mut().query::<&Transform>();
    assert!(boxes.iter(app.world()).all(|t| t.translation.y == 0.5));
}
