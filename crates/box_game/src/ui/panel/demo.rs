//! The strip of the 2012 scene: which of its steppers moves the box, what each does wrong, and ours.

use bevy_egui::egui::{Label, RichText, Ui};
use box_scenarios::dissertation::Stepper;

use super::format::number;
use super::view::{DemoView, PanelView};
use super::widgets::{button, choice, text};
use crate::action::Action;
use crate::demo_2012::FAULTS;

/// In that scene alone; its words where there is `room`.
pub(super) fn show(ui: &mut Ui, view: &PanelView, room: bool, out: &mut Vec<Action>) {
    let Some(demo) = &view.demo else {
        return;
    };
    ui.horizontal_wrapped(|ui| {
        choices(ui, demo, out);
        if demo.stepper.is_some() {
            log(ui, demo, out);
        }
    });
    let words = match demo.stepper {
        Some(stepper) => format!("{} All three: {}.", stepper.fault(), FAULTS.join("; ")),
        None => format!(
            "{}: pushes add up, the fall is a parabola, contact acts at the corners.",
            view.integrator.name()
        ),
    };
    if room {
        ui.add(Label::new(words).wrap());
    }
}

fn choices(ui: &mut Ui, demo: &DemoView, out: &mut Vec<Action>) {
    let of_2012 = Stepper::ALL.map(Some);
    for stepper in of_2012.into_iter().chain([None]) {
        let name = stepper.map_or("box_physics", Stepper::name);
        let ours = "The plugin, with the integrator selected on the right.";
        let words = text(name, stepper.map_or(ours, Stepper::fault));
        choice(
            ui,
            demo.stepper == stepper,
            words,
            Action::SetDemo(stepper),
            out,
        );
    }
}

fn log(ui: &mut Ui, demo: &DemoView, out: &mut Vec<Action>) {
    let name = ["Start cycle log", "Stop cycle log"][usize::from(demo.log.is_some())];
    let hint = "Write the time of every integration cycle to a text file, as in 2012.";
    button(ui, text(name, hint), Action::ToggleDemoLog, out);
    let cycle = number((demo.cycle_us * 100.0).round() / 100.0);
    ui.label(RichText::new(format!("last cycle {cycle} µs")).small());
    if let Some((path, cycles)) = &demo.log {
        ui.label(RichText::new(format!("{path} · {cycles} cycles")).small());
    }
}
