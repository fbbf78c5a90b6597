//! The drawer below the picture: curves over time, error against cost, and the table of integrators.

mod compare;
mod plots;
mod table;
mod work_precision;

use bevy_egui::egui::{Button, Rect, RichText, Ui, WidgetInfo, WidgetType};

use super::memory::{Frozen, PanelMemory};
use super::view::PanelView;
use super::widgets::{button, named_button, toggle};
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
        "Cost of a body-step under every integrator over time.",
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

/// A tab; returns whether it is to be opened.
fn select(ui: &mut Ui, chosen: bool, name: &str, hint: &str) -> bool {
    let tab = ui.add(Button::selectable(chosen, name));
    tab.widget_info(|| {
        WidgetInfo::selected(WidgetType::Button, true, chosen, format!("{name} tab"))
    });
    tab.on_hover_text(hint).clicked() && !chosen
}

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
            if select(ui, view.plot == plot, name, hint) {
                out.push(Action::SelectPlot(plot));
            }
        }
        ui.separator();
        let mut asked = Vec::new();
        tools(ui, &view.compare, view.plot, &mut asked);
        out.extend(asked.into_iter().map(Action::Compare));
        let hint = "Save this plot or table as plot-NN.png in the current folder.";
        if named_button(ui, "PNG", "Save plot", hint) {
            out.push(Action::SavePlot(None));
        }
        if button(ui, "Close plots", "Hide the drawer (M).") {
            out.push(Action::TogglePlots);
        }
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
    let mut asked = Vec::new();
    match view.plot {
        Plot::Error => compare::error(ui, &shown.compare),
        Plot::Energy => compare::energy(ui, &shown.compare),
        Plot::Timing => plots::timing(ui, shown),
        Plot::Cpu => plots::cpu(ui, shown),
        Plot::WorkPrecision => work_precision::show(ui, &view.compare, memory, &mut asked),
        Plot::Table => table::show(ui, &view.compare, &view.timings, &mut asked),
    }
    out.extend(asked.into_iter().map(Action::Compare));
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
fn tools(ui: &mut Ui, view: &CompareView, plot: Plot, out: &mut Vec<CompareAction>) {
    let settings = &view.settings;
    let over_time = matches!(plot, Plot::Error | Plot::Energy);
    let mut choice = |ui: &mut Ui, on: bool, name: &str, hint: &str, action: CompareAction| {
        if toggle(ui, on, name, hint) {
            out.push(action);
        }
    };
    match plot {
        Plot::Error => {
            let hint = "Logarithmic axis.";
            choice(
                ui,
                settings.logarithmic,
                "log",
                hint,
                CompareAction::ToggleLogarithmic,
            );
            let hint = "Error of each step alone, from the reference's state; meaningful even after chaos sets in.";
            choice(
                ui,
                settings.local,
                "per step",
                hint,
                CompareAction::ToggleLocal,
            );
        }
        Plot::Energy => {
            let hint = "Magnitude on a logarithmic axis.";
            let action = CompareAction::ToggleLogarithmicEnergy;
            choice(ui, settings.logarithmic_energy, "log", hint, action);
        }
        _ => {}
    }
    if over_time {
        for window in Window::ALL {
            let action = CompareAction::SetWindow(window);
            choice(
                ui,
                settings.window == window,
                window.name(),
                "Time span shown.",
                action,
            );
        }
    }
    let copies = plot != Plot::Cpu && plot != Plot::Timing;
    if copies
        && button(
            ui,
            "Copy CSV",
            "Copy the data shown to the clipboard, as CSV.",
        )
    {
        out.push(CompareAction::Copy);
    }
}
