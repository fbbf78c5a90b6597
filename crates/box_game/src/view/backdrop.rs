//! A background with depth: a sky from a light horizon to a dark zenith, and a floor that fades into it. Without a
//! floor, a lattice of faint crosses. Also the walls of a scene.

use bevy::camera::visibility::NoFrustumCulling;
use bevy::mesh::{MeshVertexBufferLayoutRef, VertexAttributeValues};
use bevy::pbr::{DistanceFog, FogFalloff, MaterialPipeline, MaterialPipelineKey};
use bevy::prelude::*;
use bevy::render::render_resource::{
    AsBindGroup, RenderPipelineDescriptor, SpecializedMeshPipelineError,
};
use bevy::shader::ShaderRef;
use box_physics::prelude::{Floor, StaticPlane};

use crate::camera::orbit::OrbitCamera;
use crate::camera::views::{Everywhere, everywhere};
use crate::scene::start::Wall;

/// sRGB at the horizon, above and below.
const HORIZON: [f32; 3] = [0.20, 0.23, 0.28];
const ZENITH: [f32; 3] = [0.07, 0.08, 0.11];
const NADIR: [f32; 3] = [0.09, 0.10, 0.13];

/// Distances at which the floor begins to fade and has vanished, in distances of the camera from its target.
const FADE: (f32, f32) = (1.8, 8.0);
/// Radius of the sky, relative to the same distance.
const SKY: f32 = 60.0;

/// Number of crosses along each axis, on either side of the middle.
const REACH: i32 = 3;
/// Cells of the grid on a wall, along it and up.
const CELLS: UVec2 = UVec2::new(12, 2);

#[derive(Component)]
pub(super) struct Sky;

/// Shows the colors of the vertices. The standard material would be slow, because the sky is most of the picture.
#[derive(Asset, TypePath, AsBindGroup, Clone, Default)]
pub(super) struct SkyMaterial {}

impl Material for SkyMaterial {
    fn fragment_shader() -> ShaderRef {
        "embedded://box_game/view/sky.wgsl".into()
    }

    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }

    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _: &MeshVertexBufferLayoutRef,
        _: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        // Seen from inside.
        descriptor.primitive.cull_mode = None;
        Ok(())
    }
}

fn color([r, g, b]: [f32; 3]) -> Color {
    Color::srgb(r, g, b)
}

/// The color of the sky in the direction with this sine of the elevation.
fn sky(elevation: f32) -> [f32; 4] {
    let end = if elevation > 0.0 { ZENITH } else { NADIR };
    let share = elevation.abs().sqrt();
    let mixed = color(HORIZON).mix(&color(end), share);
    mixed.to_linear().to_f32_array()
}

/// A sphere around the camera, painted by elevation.
pub(super) fn spawn_backdrop(
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<SkyMaterial>>,
    mut commands: Commands,
) {
    let mut sphere = Sphere::new(1.0).mesh().uv(24, 48);
    let Some(VertexAttributeValues::Float32x3(places)) = sphere.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        return;
    };
    // The UV sphere has its poles along z.
    let colors: Vec<[f32; 4]> = places.iter().map(|p| sky(p[2])).collect();
    sphere.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    commands.spawn((
        Sky,
        everywhere(),
        Mesh3d(meshes.add(sphere)),
        MeshMaterial3d(materials.add(SkyMaterial::default())),
        NoFrustumCulling,
    ));
}

/// Centers the sky on the camera, and fades the floor with the distance from the target.
pub(super) fn place_backdrop(
    orbit: Single<(&OrbitCamera, &Transform), Without<Sky>>,
    mut sky: Single<&mut Transform, With<Sky>>,
    cameras: Query<Entity, With<Camera3d>>,
    mut faded: Local<f32>,
    mut commands: Commands,
) {
    let (orbit, eye) = *orbit;
    let placed = Transform::from_translation(eye.translation)
        .with_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2))
        .with_scale(Vec3::splat(SKY * orbit.distance));
    sky.set_if_neq(placed);
    if *faded != orbit.distance {
        *faded = orbit.distance;
        for camera in &cameras {
            commands.entity(camera).insert(DistanceFog {
                color: color(HORIZON),
                falloff: FogFalloff::Linear {
                    start: FADE.0 * orbit.distance,
                    end: FADE.1 * orbit.distance,
                },
                ..default()
            });
        }
    }
}

/// Distance of the crosses \[m\] for a camera `distance` \[m\] away: the power of two that gives about five across the
/// picture.
fn spacing(distance: f32) -> f32 {
    (distance / 4.0).clamp(1e-3, 1e6).log2().round().exp2()
}

/// The positions \[m\] of the crosses around `target`, fixed in the world for any camera.
fn lattice(target: Vec3, spacing: f32) -> impl Iterator<Item = Vec3> {
    let middle = (target / spacing).round();
    let across = 2 * REACH + 1;
    (0..across.pow(3)).map(move |k| {
        let place = IVec3::new(k / (across * across), k / across % across, k % across);
        (middle + (place - REACH).as_vec3()) * spacing
    })
}

/// Draws the lattice if there is no floor, so that motion is visible; it is fainter toward its edge.
pub(super) fn draw_lattice(
    floor: Option<Res<Floor>>,
    camera: Single<&OrbitCamera>,
    mut gizmos: Gizmos<Everywhere>,
) {
    if floor.is_some() {
        return;
    }
    let spacing = spacing(camera.distance);
    let reach = REACH as f32 * spacing;
    for at in lattice(camera.target, spacing) {
        let nearness = 1.0 - at.distance(camera.target) / reach;
        if nearness > 0.0 {
            let color = Color::srgba(0.6, 0.65, 0.75, 0.5 * nearness);
            gizmos.cross(at, 0.03 * spacing, color);
        }
    }
}

/// Draws each wall of a tray as a grid between its two neighbors.
pub(super) fn draw_walls(walls: Query<&StaticPlane, With<Wall>>, mut gizmos: Gizmos<Everywhere>) {
    for wall in &walls {
        let (foot, normal) = (wall.point.as_vec3(), wall.normal.as_vec3());
        let cell = 2.0 * foot.with_y(0.0).length() / CELLS.x as f32;
        let middle = foot + Vec3::Y * (0.5 * cell * CELLS.y as f32);
        let place = Isometry3d::new(middle, Quat::from_rotation_arc(Vec3::Z, normal));
        let color = Color::srgba(0.6, 0.65, 0.75, 0.35);
        let grid = gizmos.grid(place, CELLS, Vec2::splat(cell), color);
        grid.outer_edges();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lattice_stays_where_it_is_while_the_camera_moves() {
        let near: Vec<Vec3> = lattice(Vec3::new(0.2, 5.1, -0.4), 1.0).collect();
        let moved: Vec<Vec3> = lattice(Vec3::new(0.9, 5.3, -0.1), 1.0).collect();
        assert_eq!(near.len(), 343);
        let shared = near.iter().filter(|p| moved.contains(p)).count();
        assert_eq!(shared, 6 * 49, "one layer changed");
        assert_eq!([4.0, 9.0, 24.0].map(spacing), [1.0, 2.0, 8.0]);
    }
}
