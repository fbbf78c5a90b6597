//! Scene reset: despawns all entities of the scene and resets the clock. The second run repeats the first.
//! `cargo run --release --example reset_despawn`

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::digest::state_digest;
use box_physics::prelude::*;

fn spawn_scene(commands: &mut Commands) {
    for k in 0_u8..20 {
        let k = f32::from(k);
        commands.spawn((
            RigidBox::default(),
            Transform::from_xyz(2.0 * k, 1.0 + 0.3 * k, 0.0)
                .with_rotation(Quat::from_rotation_z(0.2 * k)),
        ));
    }
}

/// Resets the scene, as a reset button would.
fn reset(
    mut commands: Commands,
    boxes: Query<Entity, With<RigidBox>>,
    mut clock: ResMut<PhysicsClock>,
) {
    for entity in &boxes {
        commands.entity(entity).despawn();
    }
    clock.reset();
    spawn_scene(&mut commands);
}

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(Floor::default())
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)); // not for a game: one tick per update
    // The first update only starts the clocks.
    app.update();
    let mut digests = Vec::new();
    for run in 0..3 {
        app.world_mut()
            .run_system_cached(reset)
            .expect("a system without conditions");
        for _ in 0..120 {
            app.update();
        }
        let mut boxes = app.world_mut().query::<&BodyState>();
        let digest = state_digest(boxes.iter(app.world()));
        let steps = app.world().resource::<PhysicsClock>().steps();
        println!("run {run}: {steps} steps, states {digest:016x}");
        digests.push((steps, digest));
    }
    assert!(digests.iter().all(|d| *d == digests[0]));
}
