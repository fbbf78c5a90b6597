//! Common parts of all plots, and the plots of timing and CPU usage. Every plot ignores the mouse wheel, has gaps at
//! non-finite values, and has a description for screen readers.

use bevy_egui::egui::{Rangef, Rect, ScrollArea, Stroke, TextStyle, Ui, pos2, vec2};
use box_physics::prelude::Integrator;
use egui_plot::{
    AxisHints, Corner, HoverPosition, Legend, Line, LineStyle, Plot, PlotPoint, PlotPoints, PlotUi,
    Points, log_grid_spacer,
};

use super::super::axis::{self, ALONG, UPRIGHT, from_axis, to_axis};
use super::super::decimate::{MAX_POINTS, decimate, segments};
use super::super::format::number;
use super::super::view::PanelView;
use super::super::widgets::{describe, note, within};
use crate::compare::verdict::short;
use crate::view::style::{self, IntegratorStyle};

/// Width of a column of the legend beside the plot, and minimum width of the plot [points].
const LEGEND: f32 = 140.0;
const PLOT: f32 = 220.0;
/// Minimum height of a plot [points]; a lower drawer scrolls.
pub(super) const LOWEST: f32 = 90.0;

/// Minimum cost of a body-step of every integrator on the scene's bodies, on a log axis. The legend is beside the plot
/// because it would cover it. A narrow drawer has no legend; the list of integrators replaces it.
pub(super) fn timing(ui: &mut Ui, view: &PanelView) {
    let clock = view.grain.map(|(grain, part)| {
        let (grain, part) = (number(grain), number(100.0 * part));
        format!(" · clock resolution {grain} µs, samples ±{part} %")
    });
    let micros = |ms: f64| view.measured(1e3 * ms, |us| format!("{} µs", short(us)));
    note(
        ui,
        format!(
            "fastest sample of two seconds · plugin {} per step · comparisons {} · panel {} · frame {} ms{}",
            view.step_time(),
            micros(view.compare.comparisons_ms),
            micros(view.compare.panel_ms),
            short(view.frame_time_ms),
            clock.unwrap_or_default(),
        ),
    );
    let line = ui.text_style_height(&TextStyle::Small);
    let rows = ((ui.available_height() / line) as usize).max(1);
    let columns = Integrator::ALL.len().div_ceil(rows);
    let legend = |ui: &mut Ui| {
        let corner = ui.max_rect().min;
        for (k, &integrator) in Integrator::ALL.iter().enumerate() {
            let at = corner + vec2((k / rows) as f32 * LEGEND, (k % rows) as f32 * line);
            within(ui, Rect::from_min_size(at, vec2(LEGEND, line)), |ui| {
                let name = style::in_ink(ui, integrator, style::marked_name(integrator));
                note(ui, name);
            });
        }
    };
    with_legend(ui, [LEGEND * columns as f32, PLOT], legend, |ui| {
        timing_plot(ui, view);
    });
}

fn timing_plot(ui: &mut Ui, view: &PanelView) {
    let axes = [("wall time [s]", false), ("ns per box and step", true)];
    let plot = frame("Timing", axes).label_formatter(|at| {
        let unit = "ns per box and step, fastest sample";
        hover(at, |p| {
            format!("t = {:.3} s\n{} {unit}", p.x, number(from_axis(p.y)))
        })
    });
    let draw = |plot: &mut PlotUi<'_>| {
        for (&integrator, history) in Integrator::ALL.iter().zip(&view.timing_history) {
            let points: Vec<_> = history.iter().map(|&(t, ns)| [t, ns]).collect();
            let points = decimate(MAX_POINTS, &points);
            let points: Vec<_> = points.iter().map(|&[t, ns]| [t, to_axis(ns)]).collect();
            let width = if integrator == view.integrator {
                3.0
            } else {
                1.5
            };
            let name = style::marked_name(integrator);
            line(plot, &name, &points, style::of(integrator), width);
        }
    };
    describe(
        &plot.show(ui, draw).response,
        "Minimum nanoseconds per box and step of every integrator over wall time, logarithmic",
    );
}

/// CPU usage of the process and the system.
pub(super) fn cpu(ui: &mut Ui, view: &PanelView) {
    if let Some(reason) = view.no_cpu {
        ui.label(reason);
        return;
    }
    let history = &view.cpu_history;
    let process: Vec<_> = history
        .iter()
        .map(|&(t, process, _)| [t, process])
        .collect();
    let system: Vec<_> = history.iter().map(|&(t, _, system)| [t, system]).collect();
    let now = [&process, &system].map(|points| number(points.last().map_or(f64::NAN, |p| p[1])));
    let legend = Legend::default().position(Corner::LeftTop);
    scrolled(ui, |ui| {
        let plot = frame("CPU", [("wall time [s]", false), ("% of all cores", false)])
            .legend(legend.follow_insertion_order(true))
            .include_y(0.0)
            .include_y(100.0)
            .y_grid_spacer(log_grid_spacer(10))
            .label_formatter(|at| {
                hover(at, |p| {
                    format!("t = {:.3} s\n{} % of all cores", p.x, number(p.y))
                })
            });
        let draw = |plot: &mut PlotUi<'_>| {
            for (name, points, looks) in [
                ("this process", process, style::PROCESS),
                ("whole system", system, style::SYSTEM),
            ] {
                line(plot, name, &decimate(MAX_POINTS, &points), looks, 2.0);
            }
        };
        let response = plot.show(ui, draw).response;
        let [process, system] = now;
        let now = format!("now {process} % this process, {system} % whole system");
        describe(&response, &format!("CPU usage over wall time, {now}"));
    });
}

/// Creates a plot with the common settings. Each axis has a label, and is logarithmic if `true`.
pub(super) fn frame<'a>(name: &str, [x, y]: [(&str, bool); 2]) -> Plot<'a> {
    let hints = |hints: AxisHints<'a>, (label, log): (&str, bool)| {
        let hints = hints.label(label);
        hints.formatter(move |mark, range| axis::label(log, mark, range))
    };
    // Labels may stand closer than usual: the plots are small.
    let along = hints(AxisHints::new_x(), x).label_spacing(Rangef::new(36.0, 60.0));
    let upright = hints(AxisHints::new_y(), y).label_spacing(Rangef::new(15.0, 24.0));
    Plot::new(name.to_owned())
        .allow_scroll(false)
        .custom_x_axes(vec![along])
        .custom_y_axes(vec![upright])
        .x_grid_spacer(axis::marks(x.1, ALONG))
        .y_grid_spacer(axis::marks(y.1, UPRIGHT))
        .min_size(vec2(60.0, LOWEST))
        .set_margin_fraction(vec2(0.01, 0.08))
}

/// Adds contents in a scroll area, for windows too low for a plot.
pub(super) fn scrolled(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    let height = ui.available_height().max(LOWEST + 30.0);
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .show(ui, |ui| {
            ui.set_max_height(height);
            add(ui);
        });
}

/// Adds a plot with a legend of this width beside it. Omits the legend if the plot would be narrower than `least`
/// [points].
pub(super) fn with_legend(
    ui: &mut Ui,
    [width, least]: [f32; 2],
    legend: impl FnOnce(&mut Ui),
    plot: impl FnOnce(&mut Ui),
) {
    let whole = ui.available_rect_before_wrap();
    let mut place = whole;
    if whole.width() - width >= least {
        place.max.x -= width + 8.0;
        let beside = pos2(place.right() + 8.0, whole.top());
        within(ui, Rect::from_min_max(beside, whole.max), legend);
    }
    within(ui, place, |ui| scrolled(ui, plot));
}

/// Longest path that is dashed [points]. The dashes of longer, noisy lines run together and cost more than the rest of
/// the panel.
const DASHED: f32 = 4000.0;

/// Draws a line with gaps at non-finite values and a marker at the newest point.
pub(super) fn line(
    plot: &mut PlotUi<'_>,
    name: &str,
    points: &[[f64; 2]],
    looks: IntegratorStyle,
    width: f32,
) {
    let color = looks.ink(plot.ctx().theme());
    let dash = if path_length(plot, points) <= DASHED {
        looks.dash
    } else {
        LineStyle::Solid
    };
    for stretch in segments(points) {
        let line = Line::new(name, PlotPoints::new(stretch.to_vec()));
        plot.line(line.stroke(Stroke::new(width, color)).style(dash));
    }
    if let Some(last) = segments(points).last().and_then(|stretch| stretch.last()) {
        let mark = Points::new(name, *last).shape(looks.marker);
        plot.points(mark.radius(4.5).color(color));
    }
}

/// Length of the line on the screen of the last frame [points], without gaps.
fn path_length(plot: &PlotUi<'_>, points: &[[f64; 2]]) -> f32 {
    let scale = plot.transform().dpos_dvalue();
    let length = |pair: &[[f64; 2]]| {
        let [dx, dy] = [0, 1].map(|axis| (pair[1][axis] - pair[0][axis]) * scale[axis]);
        dx.hypot(dy) as f32
    };
    let lengths = points.windows(2).map(length);
    lengths.filter(|length| length.is_finite()).sum()
}

/// The label at the cursor: name of the line, and `text` of the point.
pub(super) fn hover(at: &HoverPosition<'_>, text: impl Fn(&PlotPoint) -> String) -> Option<String> {
    Some(match at {
        HoverPosition::NearDataPoint {
            plot_name,
            position,
            ..
        } => format!("{plot_name}\n{}", text(position)),
        HoverPosition::Elsewhere { position } => text(position),
    })
}
