//! The layout of views: up to four integrators in one view each, seen from the same place. The first view shows the
//! main box, the others one comparison each, smallest error first. All show floor and lattice. Each view has a separate
//! light, because a light casts the shadows of everything on its layers.

use bevy::camera::visibility::RenderLayers;
use bevy::camera::{ClearColorConfig, Viewport};
use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;

use super::TONEMAPPING;
use super::orbit::OrbitCamera;
use crate::action::compare::Layout;
use crate::compare::Comparison;
use crate::view::renderer::PictureTarget;

/// Maximum number of views.
pub const MAX_VIEWS: usize = 4;
/// Gap between two views \[pixels\].
const GAP: u32 = 2;

/// Area of the picture beside the panel \[pixels\], and the height at its top that captions cover \[points\]. Without
/// it, the layout of views is drawn in one place.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct PictureArea(pub URect, pub f32);

/// An additional view, by its number: 1 to 3.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplitView(pub usize);

/// Layers visible in every view.
pub fn everywhere() -> RenderLayers {
    (0..MAX_VIEWS).collect()
}

/// Layer visible only in view `k`; 0 is also the default layer.
pub fn only(k: usize) -> RenderLayers {
    RenderLayers::layer(k)
}

/// Lines in every view.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct Everywhere;

/// Lines in the second view.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct Second;

/// Lines in the third view.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct Third;

/// Lines in the fourth view.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct Fourth;

/// Lines on boxes of the first view, a little in front of their faces.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct Edges;

/// The same edges, drawn faintly behind the objects that hide them.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct HiddenEdges;

/// The pins through the boxes of the first view.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct Pins;

/// Adds the gizmo groups for each view and for all views.
pub fn add_gizmos(app: &mut App) {
    let lines = |width: f32, depth_bias: f32| GizmoConfig {
        line: GizmoLineConfig { width, ..default() },
        depth_bias,
        ..default()
    };
    app.insert_gizmo_config(Edges, lines(2.5, -0.0005))
        .insert_gizmo_config(HiddenEdges, lines(1.5, -1.0))
        .insert_gizmo_config(Pins, lines(6.0, -0.0002));
    let group = |layers: RenderLayers| GizmoConfig {
        render_layers: layers,
        ..default()
    };
    app.insert_gizmo_config(Everywhere, group(everywhere()))
        .insert_gizmo_config(Second, group(only(1)))
        .insert_gizmo_config(Third, group(only(2)))
        .insert_gizmo_config(Fourth, group(only(3)));
}

/// The views of `n` integrators in `area`: one, two or three side by side, or two by two.
pub fn cells(area: URect, n: usize) -> Vec<URect> {
    let wide = 2 * area.width() > 3 * area.height();
    let (columns, rows) = match n {
        0 | 1 => (1, 1),
        2 => (2, 1),
        3 if wide => (3, 1),
        _ => (2, 2),
    };
    // A picture of a few pixels has no room for gaps.
    let roomy = area.size().min_element() >= 8 * GAP;
    let gap = if roomy { GAP } else { 0 };
    let part = |length: u32, parts: u32| (length.saturating_sub(gap * (parts - 1)) / parts).max(1);
    let size = UVec2::new(part(area.width(), columns), part(area.height(), rows));
    (0..rows)
        .flat_map(|row| (0..columns).map(move |column| UVec2::new(column, row)))
        .take(n.max(1))
        .map(|at| {
            let corner = (area.min + at * (size + gap)).min(area.max.max(UVec2::ONE) - 1);
            URect::from_corners(corner, corner + size)
        })
        .collect()
}

/// Number of views.
pub fn count(comparison: &Comparison) -> usize {
    match &comparison.run {
        Some(run) if comparison.settings.layout == Layout::Views => {
            (run.comparisons.len() + 1).min(MAX_VIEWS)
        }
        _ => 1,
    }
}

/// Spawns the cameras of the additional views, which copy the main one. They cost nothing while they are off.
pub fn spawn_views(
    target: Res<PictureTarget>,
    adapter: Option<Res<RenderAdapterInfo>>,
    mut commands: Commands,
) {
    for k in 1..MAX_VIEWS {
        commands.spawn((
            SplitView(k),
            Camera3d::default(),
            Camera {
                order: k as isize,
                is_active: false,
                // The first camera clears the whole picture.
                clear_color: ClearColorConfig::None,
                ..default()
            },
            only(k),
            target.0.clone(),
            target.antialiasing(adapter.as_deref()),
            TONEMAPPING,
        ));
    }
}

/// Sets the viewport of every camera.
pub fn arrange_views(
    comparison: Res<Comparison>,
    area: Res<PictureArea>,
    mut main: Query<&mut Camera, (With<OrbitCamera>, Without<SplitView>)>,
    mut views: Query<(&SplitView, &mut Camera)>,
) {
    if area.0.is_empty() {
        return;
    }
    let cells = cells(area.0, count(&comparison));
    let further = views.iter_mut().map(|(view, camera)| (view.0, camera));
    for (k, mut camera) in main.iter_mut().map(|camera| (0, camera)).chain(further) {
        let cell = cells.get(k);
        if camera.is_active != cell.is_some() {
            camera.is_active = cell.is_some();
        }
        if let Some(cell) = cell {
            place(&mut camera, *cell);
        }
    }
}

/// Changes the camera only if necessary, because a change recreates its render target.
fn place(camera: &mut Mut<Camera>, cell: URect) {
    let here = |v: &Viewport| v.physical_position == cell.min && v.physical_size == cell.size();
    if !camera.viewport.as_ref().is_some_and(here) {
        camera.viewport = Some(Viewport {
            physical_position: cell.min,
            physical_size: cell.size(),
            ..default()
        });
    }
}

/// Copies the pose of the first camera to every view.
pub fn follow_main(
    main: Query<&Transform, (With<OrbitCamera>, Without<SplitView>)>,
    mut views: Query<&mut Transform, With<SplitView>>,
) {
    if let Some(main) = main.iter().next() {
        for mut view in &mut views {
            view.set_if_neq(*main);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The views are inside the area, do not overlap, and have equal size; there is one per integrator.
    #[test]
    fn views_share_the_picture() {
        for area in [URect::new(0, 96, 940, 462), URect::new(3, 5, 8, 8)] {
            for n in 1..=MAX_VIEWS {
                let cells = cells(area, n);
                assert_eq!(cells.len(), n);
                for (k, cell) in cells.iter().enumerate() {
                    assert!(area.contains(cell.min) && area.contains(cell.max));
                    assert_eq!(cell.size(), cells[0].size());
                    assert!(!cell.is_empty());
                    for other in &cells[..k] {
                        assert!(cell.intersect(*other).is_empty());
                    }
                }
            }
        }
        assert_eq!(
            cells(URect::new(0, 0, 10, 10), 1),
            [URect::new(0, 0, 10, 10)]
        );
    }
}
