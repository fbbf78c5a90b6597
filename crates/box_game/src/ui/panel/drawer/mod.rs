//! The drawer below the picture: curves over time, error over cost, and the table of integrators.

mod compare;
mod plots;
mod table;
mod work_precision;

use bevy_egui::egui::{Rect, RichText, Ui};

use super::widgets::{Panel, Text, text};
use crate::action::compare::{CompareAction, Window};
use crate::action::{Action, Plot};

/// Time that the plots remain frozen after the pointer has left them \[s\].
const THAW: f64 = 0.3;

/// Every tab, with its name and tooltip.
#[rustfmt::skip]
pub(super) const TABS: [(Plot, &str, &str); 6] = [
    (Plot::Error, "Error", "Position and attitude error over simulated time."),
    (Plot::Energy, "Energy", "Drift of energy and angular momentum over simulated time."),
    (Plot::Timing, "Timing", "Cost per box and step of every integrator over time."),
    (Plot::Cpu, "CPU", "CPU usage over time."),
    (Plot::WorkPrecision, "Work–precision", "Error against cost, live and for a range of step sizes."),
    (Plot::Table, "Table", "Current values of every integrator."),
];

/// Draws the tabs and the content of the selected one; returns its area.
pub(super) fn show(ui: &mut Ui, panel: &mut Panel<'_>) -> Rect {
    let view = panel.view;
    let now = ui.input(|i| i.time);
    let frozen = &mut panel.memory.frozen;
    frozen.take_if(|(held, until)| *until < now || held.plot != view.plot);
    ui.horizontal_wrapped(|ui| {
        for (plot, name, hint) in TABS {
            let accessible = format!("{name} tab");
            let words = Text(name, &accessible, hint);
            panel.choice(ui, view.plot == plot, words, Action::SelectPlot(plot));
        }
        ui.separator();
        tools(ui, panel);
        let hint = "Save this plot or table as plot-NN.png in the current folder.";
        panel.button(ui, Text("PNG", "Save plot", hint), Action::SavePlot(None));
        if panel.memory.frozen.is_some() {
            ui.label(RichText::new("⏸ frozen").strong()).on_hover_text(
                "The plots are frozen while the pointer is over them; the simulation continues.",
            );
        }
    });
    let mut frozen = panel.memory.frozen.take();
    let shown = frozen.as_ref().map_or(view, |(held, _)| held);
    let place = ui.available_rect_before_wrap();
    match view.plot {
        Plot::Error => compare::error(ui, &shown.compare),
        Plot::Energy => compare::energy(ui, &shown.compare),
        Plot::Timing => plots::timing(ui, shown),
        Plot::Cpu => plots::cpu(ui, shown),
        Plot::WorkPrecision => work_precision::show(ui, panel),
        Plot::Table => table::show(ui, &view.compare, &view.timings),
    }
    let pointer = ui.ctx().pointer_latest_pos();
    let over = pointer.is_some_and(|p| place.contains(p)) && ui.rect_contains_pointer(place);
    if over && !matches!(view.plot, Plot::Table | Plot::WorkPrecision) {
        frozen.get_or_insert_with(|| (view.clone(), 0.0)).1 = now + THAW;
    }
    panel.memory.frozen = frozen;
    place
}

fn tools(ui: &mut Ui, panel: &mut Panel<'_>) {
    let (plot, settings) = (panel.view.plot, &panel.view.compare.settings);
    if plot == Plot::Error {
        let (on, log) = (settings.logarithmic, text("log", "Logarithmic axis."));
        panel.toggle(ui, on, log, CompareAction::ToggleLogarithmic);
        let hint = "Local error: of each single step from the reference state; meaningful even in chaotic motion.";
        let local = text("local", hint);
        panel.toggle(ui, settings.local, local, CompareAction::ToggleLocal);
    }
    if plot == Plot::Energy {
        let on = settings.logarithmic_energy;
        let log = text("log", "Magnitude on a logarithmic axis.");
        panel.toggle(ui, on, log, CompareAction::ToggleLogarithmicEnergy);
    }
    if matches!(plot, Plot::Error | Plot::Energy) {
        for (window, name) in Window::ALL {
            let (on, words) = (settings.window == window, text(name, "Time span shown."));
            panel.toggle(ui, on, words, CompareAction::SetWindow(window));
        }
    }
    if !matches!(plot, Plot::Cpu | Plot::Timing) {
        let hint = "Copy the data shown to the clipboard as CSV.";
        panel.button(ui, text("Copy CSV", hint), CompareAction::Copy);
    }
}
