//! Draws the panel over the picture and forwards its requests.

use bevy::camera::ClearColorConfig;
use bevy::camera::visibility::RenderLayers;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use bevy_egui::{EguiContexts, EguiGlobalSettings, PrimaryEguiContext, egui};

use super::panel::{self, PanelMemory};
use super::panel_view::{self, Sources};
use crate::action::Actions;
use crate::action::compare::Layout;
use crate::camera::views::{self, PictureArea};
use crate::input::UiFocus;
use crate::parameters::UI_SCALES;
use crate::preferences::Preferences;
use crate::record::screenshot::PlotArea;
use crate::view::renderer::PictureTarget;

#[derive(Component)]
pub(super) struct PanelCamera;

/// State of the panel between frames.
#[derive(Default)]
pub(super) struct PanelState {
    memory: PanelMemory,
    /// Current scale of the panel.
    scale: Option<f32>,
    /// Time for drawing the panel in the last frame \[ms\].
    cost: f64,
}

/// Spawns the panel's camera, which draws over the picture.
pub(super) fn spawn_camera(
    (target, adapter): (Res<PictureTarget>, Option<Res<RenderAdapterInfo>>),
    mut egui: ResMut<EguiGlobalSettings>,
    mut commands: Commands,
) {
    egui.auto_create_primary_context = false;
    commands.spawn((
        PanelCamera,
        PrimaryEguiContext,
        Camera2d,
        // As the cameras below it: cameras of one target share their texture only then.
        target.antialiasing(adapter.as_deref()),
        Camera {
            order: views::MAX_VIEWS as isize,
            clear_color: ClearColorConfig::None,
            ..default()
        },
        target.0.clone(),
        RenderLayers::none(),
    ));
}

/// Draws the panel, collects its requests, and sets the area of the picture.
pub(super) fn show_panel(
    mut contexts: EguiContexts,
    mut sources: Sources,
    mut state: Local<PanelState>,
    mut actions: ResMut<Actions>,
    mut focus: ResMut<UiFocus>,
    (mut picture, mut plot): (ResMut<PictureArea>, ResMut<PlotArea>),
    camera: Single<&Camera, With<PanelCamera>>,
) -> Result {
    let start = Instant::now();
    let context = contexts.ctx_mut()?;
    follow_scale(context, &mut state.scale, &mut sources.preferences);
    let place = egui::UiBuilder::new().layer_id(egui::LayerId::background());
    let place = place.max_rect(context.viewport_rect());
    let mut ui = egui::Ui::new(context.clone(), "game".into(), place);
    let mut view = panel_view::view(&sources);
    view.compare.panel_ms = state.cost;
    let layout = panel::show(&mut ui, &view, &mut state.memory, &mut actions.0);
    let pointer = context.pointer_latest_pos();
    *focus = UiFocus {
        text: context.text_edit_focused(),
        widget: context.egui_wants_keyboard_input(),
        pointer: context.egui_wants_pointer_input()
            || pointer.is_some_and(|p| !layout.central.contains(p)),
    };
    let whole = camera.physical_target_size().unwrap_or(UVec2::ONE);
    let pixels = |rect| pixels(rect, context.pixels_per_point(), whole);
    plot.0 = layout.plot.map(pixels).unwrap_or_default();
    // Views stand below the captions, which would cover the upper ones and their names.
    let (mut room, mut captions) = (layout.central, layout.captions);
    if view.compare.settings.layout == Layout::Views {
        room.min.y = (room.min.y + captions).min(room.max.y);
        captions = 0.0;
    }
    *picture = PictureArea(pixels(room), captions);
    state.cost = start.elapsed().as_secs_f64() * 1e3;
    Ok(())
}

/// Converts a rectangle of the panel to pixels of the picture, with at least one pixel inside.
fn pixels(rect: egui::Rect, scale: f32, whole: UVec2) -> URect {
    let scaled = |x: f32, y: f32| UVec2::new((x * scale) as u32, (y * scale) as u32);
    let min = scaled(rect.min.x, rect.min.y).min(whole.saturating_sub(UVec2::ONE));
    let most = (whole - min).max(UVec2::ONE);
    let size = scaled(rect.width(), rect.height()).clamp(UVec2::ONE, most);
    URect::from_corners(min, min + size)
}

/// Applies the scale of the preferences, or stores a scale set with Ctrl and + or −.
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
