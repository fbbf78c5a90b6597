//! Error against cost, both logarithmic: down and left is better. The dots are the comparisons as they run;
//! the lines are the sweep over step sizes.

use bevy_egui::egui::{Label, ProgressBar, Rect, RichText, Ui, UiBuilder, pos2, vec2};
use egui_plot::{HoverPosition, Line, PlotPoints, Points};

use box_scenarios::statistics::Fitted;

use super::super::decimate::segments;
use super::super::format::number;
use super::super::log_axis::{from_axis, marks, tick, to_axis};
use super::super::memory::PanelMemory;
use super::super::widgets::{Text, button, own_toggle, text};
use super::plots::{describe, frame, scrolled};
use crate::action::Action;
use crate::action::compare::CompareAction;
use crate::compare::sweep::{SweepLine, SweepPoint};
use crate::compare::{CompareView, TrajectoryView};
use crate::view::style;

/// Width of the legend beside the plot, and what the plot keeps beside it [points].
const LEGEND: f32 = 235.0;
const PLOT: f32 = 260.0;

pub(super) fn show(
    ui: &mut Ui,
    view: &CompareView,
    memory: &mut PanelMemory,
    out: &mut Vec<Action>,
) {
    ui.horizontal_wrapped(|ui| controls(ui, view, memory, out));
    let position = memory.sweep_position.unwrap_or(!view.attitude);
    let whole = ui.available_rect_before_wrap();
    let right = if whole.width() - LEGEND >= PLOT {
        whole.right() - LEGEND - 8.0
    } else {
        whole.right()
    };
    if right < whole.right() {
        let place = Rect::from_min_max(pos2(right + 8.0, whole.top()), whole.max);
        ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
            ui.spacing_mut().item_spacing.y = 1.0;
            for trajectory in &view.trajectories {
                let line = view
                    .sweep
                    .lines
                    .iter()
                    .find(|l| l.integrator == trajectory.integrator);
                legend(ui, trajectory, line, position);
            }
        });
    }
    let place = Rect::from_min_max(whole.min, pos2(right, whole.bottom()));
    ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        scrolled(ui, |ui| diagram(ui, view, position));
    });
}

fn controls(ui: &mut Ui, view: &CompareView, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    let sweep = &view.sweep;
    if sweep.running {
        let cancel = text("Cancel sweep", "Stop, and keep the finished lines.");
        button(ui, cancel, CompareAction::CancelSweep, out);
        let (done, total) = sweep.progress;
        let bar = ProgressBar::new(done as f32 / total.max(1) as f32)
            .desired_width(140.0)
            .text(format!("{done} of {total}"));
        ui.add(bar);
    } else {
        let hint = "Run this scene under every selected integrator with dt from 1/15 to 1/1920 s, in the background.";
        button(ui, text("Sweep", hint), CompareAction::StartSweep, out);
    }
    for (position, name, hint) in [
        (false, "attitude", "Largest angle to the reference."),
        (true, "position", "Largest distance from the reference."),
    ] {
        let chosen = memory.sweep_position.unwrap_or(!view.attitude) == position;
        let accessible = format!("{name} error");
        if own_toggle(ui, chosen, Text(name, &accessible, hint), &accessible) {
            memory.sweep_position = Some(position);
        }
    }
    ui.add(
        Label::new(
            RichText::new(
                "dots: now · lines: step sizes from 1/15 to 1/1920 s · lower left is better",
            )
            .small()
            .weak(),
        )
        .truncate(),
    );
}

/// `■ RK4 (Δtᵖ, p = 4.0)`.
fn legend(ui: &mut Ui, trajectory: &TrajectoryView, line: Option<&SweepLine>, position: bool) {
    let mut text = style::marked_name(trajectory.integrator);
    if let Some(line) = line {
        text.push_str(&match line.order(position) {
            Fitted::Order(p) => format!(" (Δt^p, p = {p:.1})"),
            other => format!(" ({other})"),
        });
    }
    let color = style::of(trajectory.integrator).ink(ui.ctx().theme());
    ui.add(Label::new(RichText::new(text).small().color(color)).truncate());
}

fn diagram(ui: &mut Ui, view: &CompareView, position: bool) {
    let unit = if position { "m" } else { "°" };
    let x_label = if position {
        "largest position error [m]"
    } else {
        "largest attitude error [°]"
    };
    let plot = frame("Work–precision")
        .x_axis_label(x_label)
        .y_axis_label("cost [µs/s]")
        .x_grid_spacer(marks)
        .y_grid_spacer(marks)
        .x_axis_formatter(|mark, range| tick(mark, *range.start(), *range.end()))
        .y_axis_formatter(|mark, range| tick(mark, *range.start(), *range.end()))
        .set_margin_fraction(vec2(0.06, 0.1))
        .label_formatter(move |at| {
            let (name, p) = match at {
                HoverPosition::NearDataPoint {
                    plot_name,
                    position,
                    ..
                } => (plot_name.to_string(), *position),
                HoverPosition::Elsewhere { position } => (String::new(), *position),
            };
            Some(format!(
                "{name}\nerror {} {unit}\n{} µs per simulated second",
                number(from_axis(p.x)),
                number(from_axis(p.y))
            ))
        });
    let response = plot
        .show(ui, |plot| {
            for sweep in &view.sweep.lines {
                let looks = style::of(sweep.integrator);
                let name = style::marked_name(sweep.integrator);
                let points: Vec<[f64; 2]> =
                    sweep.points.iter().map(|p| place(p, position)).collect();
                for stretch in segments(&points) {
                    plot.line(
                        Line::new(name.clone(), PlotPoints::new(stretch.to_vec()))
                            .color(looks.ink(plot.ctx().theme()))
                            .width(2.0)
                            .style(looks.dash),
                    );
                    plot.points(
                        Points::new(name.clone(), PlotPoints::new(stretch.to_vec()))
                            .shape(looks.marker)
                            .radius(3.5)
                            .color(looks.ink(plot.ctx().theme())),
                    );
                }
            }
            for trajectory in &view.trajectories {
                let Some(dot) = now(trajectory, position) else {
                    continue;
                };
                let looks = style::of(trajectory.integrator);
                plot.points(
                    Points::new(
                        format!("{} now", style::marked_name(trajectory.integrator)),
                        PlotPoints::new(vec![dot]),
                    )
                    .shape(looks.marker)
                    .filled(trajectory.main_box)
                    .radius(8.0)
                    .color(looks.ink(plot.ctx().theme())),
                );
            }
        })
        .response;
    describe(
        &response,
        "Largest error against cost (µs of computing per simulated second), both logarithmic: dots for now, lines for the sweep over step sizes",
    );
}

fn place(p: &SweepPoint, position: bool) -> [f64; 2] {
    let error = if position { p.position } else { p.attitude };
    [to_axis(error), to_axis(p.cost * 1e-3)]
}

/// A comparison as it runs: its largest error and its cost so far.
fn now(trajectory: &TrajectoryView, position: bool) -> Option<[f64; 2]> {
    let error = if position {
        trajectory.worst.0
    } else {
        trajectory.worst.1
    };
    let at = [to_axis(error), to_axis(trajectory.run_cost? * 1e-3)];
    (at.iter().all(|v| v.is_finite()) && !trajectory.diverged()).then_some(at)
}
