//! Labels in the picture: name and verdict at every box, connected by a short line. If they would overlap, they are in
//! one legend.

use std::sync::Arc;

use bevy::math::Vec3;
use bevy_egui::egui::emath::Rot2;
use bevy_egui::egui::text::LayoutJob;
use bevy_egui::egui::{
    Color32, Context, Galley, LayerId, Order, Painter, Pos2, Rect, Stroke, TextFormat, Vec2, vec2,
};
use box_physics::prelude::Integrator;
use box_scenarios::dissertation::Stepper;

use super::events::strip_place;
use super::shown::{Seen, points};
use crate::action::compare::Layout;
use crate::camera::views::{PictureArea, cells};
use crate::compare::verdict::{Quality, short};
use crate::view::style;

/// Width of a single picture below which a label is the integrator's mark without its name \[points\].
const NARROW: f32 = 460.0;
/// Distance of two boxes' marked points below which they share a label \[points\].
const TOGETHER: f32 = 10.0;
/// Lengths of the line to a label to try \[points\], and deviations from its direction \[rad\].
const REACH: [f32; 3] = [26.0, 52.0, 84.0];
const TURNS: [f32; 7] = [0.0, 0.5, -0.5, 1.0, -1.0, 1.6, -1.6];
/// Maximum number of labels; more are shown as a legend.
const MAX_LABELS: usize = 5;
/// Margin around the text of a label.
const MARGIN: Vec2 = vec2(7.0, 4.0);

#[derive(Default)]
struct Label {
    marks: Vec<(char, Color32, String)>,
    word: String,
    /// `true` if the word is below the names.
    stacked: bool,
    bad: bool,
    at: Option<Pos2>,
}

impl Label {
    fn text(&self, painter: &Painter) -> Arc<Galley> {
        let mut job = LayoutJob::default();
        let mut append = |text: &str, color| {
            job.append(text, 0.0, TextFormat::simple(style::PICTURE_FONT, color));
        };
        for (k, (glyph, color, name)) in self.marks.iter().enumerate() {
            if k > 0 {
                append(" = ", style::PICTURE_WEAK);
            }
            append(&glyph.to_string(), *color);
            append(&format!(" {name}"), style::PICTURE_TEXT);
        }
        let (good, bad) = (style::PICTURE_GOOD, style::PICTURE_BAD);
        let color = if self.bad { bad } else { good };
        let space = if self.stacked { "\n" } else { "  " };
        append(&format!("{space}{}", self.word), color);
        painter.layout_job(job)
    }

    /// Limits the width: if necessary, with the word below the names; as a last resort, without them.
    fn fit(&mut self, painter: &Painter, width: f32) {
        self.stacked = self.size(painter).x > width;
        if self.size(painter).x > width {
            self.marks.iter_mut().for_each(|mark| mark.2.clear());
        }
    }

    /// Size including the plate.
    fn size(&self, painter: &Painter) -> Vec2 {
        self.text(painter).size() + 2.0 * MARGIN
    }
}

/// Draws the labels. If a 2012 `stepper` moves the main box, its label has that name.
pub(super) fn draw(
    context: &Context,
    seen: &Seen<'_>,
    area: &PictureArea,
    stepper: Option<Stepper>,
) {
    let (run, layout) = (seen.run, seen.layout);
    if layout == Layout::Solo || run.comparisons.is_empty() {
        return;
    }
    // In pixels: the views and their union.
    let pixels = |r: bevy::math::URect| points(r.as_rect(), 1.0 / context.pixels_per_point());
    let views = (layout == Layout::Views).then_some(area);
    let view = views.map_or(seen.view, |area| pixels(area.0));
    let cells = views.map(|area| cells(area.0, seen.trajectories.len()));
    let cells: Vec<Rect> = cells.into_iter().flatten().map(pixels).collect();
    let layer = LayerId::new(Order::Background, "labels".into());
    let painter = &context.layer_painter(layer).with_clip_rect(view);
    let narrow = layout != Layout::Views && view.width() < NARROW;
    let mut labels = labels(seen, narrow, stepper);
    match layout {
        Layout::Views => {
            for (label, cell) in labels.iter_mut().zip(&cells) {
                label.fit(painter, cell.width() - 20.0);
                plate(painter, label.text(painter), cell.min + vec2(10.0, 10.0));
            }
            if let Some(text) = left_out(seen) {
                let text = painter.layout_no_wrap(text, style::PICTURE_FONT, style::PICTURE_WEAK);
                let height = text.size().y + 2.0 * MARGIN.y;
                plate(
                    painter,
                    text,
                    view.left_bottom() + vec2(10.0, -10.0 - height),
                );
            }
        }
        Layout::SideBySide => {
            let mut taken: Vec<Rect> = Vec::new();
            for label in &labels {
                let Some(at) = label.at else {
                    continue;
                };
                let size = label.size(painter);
                let mut corner = at - vec2(0.5 * size.x, size.y);
                let over = |corner| Rect::from_min_size(corner, size);
                // Above the labels that are already placed.
                while let Some(other) = taken.iter().find(|t| t.intersects(over(corner))) {
                    corner.y = other.top() - size.y - 2.0;
                }
                taken.push(plate(painter, label.text(painter), corner));
            }
        }
        Layout::Solo | Layout::Overlaid => {
            let position = run.main_box.state().position.as_vec3();
            let edge = position + *seen.eye.right() * run.law.body.radius() as f32;
            let (center, edge) = (seen.at(position), seen.at(edge));
            let reach = center.zip(edge).map_or(0.0, |(a, b)| a.distance(b));
            let mut room = view;
            room.min.y += area.1;
            if let Some(strip) = strip_place(seen) {
                room.max.y = strip.top();
            }
            at_the_boxes(painter, room, &labels, center, reach);
        }
    }
}

/// The comparisons without a view, if there are any.
fn left_out(seen: &Seen<'_>) -> Option<String> {
    let shown = |i: Integrator| seen.trajectories.iter().any(|t| t.integrator == i);
    let others = seen.run.integrators().filter(|&i| !shown(i));
    let marks: Vec<String> = others.map(|i| style::of(i).glyph.to_string()).collect();
    let text = format!("{} not shown: {}", marks.len(), marks.join(" "));
    (!marks.is_empty()).then_some(text)
}

/// A label for the reference in the overlaid layout, and one for each trajectory, or group of equal ones.
fn labels(seen: &Seen<'_>, narrow: bool, stepper: Option<Stepper>) -> Vec<Label> {
    let (run, layout) = (seen.run, seen.layout);
    let attitude = run.attitude_says_more();
    let mut labels: Vec<Label> = Vec::new();
    if let (Some(reference), Layout::Overlaid) = (run.trusted(), layout) {
        let mut name = "Reference".to_owned();
        // The camera follows a box in flight, so the label shows its rise or fall.
        if run.law.floor().is_none() && run.law.forces.gravity.length() > 0.0 {
            let rise = reference.position.y - run.start().position.y;
            let side = if rise < 0.0 { "below" } else { "above" };
            name += &format!(", {} m {side} the start", short(rise.abs()));
        }
        labels.push(Label {
            marks: vec![('┄', Color32::WHITE, name)],
            at: seen.at(reference.point(seen.tip).as_vec3()),
            ..Label::default()
        });
    }
    for (k, t) in seen.trajectories.iter().enumerate() {
        let quality = Quality::of(t.track.now.worst, run.late(t.track), t.status, attitude);
        let mut name = match stepper {
            Some(stepper) if k == 0 => stepper.name().to_owned(),
            _ if narrow => String::new(),
            _ => t.integrator.name().to_owned(),
        };
        if k == 0 && !narrow {
            name.push_str(" (main box)");
        }
        let radius = run.law.body.radius() as f32;
        let above = t.state.position.as_vec3() + t.offset + Vec3::Y * radius * 1.25;
        let side_by_side = layout == Layout::SideBySide;
        let looks = style::of(t.integrator);
        let label = Label {
            marks: vec![(looks.glyph, looks.ink_on_picture(), name)],
            word: match quality {
                Quality::Right => quality.sign().to_owned(),
                _ => format!("{} {quality}", quality.sign()),
            },
            bad: quality != Quality::Right,
            at: seen.at(if side_by_side {
                above
            } else {
                t.place(seen.tip)
            }),
            stacked: false,
        };
        let near = |other: &&mut Label| {
            let distance = other.at.zip(label.at).map(|(a, b)| a.distance(b));
            distance.is_some_and(|d| d < TOGETHER) && !other.bad && !label.bad
        };
        match labels.iter_mut().find(near) {
            Some(same) if layout == Layout::Overlaid => {
                same.marks.extend(label.marks);
                same.word = label.word;
            }
            _ => labels.push(label),
        }
    }
    labels
}

/// The labels at their boxes, outside the circle of radius `reach` around `center` that the main box fills. They form a
/// legend if there is no room.
fn at_the_boxes(painter: &Painter, view: Rect, labels: &[Label], center: Option<Pos2>, reach: f32) {
    let sizes: Vec<Vec2> = labels.iter().map(|label| label.size(painter)).collect();
    let center = center.filter(|_| labels.len() <= MAX_LABELS);
    let places = center.and_then(|c| arrange(view.shrink(8.0), labels, &sizes, c, reach));
    let Some(places) = places else {
        let mut corner = view.min + vec2(10.0, 10.0);
        for label in labels {
            corner.y = plate(painter, label.text(painter), corner).bottom() + 3.0;
        }
        return;
    };
    for (label, place) in labels.iter().zip(&places) {
        if let Some(at) = label.at {
            let color = label.marks[0].1.gamma_multiply(0.8);
            painter.line_segment([place.clamp(at), at], Stroke::new(1.5, color));
        }
    }
    for (label, place) in labels.iter().zip(&places) {
        plate(painter, label.text(painter), place.min);
    }
}

/// A place for every label that overlaps neither the others nor the box; `None` if one has no such place.
fn arrange(
    view: Rect,
    labels: &[Label],
    sizes: &[Vec2],
    center: Pos2,
    reach: f32,
) -> Option<Vec<Rect>> {
    let mut places: Vec<Rect> = Vec::new();
    let body = Rect::from_center_size(center, Vec2::splat(1.7 * reach));
    for (label, &size) in labels.iter().zip(sizes) {
        let at = label.at?;
        let mut out = at - center;
        if out.length() < 6.0 {
            out = vec2(0.3, -1.0);
        }
        // From inside the box, the line first has to leave it.
        let inside = (reach - out.length()).max(0.0);
        let mut tries = REACH.iter().flat_map(|length| {
            TURNS.iter().map(move |turn| {
                let direction = Rot2::from_angle(*turn) * out.normalized();
                let near = at + (inside + *length) * direction;
                // The side of the label that faces the box is at the end of the line.
                Rect::from_center_size(near + 0.5 * size * direction, size)
            })
        });
        let place = tries.find(|place| {
            view.contains_rect(*place)
                && !place.intersects(body)
                && places.iter().all(|p| !p.expand(2.0).intersects(*place))
        })?;
        places.push(place);
    }
    Some(places)
}

/// Draws a label's plate; returns its area.
fn plate(painter: &Painter, text: Arc<Galley>, corner: Pos2) -> Rect {
    let place = Rect::from_min_size(corner, text.size() + 2.0 * MARGIN);
    painter.rect_filled(place, 5.0, style::PICTURE_PLATE);
    painter.galley(corner + MARGIN, text, style::PICTURE_TEXT);
    place
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_egui::egui::{RawInput, pos2};

    fn label(at: (f32, f32)) -> Label {
        Label {
            at: Some(at.into()),
            ..Label::default()
        }
    }

    /// A name is dropped only if even two lines have no room for it.
    #[test]
    fn a_name_is_the_last_to_go() {
        let context = Context::default();
        let _ = context.run_ui(RawInput::default(), |ui| {
            for (width, stacked, named) in [
                (500.0, false, true),
                (200.0, true, true),
                (60.0, true, false),
            ] {
                let mut label = Label {
                    marks: vec![('▲', Color32::WHITE, "Semi-implicit Euler".to_owned())],
                    word: "⏰ flip 2 late by 0.40 s".to_owned(),
                    ..Label::default()
                };
                label.fit(ui.painter(), width);
                assert_eq!(label.stacked, stacked, "{width}");
                assert_eq!(!label.marks[0].2.is_empty(), named, "{width}");
            }
        });
    }

    /// Labels are near their points, and do not overlap each other or the box; otherwise there are none.
    #[test]
    fn labels_find_a_place_near_their_boxes_or_none() {
        let view = Rect::from_min_size(Pos2::ZERO, vec2(800.0, 400.0));
        let center = pos2(400.0, 200.0);
        let labels = [
            label((420.0, 150.0)),
            label((424.0, 152.0)),
            label((380.0, 260.0)),
        ];
        let sizes = [vec2(170.0, 24.0); 3];
        let places = arrange(view, &labels, &sizes, center, 60.0).expect("room for three");
        for (k, place) in places.iter().enumerate() {
            let at = labels[k].at.expect("seen");
            assert!(place.distance_to_pos(at) < 150.0 && view.contains_rect(*place));
            assert!(places[..k].iter().all(|other| !other.intersects(*place)));
            assert!(!place.contains(center));
        }
        let small = Rect::from_min_size(Pos2::ZERO, vec2(150.0, 90.0));
        assert!(arrange(small, &labels, &sizes, center, 60.0).is_none());
    }
}
