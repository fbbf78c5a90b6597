//! The same throw with two clocks: at 30 Hz, with and without interpolation, and at 240 Hz in a separate physics app.
//! Until they land the paths agree, because the default integrator is exact in flight. Space throws again.
//! `cargo run --release --example two_clocks`

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_transform_interpolation::prelude::*;
use box_physics::plugin::BodyMutItem;
use box_physics::prelude::*;

/// A second app without a window, with physics at 240 Hz.
struct Fine(App);

/// The entity that displays a brick of the second app.
#[derive(Component)]
struct Shows(Entity);

/// Text displayed below a brick.
#[derive(Component)]
struct Label(&'static str);

fn physics(hz: f64) -> Result<App, BevyError> {
    let mut app = App::new();
    app.insert_resource(Time::<Fixed>::from_hz(hz))
        .insert_resource(Floor::new(0.0, 0.6, 0.4)?);
    Ok(app)
}

fn main() -> Result<(), BevyError> {
    let mut fine = physics(240.0)?;
    fine.add_plugins((MinimalPlugins, PhysicsPlugins::default()));
    physics(30.0)?
        .add_plugins((DefaultPlugins, PhysicsPlugins::default()))
        .add_plugins(TransformInterpolationPlugin::default())
        .insert_non_send(Fine(fine))
        .add_systems(Startup, setup)
        .add_systems(Update, (throw, follow, show).chain())
        .run();
    Ok(())
}

fn brick() -> Result<RigidBox, InvalidValue> {
    RigidBox::new(Vec3::new(0.5, 0.25, 0.125), 3.0)
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut fine: NonSendMut<Fine>,
) -> Result {
    let shape = meshes.add(Cuboid::from_size(2.0 * brick()?.half_extents().as_vec3()));
    let mut spawn = |x: f32, label, color| {
        let material = MeshMaterial3d(materials.add(color));
        let mut brick = commands.spawn((Label(label), Mesh3d(shape.clone()), material));
        brick.insert(Transform::from_xyz(x, 1.0, 0.0));
        brick.id()
    };
    let steps = spawn(-2.2, "30 Hz", Color::srgb(0.8, 0.35, 0.0));
    let smooth = spawn(0.0, "30 Hz, interpolated", Color::srgb(0.0, 0.6, 0.45));
    let shown = spawn(2.2, "240 Hz", Color::srgb(0.0, 0.45, 0.7));
    commands.entity(steps).insert(brick()?);
    commands
        .entity(smooth)
        .insert((brick()?, TransformInterpolation));
    fine.0.world_mut().spawn((brick()?, Shows(shown)));
    let looking = |x, y, z| Transform::from_xyz(x, y, z).looking_at(Vec3::Y * 1.2, Vec3::Y);
    commands.spawn((Camera3d::default(), looking(0.0, 2.0, 6.5)));
    commands.spawn((DirectionalLight::default(), looking(2.0, 5.0, 4.0)));
    let ground = meshes.add(Plane3d::default().mesh().size(40.0, 40.0));
    commands.spawn((
        Mesh3d(ground),
        MeshMaterial3d(materials.add(Color::srgb(0.2, 0.2, 0.25))),
    ));
    Ok(())
}

/// Throws all three bricks identically, at the start and when Space is pressed.
fn throw(
    mut bricks: Query<(&Label, BodyMut)>,
    mut fine: NonSendMut<Fine>,
    keys: Res<ButtonInput<KeyCode>>,
    mut thrown: Local<bool>,
) {
    if *thrown && !keys.just_pressed(KeyCode::Space) {
        return;
    }
    *thrown = true;
    let start = |x: f64, mut body: BodyMutItem| {
        *body.state = BodyState::at(DVec3::new(x, 0.5, 0.0)).with_velocity(DVec3::Y * 6.0);
        body.set_angular_velocity(DVec3::new(1.0, 3.0, 7.0));
    };
    for (label, body) in &mut bricks {
        start(if label.0 == "30 Hz" { -2.2 } else { 0.0 }, body);
    }
    let world = fine.0.world_mut();
    for body in world.query::<BodyMut>().iter_mut(world) {
        start(2.2, body);
    }
    info!("thrown");
}

/// Updates the second app by the time of this frame, and displays its brick.
fn follow(time: Res<Time>, mut fine: NonSendMut<Fine>, mut shown: Query<&mut Transform>) {
    let Fine(app) = &mut *fine;
    app.insert_resource(TimeUpdateStrategy::ManualDuration(time.delta()));
    app.update();
    let world = app.world_mut();
    for (there, shows) in world.query::<(&Transform, &Shows)>().iter(world) {
        if let Ok(mut here) = shown.get_mut(shows.0) {
            *here = *there;
        }
    }
}

fn show(bricks: Query<(&Transform, &Label)>, mut gizmos: Gizmos) {
    for (transform, label) in &bricks {
        let below = Vec3::new(transform.translation.x, 0.3, 1.6);
        let flat = Isometry3d::new(below, Quat::from_rotation_x(-0.9));
        gizmos.text(flat, label.0, 0.15, Vec2::ZERO, Color::WHITE);
    }
}
