//! The curves. Every plot leaves the wheel to the panel, breaks its lines at what is not a number, and
//! says in words what it shows, for screen readers.

use bevy_egui::egui::{
    Color32, Label, Rangef, Rect, Response, RichText, ScrollArea, Stroke, TextStyle, Ui, UiBuilder,
    WidgetInfo, WidgetType, pos2, vec2,
};
use box_physics::prelude::Integrator;
use egui_plot::{
    AxisHints, Corner, HoverPosition, Legend, Line, LineStyle, Plot, PlotPoints, PlotUi, Points,
};

use super::super::decimate::{decimate, segments, staircase};
use super::super::format::number;
use super::super::linear_axis;
use super::super::log_axis::{from_axis, marks, tick, to_axis};
use super::super::view::PanelView;
use crate::compare::verdict::short;
use crate::view::style::{self, IntegratorStyle};

/// Width of a column of the legend beside the plot [points].
const LEGEND: f32 = 140.0;
/// The plot keeps this much beside a legend, or there is none [points].
const PLOT_BESIDE_LEGEND: f32 = 220.0;
/// A plot lower than this is no use; the drawer scrolls instead.
const LOWEST: f32 = 90.0;

/// Cost of a body-step of every integrator on the scene's bodies, the minimum, on a log axis. The legend stands beside the plot, as
/// with all integrators it would cover it; a narrow drawer has none, and the list of integrators serves.
pub(super) fn timing(ui: &mut Ui, view: &PanelView) {
    let clock = view
        .history
        .grain
        .map_or_else(String::new, |(grain, part)| {
            format!(
                " · clock: steps of {} µs, samples ±{} %",
                number(grain),
                number(100.0 * part)
            )
        });
    ui.add(
        Label::new(
            RichText::new(format!(
                "fastest sample of two seconds · plugin {} a step · comparisons {} µs · panel {} µs · frame {} ms{clock}",
                view.step_time(),
                short(view.compare.comparisons_ms * 1e3),
                short(view.compare.panel_ms * 1e3),
                short(view.frame_time_ms),
            ))
            .small(),
        )
        .truncate(),
    );
    let whole = ui.available_rect_before_wrap();
    let line = ui.text_style_height(&TextStyle::Small);
    let rows = ((whole.height() / line) as usize).max(1);
    let columns = Integrator::ALL.len().div_ceil(rows);
    let width = LEGEND * columns as f32;
    let right = if whole.width() - width >= PLOT_BESIDE_LEGEND {
        whole.right() - width - 8.0
    } else {
        whole.right()
    };
    if right < whole.right() {
        for (k, &integrator) in Integrator::ALL.iter().enumerate() {
            let (column, row) = ((k / rows) as f32, (k % rows) as f32);
            let at = pos2(right + 8.0 + column * LEGEND, whole.top() + row * line);
            let name = RichText::new(style::marked_name(integrator))
                .color(style::of(integrator).ink(ui.ctx().theme()));
            let cell = Rect::from_min_size(at, vec2(LEGEND, line));
            ui.scope_builder(UiBuilder::new().max_rect(cell), |ui| {
                ui.add(Label::new(name.small()).truncate());
            });
        }
    }
    let place = Rect::from_min_max(whole.min, pos2(right, whole.bottom()));
    ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        scrolled(ui, |ui| timing_plot(ui, view));
    });
}

fn timing_plot(ui: &mut Ui, view: &PanelView) {
    let plot = frame("Timing")
        .x_axis_label("wall time [s]")
        .x_grid_spacer(linear_axis::along)
        .y_axis_label("ns per step of a box")
        .y_grid_spacer(marks)
        .y_axis_formatter(|mark, range| tick(mark, *range.start(), *range.end()))
        .label_formatter(|at| {
            Some(time_and(at, |y| {
                format!(
                    "{} ns per step of a box, the fastest sample",
                    number(from_axis(y))
                )
            }))
        });
    let response = plot
        .show(ui, |plot| {
            for (&integrator, history) in Integrator::ALL.iter().zip(&view.history.timing) {
                let mut points = decimate(history.iter().map(|&(t, ns)| [t, ns]));
                for point in &mut points {
                    point[1] = to_axis(point[1]);
                }
                let width = if integrator == view.integrator {
                    3.0
                } else {
                    1.5
                };
                line(
                    plot,
                    &style::marked_name(integrator),
                    &points,
                    style::of(integrator),
                    width,
                );
            }
        })
        .response;
    describe(
        &response,
        "Minimum of nanoseconds per step of a box under every integrator over wall time, logarithmic",
    );
}

/// CPU use of the process and the system, as stairs: the system measures it only now and then.
pub(super) fn cpu(ui: &mut Ui, view: &PanelView) {
    if let Some(reason) = view.history.no_cpu {
        ui.label(reason);
        return;
    }
    scrolled(ui, |ui| {
        let plot = frame("CPU")
            .legend(
                Legend::default()
                    .position(Corner::LeftTop)
                    .follow_insertion_order(true),
            )
            .include_y(0.0)
            .include_y(100.0)
            .x_axis_label("wall time [s]")
            .x_grid_spacer(linear_axis::along)
            .y_axis_label("% of all cores")
            .label_formatter(|at| Some(time_and(at, |y| format!("{} % of all cores", number(y)))));
        let history = &view.history.cpu;
        let response = plot
            .show(ui, |plot| {
                let process = staircase(history.iter().map(|&(t, process, _)| [t, process]));
                let system = staircase(history.iter().map(|&(t, _, system)| [t, system]));
                for (name, points, looks) in [
                    ("● this process", process, style::PROCESS),
                    ("○ whole system", system, style::SYSTEM),
                ] {
                    line(plot, name, &decimate(points.iter().copied()), looks, 2.0);
                }
            })
            .response;
        let (process, system) = history
            .last()
            .map_or((f64::NAN, f64::NAN), |&(_, p, s)| (p, s));
        let now = format!(
            "now {} % this process, {} % whole system",
            number(process),
            number(system)
        );
        describe(&response, &format!("CPU use over wall time, {now}"));
    });
}

/// A plot with the settings that all share.
pub(super) fn frame<'a>(name: &str) -> Plot<'a> {
    Plot::new(name.to_owned())
        .allow_scroll(false)
        // Labels may stand closer than usual: the plots are small.
        .custom_x_axes(vec![
            AxisHints::new_x().label_spacing(Rangef::new(36.0, 60.0)),
        ])
        // After the axes, which would replace it.
        .x_axis_formatter(|mark, _| number(mark.value))
        .custom_y_axes(vec![
            AxisHints::new_y().label_spacing(Rangef::new(15.0, 24.0)),
        ])
        .min_size(vec2(60.0, LOWEST))
        .set_margin_fraction(vec2(0.01, 0.08))
}

/// In a scroll area, for windows too low for a plot.
pub(super) fn scrolled(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    let height = ui.available_height().max(LOWEST + 30.0);
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .show(ui, |ui| {
            ui.set_max_height(height);
            add(ui);
        });
}

/// Longest path that is dashed [points]. A noisy line of a thousand points runs up and down for tens of
/// thousands; its dashes run together and cost more than the rest of the panel.
const DASHED: f32 = 4000.0;

/// A line, broken where it is not finite, with its mark at the newest point.
pub(super) fn line(
    plot: &mut PlotUi<'_>,
    name: &str,
    points: &[[f64; 2]],
    looks: IntegratorStyle,
    width: f32,
) {
    let color: Color32 = looks.ink(plot.ctx().theme());
    let dash = if path_length(plot, points) <= DASHED {
        looks.dash
    } else {
        LineStyle::Solid
    };
    let mut last = None;
    for stretch in segments(points) {
        last = stretch.last().copied();
        plot.line(
            Line::new(name, PlotPoints::new(stretch.to_vec()))
                .stroke(Stroke::new(width, color))
                .style(dash),
        );
    }
    if let Some(last) = last {
        let points = PlotPoints::new(vec![last]);
        plot.points(
            Points::new(name, points)
                .shape(looks.marker)
                .radius(4.5)
                .color(color),
        );
    }
}

/// Length of the line on the screen of the last frame [points], without gaps.
fn path_length(plot: &PlotUi<'_>, points: &[[f64; 2]]) -> f32 {
    let scale = plot.transform().dpos_dvalue();
    points
        .windows(2)
        .map(|pair| {
            let [dx, dy] = [0, 1].map(|axis| (pair[1][axis] - pair[0][axis]) * scale[axis]);
            dx.hypot(dy) as f32
        })
        .filter(|length| length.is_finite())
        .sum()
}

/// The label at the cursor: name of the line, time, value.
pub(super) fn time_and(at: &HoverPosition<'_>, value: impl Fn(f64) -> String) -> String {
    match at {
        HoverPosition::NearDataPoint {
            plot_name,
            position,
            ..
        } => {
            format!(
                "{plot_name}\nt = {:.3} s\n{}",
                position.x,
                value(position.y)
            )
        }
        HoverPosition::Elsewhere { position } => {
            format!("t = {:.3} s\n{}", position.x, value(position.y))
        }
    }
}

pub(super) fn describe(response: &Response, what: &str) {
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Image, true, what));
}
