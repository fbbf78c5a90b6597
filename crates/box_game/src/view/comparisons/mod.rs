//! The comparisons as pictures: edges over the main box or solid boxes beside it, the reference as a dashed white
//! frame, pins, fading trails, labels at the boxes, and marks where something happens.
//!
//! Nothing here is simulated or read back: side by side, only the picture is shifted.

mod acting;
mod events;
mod frames;
mod labels;
mod shown;
mod strips;

use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy_egui::EguiPrimaryContextPass;
use box_physics::prelude::{BodyState, Integrator};

use crate::action::compare::Layout;
use crate::camera::views;
use crate::compare::Comparison;
use crate::view::marks::marked_cuboid;
use crate::view::visuals::box_color;
use shown::{drawn, shown};

/// Draws the comparisons of a [`Comparison`] over the picture of the first 3-D camera. Needs a renderer and
/// [`ComparePlugin`](crate::compare::ComparePlugin); labels need `EguiPlugin`.
pub(super) struct ComparisonsPlugin;

impl Plugin for ComparisonsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<frames::Trails>()
            .add_systems(
                Update,
                (
                    place_comparisons,
                    strips::place_strips,
                    strips::step_back,
                    frames::lengthen_trails,
                    frames::draw_frames,
                    acting::draw_cones,
                )
                    .chain(),
            )
            .add_systems(
                EguiPrimaryContextPass,
                (labels::draw_labels, events::draw_events).chain(),
            );
    }
}

/// The box of a comparison; once spawned it stays, and is hidden when it is not wanted.
#[derive(Component, Clone, Copy, Debug)]
pub(super) struct ComparisonBox(pub Integrator);

/// A solid box for every comparison that is drawn beside the main box; over it, edges do.
fn place_comparisons(
    comparison: Res<Comparison>,
    mut boxes: Query<(
        &ComparisonBox,
        &mut Transform,
        &mut Visibility,
        &mut Mesh3d,
        &mut RenderLayers,
    )>,
    area: Option<Res<views::PictureArea>>,
    (mut meshes, mut materials): (ResMut<Assets<Mesh>>, ResMut<Assets<StandardMaterial>>),
    mut made: Local<Option<(Vec3, Handle<Mesh>)>>,
    mut commands: Commands,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let half = run.law.body.half_extents().as_vec3();
    let mesh = match &*made {
        Some((size, mesh)) if *size == half => mesh.clone(),
        _ => {
            let mesh = meshes.add(marked_cuboid(half));
            *made = Some((half, mesh.clone()));
            mesh
        }
    };
    let layout = drawn(&comparison, area.is_some());
    let wanted = match layout {
        Layout::SideBySide | Layout::Views => shown(run, layout),
        Layout::Solo | Layout::Overlaid => Vec::new(),
    };
    // With the view that it is seen in alone.
    let view = |k: usize| if layout == Layout::Views { k } else { 0 };
    let mut missing: Vec<_> = wanted.iter().enumerate().skip(1).collect();
    for (drawn_box, mut transform, mut visibility, mut shape, mut layers) in &mut boxes {
        let found = missing.iter().position(|(_, s)| s.0 == drawn_box.0);
        let Some(n) = found else {
            visibility.set_if_neq(Visibility::Hidden);
            continue;
        };
        let (k, (_, state, _, offset, _)) = missing.swap_remove(n);
        *transform = pose(state, *offset);
        visibility.set_if_neq(Visibility::Visible);
        if shape.0 != mesh {
            shape.0 = mesh.clone();
        }
        layers.set_if_neq(views::only(view(k)));
    }
    for (k, (integrator, state, _, offset, _)) in missing {
        commands.spawn((
            ComparisonBox(*integrator),
            Mesh3d(mesh.clone()),
            MeshMaterial3d(materials.add(StandardMaterial {
                base_color: box_color(*integrator),
                perceptual_roughness: 0.6,
                ..default()
            })),
            pose(state, *offset),
            views::only(view(k)),
        ));
    }
}

fn pose(state: &BodyState, offset: Vec3) -> Transform {
    Transform::from_translation(state.position.as_vec3() + offset)
        .with_rotation(state.rotation.as_quat())
}
