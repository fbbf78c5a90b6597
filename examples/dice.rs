//! Five dice in a tray: throws them, waits until they settle, and reads their faces. Space throws again.
//! `cargo run --release --example dice`

use bevy::prelude::*;
use box_physics::prelude::*;

/// Edge of a die [m], and its mass [kg].
const EDGE: f32 = 0.016;
const MASS: f64 = 0.004;
/// Largest random velocity [m/s] and angular velocity [rad/s] of a throw, per axis.
const THROW: (f64, f64) = (0.8, 25.0);
/// Distance of the tray's walls from its middle, and their height [m].
const TRAY: (f32, f32) = (0.1, 0.03);

/// Number of pips on the face with this normal; opposite faces add up to seven.
fn pips(normal: DVec3) -> usize {
    let positive = normal.abs().dot(DVec3::new(2.0, 1.0, 3.0)) as usize;
    if normal.element_sum() > 0.0 {
        positive
    } else {
        7 - positive
    }
}

/// Number of the upper face, once the die is at rest.
#[derive(Component, Default)]
struct Die(Option<usize>);

/// Generator of random numbers between −1 and 1.
#[derive(Resource)]
struct Luck(u64);

impl Luck {
    fn vector(&mut self) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| {
            let next = self.0.wrapping_mul(6_364_136_223_846_793_005);
            self.0 = next.wrapping_add(1);
            (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        }))
    }
}

fn main() -> Result<(), BevyError> {
    App::new()
        .add_plugins((DefaultPlugins, PhysicsPlugins::default()))
        .insert_resource(Floor::new(0.0, 0.3, 0.6)?)
        .insert_resource(ClearColor(Color::srgb(0.02, 0.1, 0.06)))
        .insert_resource(Luck(7))
        .add_systems(Startup, setup)
        .add_systems(Update, (throw, show))
        .add_observer(read)
        .run();
    Ok(())
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut gizmos: ResMut<GizmoConfigStore>,
) -> Result {
    gizmos.config_mut::<DefaultGizmoConfigGroup>().0.line.width = 3.0;
    let cube = meshes.add(Cuboid::from_length(EDGE));
    let pip = meshes.add(Sphere::new(0.09 * EDGE));
    let mut paint = |r, g, b| materials.add(Color::srgb(r, g, b));
    let (ivory, black) = (paint(0.95, 0.9, 0.8), paint(0.05, 0.05, 0.05));
    let (felt, wood) = (paint(0.05, 0.3, 0.15), paint(0.35, 0.2, 0.1));
    for k in 0_u8..5 {
        let die = RigidBox::cube(f64::from(EDGE), MASS)?;
        let place = Transform::from_xyz(0.03 * (f32::from(k) - 2.0), EDGE, 0.0);
        commands
            .spawn((Die::default(), die, place))
            .insert((Mesh3d(cube.clone()), MeshMaterial3d(ivory.clone())))
            .with_children(|die| {
                for normal in Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
                    let (u, v) = normal.any_orthonormal_pair();
                    for (x, y) in places(pips(normal.as_dvec3())) {
                        let at = (0.48 * normal + 0.25 * (x * u + y * v)) * EDGE;
                        let pip = (Mesh3d(pip.clone()), MeshMaterial3d(black.clone()));
                        die.spawn((pip, Transform::from_translation(at)));
                    }
                }
            });
    }
    let looking = |x, y, z| Transform::from_xyz(x, y, z).looking_at(Vec3::ZERO, Vec3::Y);
    commands.spawn((Camera3d::default(), looking(0.0, 0.24, 0.25)));
    commands.spawn((DirectionalLight::default(), looking(0.2, 1.0, 0.4)));
    let table = meshes.add(Plane3d::default().mesh().size(2.0 * TRAY.0, 2.0 * TRAY.0));
    commands.spawn((Mesh3d(table), MeshMaterial3d(felt)));
    let board = meshes.add(Cuboid::new(2.1 * TRAY.0, 2.0 * TRAY.1, 0.1 * TRAY.0));
    for side in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
        commands.spawn(StaticPlane::new(side * TRAY.0, -side)?);
        let place = Transform::from_translation(1.05 * TRAY.0 * side).looking_to(side, Vec3::Y);
        commands.spawn((Mesh3d(board.clone()), MeshMaterial3d(wood.clone()), place));
    }
    Ok(())
}

/// Positions of the pips on a face, in quarters of the edge.
fn places(pips: usize) -> impl Iterator<Item = (f32, f32)> {
    let x = [0.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0];
    let y = [0.0, 1.0, -1.0, -1.0, 1.0, 0.0, 0.0];
    x.into_iter().zip(y).skip(1 - pips % 2).take(pips)
}

/// Throws all dice from above at the start and when Space is pressed.
fn throw(
    mut dice: Query<(BodyMut, &mut Die)>,
    keys: Res<ButtonInput<KeyCode>>,
    mut luck: ResMut<Luck>,
    mut thrown: Local<bool>,
) {
    if std::mem::replace(&mut *thrown, true) && !keys.just_pressed(KeyCode::Space) {
        return;
    }
    for (k, (mut body, mut die)) in dice.iter_mut().enumerate() {
        die.0 = None;
        let place = DVec3::new(0.03 * (k as f64 - 2.0), 0.1, 0.05) + 0.005 * luck.vector();
        *body.state = BodyState::at(place).with_velocity(luck.vector() * THROW.0);
        body.set_angular_velocity(luck.vector() * THROW.1);
    }
    info!("thrown");
}

/// Reads a die that has settled: the body axis that points up is the normal of its upper face.
fn read(settled: On<Settled>, mut dice: Query<(&BodyState, &mut Die)>) {
    let Ok((state, mut die)) = dice.get_mut(settled.entity) else {
        return;
    };
    die.0 = Some(pips(state.axis_towards(DVec3::Y)));
    let faces: Option<Vec<_>> = dice.iter().map(|(_, die)| die.0).collect();
    if let Some(faces) = faces {
        info!("{faces:?}: {}", faces.iter().sum::<usize>());
    }
}

/// Displays the number above each die at rest, and the sum.
fn show(dice: Query<(&Transform, &Die)>, mut gizmos: Gizmos) {
    let facing = Quat::from_rotation_x(-0.75);
    let mut sum = 0;
    for (transform, face) in dice.iter().filter_map(|(t, die)| Some((t, die.0?))) {
        let above = Isometry3d::new(transform.translation + Vec3::Y * 0.025, facing);
        gizmos.text(above, &face.to_string(), 0.012, Vec2::ZERO, Color::WHITE);
        sum += face;
    }
    let behind = Isometry3d::new(Vec3::new(0.0, 0.05, -0.11), facing);
    let text = format!("{sum}    Space throws");
    gizmos.text(behind, &text, 0.014, Vec2::ZERO, Color::WHITE);
}
