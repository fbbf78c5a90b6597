//! Error and energy of every trajectory over time, with a common time axis and cursor, and marks of events.

use bevy_egui::egui::{
    Align2, Color32, FontId, Label, Rect, RichText, Sense, Stroke, Theme, Ui, pos2, vec2,
};
use egui_plot::{Axis, HLine, LineStyle, PlotPoint, PlotTransform, PlotUi, Span, Text, VLine};

use super::super::axis::{from_axis, to_axis};
use super::super::format::number;
use super::super::widgets::{describe, note, within};
use super::plots::{LOWEST, frame, hover, line, scrolled};
use crate::compare::verdict::{ROUNDING, short};
use crate::compare::{CompareView, MarkKind, Quantity};
use crate::view::style;
use box_scenarios::Status;

/// Minimum width of plots that are side by side; narrower ones are stacked [points].
const NARROWEST: f32 = 200.0;
/// Width of the energy bars, and of a drawer with enough room for them [points].
const BARS: f32 = 150.0;
const ROOM_FOR_BARS: f32 = 760.0;
/// Height of the time axis, and width of a letter in the label of the vertical axis [points].
const AXIS: f32 = 36.0;
const LETTER: f32 = 5.6;
/// Height of the tick of a contact or flip [points].
const TICK: f32 = 8.0;
/// Maximum number of event lines.
const MAX_MARK_LINES: usize = 200;
/// The common axis of all curves.
const TIME: &str = "time of the trajectories";

/// The colors of the three energies, which differ from those of the integrators.
const ENERGIES: [(&str, [u8; 3]); 3] = [
    ("translation", [0x8D, 0xA0, 0xCB]),
    ("rotation", [0xE7, 0xD4, 0x8F]),
    ("potential", [0x80, 0x88, 0x90]),
];

/// Distance and angle to the reference.
pub(super) fn error(ui: &mut Ui, view: &CompareView) {
    let quantities = if view.settings.local {
        [Quantity::LocalPosition, Quantity::LocalAttitude]
    } else {
        [Quantity::Position, Quantity::Attitude]
    };
    let (named, unit) = if view.attitude { (1, "°") } else { (0, " m") };
    let (plots, still) = telling(view, &quantities);
    legend(ui, view, quantities[named], unit, &still);
    curves(ui, view, &plots, view.settings.logarithmic);
}

/// Quantities that should be constant: energy, |L| and the direction of L, without the accounted changes.
pub(super) fn energy(ui: &mut Ui, view: &CompareView) {
    let quantities = [Quantity::Energy, Quantity::Momentum, Quantity::Direction];
    let (plots, still) = telling(view, &quantities);
    legend(ui, view, Quantity::Energy, " %", &still);
    let mut rest = ui.available_rect_before_wrap();
    if rest.width() >= ROOM_FOR_BARS {
        let place = Rect::from_min_size(rest.min, vec2(BARS, rest.height()));
        within(ui, place, |ui| energy_bars(ui, view));
        rest.min.x += BARS + 8.0;
    }
    within(ui, rest, |ui| {
        curves(ui, view, &plots, view.settings.logarithmic_energy);
    });
}

/// The quantities that differ from rounding in some trajectory (at least the first one), and the others.
fn telling(view: &CompareView, quantities: &[Quantity]) -> (Vec<Quantity>, Vec<Quantity>) {
    let tells = |q: &Quantity| {
        let lines = view.trajectories.iter().flat_map(|t| &t.lines);
        let mut lines = lines.filter(|(of, _)| of == q);
        lines.any(|(_, points)| points.iter().any(|p| p[1].abs() > ROUNDING))
    };
    let (mut telling, mut others): (Vec<_>, Vec<_>) = quantities.iter().copied().partition(tells);
    if telling.is_empty() {
        telling.push(others.remove(0));
    }
    (telling, others)
}

/// Name, value and state of every trajectory in one wrapped line: the plots' legend.
fn legend(ui: &mut Ui, view: &CompareView, quantity: Quantity, unit: &str, still: &[Quantity]) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 14.0;
        for trajectory in &view.trajectories {
            let value = quantity.scale() * trajectory.get(quantity);
            let mut text = style::marked_name(trajectory.integrator);
            if trajectory.main_box {
                text.push_str(" (main)");
            }
            if value.is_finite() {
                text.push_str(&format!(" {}{unit}", short(value)));
            }
            if trajectory.status != Status::Ok {
                text.push_str(&format!(" · {}", trajectory.status));
            }
            let text = style::in_ink(ui, trajectory.integrator, text);
            ui.add(Label::new(text.small()).extend());
        }
        let mut kinds: Vec<MarkKind> = Vec::new();
        for mark in &view.marks {
            if !kinds.contains(&mark.kind) {
                kinds.push(mark.kind);
                let (name, rgb) = looks(mark.kind);
                let color = style::ink(rgb, ui.ctx().theme());
                let text = RichText::new(format!("| {name}")).small();
                ui.add(Label::new(text.color(color)).extend());
            }
        }
        for quantity in still {
            let name = quantity.label().split(" [").next().unwrap_or_default();
            ui.add(Label::new(RichText::new(format!("{name}: none")).small().weak()).extend());
        }
        let caption = match (quantity, view.horizon) {
            (Quantity::Energy, _) if view.conservative => {
                "should be constant; the drift is numerical error".to_owned()
            }
            (Quantity::Energy, _) => {
                "excludes work by forces, contact and pushes; what remains is numerical error"
                    .to_owned()
            }
            (_, Some(t)) => format!("reference: {} · chaotic after {t:.1} s", view.reference),
            _ => format!("reference: {}", view.reference),
        };
        note(ui, RichText::new(caption).weak());
    });
}

/// Plots side by side, or stacked if that is too narrow.
fn curves(ui: &mut Ui, view: &CompareView, quantities: &[Quantity], log: bool) {
    let n = quantities.len() as f32;
    let width = (ui.available_width() - 8.0 * (n - 1.0)) / n;
    if width >= NARROWEST {
        let whole = ui.available_rect_before_wrap();
        let size = vec2(width, whole.height().max(LOWEST));
        for (k, &quantity) in quantities.iter().enumerate() {
            let corner = whole.min + vec2(k as f32 * (width + 8.0), 0.0);
            within(ui, Rect::from_min_size(corner, size), |ui| {
                curve(ui, view, quantity, log);
            });
        }
    } else {
        scrolled(ui, |ui| {
            // Each plot has a fixed height, independent of the drawer.
            ui.set_max_height(n * (LOWEST + 30.0));
            for &quantity in quantities {
                let size = vec2(ui.available_width(), LOWEST + 20.0);
                ui.allocate_ui(size, |ui| curve(ui, view, quantity, log));
            }
        });
    }
}

fn curve(ui: &mut Ui, view: &CompareView, quantity: Quantity, log: bool) {
    let (scale, label) = (quantity.scale(), quantity.label());
    // Rounding noise on a constant must not fill the plot.
    let least = if log {
        [to_axis(ROUNDING); 2]
    } else {
        [-1e-9, 1e-9]
    };
    // A low plot shows only the unit, because a long label would cover the legend.
    let unit = label.find('[').map_or(label, |start| &label[start..]);
    let wide = ui.available_height() > AXIS + LETTER * label.len() as f32;
    let axis = if wide { label } else { unit };
    let plot = frame(label, [("simulated time [s]", false), (axis, log)])
        .link_axis(TIME, [true, false])
        .link_cursor(TIME, [true, false])
        .include_y(least[0])
        .include_y(least[1])
        .label_formatter(move |at| {
            let value = |y| number(if log { from_axis(y) } else { y });
            hover(at, |p| format!("t = {:.3} s\n{} {label}", p.x, value(p.y)))
        });
    let place = |&[t, y]: &[f64; 2]| match log {
        true => [t, to_axis((scale * y.abs()).max(ROUNDING))],
        false => [t, scale * y],
    };
    let draw = |plot: &mut PlotUi<'_>| {
        let lines = view.trajectories.iter().flat_map(|t| &t.lines);
        let times = lines.filter_map(|(_, points)| points.first().map(|p| p[0]));
        let start = times.fold(f64::INFINITY, f64::min);
        mark_lines(plot, view, start);
        if let (Some(visible), true) = (quantity.visible(), log) {
            bands(plot, visible, start);
        }
        // Draws the main box last, over the others.
        for trajectory in view.trajectories.iter().rev() {
            let width = if trajectory.main_box { 2.5 } else { 1.6 };
            let name = style::marked_name(trajectory.integrator);
            for (_, points) in trajectory.lines.iter().filter(|(q, _)| *q == quantity) {
                let points: Vec<_> = points.iter().map(place).collect();
                line(
                    plot,
                    &name,
                    &points,
                    style::of(trajectory.integrator),
                    width,
                );
            }
        }
    };
    let shown = plot.show(ui, draw);
    ticks(ui, &shown.transform, view);
    let figures = view.trajectories.iter().map(|trajectory| {
        let figure = number(scale * trajectory.get(quantity));
        format!("{} {figure}", trajectory.integrator.name())
    });
    let figures = figures.collect::<Vec<_>>().join(", ");
    let words = format!("{label} over simulated time, now {figures}");
    describe(&shown.response, &words);
}

/// On a logarithmic error axis: the floor of rounding, and the range of visible errors.
fn bands(plot: &mut PlotUi<'_>, visible: f64, start: f64) {
    let dark = plot.ctx().theme() == Theme::Dark;
    let tint = if dark { 255 } else { 0 };
    // Without a name, which would be written across the band; the text below is the same.
    let band = Span::new("", to_axis(visible)..=to_axis(1e6)).axis(Axis::Y);
    let fill = Color32::from_rgba_unmultiplied(tint, tint, tint, 10);
    plot.span(band.fill(fill).border_width(0.0));
    let floor = HLine::new("rounding", to_axis(ROUNDING));
    plot.hline(floor.color(Color32::GRAY).allow_hover(false));
    if start.is_infinite() {
        return;
    }
    // At the oldest sample, because a text at the plot's edge would widen the plot in every frame.
    // Between the two lines, because either may be an edge of the plot.
    for (text, at, anchor) in [
        ("rounding", ROUNDING, Align2::LEFT_BOTTOM),
        ("visible to the eye", visible, Align2::LEFT_TOP),
    ] {
        let place = PlotPoint::new(start, to_axis(at));
        // Spaces separate it from the curves, which rise there.
        let label = Text::new(text, place, RichText::new(format!("  {text}")).small());
        plot.text(label.anchor(anchor).allow_hover(false));
    }
}

/// Name and color of an event.
const fn looks(kind: MarkKind) -> (&'static str, [u8; 3]) {
    match kind {
        MarkKind::Contact => ("contact", [140; 3]),
        MarkKind::Flip => ("flip", [180; 3]),
        MarkKind::Input => ("push or change", [150, 110, 150]),
        MarkKind::Step => ("dt changed", [90, 140, 170]),
        MarkKind::Integrator => ("integrator changed", [170, 140, 80]),
        MarkKind::Resync => ("re-sync", [160; 3]),
    }
}

/// Returns `true` for contacts and flips, which repeat; their ticks do not cover the curves.
const fn repeats(kind: MarkKind) -> bool {
    matches!(kind, MarkKind::Contact | MarkKind::Flip)
}

/// A dashed line for each other event since `start`.
fn mark_lines(plot: &mut PlotUi<'_>, view: &CompareView, start: f64) {
    let lines = view.marks.iter().filter(|m| !repeats(m.kind));
    for mark in lines.rev().take(MAX_MARK_LINES).filter(|m| m.t >= start) {
        let (name, rgb) = looks(mark.kind);
        let color = style::ink(rgb, plot.ctx().theme());
        let line = VLine::new(name, mark.t).color(color).width(1.0);
        let dashed = line.style(LineStyle::Dashed { length: 4.0 });
        plot.vline(dashed.allow_hover(false));
    }
}

/// A tick at the top edge for each contact and flip.
fn ticks(ui: &Ui, transform: &PlotTransform, view: &CompareView) {
    let frame = *transform.frame();
    let painter = ui.painter_at(frame);
    for mark in view.marks.iter().filter(|m| repeats(m.kind)) {
        let x = transform
            .position_from_point(&PlotPoint::new(mark.t, 0.0))
            .x;
        if frame.x_range().contains(x) {
            let color = style::ink(looks(mark.kind).1, ui.ctx().theme());
            let tick = frame.top()..=frame.top() + TICK;
            painter.vline(x, tick, Stroke::new(2.0, color));
        }
    }
}

/// A stacked bar of energies for each trajectory.
fn energy_bars(ui: &mut Ui, view: &CompareView) {
    let total = |energies: &[f64; 3]| -> f64 {
        let finite = energies.iter().filter(|e| e.is_finite());
        finite.map(|e| e.abs()).sum()
    };
    let totals = view.trajectories.iter().map(|t| total(&t.energies));
    let most = totals.fold(1e-12, f64::max);
    note(ui, format!("energy; full bar: {} J", number(most)));
    let theme = ui.ctx().theme();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        for (name, rgb) in ENERGIES {
            let name = RichText::new(name).color(style::ink(rgb, theme));
            ui.add(Label::new(name.small()).extend());
        }
    });
    // All of them fit, because a drawer that grows with them would not shrink again.
    ui.spacing_mut().item_spacing.y = 2.0;
    let height = (ui.available_height() / view.trajectories.len().max(1) as f32).clamp(5.0, 22.0);
    for trajectory in &view.trajectories {
        let size = vec2(ui.available_width(), height - 2.0);
        let (place, response) = ui.allocate_exact_size(size, Sense::hover());
        let name = trajectory.integrator.name();
        let [t, r, p] = trajectory.energies.map(number);
        let text = format!("{name}: translation {t} J, rotation {r} J, potential {p} J");
        describe(&response, &text);
        let painter = ui.painter_at(place);
        let looks = style::of(trajectory.integrator);
        painter.text(
            place.left_center(),
            Align2::LEFT_CENTER,
            looks.glyph,
            FontId::proportional(size.y.clamp(5.0, 12.0)),
            looks.ink(theme),
        );
        let mut x = place.left() + 16.0;
        let scale = (place.width() - 16.0) / most as f32;
        for (energy, (_, rgb)) in trajectory.energies.iter().zip(ENERGIES) {
            let width = (energy.abs() as f32 * scale).min(place.right() - x);
            if width.is_finite() && width > 0.0 {
                let bar = Rect::from_min_size(pos2(x, place.top()), vec2(width, size.y));
                painter.rect_filled(bar, 0.0, style::ink(rgb, theme));
                x += width;
            }
        }
        response.on_hover_text(text);
    }
}
