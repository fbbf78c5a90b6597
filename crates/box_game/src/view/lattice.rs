//! A lattice of faint crosses for scenes without a floor, so that motion is visible.

use bevy::prelude::*;
use box_physics::prelude::Floor;

use crate::camera::orbit::OrbitCamera;
use crate::camera::views::Everywhere;

/// Crosses along each axis, on either side of the middle.
const REACH: i32 = 3;

/// Distance of the crosses \[m\] for a camera `distance` \[m\] away: the power of two that puts some five
/// across the picture.
fn spacing(distance: f32) -> f32 {
    (distance / 4.0).clamp(1e-3, 1e6).log2().round().exp2()
}

/// The places \[m\] of the crosses about `target`: fixed in the world, however the camera moves.
fn lattice(target: Vec3, spacing: f32) -> impl Iterator<Item = Vec3> {
    let middle = (target / spacing).round();
    let along = -REACH..=REACH;
    along.clone().flat_map(move |i| {
        let along = along.clone();
        along.clone().flat_map(move |j| {
            along.clone().map(move |k| {
                let offset = IVec3::new(i, j, k).as_vec3();
                (middle + offset) * spacing
            })
        })
    })
}

/// Draws the lattice, fainter toward its edge.
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
            gizmos.cross(
                Isometry3d::from_translation(at),
                0.03 * spacing,
                Color::srgba(0.6, 0.65, 0.75, 0.5 * nearness),
            );
        }
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
        assert_eq!((spacing(4.0), spacing(9.0), spacing(24.0)), (1.0, 2.0, 8.0));
    }
}
