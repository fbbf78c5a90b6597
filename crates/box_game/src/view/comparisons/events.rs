//! What happens, marked where and when it happens: rings at flips and impacts, and the strip of flips.

use bevy::prelude::*;
use bevy_egui::{EguiContexts, egui};

use super::labels::seen;
use super::shown::{Shown, drawn, shown, tip};
use crate::action::compare::Layout;
use crate::camera::views::{PictureArea, SplitView};
use crate::compare::{Comparison, RuleKind, Run};
use crate::view::style;

/// Time that a ring takes to grow and fade \[s\], and its largest radius \[points\].
const RING: f64 = 0.5;
const RADIUS: f32 = 34.0;
/// Time that the strip shows \[s\], height of a row and room of its names [points].
const SPAN: f64 = 10.0;
const ROW: f32 = 15.0;
const NAMES: f32 = 26.0;
/// A picture lower than this has no strip [points].
const LOWEST: f32 = 220.0;

/// A flip or an impact that has just been: how far its ring has grown, 0 to 1.
fn growth(now: f64, event: f64) -> Option<f32> {
    let share = (now - event) / RING;
    (0.0..=1.0).contains(&share).then_some(share as f32)
}

/// Room of the strip in `view`; none without flips, or in a picture that is too low.
pub(super) fn strip_place(
    run: &Run,
    trajectories: &[Shown<'_>],
    layout: Layout,
    view: egui::Rect,
) -> Option<egui::Rect> {
    let flips = !run.reference_flips.times().is_empty()
        || trajectories.iter().any(|t| !t.2.flips.times().is_empty());
    if !flips || view.height() < LOWEST || layout == Layout::Views {
        return None;
    }
    let height = ROW * (trajectories.len() + 1) as f32 + 26.0;
    Some(egui::Rect::from_min_max(
        egui::pos2(view.left() + 10.0, view.bottom() - height - 8.0),
        egui::pos2(view.right() - 10.0, view.bottom() - 8.0),
    ))
}

/// Draws rings and strip.
pub(super) fn draw_events(
    comparison: Res<Comparison>,
    mut contexts: EguiContexts,
    camera: Query<(&Camera, &GlobalTransform), (With<Camera3d>, Without<SplitView>)>,
    window: Query<&Window>,
    area: Option<Res<PictureArea>>,
) -> Result {
    let Some(run) = &comparison.run else {
        return Ok(());
    };
    let layout = drawn(&comparison, area.is_some());
    let context = contexts.ctx_mut()?;
    let Some(seen) = seen(context, camera.iter().next(), &window) else {
        return Ok(());
    };
    let painter = context
        .layer_painter(egui::LayerId::new(egui::Order::Background, "events".into()))
        .with_clip_rect(seen.view);
    let ring = |at: Vec3, color: egui::Color32, share: f32| {
        if let Some(at) = seen.at(at) {
            let stroke = egui::Stroke::new(3.0, color.gamma_multiply(1.0 - share));
            painter.circle_stroke(at, 6.0 + share * RADIUS, stroke);
        }
    };
    let tip = tip(run);
    let trajectories = shown(run, layout);
    if layout != Layout::Views {
        for (integrator, state, track, offset, _) in &trajectories {
            let newest = track.flips.times().last();
            if let Some(share) = newest.and_then(|&t| growth(track.now.sample.t, t)) {
                let at = state.point(tip).as_vec3() + *offset;
                ring(at, style::of(*integrator).color(), share);
            }
        }
        let impact = run
            .rules
            .iter()
            .rfind(|rule| rule.kind == RuleKind::Contact);
        if let (Some(rule), Some(floor)) = (impact, run.law.floor)
            && let Some(share) = growth(run.clock, rule.t)
        {
            let mut at = run.main_box.state.position.as_vec3();
            at.y = floor.height as f32;
            ring(at, egui::Color32::WHITE, share);
        }
    }
    let Some(place) = strip_place(run, &trajectories, layout, seen.view) else {
        return Ok(());
    };
    let due = run.reference_flips.times();
    let rows: Vec<(&str, egui::Color32, &[f64])> = [("┄", egui::Color32::WHITE, due)]
        .into_iter()
        .chain(trajectories.iter().map(|(integrator, _, track, ..)| {
            let looks = style::of(*integrator);
            (looks.glyph, looks.color(), track.flips.times())
        }))
        .collect();
    strip(&painter, place, run.clock, &rows);
    Ok(())
}

/// A row of ticks for every trajectory, one a flip, the last seconds from left to right.
fn strip(
    painter: &egui::Painter,
    place: egui::Rect,
    now: f64,
    rows: &[(&str, egui::Color32, &[f64])],
) {
    painter.rect_filled(place, 5.0, style::PICTURE_PLATE);
    let font = egui::FontId::proportional(12.0);
    let top = place.top() + 19.0;
    painter.text(
        place.min + egui::vec2(8.0, 3.0),
        egui::Align2::LEFT_TOP,
        "flips",
        font.clone(),
        style::PICTURE_TEXT,
    );
    let start = (now - SPAN).max(0.0);
    let (left, right) = (place.left() + NAMES, place.right() - 12.0);
    let x = |t: f64| left + (right - left) * ((t - start) / SPAN) as f32;
    for second in (start.ceil() as i64)..=((start + SPAN) as i64) {
        let at = x(second as f64);
        if second % 2 == 0 && at > place.left() + 48.0 {
            painter.text(
                egui::pos2(at, place.top() + 3.0),
                egui::Align2::CENTER_TOP,
                format!("{second} s"),
                font.clone(),
                style::PICTURE_WEAK,
            );
        }
    }
    let bottom = top + ROW * rows.len() as f32;
    painter.vline(
        x(now),
        top..=bottom,
        egui::Stroke::new(1.0, style::PICTURE_WEAK),
    );
    for (k, (glyph, color, flips)) in rows.iter().enumerate() {
        let middle = top + (k as f32 + 0.5) * ROW;
        painter.hline(
            left..=right,
            middle,
            egui::Stroke::new(1.0, style::PICTURE_WEAK.gamma_multiply(0.35)),
        );
        let name = egui::pos2(place.left() + 14.0, middle);
        painter.text(
            name,
            egui::Align2::CENTER_CENTER,
            glyph,
            font.clone(),
            *color,
        );
        for &flip in flips.iter().filter(|&&t| t >= start && t <= now) {
            let at = x(flip);
            if k == 0 {
                // When the others should have turned over.
                painter.vline(
                    at,
                    top..=bottom,
                    egui::Stroke::new(1.0, egui::Color32::WHITE.gamma_multiply(0.5)),
                );
            }
            painter.vline(
                at,
                middle - 6.0..=middle + 6.0,
                egui::Stroke::new(3.0, *color),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_grows_once() {
        assert_eq!(growth(5.0, 5.1), None);
        assert_eq!(growth(5.0, 5.0), Some(0.0));
        assert_eq!(growth(5.0, 5.0 - RING), Some(1.0));
        assert_eq!(growth(6.0, 5.0), None);
    }
}
