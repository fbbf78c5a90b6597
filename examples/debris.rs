//! A tower of 10 000 bricks with a bomb inside. Space detonates the bomb, R rebuilds the tower.
//! `cargo run --release --example debris`

use std::time::Duration;

use bevy::prelude::*;
use box_physics::prelude::*;

/// Number of bricks along x, y and z.
const TOWER: [u16; 3] = [20, 25, 20];
/// Half-extents of a brick [m].
const BRICK: DVec3 = DVec3::new(0.2, 0.1, 0.2);
const BOMB: Explosion = Explosion {
    center: DVec3::new(0.0, 1.0, 0.0),
    radius: 9.0,    // m
    impulse: 260.0, // N s
    falloff: 2.0,
};

/// Snapshot of the tower before the explosion.
#[derive(Resource)]
struct Before(PhysicsSnapshot);

fn main() -> Result<(), BevyError> {
    App::new()
        .add_plugins((DefaultPlugins, PhysicsPlugins::default()))
        .insert_resource(Floor::new(0.0, 0.3, 0.6)?)
        .insert_resource(Time::<Fixed>::from_hz(60.0))
        .insert_resource(ClearColor(Color::srgb(0.45, 0.55, 0.65)))
        .add_systems(Startup, (setup, keep).chain())
        .add_systems(Update, (explode, rebuild, show))
        .run();
    Ok(())
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut clock: ResMut<PhysicsClock>,
    mut gizmos: ResMut<GizmoConfigStore>,
) -> Result {
    // Draws the text in front of the bricks.
    gizmos.config_mut::<DefaultGizmoConfigGroup>().0.depth_bias = -1.0;
    // Bricks do not support each other. The tower stands because the clock is paused.
    clock.paused = true;
    let brick = RigidBox::new(BRICK, 8.0)?;
    let mesh = meshes.add(Cuboid::from_size(2.0 * BRICK.as_vec3()));
    let bricks = [
        Color::srgb(0.7, 0.3, 0.2),
        Color::srgb(0.8, 0.45, 0.3),
        Color::srgb(0.6, 0.25, 0.15),
    ]
    .map(|color| materials.add(color));
    for (i, (j, k)) in (0..TOWER[0])
        .flat_map(|i| (0..TOWER[1]).flat_map(move |j| (0..TOWER[2]).map(move |k| (i, (j, k)))))
    {
        let cell = DVec3::new(f64::from(i), f64::from(j), f64::from(k));
        let middle = DVec3::new(f64::from(TOWER[0] - 1), -1.0, f64::from(TOWER[2] - 1));
        let place = BodyState::at((2.0 * cell - middle) * BRICK);
        let color = bricks[usize::from(i * 7 + j * 5 + k * 3) % 3].clone();
        commands.spawn((brick, place, Mesh3d(mesh.clone()), MeshMaterial3d(color)));
    }
    let looking = |x, y, z| Transform::from_xyz(x, y, z).looking_at(Vec3::Y * 3.0, Vec3::Y);
    commands.spawn((Camera3d::default(), looking(6.0, 6.0, 17.0)));
    commands.spawn((DirectionalLight::default(), looking(5.0, 12.0, 8.0)));
    let ground = meshes.add(Plane3d::default().mesh().size(400.0, 400.0));
    commands.spawn((
        Mesh3d(ground),
        MeshMaterial3d(materials.add(Color::srgb(0.3, 0.35, 0.3))),
    ));
    Ok(())
}

fn keep(world: &mut World) {
    world.flush();
    let before = PhysicsSnapshot::take(world);
    world.insert_resource(Before(before));
}

fn explode(
    keys: Res<ButtonInput<KeyCode>>,
    bricks: Query<BodyRef>,
    mut impulses: MessageWriter<ApplyImpulse>,
    mut clock: ResMut<PhysicsClock>,
) {
    if keys.just_pressed(KeyCode::Space) {
        clock.paused = false;
        impulses.write_batch(
            bricks
                .iter()
                .filter_map(|brick| ApplyImpulse::radial(&brick, &BOMB)),
        );
        info!("boom");
    }
}

fn rebuild(world: &mut World) {
    if world
        .resource::<ButtonInput<KeyCode>>()
        .just_pressed(KeyCode::KeyR)
    {
        world.resource_scope(|world, before: Mut<Before>| before.0.restore(world));
        world.resource_mut::<PhysicsClock>().paused = true;
        info!("rebuilt");
    }
}

/// Displays the frame time, the physics time and the number of bricks at rest.
fn show(
    mut gizmos: Gizmos,
    camera: Single<&Transform, With<Camera3d>>,
    time: Res<Time<Real>>,
    timings: Res<PhysicsTimings>,
    resting: Query<&RestingSince>,
    mut frame: Local<f64>,
    mut said: Local<Duration>,
) {
    *frame += 0.1 * (time.delta_secs_f64() - *frame);
    let rest = resting.iter().filter(|since| since.0.is_some()).count();
    let text = format!(
        "{} bricks, {rest} at rest   frame {:.1} ms, physics {:.2} ms   Space: bomb, R: again",
        resting.iter().len(),
        *frame * 1e3,
        timings.total() as f64 * 1e-6,
    );
    let at = camera.translation + camera.rotation * Vec3::new(0.0, 3.7, -10.0);
    gizmos.text(
        Isometry3d::new(at, camera.rotation),
        &text,
        0.2,
        Vec2::ZERO,
        Color::BLACK,
    );
    if time.elapsed() - *said > Duration::from_secs(2) {
        *said = time.elapsed();
        info!("{text}");
    }
}
