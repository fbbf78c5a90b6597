//! Labels in the picture: name and verdict at every box, on a short line to it; in one legend where they would
//! overlap.

use bevy::prelude::*;
use bevy_egui::{EguiContexts, egui};
use egui::text::LayoutJob;

use super::events::strip_place;
use super::shown::{Shown, drawn, shown, tip};
use crate::action::compare::Layout;
use crate::camera::views::{PictureArea, SplitView, cells};
use crate::compare::verdict::Quality;
use crate::compare::{Comparison, Run};
use crate::demo_2012::Demo2012;
use crate::scene::session::Session;
use crate::view::style;

/// In a picture narrower than this \[points\] a label is the integrator's mark without its name.
const NARROW: f32 = 460.0;
/// Two boxes whose marked points are this close \[points\] share a label.
const TOGETHER: f32 = 10.0;
/// Lengths of the line to a label that are tried \[points\], and directions beside the straight one \[rad\].
const REACH: [f32; 3] = [26.0, 52.0, 84.0];
const TURNS: [f32; 7] = [0.0, 0.5, -0.5, 1.0, -1.0, 1.6, -1.6];
/// More labels than this are a legend.
const MOST: usize = 5;
/// Room around the text of a label.
const MARGIN: egui::Vec2 = egui::vec2(7.0, 4.0);

/// Where world points are seen, and the room for labels.
pub(super) struct Seen<'a> {
    camera: &'a Camera,
    eye: &'a GlobalTransform,
    scale: f32,
    /// The picture \[points\].
    pub(super) view: egui::Rect,
}

impl Seen<'_> {
    /// A point of the world on the screen.
    pub(super) fn at(&self, world: Vec3) -> Option<egui::Pos2> {
        let at = self.camera.world_to_viewport(self.eye, world).ok()?;
        Some(egui::pos2(at.x * self.scale, at.y * self.scale))
    }
}

/// The picture of the first camera.
pub(super) fn seen<'a>(
    context: &egui::Context,
    camera: Option<(&'a Camera, &'a GlobalTransform)>,
    window: &Query<&Window>,
) -> Option<Seen<'a>> {
    let (camera, eye) = camera?;
    let scale = window.iter().next().map_or(1.0, Window::scale_factor) / context.pixels_per_point();
    let view = camera.logical_viewport_rect()?;
    let point = |v: Vec2| egui::pos2(v.x * scale, v.y * scale);
    Some(Seen {
        camera,
        eye,
        scale,
        view: egui::Rect::from_min_max(point(view.min), point(view.max)),
    })
}

/// What a label says.
struct Label {
    marks: Vec<(&'static str, egui::Color32, String)>,
    word: String,
    bad: bool,
    at: Option<egui::Pos2>,
}

impl Label {
    fn text(&self, painter: &egui::Painter) -> std::sync::Arc<egui::Galley> {
        let mut job = LayoutJob::default();
        let format = |color| egui::TextFormat::simple(style::PICTURE_FONT, color);
        for (k, (glyph, color, name)) in self.marks.iter().enumerate() {
            if k > 0 {
                job.append(" = ", 0.0, format(style::PICTURE_WEAK));
            }
            job.append(glyph, 0.0, format(*color));
            job.append(&format!(" {name}"), 0.0, format(style::PICTURE_TEXT));
        }
        let word = if self.bad {
            style::PICTURE_BAD
        } else {
            style::PICTURE_GOOD
        };
        job.append(&format!("  {}", self.word), 0.0, format(word));
        painter.layout_job(job)
    }
}

/// A word for every trajectory.
pub(super) fn quality(run: &Run, (_, _, track, _, status): &Shown<'_>, attitude: bool) -> Quality {
    Quality::of(track.now.worst, run.late(track), *status, attitude)
}

/// Draws the labels.
pub(super) fn draw_labels(
    comparison: Res<Comparison>,
    session: Option<Res<Session>>,
    demo: Option<Res<Demo2012>>,
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
    if layout == Layout::Solo || run.comparisons.is_empty() {
        return Ok(());
    }
    // In pixels; the views and the whole of them.
    let pixels = |r: URect| {
        let corner =
            |c: UVec2| egui::Pos2::from(c.as_vec2().to_array()) / context.pixels_per_point();
        egui::Rect::from_min_max(corner(r.min), corner(r.max))
    };
    let trajectories = shown(run, layout);
    let cells: Vec<egui::Rect> = match (&area, layout) {
        (Some(area), Layout::Views) => cells(area.0, trajectories.len())
            .into_iter()
            .map(pixels)
            .collect(),
        _ => Vec::new(),
    };
    let view = match &area {
        Some(area) if layout == Layout::Views => pixels(area.0),
        _ => seen.view,
    };
    let painter = context
        .layer_painter(egui::LayerId::new(egui::Order::Background, "labels".into()))
        .with_clip_rect(view);
    // The demo of 2012 moves its box itself.
    let stepper = match (&demo, &session) {
        (Some(demo), Some(session)) => demo.active(session),
        _ => None,
    };
    let narrow = cells.first().unwrap_or(&view).width() < NARROW;
    let attitude = run.attitude_says_more();
    let (tip, radius) = (tip(run), run.law.body.radius() as f32);
    let mut labels: Vec<Label> = Vec::new();
    if let (Some(reference), Layout::Overlaid) = (run.trusted(), layout) {
        labels.push(Label {
            marks: vec![("┄", egui::Color32::WHITE, "Reference".to_owned())],
            word: String::new(),
            bad: false,
            at: seen.at(reference.point(tip).as_vec3()),
        });
    }
    for (k, trajectory) in trajectories.iter().enumerate() {
        let (integrator, state, _, offset, _) = trajectory;
        let quality = quality(run, trajectory, attitude);
        let looks = style::of(*integrator);
        let mut name = match stepper {
            Some(stepper) if k == 0 => stepper.name().to_owned(),
            _ if narrow => String::new(),
            _ => integrator.name().to_owned(),
        };
        if k == 0 && !narrow {
            name.push_str(" (main box)");
        }
        let world = match layout {
            Layout::SideBySide => state.position.as_vec3() + *offset + Vec3::Y * radius * 1.25,
            _ => state.point(tip).as_vec3() + *offset,
        };
        let label = Label {
            marks: vec![(looks.glyph, looks.color(), name)],
            word: match quality {
                Quality::Right => quality.sign().to_owned(),
                _ => format!("{} {quality}", quality.sign()),
            },
            bad: quality != Quality::Right,
            at: seen.at(world),
        };
        let near = |other: &&mut Label| match (other.at, label.at) {
            (Some(a), Some(b)) => a.distance(b) < TOGETHER && !other.bad && !label.bad,
            _ => false,
        };
        match labels.iter_mut().find(near) {
            Some(same) if layout == Layout::Overlaid => {
                same.marks.extend(label.marks);
                same.word = label.word;
            }
            _ => labels.push(label),
        }
    }
    match layout {
        Layout::Views => {
            for (label, cell) in labels.iter().zip(&cells) {
                plate(&painter, label, cell.min + egui::vec2(10.0, 10.0));
            }
        }
        Layout::SideBySide => {
            let mut taken: Vec<egui::Rect> = Vec::new();
            for label in &labels {
                let Some(at) = label.at else {
                    continue;
                };
                let size = label.text(&painter).size() + 2.0 * MARGIN;
                let mut corner = egui::pos2(at.x - 0.5 * size.x, at.y - size.y);
                let over = |corner| egui::Rect::from_min_size(corner, size);
                // Above those that are there already.
                while let Some(other) = taken.iter().find(|t| t.intersects(over(corner))) {
                    corner.y = other.top() - size.y - 2.0;
                }
                taken.push(plate(&painter, label, corner));
            }
        }
        Layout::Solo | Layout::Overlaid => {
            let center = seen.at(run.main_box.state.position.as_vec3());
            let edge = run.main_box.state.position.as_vec3() + *seen.eye.right() * radius;
            let reach = match (center, seen.at(edge)) {
                (Some(center), Some(edge)) => center.distance(edge),
                _ => 0.0,
            };
            let mut room = view;
            room.min.y += area.as_ref().map_or(0.0, |area| area.1);
            if let Some(strip) = strip_place(run, &trajectories, layout, view) {
                room.max.y = strip.top();
            }
            at_the_boxes(&painter, room, &labels, center, reach);
        }
    }
    Ok(())
}

/// The labels at their boxes, outside the circle of radius `reach` around `center` that the main box fills; in a
/// legend if there is no room.
fn at_the_boxes(
    painter: &egui::Painter,
    view: egui::Rect,
    labels: &[Label],
    center: Option<egui::Pos2>,
    reach: f32,
) {
    let sizes: Vec<egui::Vec2> = labels
        .iter()
        .map(|label| label.text(painter).size() + 2.0 * MARGIN)
        .collect();
    let places = center
        .filter(|_| labels.len() <= MOST)
        .and_then(|center| arrange(view.shrink(8.0), labels, &sizes, center, reach));
    match places {
        Some(places) => {
            for (label, place) in labels.iter().zip(&places) {
                if let Some(at) = label.at {
                    let color = label.marks[0].1.gamma_multiply(0.8);
                    painter.line_segment([place.clamp(at), at], egui::Stroke::new(1.5, color));
                }
            }
            for (label, place) in labels.iter().zip(&places) {
                plate(painter, label, place.min);
            }
        }
        None => {
            let mut corner = view.min + egui::vec2(10.0, 10.0);
            for label in labels {
                corner.y = plate(painter, label, corner).bottom() + 3.0;
            }
        }
    }
}

/// A place for every label, free of the others and of the box; `None` if one of them finds none.
fn arrange(
    view: egui::Rect,
    labels: &[Label],
    sizes: &[egui::Vec2],
    center: egui::Pos2,
    reach: f32,
) -> Option<Vec<egui::Rect>> {
    let mut places: Vec<egui::Rect> = Vec::new();
    let body = egui::Rect::from_center_size(center, egui::Vec2::splat(1.7 * reach));
    for (label, &size) in labels.iter().zip(sizes) {
        let at = label.at?;
        let out = at - center;
        let out = if out.length() < 6.0 {
            egui::vec2(0.3, -1.0)
        } else {
            out
        };
        // From inside the box, the line first has to leave it.
        let inside = (reach - out.length()).max(0.0);
        let tries = REACH
            .iter()
            .flat_map(|length| TURNS.iter().map(move |turn| (length, turn)));
        let place = tries
            .map(|(length, turn)| {
                let direction = egui::emath::Rot2::from_angle(*turn) * out.normalized();
                let near = at + (inside + *length) * direction;
                // The side of the label that faces the box is at the end of the line.
                let shift = egui::vec2(
                    0.5 * size.x * direction.x.clamp(-1.0, 1.0),
                    0.5 * size.y * direction.y.clamp(-1.0, 1.0),
                );
                egui::Rect::from_center_size(near + shift, size)
            })
            .find(|place| {
                view.contains_rect(*place)
                    && !place.intersects(body)
                    && places.iter().all(|p| !p.expand(2.0).intersects(*place))
            })?;
        places.push(place);
    }
    Some(places)
}

/// A label's plate; returns its place.
fn plate(painter: &egui::Painter, label: &Label, corner: egui::Pos2) -> egui::Rect {
    let text = label.text(painter);
    let place = egui::Rect::from_min_size(corner, text.size() + 2.0 * MARGIN);
    painter.rect_filled(place, 5.0, style::PICTURE_PLATE);
    painter.galley(corner + MARGIN, text, style::PICTURE_TEXT);
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(at: (f32, f32)) -> Label {
        Label {
            marks: Vec::new(),
            word: String::new(),
            bad: false,
            at: Some(egui::pos2(at.0, at.1)),
        }
    }

    /// Labels stand near their points, apart from each other and from the box, or not at all.
    #[test]
    fn labels_find_a_place_near_their_boxes_or_none() {
        let view = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(800.0, 400.0));
        let center = egui::pos2(400.0, 200.0);
        let labels = [
            label((420.0, 150.0)),
            label((424.0, 152.0)),
            label((380.0, 260.0)),
        ];
        let sizes = [egui::vec2(170.0, 24.0); 3];
        let places = arrange(view, &labels, &sizes, center, 60.0).expect("room for three");
        for (k, place) in places.iter().enumerate() {
            let at = labels[k].at.expect("seen");
            assert!(place.distance_to_pos(at) < 150.0 && view.contains_rect(*place));
            assert!(places[..k].iter().all(|other| !other.intersects(*place)));
            assert!(!place.contains(center));
        }
        let small = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(150.0, 90.0));
        assert!(arrange(small, &labels, &sizes, center, 60.0).is_none());
    }
}
