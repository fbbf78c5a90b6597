//! The drawer below the picture: curves over time, error against cost, and the table of integrators.

mod compare;
mod plots;
mod table;
mod work_precision;

use bevy_egui::egui::{Button, Checkbox, Rect, RichText, Ui, WidgetInfo, WidgetType};
use box_physics::prelude::Integrator;

use super::memory::{Frozen, PanelMemory};
use super::view::PanelView;
use crate::action::{Action, Plot};
use crate::compare::{CompareAction, CompareView, Window};

const TABS: [(Plot, &str, &str); 6] = [
    (
        Plot::Error,
        "Error",
        "Distance and angle to the reference over simulated time.",
    ),
    (
        Plot::Energy,
        "Energy",
        "Energy and angular momentum that nothing accounts for, over simulated time.",
    ),
    (
        Plot::Timing,
        "Timing",
        "What a body-step costs under every integrator, over time.",
    ),
    (Plot::Cpu, "CPU", "Use of the processor over time."),
    (
        Plot::WorkPrecision,
        "Work–precision",
        "Error against cost of every lane, and over step sizes.",
    ),
    (
        Plot::Table,
        "Table",
        "The figures of every integrator side by side.",
    ),
];

/// How long the plots stay frozen after the pointer has left them \[s\].
const THAW: f64 = 0.3;

/// The tabs of the comparison alone, for a window in another app.
pub(super) fn comparison(
    ui: &mut Ui,
    view: &CompareView,
    plot: Plot,
    memory: &mut PanelMemory,
    out: &mut Vec<Action>,
) {
    ui.horizontal_wrapped(|ui| {
        for (tab, name, hint) in TABS {
            if !matches!(tab, Plot::Timing | Plot::Cpu) && select(ui, tab == plot, name, hint) {
                out.push(Action::SelectPlot(tab));
            }
        }
        ui.separator();
        let mut asked = Vec::new();
        tools(ui, view, plot, &mut asked);
        out.extend(asked.into_iter().map(Action::Compare));
    });
    ui.horizontal_wrapped(|ui| {
        for &integrator in Integrator::ALL {
            let lane = view.lanes.iter().find(|l| l.integrator == integrator);
            let mut on = lane.is_some();
            let hero = lane.is_some_and(|l| l.hero);
            let tick = ui.add_enabled(
                !hero,
                Checkbox::new(&mut on, crate::view::style::tagged(integrator)),
            );
            if tick.changed() {
                out.push(Action::Compare(CompareAction::ToggleLane(integrator)));
            }
        }
    });
    let mut asked = Vec::new();
    match plot {
        Plot::Error => compare::error(ui, view),
        Plot::WorkPrecision => work_precision::show(ui, view, memory, &mut asked),
        Plot::Table => table::show(ui, view, &[], &mut asked),
        Plot::Energy | Plot::Timing | Plot::Cpu => compare::energy(ui, view),
    }
    out.extend(asked.into_iter().map(Action::Compare));
}

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
        let picture = ui.button("PNG");
        picture.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, "Save plot"));
        if picture
            .on_hover_text("Save this plot or table as plot-NN.png in the present folder.")
            .clicked()
        {
            out.push(Action::SavePlot(None));
        }
        if ui
            .button("Close plots")
            .on_hover_text("Hide the drawer (M).")
            .clicked()
        {
            out.push(Action::TogglePlots);
        }
        if memory.frozen.is_some() {
            ui.label(RichText::new("⏸ frozen").strong()).on_hover_text(
                "The plots stand still while the pointer is over them; the simulation does not.",
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

/// What can be chosen of the open tab.
fn tools(ui: &mut Ui, view: &CompareView, plot: Plot, out: &mut Vec<CompareAction>) {
    let settings = &view.settings;
    let over_time = matches!(plot, Plot::Error | Plot::Energy);
    let mut toggle = |ui: &mut Ui, on: bool, name: &str, hint: &str, action: CompareAction| {
        let button = ui.add(Button::selectable(on, name).frame_when_inactive(true));
        button.widget_info(|| WidgetInfo::selected(WidgetType::Button, true, on, name));
        if button.on_hover_text(hint).clicked() {
            out.push(action);
        }
    };
    match plot {
        Plot::Error => {
            let hint = "Logarithmic instead of linear.";
            let action = CompareAction::ToggleLogarithmic;
            toggle(ui, settings.logarithmic, "log", hint, action);
            let hint = "The error of each step alone, from the reference's state, instead of that since the start: it says something even after chaos.";
            toggle(
                ui,
                settings.local,
                "per step",
                hint,
                CompareAction::ToggleLocal,
            );
        }
        Plot::Energy => {
            let hint = "The size on a logarithmic axis instead of the value on a linear one.";
            let action = CompareAction::ToggleLogarithmicEnergy;
            toggle(ui, settings.logarithmic_energy, "log", hint, action);
        }
        _ => {}
    }
    if over_time {
        for window in Window::ALL {
            let on = settings.window == window;
            let hint = "How much of the past is shown.";
            toggle(
                ui,
                on,
                window.name(),
                hint,
                CompareAction::SetWindow(window),
            );
        }
    }
    if plot != Plot::Cpu && plot != Plot::Timing {
        let copy = ui.button("Copy CSV");
        if copy
            .on_hover_text("What is shown, as CSV, to the clipboard.")
            .clicked()
        {
            out.push(CompareAction::Copy);
        }
    }
}
