//! One body with its own integrator: a stiff spring uses an implicit integrator, and the other bodies the default.
//! `cargo run --release --example per_body_integrator`

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)) // not for a game: one tick per update
        .add_systems(Startup, spawn);
    for _ in 0..300 {
        app.update();
    }
    let mut boxes = app
        .world_mut()
        .query::<(&Name, &BodyState, Option<&BodyIntegrator>)>();
    for (name, state, own) in boxes.iter(app.world()) {
        let integrator = own.map_or("the global one".to_owned(), |own| own.0.to_string());
        println!("{name}: {integrator}, y = {:.6} m", state.position.y);
        if name.as_str() == "on a stiff spring" {
            // It hangs where the spring supports its weight: m g/k = 9.81 µm below the anchor.
            assert!((5.0 - state.position.y - 9.81e-6).abs() < 1e-9);
        }
    }
}

fn spawn(mut commands: Commands) {
    commands.spawn((
        Name::new("falls freely"),
        RigidBox::default(),
        BodyState::at(Vec3::Y * 100.0),
    ));
    // √(k/m)·dt = 16 here; explicit integrators have a limit of 2.
    let spring = Spring {
        body_point: DVec3::ZERO,
        anchor: DVec3::Y * 5.0,
        stiffness: 1e6,
        damping: 100.0,
    };
    commands.spawn((
        Name::new("on a stiff spring"),
        RigidBox::default(),
        BodyState::at(Vec3::Y * 5.0),
        Springs(vec![spring]),
        BodyIntegrator(Integrator::BackwardEuler),
    ));
}
