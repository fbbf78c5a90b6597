//! Moving a body directly: once (a teleport), or every step (a kinematic body that follows a path).
//! `cargo run --release --example teleport_kinematic`

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

/// Marks a body that follows a path instead of the forces.
#[derive(Component)]
struct Elevator;

/// Moves kinematic bodies, which have no gravity and whose position and velocity you set before every step. The
/// velocity is chosen so that the step ends on the path.
fn lift(clock: Res<PhysicsClock>, mut elevators: Query<&mut BodyState, With<Elevator>>) {
    // `time` is the end of this step; this is its start.
    let begin = clock.time() - clock.step();
    for mut state in &mut elevators {
        let height = |t: f64| 2.0 + 0.5 * t; // m: half a meter a second
        state.position.y = height(begin);
        state.velocity = DVec3::Y * (height(clock.time()) - height(begin)) / clock.step();
        state.angular_momentum = DVec3::ZERO;
    }
}

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)) // not for a game: one tick per update
        .add_systems(PhysicsSchedule, lift.in_set(PhysicsSystems::First));
    let elevator = app
        .world_mut()
        .spawn((Elevator, RigidBox::default(), GravityScale(0.0)))
        .id();
    let stone = app
        .world_mut()
        .spawn((RigidBox::default(), Transform::from_xyz(5.0, 50.0, 0.0)))
        .id();
    for _ in 0..65 {
        app.update();
    }
    let time = app.world().resource::<PhysicsClock>().time();
    let state = |app: &App, entity| *app.world().get::<BodyState>(entity).expect("a body");
    let height = state(&app, elevator).position.y;
    println!("after {time} s the elevator is at {height:.3} m");
    assert!((height - (2.0 + 0.5 * time)).abs() < 1e-12);

    // A teleport keeps the velocity. (From a system: `commands.queue(…)`.)
    let before = state(&app, stone);
    let elsewhere = Teleport::to(stone, Vec3::new(-5.0, 10.0, 0.0));
    app.world_mut().commands().queue(elsewhere);
    app.update();
    let after = state(&app, stone);
    println!(
        "teleported from {:.2} to {:.2}, still falling at {:.2} m/s",
        before.position, after.position, after.velocity.y
    );
    assert!(after.position.x == -5.0 && after.velocity.y < before.velocity.y);

    // To stop the body as well, set the state, which is f64 and includes velocities.
    *app.world_mut().get_mut(stone).expect("a body") = BodyState::at(DVec3::Y * 3.0);
}
