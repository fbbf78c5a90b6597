//! Bodies in scene literals: a function returns a scene, and other code patches it. No window.
//! `cargo run --release --example scene_literal`

use bevy::asset::AssetPlugin;
use bevy::prelude::*;
use bevy::scene::ScenePlugin;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

/// A crate of 1 m and 10 kg that falls through air. `template_value` accepts a value created in Rust, for boxes of
/// other sizes.
fn crate_in_air() -> impl Scene {
    let body = RigidBox::new(DVec3::splat(0.5), 10.0).expect("sizes and mass in range");
    bsn! {
        template_value(body)
        LinearDrag(2.0)
        QuadraticDrag(0.5)
        ReportContacts
    }
}

fn setup(mut commands: Commands) {
    commands.spawn_scene(bsn! {
        #Dropped
        crate_in_air()
        Transform { translation: Vec3 { y: 5.0 } }
    });
    commands.spawn_scene(bsn! {
        #Thrown
        crate_in_air()
        BodyState { position: DVec3 { y: 2.0 }, velocity: DVec3 { x: 3.0, y: 4.0 } }
        BodyIntegrator(Integrator::Rk4)
        QuadraticDrag(0.0)
    });
}

fn main() {
    let mut app = App::new();
    // DefaultPlugins include assets and scenes.
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), ScenePlugin))
        .add_plugins(PhysicsPlugins::default())
        .insert_resource(Floor::default())
        .add_systems(Startup, setup)
        // Not for a game: every update is exactly one tick, so the example does not wait.
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    for _ in 0..128 {
        app.update();
    }
    let mut bodies = app.world_mut().query::<(&Name, &BodyState)>();
    let mut seen = 0;
    for (name, state) in bodies.iter(app.world()) {
        println!(
            "{name}: x = {:.3} m, y = {:.3} m",
            state.position.x, state.position.y
        );
        assert!(
            (state.position.y - 0.5).abs() < 1e-6,
            "it rests on the floor"
        );
        seen += 1;
    }
    assert_eq!(seen, 2);
}
