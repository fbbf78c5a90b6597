//! Name and error of every comparison, in words over the picture.

use bevy::prelude::*;
use bevy_egui::{EguiContexts, egui};

use super::shown::{drawn, shown, tip};
use crate::action::compare::Layout;
use crate::camera::views::{PictureArea, SplitView, cells};
use crate::compare::track::Track;
use crate::compare::{Comparison, Quantity};
use crate::demo_2012::Demo2012;
use crate::scene::session::Session;
use crate::view::style;
use box_scenarios::Status;

/// In a picture narrower than this \[points\] a label is the integrator's mark without its name: it would cover
/// the box.
const NARROW: f32 = 460.0;

/// Name and error at every box. The labels of comparisons, which are all in one place, stand in a column
/// beside them, each with a line to its box.
pub(super) fn draw_labels(
    comparison: Res<Comparison>,
    session: Option<Res<Session>>,
    demo: Option<Res<Demo2012>>,
    mut contexts: EguiContexts,
    camera: Query<(&Camera, &GlobalTransform), (With<Camera3d>, Without<SplitView>)>,
    window: Query<&Window>,
    area: Option<Res<PictureArea>>,
) -> Result {
    let (Some(run), Some((camera, eye))) = (&comparison.run, camera.iter().next()) else {
        return Ok(());
    };
    let layout = drawn(&comparison, area.is_some());
    if layout == Layout::Solo || run.comparisons.is_empty() {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let scale = window.iter().next().map_or(1.0, Window::scale_factor) / context.pixels_per_point();
    let Some(view) = camera.logical_viewport_rect() else {
        return Ok(());
    };
    let point = |v: Vec2| egui::pos2(v.x * scale, v.y * scale);
    let comparisons = shown(run, layout);
    // In pixels; the views and the whole of them.
    let pixels = |r: URect| {
        let corner =
            |c: UVec2| egui::Pos2::from(c.as_vec2().to_array()) / context.pixels_per_point();
        egui::Rect::from_min_max(corner(r.min), corner(r.max))
    };
    let cells: Vec<egui::Rect> = match (&area, layout) {
        (Some(area), Layout::Views) => cells(area.0, comparisons.len())
            .into_iter()
            .map(pixels)
            .collect(),
        _ => Vec::new(),
    };
    let view = match &area {
        Some(area) if layout == Layout::Views => pixels(area.0),
        _ => egui::Rect::from_min_max(point(view.min), point(view.max)),
    };
    let painter = context
        .layer_painter(egui::LayerId::new(egui::Order::Background, "labels".into()))
        .with_clip_rect(view);
    let tip = tip(run);
    let radius = run.law.body.radius() as f32;
    let seen = |at: Vec3| camera.world_to_viewport(eye, at).ok().map(point);
    let attitude = run.attitude_says_more();
    let mut taken: Vec<egui::Rect> = Vec::new();
    // Below the one line that a hidden panel leaves.
    let hidden = session.as_ref().is_some_and(|s| s.hidden);
    // The demo of 2012 moves its box itself.
    let stepper = match (&demo, &session) {
        (Some(demo), Some(session)) => demo.active(session),
        _ => None,
    };
    let narrow = cells.first().unwrap_or(&view).width() < NARROW;
    let line = if hidden { 46.0 } else { 10.0 };
    let mut next = view.top() + line;
    for (k, (integrator, state, track, offset, status)) in comparisons.into_iter().enumerate() {
        let name = match stepper {
            Some(stepper) if k == 0 => stepper.name().to_owned(),
            _ if narrow => style::of(integrator).glyph.to_owned(),
            _ => style::marked_name(integrator),
        };
        let text = label(name, k == 0 && !narrow, track, status, attitude);
        let center = state.position.as_vec3() + offset;
        let font = egui::FontId::proportional(13.0);
        let looks = style::of(integrator).color();
        let galley = painter.layout_no_wrap(text, font, egui::Color32::WHITE);
        let size = galley.size() + egui::vec2(12.0, 6.0);
        let corner = match layout {
            Layout::SideBySide => {
                let Some(above) = seen(center + Vec3::Y * radius * 1.25) else {
                    continue;
                };
                let mut corner = egui::pos2(above.x - 0.5 * size.x, above.y - size.y);
                // Above those that are there already.
                while let Some(other) = taken
                    .iter()
                    .find(|t| t.intersects(egui::Rect::from_min_size(corner, size)))
                {
                    corner.y = other.top() - size.y - 2.0;
                }
                corner
            }
            Layout::Views => {
                let Some(cell) = cells.get(k) else {
                    continue;
                };
                // The first is below the one line, too.
                let down = if cell.top() > view.top() { 10.0 } else { line };
                cell.min + egui::vec2(12.0, down)
            }
            Layout::Solo | Layout::Overlaid => {
                let corner = egui::pos2(view.left() + 12.0, next);
                next += size.y + 4.0;
                let from = egui::pos2(corner.x + size.x, corner.y + 0.5 * size.y);
                if let Some(to) = seen(state.point(tip).as_vec3() + offset) {
                    painter.line_segment(
                        [from, to],
                        egui::Stroke::new(1.0, looks.gamma_multiply(0.6)),
                    );
                }
                corner
            }
        };
        let place = egui::Rect::from_min_size(corner, size);
        taken.push(place);
        painter.rect_filled(place, 4.0, heat(track, status, attitude));
        painter.rect_stroke(
            place,
            4.0,
            egui::Stroke::new(if k == 0 { 2.5 } else { 1.5 }, looks),
            egui::StrokeKind::Inside,
        );
        painter.galley(corner + egui::vec2(6.0, 3.0), galley, egui::Color32::WHITE);
    }
    Ok(())
}

/// `■ RK4 · 0.13°`.
fn label(
    mut text: String,
    main_box: bool,
    track: &Track,
    status: Status,
    attitude: bool,
) -> String {
    if main_box {
        text.push_str(" (main)");
    }
    if status.is_diverged() {
        return format!("{text} · {status}");
    }
    let (value, unit) = now(track, attitude);
    if value.is_finite() {
        text.push_str(&format!(" · {}{unit}", short(value)));
    }
    text
}

/// Two significant digits; a label is read in passing.
fn short(value: f64) -> String {
    match value {
        v if v < 1e-11 => "0".to_owned(),
        v if v < 1e-3 => format!("{v:.0e}"),
        v if v < 0.1 => format!("{v:.3}"),
        v if v < 10.0 => format!("{v:.2}"),
        v => format!("{v:.0}"),
    }
}

fn now(track: &Track, attitude: bool) -> (f64, &'static str) {
    let sample = &track.now.sample;
    if attitude {
        (sample.get(Quantity::Attitude), "°")
    } else {
        (sample.get(Quantity::Position), " m")
    }
}

/// The label's ground: dark green where the error cannot be seen, dark red where the pose is lost.
fn heat(track: &Track, status: Status, attitude: bool) -> egui::Color32 {
    let (value, _) = now(track, attitude);
    let lost = if attitude { 90.0 } else { 1.0 };
    // Four decades from harmless to lost.
    let share = if status.is_diverged() {
        1.0
    } else {
        ((value.max(1e-12) / lost).log10() / 4.0 + 1.0).clamp(0.0, 1.0) as f32
    };
    let mix = |a: f32, b: f32| (a + (b - a) * share) as u8;
    egui::Color32::from_rgba_unmultiplied(mix(18.0, 120.0), mix(64.0, 22.0), mix(40.0, 26.0), 225)
}
