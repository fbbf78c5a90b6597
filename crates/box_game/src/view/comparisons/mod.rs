//! The comparisons as pictures: translucent boxes over the main box or boxes in strips beside it, the reference as
//! a dashed white frame, fading trails, and a label with name and error for each.
//!
//! Nothing here is simulated or read back: side by side, only the picture is shifted.

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
use crate::view::visuals::{box_color, shaded_cuboid};
use shown::{color, drawn, shown};

/// Opacity of a comparison.
const OPACITY: f32 = 0.16;

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
                )
                    .chain(),
            )
            .add_systems(EguiPrimaryContextPass, labels::draw_labels);
    }
}

/// The box of a comparison; once spawned it stays, and is hidden when it is not wanted.
#[derive(Component, Clone, Copy, Debug)]
pub(super) struct ComparisonBox(pub Integrator);

/// A box for every comparison, where the comparison is.
fn place_comparisons(
    comparison: Res<Comparison>,
    mut boxes: Query<(
        &ComparisonBox,
        &mut Transform,
        &mut Visibility,
        &mut Mesh3d,
        &mut MeshMaterial3d<StandardMaterial>,
        &mut RenderLayers,
    )>,
    area: Option<Res<views::PictureArea>>,
    (mut meshes, mut materials): (ResMut<Assets<Mesh>>, ResMut<Assets<StandardMaterial>>),
    mut made: Local<Option<(Vec3, [Handle<Mesh>; 2])>>,
    mut tints: Local<Vec<(Integrator, [Handle<StandardMaterial>; 2])>>,
    mut commands: Commands,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let half = run.law.body.half_extents().as_vec3();
    let fits = made.as_ref().is_some_and(|(size, ..)| *size == half);
    if !fits {
        let plain = meshes.add(Cuboid::from_size(half * 2.0));
        let shaded = meshes.add(shaded_cuboid(half));
        *made = Some((half, [plain, shaded]));
    }
    let Some((_, [plain, shaded])) = &*made else {
        return;
    };
    let layout = drawn(&comparison, area.is_some());
    let wanted = shown(run, layout);
    let mut tint = |i: Integrator| match tints.iter().find(|(s, _)| *s == i) {
        Some((_, tint)) => tint.clone(),
        None => {
            let clear = materials.add(StandardMaterial {
                base_color: color(i, OPACITY),
                alpha_mode: AlphaMode::Blend,
                unlit: true,
                ..default()
            });
            let solid = materials.add(StandardMaterial {
                base_color: box_color(i),
                perceptual_roughness: 0.6,
                ..default()
            });
            tints.push((i, [clear.clone(), solid.clone()]));
            [clear, solid]
        }
    };
    // With the view that it is seen in alone.
    let mut missing: Vec<_> = wanted[1..].iter().zip(1..).collect();
    for (drawn_box, mut transform, mut visibility, mut mesh, mut material, mut layers) in &mut boxes
    {
        let found = missing.iter().position(|((i, ..), _)| *i == drawn_box.0);
        let Some(n) = found else {
            visibility.set_if_neq(Visibility::Hidden);
            continue;
        };
        let ((integrator, state, _, offset, _), k) = missing.swap_remove(n);
        *transform = pose(state, *offset);
        visibility.set_if_neq(Visibility::Visible);
        let [clear, solid] = tint(*integrator);
        let (shape, look, view) = match layout {
            Layout::SideBySide => (shaded, solid, 0),
            Layout::Views => (shaded, solid, k),
            Layout::Solo | Layout::Overlaid => (plain, clear, 0),
        };
        if mesh.0 != *shape {
            mesh.0 = shape.clone();
        }
        if material.0 != look {
            material.0 = look;
        }
        layers.set_if_neq(views::only(view));
    }
    for ((integrator, state, _, offset, _), _) in missing {
        commands.spawn((
            ComparisonBox(*integrator),
            Mesh3d(plain.clone()),
            MeshMaterial3d(tint(*integrator)[0].clone()),
            pose(state, *offset),
            views::only(0),
            bevy::light::NotShadowCaster,
        ));
    }
}

fn pose(state: &BodyState, offset: Vec3) -> Transform {
    Transform::from_translation(state.position.as_vec3() + offset)
        .with_rotation(state.rotation.as_quat())
}
