//! Draws the panel over the picture and passes on its requests.

use bevy::camera::ClearColorConfig;
use bevy::camera::visibility::RenderLayers;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy_egui::{EguiContexts, EguiGlobalSettings, PrimaryEguiContext, egui};

use super::panel::{self, PanelMemory};
use super::panel_view::{self, Sources};
use crate::action::Actions;
use crate::camera::views::{self, PictureArea};
use crate::input::focus::UiFocus;
use crate::parameters::UI_SCALES;
use crate::preferences::Preferences;
use crate::record::screenshot::PlotArea;
use crate::view::renderer::PictureTarget;

/// The camera of the panel.
#[derive(Component)]
pub(super) struct PanelCamera;

/// State of the panel between frames.
#[derive(Resource, Default)]
pub(super) struct PanelState {
    memory: PanelMemory,
    /// The scale that the panel has.
    scale: Option<f32>,
}

/// Spawns the panel's camera, which draws over the picture.
pub(super) fn spawn_camera(
    target: Res<PictureTarget>,
    mut egui: ResMut<EguiGlobalSettings>,
    mut commands: Commands,
) {
    egui.auto_create_primary_context = false;
    commands.spawn((
        PanelCamera,
        PrimaryEguiContext,
        Camera2d,
        Camera {
            order: views::MOST as isize,
            clear_color: ClearColorConfig::None,
            ..default()
        },
        target.0.clone(),
        RenderLayers::none(),
    ));
}

/// Draws the panel, takes its requests, and gives the picture the room that is left.
pub(super) fn show_panel(
    mut contexts: EguiContexts,
    mut sources: Sources,
    (mut state, mut drawn): (ResMut<PanelState>, Local<f64>),
    mut actions: ResMut<Actions>,
    mut focus: ResMut<UiFocus>,
    (mut picture, mut plot): (ResMut<PictureArea>, ResMut<PlotArea>),
    camera: Single<&Camera, With<PanelCamera>>,
) -> Result {
    let start = Instant::now();
    let context = contexts.ctx_mut()?;
    follow_scale(context, &mut state.scale, &mut sources.preferences);
    let mut ui = egui::Ui::new(
        context.clone(),
        "game".into(),
        egui::UiBuilder::new()
            .layer_id(egui::LayerId::background())
            .max_rect(context.viewport_rect()),
    );
    let state = &mut *state;
    let mut view = panel_view::view(&sources);
    view.compare.panel_ms = *drawn;
    let layout = panel::show(&mut ui, &view, &mut state.memory, &mut actions.0);
    *focus = UiFocus {
        text: context.text_edit_focused(),
        widget: context.egui_wants_keyboard_input(),
        pointer: context.egui_wants_pointer_input()
            || context
                .pointer_latest_pos()
                .is_some_and(|p| !layout.central.contains(p)),
    };
    let scale = context.pixels_per_point();
    let whole = camera.physical_target_size().unwrap_or(UVec2::ONE);
    plot.0 = layout
        .plot
        .map_or_else(URect::default, |rect| pixels(rect, scale, whole));
    *picture = PictureArea(pixels(layout.central, scale, whole), layout.captions);
    *drawn = start.elapsed().as_secs_f64() * 1e3;
    Ok(())
}

/// A place on the panel in pixels of the picture, of which at least one is in it.
fn pixels(rect: egui::Rect, scale: f32, whole: UVec2) -> URect {
    let least = |at: f32, all: u32| ((at * scale) as u32).min(all.saturating_sub(1));
    let min = UVec2::new(least(rect.min.x, whole.x), least(rect.min.y, whole.y));
    let extent =
        |length: f32, from: u32, all: u32| ((length * scale) as u32).clamp(1, (all - from).max(1));
    let size = UVec2::new(
        extent(rect.width(), min.x, whole.x),
        extent(rect.height(), min.y, whole.y),
    );
    URect::from_corners(min, min + size)
}

/// Sets the panel's scale where it was asked for, and keeps the one that Ctrl and + or − made.
fn follow_scale(context: &egui::Context, shown: &mut Option<f32>, kept: &mut ResMut<Preferences>) {
    if *shown == Some(kept.ui_scale) {
        let zoomed = context.zoom_factor().clamp(UI_SCALES.0, UI_SCALES.1);
        if (zoomed - kept.ui_scale).abs() > 1e-3 {
            kept.ui_scale = zoomed;
        }
    }
    if *shown != Some(kept.ui_scale) {
        context.set_zoom_factor(kept.ui_scale);
        *shown = Some(kept.ui_scale);
    }
}
