//! The panel on the right: collapsible sections, scrolled where the window is low.

mod integrators;
mod parameters;
mod readouts;

use bevy_egui::egui::{CollapsingHeader, ScrollArea, Ui, style::ScrollStyle};

use super::memory::{PanelMemory, Section};
use super::view::PanelView;
use super::widgets::identify;
use crate::action::Action;
use parameters::{BOX, WORLD};

/// Draws every section.
pub(super) fn show(ui: &mut Ui, view: &PanelView, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    // A bar of its own beside the widgets, not over them.
    ui.spacing_mut().scroll = ScrollStyle::solid();
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .show(ui, |ui| {
            for section in Section::ALL {
                let place = section as usize;
                let header = CollapsingHeader::new(section.title())
                    .open(Some(memory.open[place]))
                    .show_unindented(ui, |ui| body(ui, section, view, memory, out))
                    .header_response;
                identify(&header, format!("section {}", section.title()));
                if header.clicked() {
                    memory.open[place] = !memory.open[place];
                }
            }
        });
}

fn body(
    ui: &mut Ui,
    section: Section,
    view: &PanelView,
    memory: &mut PanelMemory,
    out: &mut Vec<Action>,
) {
    match section {
        Section::Integrator => integrators::show(ui, view, memory, out),
        Section::Step => parameters::step(ui, view, memory, out),
        Section::World => parameters::plain(ui, view, "world", WORLD, memory, out),
        Section::Box => parameters::plain(ui, view, "box", BOX, memory, out),
        Section::Push => parameters::push(ui, view, memory, out),
        Section::View => readouts::drawn(ui, view, out),
        Section::Load => parameters::load(ui, view, memory, out),
        Section::Now => readouts::now(ui, view),
        Section::Log => readouts::log(ui, view, out),
    }
    ui.add_space(4.0);
}
