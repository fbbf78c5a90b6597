//! The walls of a scene, as grids.

use bevy::prelude::*;
use box_physics::prelude::StaticPlane;

use crate::camera::views::Everywhere;
use crate::scene::start::Wall;

/// Cells along a wall and up.
const CELLS: UVec2 = UVec2::new(12, 2);

/// Draws each wall of a tray from its neighbor to its neighbor.
pub(super) fn draw_walls(walls: Query<&StaticPlane, With<Wall>>, mut gizmos: Gizmos<Everywhere>) {
    for wall in &walls {
        let (foot, normal) = (wall.point.as_vec3(), wall.normal.as_vec3());
        let cell = 2.0 * foot.with_y(0.0).length() / CELLS.x as f32;
        let middle = foot + Vec3::Y * (0.5 * cell * CELLS.y as f32);
        let place = Isometry3d::new(middle, Quat::from_rotation_arc(Vec3::Z, normal));
        let color = Color::srgba(0.6, 0.65, 0.75, 0.35);
        gizmos
            .grid(place, CELLS, Vec2::splat(cell), color)
            .outer_edges();
    }
}
