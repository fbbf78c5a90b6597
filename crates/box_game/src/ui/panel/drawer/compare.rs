//! Error and energy of every trajectory over time, with a common time axis and cursor, and vertical
//! lines where something happened.

use bevy_egui::egui::{
    Align2, Color32, Label, Rect, RichText, Sense, Theme, Ui, UiBuilder, Vec2b, WidgetInfo,
    WidgetType, pos2, vec2,
};
use egui_plot::{Axis, HLine, LineStyle, PlotPoint, PlotUi, Span, Text, VLine};

use super::super::format::number;
use super::super::linear_axis;
use super::super::log_axis::{from_axis, marks, tick, to_axis};
use super::plots::{describe, frame, line, scrolled, time_and};
use crate::compare::verdict::{ROUNDING, short};
use crate::compare::{CompareView, Quantity, RuleKind, TrajectoryView};
use crate::view::style;
use box_scenarios::Status;

/// Plots stand side by side if each has this width, else one above the other [points].
const NARROWEST: f32 = 200.0;
/// A plot lower than this is no use; the drawer scrolls instead [points].
const LOWEST: f32 = 90.0;
/// Width of the energy bars, and of a drawer that has room for them [points].
const BARS: f32 = 150.0;
const ROOM_FOR_BARS: f32 = 760.0;
/// Marks of the time axis that are shown at most.
const MOST_RULES: usize = 200;

/// The colors of the three energies: those of no integrator's line.
const ENERGIES: [(&str, Color32); 3] = [
    ("translation", Color32::from_rgb(0x8d, 0xa0, 0xcb)),
    ("rotation", Color32::from_rgb(0xe7, 0xd4, 0x8f)),
    ("potential", Color32::from_rgb(0x80, 0x88, 0x90)),
];

/// Distance and angle to the reference.
pub(super) fn error(ui: &mut Ui, view: &CompareView) {
    let quantities = if view.settings.local {
        [Quantity::LocalPosition, Quantity::LocalAttitude]
    } else {
        [Quantity::Position, Quantity::Attitude]
    };
    let (named, unit) = if view.attitude { (1, "°") } else { (0, " m") };
    let plots = telling(view, &quantities);
    legend(ui, view, quantities[named], unit, &plots);
    beside(ui, plots.0.len(), |ui, k| {
        curve(ui, view, plots.0[k], view.settings.logarithmic);
    });
}

/// The quantities that differ from rounding in some trajectory, or else the first; and the others.
fn telling(view: &CompareView, quantities: &[Quantity]) -> (Vec<Quantity>, Vec<Quantity>) {
    let tells = |q: &Quantity| {
        let lines = view.trajectories.iter().flat_map(|t| &t.lines);
        let mut points = lines
            .filter(|(of, _)| of == q)
            .flat_map(|(_, points)| points);
        points.any(|p| p[1].abs() > ROUNDING)
    };
    let (mut telling, mut others): (Vec<_>, Vec<_>) = quantities.iter().copied().partition(tells);
    if telling.is_empty() {
        telling.push(others.remove(0));
    }
    (telling, others)
}

/// Quantities that should be constant: energy, |L| and the direction of L, less what is accounted for.
pub(super) fn energy(ui: &mut Ui, view: &CompareView) {
    let quantities = [Quantity::Energy, Quantity::Momentum, Quantity::Direction];
    let plots = telling(view, &quantities);
    legend(ui, view, Quantity::Energy, " %", &plots);
    let (log, plots) = (view.settings.logarithmic_energy, plots.0);
    let bars = ui.available_width() >= ROOM_FOR_BARS;
    let whole = ui.available_rect_before_wrap();
    let mut rest = whole;
    if bars {
        let place = Rect::from_min_size(whole.min, vec2(BARS, whole.height()));
        ui.scope_builder(UiBuilder::new().max_rect(place), |ui| energy_bars(ui, view));
        rest.min.x += BARS + 8.0;
    }
    ui.scope_builder(UiBuilder::new().max_rect(rest), |ui| {
        beside(ui, plots.len(), |ui, k| curve(ui, view, plots[k], log));
    });
}

/// Name, figure and state of every trajectory in one wrapped line: the plots' legend.
fn legend(
    ui: &mut Ui,
    view: &CompareView,
    quantity: Quantity,
    unit: &str,
    (_, still): &(Vec<Quantity>, Vec<Quantity>),
) {
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
            let color = style::of(trajectory.integrator).ink(ui.ctx().theme());
            ui.add(Label::new(RichText::new(text).color(color).small()).extend());
        }
        for quantity in still {
            let name = quantity.label().split(" [").next().unwrap_or_default();
            ui.add(Label::new(RichText::new(format!("{name}: none")).small().weak()).extend());
        }
        let caption = match quantity {
            Quantity::Energy if view.conservative => {
                "should be constant; the drift is numerical error".to_owned()
            }
            Quantity::Energy => {
                "excludes work by forces, contact and pushes; what remains is numerical error"
                    .to_owned()
            }
            _ => match view.horizon {
                Some(t) => format!("reference: {} · chaotic after {t:.1} s", view.reference),
                None => format!("reference: {}", view.reference),
            },
        };
        ui.add(Label::new(RichText::new(caption).small().weak()).truncate());
    });
}

/// `n` plots side by side, or one above the other where that is too narrow.
fn beside(ui: &mut Ui, n: usize, mut draw: impl FnMut(&mut Ui, usize)) {
    let width = (ui.available_width() - 8.0 * (n - 1) as f32) / n as f32;
    if width >= NARROWEST {
        let whole = ui.available_rect_before_wrap();
        for k in 0..n {
            let corner = whole.min + vec2(k as f32 * (width + 8.0), 0.0);
            let place = Rect::from_min_size(corner, vec2(width, whole.height().max(LOWEST)));
            ui.scope_builder(UiBuilder::new().max_rect(place), |ui| draw(ui, k));
        }
    } else {
        scrolled(ui, |ui| {
            // Each has its height, whatever the drawer has.
            ui.set_max_height(n as f32 * (LOWEST + 30.0));
            for k in 0..n {
                ui.allocate_ui(vec2(ui.available_width(), LOWEST + 20.0), |ui| draw(ui, k));
            }
        });
    }
}

fn curve(ui: &mut Ui, view: &CompareView, quantity: Quantity, logarithmic: bool) {
    let scale = quantity.scale();
    let mut plot = frame(quantity.label())
        .link_axis("time of the trajectories", Vec2b::new(true, false))
        .link_cursor("time of the trajectories", Vec2b::new(true, false))
        .x_axis_label("simulated time [s]")
        .y_axis_label(quantity.label())
        .x_grid_spacer(linear_axis::along)
        .label_formatter(move |at| {
            Some(time_and(at, |y| {
                let value = if logarithmic { from_axis(y) } else { y };
                format!("{} {}", number(value), quantity.label())
            }))
        });
    plot = if logarithmic {
        plot.y_grid_spacer(marks)
            .y_axis_formatter(|mark, range| tick(mark, *range.start(), *range.end()))
            .include_y(to_axis(ROUNDING))
    } else {
        // Rounding noise on a constant must not fill the plot.
        plot.include_y(-1e-9)
            .include_y(1e-9)
            .y_grid_spacer(linear_axis::marks)
            .y_axis_formatter(|mark, _| number(mark.value))
    };
    let response = plot
        .show(ui, |plot| {
            rules(plot, view);
            bands(plot, view, quantity, logarithmic);
            // The main box last, over the others.
            for trajectory in view.trajectories.iter().rev() {
                let width = if trajectory.main_box { 2.5 } else { 1.6 };
                let name = style::marked_name(trajectory.integrator);
                for (_, points) in trajectory.lines.iter().filter(|(q, _)| *q == quantity) {
                    let looks = style::of(trajectory.integrator);
                    if logarithmic {
                        let place =
                            |p: &[f64; 2]| [p[0], to_axis((scale * p[1].abs()).max(ROUNDING))];
                        let log: Vec<_> = points.iter().map(place).collect();
                        line(plot, &name, &log, looks, width);
                    } else {
                        let scaled: Vec<_> = points.iter().map(|p| [p[0], scale * p[1]]).collect();
                        line(plot, &name, &scaled, looks, width);
                    }
                }
            }
        })
        .response;
    describe(&response, &in_words(view, quantity));
}

/// On a logarithmic axis of errors: the floor of rounding, and the band in which an error can be seen.
fn bands(plot: &mut PlotUi<'_>, view: &CompareView, quantity: Quantity, logarithmic: bool) {
    let (Some(visible), true) = (quantity.visible(), logarithmic) else {
        return;
    };
    let dark = plot.ctx().theme() == Theme::Dark;
    let tint = if dark { 255 } else { 0 };
    plot.span(
        // Without a name, which it would write across the band; the text below is the same.
        Span::new("", to_axis(visible)..=to_axis(1e6))
            .axis(Axis::Y)
            .fill(Color32::from_rgba_unmultiplied(tint, tint, tint, 10))
            .border_width(0.0),
    );
    let floor = HLine::new("rounding", to_axis(ROUNDING));
    plot.hline(floor.color(Color32::GRAY).allow_hover(false));
    // At the oldest sample: at the plot's edge a text would widen the plot in every frame.
    let lines = view.trajectories.iter().flat_map(|t| &t.lines);
    let times = lines.filter_map(|(_, points)| points.first().map(|p| p[0]));
    let start = times.fold(f64::INFINITY, f64::min);
    if start.is_infinite() {
        return;
    }
    for (text, at) in [("rounding", ROUNDING), ("visible to the eye", visible)] {
        let place = PlotPoint::new(start, to_axis(at));
        let label = Text::new(text, place, RichText::new(text).small());
        plot.text(label.anchor(Align2::LEFT_BOTTOM).allow_hover(false));
    }
}

/// For screen readers: what is plotted and where every line stands.
fn in_words(view: &CompareView, quantity: Quantity) -> String {
    let figures: Vec<String> = view
        .trajectories
        .iter()
        .map(|trajectory| {
            format!(
                "{} {}",
                trajectory.integrator.name(),
                number(quantity.scale() * trajectory.get(quantity))
            )
        })
        .collect();
    format!(
        "{} over simulated time, now {}",
        quantity.label(),
        figures.join(", ")
    )
}

/// A thin line for each event.
fn rules(plot: &mut PlotUi<'_>, view: &CompareView) {
    let newest = view.rules.len().saturating_sub(MOST_RULES);
    let start = view
        .trajectories
        .iter()
        .flat_map(|l| &l.lines)
        .filter_map(|(_, points)| points.first())
        .map(|p| p[0])
        .fold(f64::INFINITY, f64::min);
    for rule in view.rules[newest..].iter().filter(|r| r.t >= start) {
        let (name, color, dash) = match rule.kind {
            RuleKind::Contact => ("contact", Color32::from_gray(105), LineStyle::Solid),
            RuleKind::Input => ("push or change", Color32::from_rgb(150, 110, 150), DASHES),
            RuleKind::Step => ("dt changed", Color32::from_rgb(90, 140, 170), DASHES),
            RuleKind::Integrator => (
                "integrator changed",
                Color32::from_rgb(170, 140, 80),
                DASHES,
            ),
            RuleKind::Resync => ("re-sync", Color32::from_gray(160), DASHES),
        };
        plot.vline(
            VLine::new(name, rule.t)
                .color(color)
                .width(1.0)
                .style(dash)
                .allow_hover(false),
        );
    }
}

const DASHES: LineStyle = LineStyle::Dashed { length: 4.0 };

/// A stacked bar for each trajectory: where its energy is.
fn energy_bars(ui: &mut Ui, view: &CompareView) {
    let most = view
        .trajectories
        .iter()
        .map(|l| {
            l.energies
                .iter()
                .filter(|e| e.is_finite())
                .map(|e| e.abs())
                .sum()
        })
        .fold(1e-12_f64, f64::max);
    ui.add(
        Label::new(RichText::new(format!("energy, full bar {} J", number(most))).small())
            .truncate(),
    );
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        for (name, color) in ENERGIES {
            ui.add(Label::new(RichText::new(name).small().color(color)).extend());
        }
    });
    // All of them fit: a drawer that grows with them would not shrink again.
    ui.spacing_mut().item_spacing.y = 2.0;
    let height = (ui.available_height() / view.trajectories.len().max(1) as f32).clamp(5.0, 22.0);
    for trajectory in &view.trajectories {
        let (place, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), height - 2.0), Sense::hover());
        let [t, r, p] = trajectory.energies;
        let text = format!(
            "{}: translation {} J, rotation {} J, potential {} J",
            trajectory.integrator.name(),
            number(t),
            number(r),
            number(p)
        );
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Image, true, &text));
        let painter = ui.painter_at(place);
        let mut x = place.left() + 16.0;
        let scale = (place.width() - 16.0) / most as f32;
        painter.text(
            pos2(place.left(), place.center().y),
            Align2::LEFT_CENTER,
            style::of(trajectory.integrator).glyph,
            bevy_egui::egui::FontId::proportional((height - 2.0).clamp(5.0, 12.0)),
            style::of(trajectory.integrator).ink(ui.ctx().theme()),
        );
        for (energy, (_, color)) in trajectory.energies.iter().zip(ENERGIES) {
            let width = (energy.abs() as f32 * scale).min(place.right() - x);
            if width.is_finite() && width > 0.0 {
                let bar = Rect::from_min_size(pos2(x, place.top()), vec2(width, place.height()));
                painter.rect_filled(bar, 0.0, color);
                x += width;
            }
        }
        response.on_hover_text(text);
    }
}

/// Figures of a comparison that stand for all of it in a row of text.
pub(super) fn state(trajectory: &TrajectoryView) -> String {
    if trajectory.skew > 0.0 {
        format!(
            "{} · input {} s late",
            trajectory.status,
            number(trajectory.skew)
        )
    } else {
        trajectory.status.to_string()
    }
}
