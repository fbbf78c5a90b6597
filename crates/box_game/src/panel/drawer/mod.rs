//! The drawer below the picture: curves over time and the table of schemes.

mod plots;
mod table;

use bevy_egui::egui::{Button, Ui, WidgetInfo, WidgetType};

use super::view::PanelView;
use crate::action::{Action, Plot};

const TABS: [(Plot, &str, &str); 4] = [
    (
        Plot::Energy,
        "Energy",
        "Total energy and |L| of the box over simulated time.",
    ),
    (
        Plot::Timing,
        "Timing",
        "What a body-step costs under every scheme, over time.",
    ),
    (Plot::Cpu, "CPU", "Use of the processor over time."),
    (
        Plot::Table,
        "Table",
        "The figures of every scheme side by side.",
    ),
];

/// Draws the tabs and the chosen one's content.
pub(super) fn show(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        for (plot, name, hint) in TABS {
            let chosen = view.plot == plot;
            let tab = ui.add(Button::selectable(chosen, name));
            tab.widget_info(|| {
                WidgetInfo::selected(WidgetType::Button, true, chosen, format!("{name} tab"))
            });
            if tab.on_hover_text(hint).clicked() && !chosen {
                out.push(Action::SelectPlot(plot));
            }
        }
        if ui
            .button("Close plots")
            .on_hover_text("Hide the drawer (M).")
            .clicked()
        {
            out.push(Action::TogglePlots);
        }
    });
    match view.plot {
        Plot::Energy => plots::energy(ui, view),
        Plot::Timing => plots::timing(ui, view),
        Plot::Cpu => plots::cpu(ui, view),
        Plot::Table => table::show(ui, view),
    }
}
