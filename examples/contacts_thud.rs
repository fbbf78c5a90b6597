//! Plays a sound for every landing, with a volume that depends on its impulse.
//! `cargo run --release --example contacts_thud`

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

/// Volumes for the mixer of a game.
#[derive(Resource, Default)]
struct Thuds(Vec<f64>);

/// Runs once per landing of this body, regardless of the number of corners.
fn thud(landed: On<Landed>, mut thuds: ResMut<Thuds>) {
    println!(
        "thud after {:.2} s at {:.2} m/s: {:.2} N s",
        landed.time, landed.approach_speed, landed.normal_impulse
    );
    thuds.0.push(landed.normal_impulse);
}

fn main() -> Result<(), BevyError> {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(Floor::new(0.0, 0.5, 0.5)?)
        .init_resource::<Thuds>()
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)) // not for a game: one tick per update
        .add_systems(Startup, |mut commands: Commands| {
            let place = Transform::from_xyz(0.0, 2.5, 0.0);
            commands
                .spawn((RigidBox::default(), place, ReportContacts)) // required for landing events
                .observe(thud)
                .observe(|settled: On<Settled>| println!("at rest after {:.2} s", settled.time));
        });
    for _ in 0..200 {
        app.update();
    }
    // After a drop of 2 m the speed is v = √(2 g h), and the impulse of the floor is m v (1 + e). Every bounce is half
    // as fast.
    let thuds = &app.world().resource::<Thuds>().0;
    let expected = (2.0 * 9.81 * 2.0_f64).sqrt() * 1.5;
    assert!((thuds[0] / expected - 1.0).abs() < 0.02, "{}", thuds[0]);
    assert!((thuds[1] / thuds[0] - 0.5).abs() < 0.02);
    Ok(())
}
