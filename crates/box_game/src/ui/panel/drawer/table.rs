//! Table of the values of every trajectory.

use bevy_egui::egui::{Grid, Label, RichText, ScrollArea, Ui, vec2};
use box_bench::measure::Cost;
use box_physics::prelude::Integrator;

use super::super::format::{number, quantity, step_size};
use crate::compare::{CompareView, Quantity, TrajectoryView};
use crate::view::style;

#[rustfmt::skip]
const HEADINGS: [(&str, &str); 12] = [
    ("integrator", "Main box first, then comparisons, then all others."),
    ("min [ns]", "Fastest sample of the last two seconds per box and step, on this scene's boxes and the plugin's code path."),
    ("median [ns]", "Median of these samples."),
    ("p95 [ns]", "95th percentile of these samples."),
    ("force evals", "Force evaluations per step, measured."),
    ("dt", "Step size."),
    ("position error [m]", "Current distance from the reference."),
    ("attitude error [°]", "Current angle to the reference."),
    ("ΔE/E₀", "Energy change not caused by pushes, forces or contact."),
    ("Δ|L|/|L₀|", "Change of |L| not caused by pushes, forces or contact."),
    ("order", "The error of free rotation decreases with this power of dt."),
    ("state", "ok, contact, resting, catching up, or the time of divergence."),
];

/// Draws the table. `timings` are of every integrator; those without a comparison follow below.
pub(super) fn show(ui: &mut Ui, compare: &CompareView, timings: &[(Option<Cost>, f64)]) {
    let trajectories = &compare.trajectories;
    let compared = |i: Integrator| trajectories.iter().any(|t| t.integrator == i);
    let grid = Grid::new("integrators").striped(true).spacing([14.0, 3.0]);
    let rows = |ui: &mut Ui| {
        for (heading, hint) in HEADINGS {
            ui.add(Label::new(RichText::new(heading).strong()).extend())
                .on_hover_text(hint);
        }
        ui.end_row();
        for t in trajectories {
            row(ui, t.integrator, (t.cost, t.evaluations), Some(t));
        }
        for (&integrator, &timing) in Integrator::ALL.iter().zip(timings) {
            if !compared(integrator) {
                row(ui, integrator, timing, None);
            }
        }
    };
    let area = ScrollArea::both().auto_shrink([false, false]);
    area.show(ui, |ui| grid.show(ui, rows));
}

fn row(
    ui: &mut Ui,
    integrator: Integrator,
    (cost, evaluations): (Option<Cost>, f64),
    trajectory: Option<&TrajectoryView>,
) {
    let info = integrator.info();
    ui.horizontal(|ui| {
        let mark = style::in_ink(ui, integrator, style::of(integrator).glyph);
        // Marks differ in width, but the names are aligned.
        ui.add_sized(vec2(16.0, ui.spacing().interact_size.y), Label::new(mark));
        let name = match trajectory {
            Some(t) if t.main_box => RichText::new(format!("{} · main box", info.name)).strong(),
            Some(_) => RichText::new(info.name).strong(),
            None => RichText::new(info.name),
        };
        ui.add(Label::new(name).extend());
    });
    let figures = cost.map(|c| [c.min, c.median, c.p95].map(quantity));
    for figure in figures.unwrap_or_else(|| ["…"; 3].map(str::to_owned)) {
        ui.monospace(figure);
    }
    ui.monospace(number(evaluations));
    let Some(trajectory) = trajectory else {
        for _ in 0..5 {
            ui.weak("–");
        }
        ui.label(info.orders.rotation.to_string());
        ui.weak("not simulated");
        ui.end_row();
        return;
    };
    ui.monospace(step_size(trajectory.dt));
    for q in [
        Quantity::Position,
        Quantity::Attitude,
        Quantity::Energy,
        Quantity::Momentum,
    ] {
        ui.monospace(figure(trajectory.get(q)));
    }
    ui.label(info.orders.rotation.to_string());
    let mut state = trajectory.status.to_string();
    if trajectory.skew > 0.0 {
        state += &format!(" · input {} s late", number(trajectory.skew));
    }
    let state = RichText::new(state);
    let diverged = trajectory.diverged();
    ui.label(if diverged { state.strong() } else { state });
    ui.end_row();
}

/// Only the magnitude of a small error matters: two digits and an exponent.
fn figure(value: f64) -> String {
    if !value.is_finite() {
        "–".to_owned()
    } else if value == 0.0 || (0.01..1e4).contains(&value.abs()) {
        number(value)
    } else {
        format!("{value:.1e}")
    }
}
