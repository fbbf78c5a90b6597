//! A calm background with depth: a sky from a light horizon to a dark zenith, and a floor that fades into it.

use bevy::camera::visibility::NoFrustumCulling;
use bevy::light::NotShadowCaster;
use bevy::mesh::VertexAttributeValues;
use bevy::pbr::{DistanceFog, FogFalloff};
use bevy::prelude::*;

use crate::camera::orbit::OrbitCamera;
use crate::camera::views::everywhere;

/// sRGB at the horizon, above and below.
const HORIZON: [f32; 3] = [0.20, 0.23, 0.28];
const ZENITH: [f32; 3] = [0.07, 0.08, 0.11];
const NADIR: [f32; 3] = [0.09, 0.10, 0.13];

/// The floor begins to fade and is gone at these distances, in distances of the camera from its target.
const FADE: (f32, f32) = (1.8, 8.0);
/// Radius of the sky in the same.
const SKY: f32 = 60.0;

/// The sky.
#[derive(Component)]
pub(super) struct Sky;

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
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    let mut sphere = Sphere::new(1.0).mesh().uv(24, 48);
    let Some(VertexAttributeValues::Float32x3(places)) = sphere.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        return;
    };
    // Poles of the UV sphere lie along z.
    let colors: Vec<[f32; 4]> = places.iter().map(|p| sky(p[2])).collect();
    sphere.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    commands.spawn((
        Sky,
        everywhere(),
        Mesh3d(meshes.add(sphere)),
        MeshMaterial3d(materials.add(StandardMaterial {
            unlit: true,
            fog_enabled: false,
            cull_mode: None,
            ..default()
        })),
        NotShadowCaster,
        NoFrustumCulling,
    ));
}

/// The sky stays around the camera, and the floor fades with the distance from what is looked at.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The floor ends in the color of the horizon, and the sky has no seam there.
    #[test]
    fn the_sky_is_continuous() {
        let horizon = color(HORIZON).to_linear().to_f32_array();
        assert_eq!(sky(0.0), horizon);
        assert!(sky(1.0).iter().zip(horizon).take(3).all(|(a, b)| *a < b));
        assert!((sky(1e-6)[0] - sky(-1e-6)[0]).abs() < 1e-3);
    }
}
