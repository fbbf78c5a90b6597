//! Simulation far from the origin. The state is f64, so the physics works as well at 10 000 km as at the origin; only
//! the f32 of `Transform` loses precision. Draw relative to an origin that follows the player: the system below does in
//! ten lines what `big_space` does with its grid cells. `cargo run --release --example floating_origin`

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

/// World position of the rendering origin \[m\].
#[derive(Resource, Default)]
struct Origin(DVec3);

/// Marks the body that the camera follows.
#[derive(Component)]
struct Player;

/// Visual entity of a body, separate from it so that the physics keeps control of the body's `Transform`.
#[derive(Component)]
struct PictureOf(Entity);

/// Moves the origin with the player in steps of a kilometer, and places the visual entities relative to it.
fn draw(
    player: Single<&BodyState, With<Player>>,
    bodies: Query<&BodyState>,
    mut origin: ResMut<Origin>,
    mut pictures: Query<(&PictureOf, &mut Transform)>,
) {
    if (player.position - origin.0).abs().max_element() > 1000.0 {
        origin.0 = (player.position / 1000.0).round() * 1000.0;
    }
    for (of, mut transform) in &mut pictures {
        if let Ok(state) = bodies.get(of.0) {
            transform.translation = (state.position - origin.0).as_vec3();
            transform.rotation = state.rotation.as_quat();
        }
    }
}

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .init_resource::<Origin>()
        .insert_resource(WorldGravity(DVec3::ZERO))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)) // not for a game: one tick per update
        .add_systems(PostUpdate, draw);
    let far = DVec3::new(1e7, 0.0, -1e7);
    let drifting = BodyState::at(far).with_velocity(DVec3::X * 1e-3);
    let body = app
        .world_mut()
        .spawn((Player, RigidBox::default(), drifting))
        .id();
    let picture = app
        .world_mut()
        .spawn((PictureOf(body), Transform::default()))
        .id();
    app.update();
    for _ in 0..640 {
        app.update();
    }
    let world = app.world();
    let moved = world.get::<BodyState>(body).expect("a body").position.x - far.x;
    let [shown, own] =
        [picture, body].map(|e| world.get::<Transform>(e).expect("spawned so").translation.x);
    println!("in 10 s at 1 mm/s: moved {moved:.6} m");
    println!("its visual is at {shown:.6} m, its own Transform at {own} m, with a spacing of 1 m");
    assert!((moved - 0.01).abs() < 1e-6);
    assert!((f64::from(shown) - moved).abs() < 1e-6);
}
