//! The panel on the right: collapsible sections, scrolled where the window is low.

mod integrators;
mod parameters;

use bevy_egui::egui::{CollapsingHeader, Grid, Label, ScrollArea, Ui, style::ScrollStyle};

use super::format::{grouped, quantity};
use super::view::FIGURES;
use super::widgets::{Panel, id_of, identify, mark, text};
use crate::action::Action;
use crate::parameters::Parameter;
use crate::platform;
use parameters::{BOX, WORLD, load, push, size, step, world};

/// Title, `true` if open at first, and contents of each section.
const SECTIONS: [(&str, bool, fn(&mut Ui, &mut Panel<'_>)); 9] = [
    ("INTEGRATORS", true, integrators::show),
    ("VIEW", true, drawn),
    ("PUSH", true, push),
    ("WORLD", true, world),
    ("BOX", false, size),
    ("STEP", true, step),
    ("LOAD", false, load),
    ("NOW", false, now),
    ("LOG", false, log),
];

pub(super) fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    let now = ui.input(|i| i.time);
    let marked = &mut panel.memory.marked;
    marked.take_if(|(_, until)| *until < now);
    let marked = marked.map(|(name, _)| section_of(name));
    // A bar of its own beside the widgets, not over them.
    ui.spacing_mut().scroll = ScrollStyle::solid();
    let sections = |ui: &mut Ui| {
        for (title, open, content) in SECTIONS {
            let header = CollapsingHeader::new(title).default_open(open || panel.memory.all_open);
            let header = header.open((marked == Some(title)).then_some(true));
            let header = header.show_unindented(ui, |ui| {
                content(ui, panel);
                ui.add_space(4.0);
            });
            identify(&header.header_response, format!("section {title}"));
        }
    };
    let area = ScrollArea::vertical().auto_shrink([false, false]);
    area.show(ui, sections);
}

/// The section with this parameter or figure.
fn section_of(name: &str) -> &'static str {
    let parameter = Parameter::ALL.into_iter().find(|p| p.info().label == name);
    match parameter {
        None => "NOW",
        Some(Parameter::Impulse) => "PUSH",
        Some(Parameter::Boxes) => "LOAD",
        Some(p) if WORLD.contains(&p) => "WORLD",
        Some(p) if BOX.contains(&p) => "BOX",
        Some(_) => "STEP",
    }
}

/// Switches for the overlays, and buttons for camera and screenshots.
fn drawn(ui: &mut Ui, panel: &mut Panel<'_>) {
    let preferences = panel.view.preferences;
    #[rustfmt::skip]
    let switches = [
        (preferences.show_aabb, "Bounding box (B)", "Axis-aligned bounding box of every body.", Action::ToggleAabb),
        (preferences.show_contacts, "Contacts (C)", "Contact points with their impulses and friction cones.",
            Action::ToggleContacts),
        (preferences.show_axes, "Axes and velocity (X)", "Body axes and velocity.", Action::ToggleAxes),
    ];
    for (mut on, name, hint, action) in switches {
        let switch = ui.checkbox(&mut on, name);
        identify(&switch, id_of(&action));
        if switch.on_hover_text(hint).changed() {
            panel.ask(action);
        }
    }
    let screenshot = match platform::SCREENSHOT_KEY {
        Some(_) => "Save a screenshot (F12).",
        None => "Save a screenshot.",
    };
    #[rustfmt::skip]
    let buttons = [
        ("Frame", "Center the view on the box (F).", Action::FrameCamera),
        ("Home", "Reset the view (Home).", Action::HomeCamera),
        ("Screenshot", screenshot, Action::Screenshot),
    ];
    panel.buttons(ui, buttons);
}

/// The main box in numbers.
fn now(ui: &mut Ui, panel: &mut Panel<'_>) {
    let view = panel.view;
    let grid = Grid::new("now").num_columns(2).spacing([12.0, 2.0]);
    grid.show(ui, |ui| {
        for ((name, unit), value) in FIGURES.into_iter().zip(view.figures) {
            let label = ui.label(name);
            let value = ui.monospace(format!("{:>10} {unit}", quantity(value)));
            mark(ui, panel.memory, name, &(label | value));
            ui.end_row();
        }
        let fallbacks = "Body-steps taken by split because the integrator is not applicable.";
        let unconverged = "Body-steps whose iteration reached its limit before its tolerance.";
        for (name, count, hint) in [
            ("Fallbacks", view.fallbacks, fallbacks),
            ("Not converged", view.unconverged, unconverged),
        ] {
            ui.label(name).on_hover_text(hint);
            ui.monospace(format!("{:>10}", grouped(count)))
                .on_hover_text(hint);
            ui.end_row();
        }
        ui.label("State");
        ui.strong(view.state.to_string());
        ui.end_row();
    });
}

fn log(ui: &mut Ui, panel: &mut Panel<'_>) {
    let log = &panel.view.log;
    let name = ["Start log", "Stop log"][usize::from(log.is_some())];
    let words = text(name, "Write every step to a CSV file (L).");
    panel.button(ui, words, Action::ToggleLog);
    let what = platform::COPIED;
    let name = format!("Copy {what}");
    let hint = format!("Copy the {what} that restores this session to the clipboard.");
    panel.button(ui, text(&name, &hint), Action::CopyCommandLine);
    if let Some((path, rows)) = log {
        ui.add(Label::new(path).wrap().selectable(true));
        ui.label(format!("{} rows", grouped(*rows)));
    } else {
        ui.label("No log.");
    }
}
