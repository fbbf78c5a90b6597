//! Saving and loading. With the feature `serde` the complete state of a body can be written to a file, and the loaded
//! body continues bit for bit. `cargo run --release --example save_load` (in your own project: `box_physics = { …,
//! features = ["serde"] }`).

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;
use serde::{Deserialize, Serialize};

/// One body in a file: the components that you set, and the state that the physics maintains.
#[derive(Serialize, Deserialize, Bundle)]
struct SavedBody {
    body: RigidBox,
    drag: LinearDrag,
    motion: BodySnapshot,
}

#[derive(Serialize, Deserialize)]
struct SavedGame {
    clock: PhysicsClock,
    integrator: GlobalIntegrator,
    gravity: WorldGravity,
    floor: Floor,
    bodies: Vec<SavedBody>,
}

fn save(world: &mut World) -> Result<String, BevyError> {
    let snapshot = PhysicsSnapshot::take(world);
    let mut bodies = world.query::<(&RigidBox, &LinearDrag)>();
    let saved = snapshot.bodies().filter_map(|(entity, motion)| {
        let (body, drag) = bodies.get(world, entity).ok()?;
        let (body, drag, motion) = (*body, *drag, motion.clone());
        Some(SavedBody { body, drag, motion })
    });
    let game = SavedGame {
        bodies: saved.collect(),
        clock: *world.resource(),
        integrator: *world.resource(),
        gravity: *world.resource(),
        floor: *world.resource(),
    };
    // RON preserves every bit of an f64. (JSON does so only with serde_json's `float_roundtrip`.)
    Ok(ron::to_string(&game)?)
}

fn load(world: &mut World, text: &str) -> Result<(), BevyError> {
    let game: SavedGame = ron::from_str(text)?;
    world.insert_resource(game.clock);
    world.insert_resource(game.integrator);
    world.insert_resource(game.gravity);
    world.insert_resource(game.floor);
    world.spawn_batch(game.bodies);
    Ok(())
}

fn new_app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)); // not for a game: one tick per update
    app.update();
    app
}

fn states(app: &mut App) -> Vec<BodyState> {
    let mut bodies = app.world_mut().query::<&BodyState>();
    bodies.iter(app.world()).copied().collect()
}

fn main() -> Result<(), BevyError> {
    let mut first = new_app();
    first
        .insert_resource(Floor::default())
        .insert_resource(GlobalIntegrator(Integrator::Exact));
    for k in 0_u8..8 {
        let k = f64::from(k);
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 1.0 + k)?;
        let state = BodyState::at(DVec3::new(2.0 * k, 1.0 + k, 0.0))
            .with_angular_velocity(&body, DVec3::new(1.0, 2.0, k));
        first.world_mut().spawn((body, state, LinearDrag(0.1 * k)));
    }
    for _ in 0..100 {
        first.update();
    }

    let text = save(first.world_mut())?;
    println!("{} bytes", text.len());
    let mut second = new_app();
    load(second.world_mut(), &text)?;
    for _ in 0..200 {
        first.update();
        second.update();
        assert_eq!(states(&mut first), states(&mut second));
    }
    println!("200 further steps: the same, bit for bit");

    // Loading checks the values.
    let bad = ron::from_str::<RigidBox>("(half_extents: (1, -1, 1), mass: 1)");
    assert!(bad.is_err());
    if let Err(error) = bad {
        println!("a bad file: {error}");
    }
    Ok(())
}
