//! Thousands of boxes fall onto the floor. `cargo run --release --example thousands -- 10000`

use std::time::Instant;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

fn main() -> Result<(), BevyError> {
    let count: u32 = match std::env::args().nth(1) {
        Some(text) => text.parse()?,
        None => 5000,
    };
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(Floor::default())
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)); // not for a game: one tick per update
    let side = f64::from(count).sqrt().ceil();
    let bodies = (0..count).map(|k| {
        let k = f64::from(k);
        let (row, column) = ((k / side).floor(), k % side);
        let body = RigidBox::default();
        let spin = DVec3::new((k * 0.7) % 5.0, (k * 1.1) % 3.0, (k * 0.3) % 4.0);
        let place = DVec3::new(2.0 * column, 2.0 + k % 7.0, 2.0 * row);
        (
            body,
            BodyState::at(place).with_angular_velocity(&body, spin),
        )
    });
    app.world_mut().spawn_batch(bodies.collect::<Vec<_>>());

    let steps = 120;
    let start = Instant::now();
    for _ in 0..steps {
        app.update();
    }
    let each = start.elapsed().as_secs_f64() * 1e9 / f64::from(count) / f64::from(steps);
    println!("{count} boxes, {steps} steps: {each:.0} ns per box and step, everything included");

    let mut boxes = app.world_mut().query::<(&RigidBox, &BodyState)>();
    let lowest = boxes
        .iter(app.world())
        .flat_map(|(body, state)| {
            box_physics::aabb::corners(body.half_extents()).map(|c| state.point(c).y)
        })
        .fold(f64::MAX, f64::min);
    println!("the lowest corner of all is at {lowest:.1e} m");
    assert!(lowest > -1e-9);
    Ok(())
}
