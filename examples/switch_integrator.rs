//! The numerical integrator is a resource that you can change at any time; the motion continues from the current state.
//! `cargo run --release --example switch_integrator`

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

fn main() -> Result<(), BevyError> {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(WorldGravity(DVec3::ZERO))
        // Not for a game: every update is exactly one tick, so the example does not wait.
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));

    // A tumbling brick, whose rotational energy depends strongly on the integrator.
    let brick = RigidBox::new(Vec3::new(0.5, 0.25, 0.125), 3.0)?;
    let spin = DVec3::new(1.5, 2.5, 1.0);
    let start = BodyState::default().with_angular_velocity(&brick, spin);
    let entity = app.world_mut().spawn((brick, start)).id();
    let energy = |app: &App| {
        let state = app.world().get::<BodyState>(entity).expect("a body");
        state.rotational_energy(&brick) / start.rotational_energy(&brick) - 1.0
    };

    for integrator in [
        Integrator::Split,
        Integrator::Exact,
        Integrator::SemiImplicitEuler,
    ] {
        app.insert_resource(GlobalIntegrator(integrator));
        let before = energy(&app);
        for _ in 0..600 {
            app.update();
        }
        let change = energy(&app) - before;
        println!("{integrator:>20}: energy changed by {change:+.1e} in 600 steps");
        if integrator != Integrator::SemiImplicitEuler {
            assert!(change.abs() < 1e-2);
        }
    }
    Ok(())
}
