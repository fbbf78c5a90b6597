//! The figures of every trajectory side by side.

use bevy_egui::egui::{Grid, Label, RichText, ScrollArea, Ui, vec2};
use box_bench::measure::Cost;
use box_physics::prelude::Integrator;

use super::super::format::{number, quantity, step_size};
use super::super::view::IntegratorTiming;
use super::compare::state;
use crate::compare::{CompareView, Quantity, TrajectoryView};
use crate::view::style;

const HEADINGS: [(&str, &str); 12] = [
    ("integrator", "Main box, comparisons, then the rest."),
    (
        "min [ns]",
        "Fastest sample of the last two seconds, per step of a box: every integrator on this scene's boxes, by the plugin's path.",
    ),
    ("median [ns]", "Median of these samples."),
    ("p95 [ns]", "95th percentile of these samples."),
    ("force evals", "Force evaluations per step, as counted."),
    ("dt", "Step size."),
    ("position error [m]", "Distance from the reference, now."),
    ("attitude error [°]", "Angle to the reference, now."),
    (
        "ΔE/E₀",
        "Energy change beyond that of pushes, forces and floor.",
    ),
    ("Δ|L|/|L₀|", "Angular momentum change beyond that."),
    (
        "order",
        "The error of a free rotation falls with this power of dt.",
    ),
    (
        "state",
        "ok, contact, resting, catching up, or when it diverged.",
    ),
];

/// `timings` are of every integrator; those that are not compared stand below.
pub(super) fn show(ui: &mut Ui, compare: &CompareView, timings: &[IntegratorTiming]) {
    ScrollArea::both()
        .auto_shrink([false, false])
        .show(ui, |ui| {
            Grid::new("integrators")
                .striped(true)
                .spacing([14.0, 3.0])
                .show(ui, |ui| {
                    for (heading, hint) in HEADINGS {
                        ui.add(Label::new(RichText::new(heading).strong()).extend())
                            .on_hover_text(hint);
                    }
                    ui.end_row();
                    for trajectory in &compare.trajectories {
                        trajectory_row(ui, trajectory);
                        ui.end_row();
                    }
                    let beside = |t: &&IntegratorTiming| {
                        compare
                            .trajectories
                            .iter()
                            .all(|l| l.integrator != t.integrator)
                    };
                    for timing in timings.iter().filter(beside) {
                        other_row(ui, timing);
                        ui.end_row();
                    }
                });
        });
}

fn mark(ui: &mut Ui, integrator: Integrator) {
    let looks = style::of(integrator);
    // Marks differ in width; the names line up.
    let mark = Label::new(RichText::new(looks.glyph).color(looks.ink(ui.ctx().theme())));
    ui.add_sized(vec2(16.0, ui.spacing().interact_size.y), mark);
}

fn timing(ui: &mut Ui, cost: Option<Cost>, evaluations: f64) {
    let figures = cost.map_or(["…"; 3].map(str::to_owned), |c| {
        [c.min, c.median, c.p95].map(quantity)
    });
    for figure in figures {
        ui.label(RichText::new(figure).monospace());
    }
    ui.label(RichText::new(number(evaluations)).monospace());
}

fn trajectory_row(ui: &mut Ui, trajectory: &TrajectoryView) {
    let info = trajectory.integrator.info();
    let name = RichText::new(format!(
        "{}{}",
        info.name,
        if trajectory.main_box {
            " · main box"
        } else {
            ""
        }
    ));
    ui.horizontal(|ui| {
        mark(ui, trajectory.integrator);
        ui.add(Label::new(name.strong()).extend());
    });
    timing(ui, trajectory.cost, trajectory.evaluations);
    ui.label(RichText::new(step_size(trajectory.dt)).monospace());
    for q in [
        Quantity::Position,
        Quantity::Attitude,
        Quantity::Energy,
        Quantity::Momentum,
    ] {
        let value = trajectory.get(q);
        let text = if value.is_finite() {
            figure(value)
        } else {
            "–".to_owned()
        };
        ui.label(RichText::new(text).monospace());
    }
    ui.label(info.orders.rotation.to_string());
    let text = RichText::new(state(trajectory));
    ui.label(if trajectory.diverged() {
        text.strong()
    } else {
        text
    });
}

/// The size of a small error is all that matters: two digits and an exponent.
fn figure(value: f64) -> String {
    if value == 0.0 || (0.01..1e4).contains(&value.abs()) {
        number(value)
    } else {
        format!("{value:.1e}")
    }
}

fn other_row(ui: &mut Ui, other: &IntegratorTiming) {
    let info = other.integrator.info();
    ui.horizontal(|ui| {
        mark(ui, other.integrator);
        ui.add(Label::new(info.name).extend());
    });
    timing(ui, other.cost, other.evaluations);
    for _ in 0..5 {
        ui.weak("–");
    }
    ui.label(info.orders.rotation.to_string());
    ui.weak("not simulated");
}
