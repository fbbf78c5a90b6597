//! The drawer below the picture: curves over time, error against cost, and the table of integrators.

mod compare;
mod plots;
mod table;
mod work_precision;

use bevy_egui::egui::{Rect, RichText, Ui};

use super::memory::{Frozen, PanelMemory};
use super::view::PanelView;
use super::widgets::{Text, button, choice, text, toggle};
use crate::action::compare::{CompareAction, Window};
use crate::action::{Action, Plot};
use crate::compare::CompareView;

/// Name and tooltip of every tab.
const TABS: [(Plot, &str, &str); 6] = [
    (
        Plot::Error,
        "Error",
        "Position and attitude error over simulated time.",
    ),
    (
        Plot::Energy,
        "Energy",
        "Unexplained energy and angular momentum over simulated time.",
    ),
    (
        Plot::Timing,
        "Timing",
        "Cost of a step of a box under every integrator over time.",
    ),
    (Plot::Cpu, "CPU", "CPU use over time."),
    (
        Plot::WorkPrecision,
        "Work–precision",
        "Error against cost, now and over step sizes.",
    ),
    (
        Plot::Table,
        "Table",
        "Figures of every integrator side by side.",
    ),
];

/// Time that the plots stay frozen after the pointer has left them \[s\].
const THAW: f64 = 0.3;

/// Draws the tabs and the chosen one's content; returns where that is.
pub(super) fn show(
    ui: &mut Ui,
    view: &PanelView,
    memory: &mut PanelMemory,
    out: &mut Vec<Action>,
) -> Rect {
    let now = ui.input(|i| i.time);
    memory
        .frozen
        .take_if(|f| f.until < now || f.plot != view.plot);
    ui.horizontal_wrapped(|ui| {
        for (plot, name, hint) in TABS {
            let accessible = format!("{name} tab");
            let words = Text(name, &accessible, hint);
            choice(ui, view.plot == plot, words, Action::SelectPlot(plot), out);
        }
        ui.separator();
        tools(ui, &view.compare, view.plot, out);
        let hint = "Save this plot or table as plot-NN.png in the current folder.";
        button(
            ui,
            Text("PNG", "Save plot", hint),
            Action::SavePlot(None),
            out,
        );
        if memory.frozen.is_some() {
            ui.label(RichText::new("⏸ frozen").strong()).on_hover_text(
                "The plots are frozen while the pointer is over them; the simulation runs on.",
            );
        }
    });
    let frozen = memory.frozen.take();
    // The newest view, but for what was frozen.
    let held;
    let shown = match &frozen {
        Some(f) => {
            held = PanelView {
                compare: f.compare.clone(),
                history: f.history.clone(),
                ..view.clone()
            };
            &held
        }
        None => view,
    };
    let place = ui.available_rect_before_wrap();
    match view.plot {
        Plot::Error => compare::error(ui, &shown.compare),
        Plot::Energy => compare::energy(ui, &shown.compare),
        Plot::Timing => plots::timing(ui, shown),
        Plot::Cpu => plots::cpu(ui, shown),
        Plot::WorkPrecision => work_precision::show(ui, &view.compare, memory, out),
        Plot::Table => table::show(ui, &view.compare, &view.timings),
    }
    let over = ui
        .ctx()
        .pointer_latest_pos()
        .is_some_and(|p| place.contains(p) && ui.rect_contains_pointer(place));
    let freezes = !matches!(view.plot, Plot::Table | Plot::WorkPrecision);
    memory.frozen = match frozen {
        Some(f) if over => Some(Frozen {
            until: now + THAW,
            ..f
        }),
        None if over && freezes => Some(Frozen {
            plot: view.plot,
            compare: view.compare.clone(),
            history: view.history.clone(),
            until: now + THAW,
        }),
        other => other,
    };
    place
}

/// Options of the open tab.
fn tools(ui: &mut Ui, view: &CompareView, plot: Plot, out: &mut Vec<Action>) {
    let settings = &view.settings;
    match plot {
        Plot::Error => {
            let log = text("log", "Logarithmic axis.");
            toggle(
                ui,
                settings.logarithmic,
                log,
                CompareAction::ToggleLogarithmic,
                out,
            );
            let hint = "Error of each step alone, from the reference's state; meaningful even after chaos sets in.";
            toggle(
                ui,
                settings.local,
                text("per step", hint),
                CompareAction::ToggleLocal,
                out,
            );
        }
        Plot::Energy => {
            let (on, action) = (
                settings.logarithmic_energy,
                CompareAction::ToggleLogarithmicEnergy,
            );
            toggle(
                ui,
                on,
                text("log", "Magnitude on a logarithmic axis."),
                action,
                out,
            );
        }
        _ => {}
    }
    if matches!(plot, Plot::Error | Plot::Energy) {
        for window in Window::ALL {
            let words = text(window.name(), "Time span shown.");
            toggle(
                ui,
                settings.window == window,
                words,
                CompareAction::SetWindow(window),
                out,
            );
        }
    }
    if !matches!(plot, Plot::Cpu | Plot::Timing) {
        let hint = "Copy the data shown to the clipboard, as CSV.";
        button(ui, text("Copy CSV", hint), CompareAction::Copy, out);
    }
}
