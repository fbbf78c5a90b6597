//! Marks of events: rings at flips and impacts, and the strip of flips.

use bevy::math::Vec3;
use bevy_egui::egui::{
    Align2, Color32, Context, FontId, LayerId, Order, Painter, Rect, Stroke, pos2, vec2,
};

use super::shown::Seen;
use crate::action::compare::Layout;
use crate::compare::MarkKind;
use crate::compare::verdict::VISIBLE_LATENESS;
use crate::view::style;

/// Time that a ring takes to grow and fade \[s\], and its largest radius \[points\].
const RING: f64 = 0.5;
const RADIUS: f32 = 34.0;
/// Time span of the strip \[s\], height of a row and width of its names [points].
const SPAN: f64 = 10.0;
const ROW: f32 = 15.0;
const NAMES: f32 = 26.0;
/// Distance of a label from ticks and other labels [points].
const APART: f32 = 5.0;
/// Minimum height of a picture with a strip [points].
const LOWEST: f32 = 220.0;

/// Growth of the ring of a recent flip or impact, 0 to 1; `None` once it is over.
fn growth(now: f64, event: f64) -> Option<f32> {
    let share = (now - event) / RING;
    (0.0..=1.0).contains(&share).then_some(share as f32)
}

/// Area of the strip; `None` without flips, in separate views, or in a picture that is too low.
pub(super) fn strip_place(seen: &Seen<'_>) -> Option<Rect> {
    let (run, trajectories) = (seen.run, &seen.trajectories);
    let tracks = trajectories.iter().map(|t| &t.track.flips);
    let mut flips = tracks.chain([&run.reference_flips]);
    let some = flips.any(|flips| !flips.times().is_empty());
    if !some || seen.view.height() < LOWEST || seen.layout == Layout::Views {
        return None;
    }
    let height = ROW * (trajectories.len() + 1) as f32 + 26.0;
    let room = seen.view.shrink2(vec2(10.0, 8.0));
    Some(room.with_min_y(room.bottom() - height))
}

pub(super) fn draw(context: &Context, seen: &Seen<'_>) {
    let (run, trajectories) = (seen.run, &seen.trajectories);
    let layer = LayerId::new(Order::Background, "events".into());
    let painter = context.layer_painter(layer).with_clip_rect(seen.view);
    let ring = |at: Vec3, color: Color32, share: f32| {
        if let Some(at) = seen.at(at) {
            let stroke = Stroke::new(3.0, color.gamma_multiply(1.0 - share));
            painter.circle_stroke(at, 6.0 + share * RADIUS, stroke);
        }
    };
    if seen.layout != Layout::Views {
        for t in trajectories {
            let newest = t.track.flips.times().last();
            if let Some(share) = newest.and_then(|&flip| growth(t.track.now.sample.t, flip)) {
                let color = style::of(t.integrator).ink_on_picture();
                ring(t.place(seen.tip), color, share);
            }
        }
        let mut marks = run.marks.iter();
        let impact = marks.rfind(|mark| mark.kind == MarkKind::Contact);
        if let (Some(mark), Some(floor)) = (impact, run.law.floor())
            && let Some(share) = growth(run.clock, mark.t)
        {
            let at = run.main_box.state().position.as_vec3();
            ring(at.with_y(floor.height as f32), Color32::WHITE, share);
        }
    }
    if let Some(place) = strip_place(seen) {
        let due = ('┄', Color32::WHITE, run.reference_flips.times());
        let rows = trajectories.iter().map(|t| {
            let looks = style::of(t.integrator);
            (looks.glyph, looks.ink_on_picture(), t.track.flips.times())
        });
        let rows: Vec<_> = [due].into_iter().chain(rows).collect();
        strip(&painter, place, run.clock, &rows);
    }
}

/// Lateness of the `n`-th flip relative to the reference, if visible: `+0.4 s`.
fn lateness(flips: &[f64], due: &[f64], n: usize) -> Option<String> {
    let late = flips[n] - due.get(n)?;
    let sign = if late > 0.0 { '+' } else { '−' };
    (late.abs() > VISIBLE_LATENESS).then(|| format!("{sign}{:.1} s", late.abs()))
}

/// Left ends of labels of these widths at these ticks, from left to right. A label is to the right of its tick, else to
/// the left. It is omitted if it would touch another tick or label, or exceed `end`.
fn beside(ticks: &[(f32, f32)], start: f32, end: f32) -> Vec<Option<f32>> {
    let mut free = start;
    let place = |(k, &(at, width)): (usize, &(f32, f32))| {
        let next = ticks.get(k + 1).map_or(end, |tick| tick.0);
        let [left, right] = [at - APART - width, at + APART];
        let place = if right + width + APART <= next {
            Some(right)
        } else {
            (left >= free).then_some(left)
        };
        free = place.map_or(at, |x| f32::max(at, x + width)) + APART;
        place
    };
    ticks.iter().enumerate().map(place).collect()
}

/// Draws a row per trajectory with a tick per flip, over the last seconds from left to right.
fn strip(painter: &Painter, place: Rect, now: f64, rows: &[(char, Color32, &[f64])]) {
    let write = |at, anchor, text: &str, color| {
        painter.text(at, anchor, text, FontId::proportional(12.0), color);
    };
    let weak = style::PICTURE_WEAK;
    painter.rect_filled(place, 5.0, style::PICTURE_PLATE);
    let corner = place.min + vec2(8.0, 3.0);
    write(corner, Align2::LEFT_TOP, "flips", style::PICTURE_TEXT);
    let start = (now - SPAN).max(0.0);
    let (left, right) = (place.left() + NAMES, place.right() - 12.0);
    let x = |t: f64| left + (right - left) * ((t - start) / SPAN) as f32;
    for second in (start.ceil() as i64)..=((start + SPAN) as i64) {
        let at = pos2(x(second as f64), place.top() + 3.0);
        if second % 2 == 0 && at.x > place.left() + 48.0 {
            write(at, Align2::CENTER_TOP, &format!("{second} s"), weak);
        }
    }
    let top = place.top() + 19.0;
    let all = top..=top + ROW * rows.len() as f32;
    painter.vline(x(now), all.clone(), Stroke::new(1.0, weak));
    for (k, (glyph, color, flips)) in rows.iter().enumerate() {
        let middle = top + (k as f32 + 0.5) * ROW;
        let line = Stroke::new(1.0, weak.gamma_multiply(0.35));
        painter.hline(left..=right, middle, line);
        let name = pos2(place.left() + 14.0, middle);
        write(name, Align2::CENTER_CENTER, &glyph.to_string(), *color);
        let mut ticks = Vec::new();
        for (n, &flip) in flips.iter().enumerate() {
            if flip < start || flip > now {
                continue;
            }
            if k == 0 {
                // When the others should have turned over.
                let faint = Color32::WHITE.gamma_multiply(0.5);
                painter.vline(x(flip), all.clone(), Stroke::new(1.0, faint));
            }
            let tick = middle - 6.0..=middle + 6.0;
            painter.vline(x(flip), tick, Stroke::new(3.0, *color));
            let text = lateness(flips, rows[0].2, n).unwrap_or_default();
            let font = FontId::proportional(12.0);
            ticks.push((x(flip), painter.layout_no_wrap(text, font, *color)));
        }
        let widths: Vec<_> = ticks
            .iter()
            .map(|(at, text)| (*at, text.size().x))
            .collect();
        for (place, (_, text)) in beside(&widths, left, right).into_iter().zip(ticks) {
            if let Some(at) = place.filter(|_| !text.is_empty()) {
                // On its own plate: the lines behind it would strike it out.
                let corner = pos2(at, middle - 0.5 * text.size().y);
                let plate = Rect::from_min_size(corner, text.size());
                painter.rect_filled(plate, 2.0, style::PICTURE_PLATE);
                painter.galley(corner, text, *color);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Labels are beside their ticks, inside the strip, and never over another tick or label.
    #[test]
    fn latenesses_have_room_or_are_left_out() {
        let alone = beside(&[(100.0, 40.0)], 26.0, 400.0);
        assert_eq!(alone, [Some(105.0)]);
        // The next tick is near: to the left; and then nowhere.
        let near = [(100.0, 40.0), (120.0, 40.0), (135.0, 40.0), (395.0, 40.0)];
        let places = beside(&near, 26.0, 400.0);
        assert_eq!(places, [Some(55.0), None, Some(140.0), Some(350.0)]);
        assert_eq!(
            beside(&[(30.0, 40.0), (60.0, 40.0)], 26.0, 100.0),
            [None; 2]
        );
    }

    #[test]
    fn a_lateness_has_a_sign_and_is_silent_where_it_cannot_be_seen() {
        let due = [1.0, 3.0, 5.0];
        let own = [1.4, 2.7, 5.05, 7.0];
        let words = [0, 1, 2, 3].map(|n| lateness(&own, &due, n));
        let [late, early] = ["+0.4 s", "−0.3 s"].map(|text| Some(text.to_owned()));
        assert_eq!(words, [late, early, None, None]);
    }
}
