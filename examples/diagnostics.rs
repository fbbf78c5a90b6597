//! Timings and energies in Bevy's `DiagnosticsStore`: the plugin publishes its timings, and your own system
//! adds other values. `cargo run --release --example diagnostics`

use bevy::diagnostic::{
    Diagnostic, DiagnosticPath, Diagnostics, DiagnosticsStore, RegisterDiagnostic,
};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::energy::total_energy;
use box_physics::force::Forces;
use box_physics::plugin::{Stage, integrator_path};
use box_physics::prelude::*;

const ENERGY: DiagnosticPath = DiagnosticPath::const_new("my_game/energy");

/// Measures the total energy after each step.
fn measure(
    bodies: Query<(&RigidBox, &BodyState)>,
    gravity: Res<WorldGravity>,
    mut diagnostics: Diagnostics,
) {
    let law = Forces {
        acceleration: gravity.0,
        ..default()
    };
    diagnostics.add_measurement(&ENERGY, || {
        bodies.iter().map(|(b, s)| total_energy(b, s, &law)).sum()
    });
}

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)) // not for a game: one tick per update
        .register_diagnostic(Diagnostic::new(ENERGY).with_suffix(" J"))
        .add_systems(PhysicsSchedule, measure.in_set(PhysicsSystems::Last));
    app.world_mut().spawn_batch(
        (0_u8..100).map(|k| (RigidBox::default(), BodyState::at(DVec3::Y * f64::from(k)))),
    );
    for _ in 0..60 {
        app.update();
    }

    let store = app.world().resource::<DiagnosticsStore>();
    let value = |path: &DiagnosticPath| store.get(path).and_then(Diagnostic::average);
    println!(
        "a step: {:.1} µs",
        value(&PhysicsDiagnosticsPlugin::STEP).unwrap_or(f64::NAN)
    );
    for stage in Stage::ALL {
        println!(
            "  {:?}: {:.1} µs",
            stage,
            value(&stage.path()).unwrap_or(f64::NAN)
        );
    }
    let split = value(&integrator_path(Integrator::Split));
    println!(
        "split: {:.1} ns per body and step",
        split.unwrap_or(f64::NAN)
    );
    let energy = value(&ENERGY).expect("measured");
    println!("energy: {energy:.3} J");
    // Free fall conserves energy: Σ m g y = 9.81 · 4950 J.
    assert!((energy / (9.81 * 4950.0) - 1.0).abs() < 1e-9);
    assert!(split.is_some_and(|ns| ns > 0.0));
}
