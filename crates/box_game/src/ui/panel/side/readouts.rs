//! The sections that show: what is drawn, the main box in numbers, the log.

use bevy_egui::egui::{Grid, Label, RichText, Ui};

use super::super::format::{bytes, grouped, quantity};
use super::super::view::PanelView;
use super::super::widgets::{button, id_of, identify, text};
use crate::action::Action;
use crate::platform;

pub(super) fn drawn(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    for (on, name, hint, action) in [
        (
            view.preferences.show_aabb,
            "Bounding box (B)",
            "Axis-aligned bounding box of every body.",
            Action::ToggleAabb,
        ),
        (
            view.preferences.show_contacts,
            "Contacts (C)",
            "Contact points with their impulses, and friction cones: the force stays inside.",
            Action::ToggleContacts,
        ),
        (
            view.preferences.show_axes,
            "Axes and velocity (X)",
            "The box's own axes and its velocity.",
            Action::ToggleAxes,
        ),
    ] {
        let mut ticked = on;
        let switch = ui.checkbox(&mut ticked, name);
        identify(&switch, id_of(&action));
        if switch.on_hover_text(hint).changed() {
            out.push(action);
        }
    }
    ui.horizontal_wrapped(|ui| {
        for (name, hint, action) in [
            (
                "Frame",
                "Center the view on the box (F).",
                Action::FrameCamera,
            ),
            ("Home", "Reset the view (Home).", Action::HomeCamera),
            ("Screenshot", "Save a screenshot (F12).", Action::Screenshot),
        ] {
            button(ui, text(name, hint), action, out);
        }
    });
}

pub(super) fn now(ui: &mut Ui, view: &PanelView) {
    let main_box = &view.main_box;
    let total =
        main_box.translational_energy + main_box.rotational_energy + main_box.potential_energy;
    Grid::new("now")
        .num_columns(2)
        .spacing([12.0, 2.0])
        .show(ui, |ui| {
            for (name, value, unit) in [
                ("Translational ½mv²", main_box.translational_energy, "J"),
                ("Rotational ½L·ω", main_box.rotational_energy, "J"),
                ("Potential energy", main_box.potential_energy, "J"),
                ("Total energy", total, "J"),
                ("Ang. momentum |L|", main_box.angular_momentum, "kg m²/s"),
                ("Speed |v|", main_box.speed, "m/s"),
                ("Spin |ω|", main_box.spin, "rad/s"),
                ("Position x", main_box.position.x, "m"),
                ("Position y", main_box.position.y, "m"),
                ("Position z", main_box.position.z, "m"),
            ] {
                ui.label(name);
                ui.label(RichText::new(format!("{:>10} {unit}", quantity(value))).monospace());
                ui.end_row();
            }
            for (name, count, hint) in [
                (
                    "Fallbacks",
                    view.fallbacks,
                    "Body-steps delegated to split because the integrator does not apply.",
                ),
                (
                    "Not converged",
                    view.unconverged,
                    "Body-steps whose iteration reached its limit before its tolerance.",
                ),
            ] {
                ui.label(name).on_hover_text(hint);
                ui.label(RichText::new(format!("{:>10}", grouped(count))).monospace())
                    .on_hover_text(hint);
                ui.end_row();
            }
            ui.label("State");
            ui.label(RichText::new(main_box.state.to_string()).strong());
            ui.end_row();
        });
}

pub(super) fn log(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let name = ["Start log", "Stop log"][usize::from(view.log.is_some())];
    let hint = "Write every step to a CSV file (L).";
    button(ui, text(name, hint), Action::ToggleLog, out);
    let what = platform::COPIED;
    let (name, hint) = (
        format!("Copy {what}"),
        format!("Copy the {what} that restores this session to the clipboard."),
    );
    button(ui, text(&name, &hint), Action::CopyCommandLine, out);
    match &view.log {
        Some(log) => {
            ui.add(Label::new(&log.path).wrap().selectable(true));
            ui.label(format!("{} rows · {}", grouped(log.rows), bytes(log.bytes)));
        }
        None => {
            ui.label("No log.");
        }
    }
}
