//! A sound for every landing, as loud as it was hard. `cargo run --release --example contacts_thud`

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

/// What a game would hand to its mixer.
#[derive(Resource, Default)]
struct Thuds(Vec<f64>);

/// The impulses of all corners that began to touch in this step make one thud.
fn listen(mut contacts: MessageReader<FloorContact>, mut thuds: ResMut<Thuds>) {
    let impulse: f64 = contacts
        .read()
        .filter(|contact| contact.phase == ContactPhase::Began)
        .map(|contact| contact.normal_impulse)
        .sum();
    if impulse > 0.2 {
        println!("thud: {impulse:.2} N s");
        thuds.0.push(impulse);
    }
}

fn main() -> Result<(), BevyError> {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(Floor::new(0.0, 0.5, 0.5)?)
        .init_resource::<Thuds>()
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)) // not in a game: a tick an update
        .add_systems(FixedLast, listen)
        .add_systems(Startup, |mut commands: Commands| {
            commands.spawn((
                RigidBox::default(),
                Transform::from_xyz(0.0, 2.5, 0.0),
                ReportContacts, // without it nobody collects contacts
            ));
        });
    for _ in 0..200 {
        app.update();
    }
    // Dropped by 2 m: v = √(2 g h), and the floor gives m v (1 + e). Every bounce is half as fast.
    let thuds = &app.world().resource::<Thuds>().0;
    let expected = (2.0 * 9.81 * 2.0_f64).sqrt() * 1.5;
    assert!((thuds[0] / expected - 1.0).abs() < 0.02, "{}", thuds[0]);
    assert!((thuds[1] / thuds[0] - 0.5).abs() < 0.02);
    Ok(())
}
