//! Error over cost, both logarithmic; lower left is better. The dots are the running comparisons, the lines are the
//! sweep over step sizes.

use bevy_egui::egui::{Align2, ProgressBar, RichText, Ui, vec2};
use box_scenarios::statistics::Fitted;
use egui_plot::{Line, PlotPoint, PlotPoints, PlotUi, Points, Text as PlotText};

use super::super::axis::{from_axis, to_axis};
use super::super::decimate::segments;
use super::super::format::number;
use super::super::widgets::{Panel, Text, describe, note, text, toggle};
use super::plots::{frame, hover, with_legend};
use crate::action::compare::CompareAction;
use crate::compare::sweep::{SweepLine, SweepPoint};
use crate::compare::{CompareView, TrajectoryView};
use crate::view::style;

/// Width of the legend beside the plot, and of the margin of the plot [points].
const LEGEND: f32 = 235.0;
const PLOT: f32 = 260.0;
/// Number of lines above which marks of the usual step size would overlap.
const MAX_MARKED_LINES: usize = 4;

pub(super) fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    let view = &panel.view.compare;
    ui.horizontal_wrapped(|ui| controls(ui, panel));
    let position = panel.memory.sweep_position.unwrap_or(!view.attitude);
    let names = |ui: &mut Ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        for trajectory in &view.trajectories {
            let mut lines = view.sweep.iter();
            let line = lines.find(|l| l.integrator == trajectory.integrator);
            legend(ui, trajectory, line, position);
        }
    };
    with_legend(ui, [LEGEND, PLOT], names, |ui| diagram(ui, view, position));
}

fn controls(ui: &mut Ui, panel: &mut Panel<'_>) {
    let view = &panel.view.compare;
    if let Some((done, total)) = view.sweeping {
        let cancel = text("Cancel sweep", "Stop and keep the finished lines.");
        panel.button(ui, cancel, CompareAction::CancelSweep);
        let bar = ProgressBar::new(done as f32 / total.max(1) as f32);
        ui.add(bar.desired_width(140.0).text(format!("{done} of {total}")));
    } else {
        let hint =
            "Run every compared integrator with dt from 1/15 to 1/1920 s, in the background.";
        panel.button(ui, text("Sweep", hint), CompareAction::StartSweep);
    }
    for (position, name, hint) in [
        (false, "attitude", "Largest angle to the reference."),
        (true, "position", "Largest distance from the reference."),
    ] {
        let chosen = panel.memory.sweep_position.unwrap_or(!view.attitude) == position;
        let accessible = format!("{name} error");
        if toggle(ui, chosen, Text(name, &accessible, hint), &accessible) {
            panel.memory.sweep_position = Some(position);
        }
    }
    let caption = "dots: this run · lines: step sizes from 1/15 to 1/1920 s · lower left is better";
    note(ui, RichText::new(caption).weak());
}

/// Legend entry: `■ RK4 (Δtᵖ, p = 4.0)`.
fn legend(ui: &mut Ui, trajectory: &TrajectoryView, line: Option<&SweepLine>, position: bool) {
    let mut text = style::marked_name(trajectory.integrator);
    if let Some(line) = line {
        text.push_str(&match line.order(position) {
            Fitted::Order(p) => format!(" (Δt^p, p = {p:.1})"),
            other => format!(" ({other})"),
        });
    }
    let text = style::in_ink(ui, trajectory.integrator, text);
    note(ui, text);
}

fn diagram(ui: &mut Ui, view: &CompareView, position: bool) {
    let (unit, error) = match position {
        true => ("m", "largest position error [m]"),
        false => ("°", "largest attitude error [°]"),
    };
    let cost = "µs per simulated second";
    let plot = frame("Work–precision", [(error, true), ("cost [µs/s]", true)])
        .set_margin_fraction(vec2(0.06, 0.1))
        .label_formatter(move |at| {
            hover(at, |p| {
                let [error, time] = [p.x, p.y].map(|place| number(from_axis(place)));
                format!("error {error} {unit}\n{time} {cost}")
            })
        });
    let draw = |plot: &mut PlotUi<'_>| {
        let theme = plot.ctx().theme();
        for sweep in &view.sweep {
            let looks = style::of(sweep.integrator);
            let name = style::marked_name(sweep.integrator);
            let points: Vec<_> = sweep.points.iter().map(|p| place(p, position)).collect();
            for stretch in segments(&points) {
                let line = Line::new(&name, PlotPoints::new(stretch.to_vec())).width(2.0);
                plot.line(line.color(looks.ink(theme)).style(looks.dash));
                let dots = Points::new(&name, PlotPoints::new(stretch.to_vec())).radius(3.5);
                plot.points(dots.shape(looks.marker).color(looks.ink(theme)));
            }
        }
        for sweep in view.sweep.iter().take(MAX_MARKED_LINES) {
            let usual = |p: &&SweepPoint| (60.0 * p.dt - 1.0).abs() < 1e-6;
            let at = sweep.points.iter().find(usual).map(|p| place(p, position));
            if let Some([x, y]) = at.filter(|at| at.iter().all(|v| v.is_finite())) {
                // Next to the dot of this run, on the side with more room.
                let bounds = plot.plot_bounds();
                let (words, anchor) = match x < bounds.min()[0] + 0.85 * bounds.width() {
                    true => ("\u{a0}\u{a0}\u{a0}\u{a0}\u{a0}1/60 s", Align2::LEFT_CENTER),
                    false => ("1/60 s\u{a0}\u{a0}\u{a0}\u{a0}\u{a0}", Align2::RIGHT_CENTER),
                };
                let words = RichText::new(words).small();
                let mark = PlotText::new("dt", PlotPoint::new(x, y), words);
                plot.text(mark.anchor(anchor).allow_hover(false));
            }
        }
        for trajectory in &view.trajectories {
            let Some(dot) = now(trajectory, position) else {
                continue;
            };
            let looks = style::of(trajectory.integrator);
            let name = format!("{} now", style::marked_name(trajectory.integrator));
            let dot = Points::new(name, dot).shape(looks.marker).radius(8.0);
            plot.points(dot.filled(trajectory.main_box).color(looks.ink(theme)));
        }
    };
    describe(
        &plot.show(ui, draw).response,
        "Largest error against cost per simulated second, both logarithmic: dots for this run, lines for the sweep over step sizes",
    );
}

fn place(p: &SweepPoint, position: bool) -> [f64; 2] {
    let error = if position { p.position } else { p.attitude };
    [to_axis(error), to_axis(p.cost * 1e-3)]
}

/// The dot of a running comparison: its largest error and its cost so far.
fn now(trajectory: &TrajectoryView, position: bool) -> Option<[f64; 2]> {
    let (distance, angle) = trajectory.worst;
    let error = if position { distance } else { angle };
    let at = [to_axis(error), to_axis(trajectory.run_cost? * 1e-3)];
    (at.iter().all(|v| v.is_finite()) && !trajectory.diverged()).then_some(at)
}
