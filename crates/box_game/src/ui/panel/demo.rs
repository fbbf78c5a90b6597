//! The strip of the 2012 scene: which of its steppers moves the box, what each does wrong, and ours.

use bevy_egui::egui::{Button, Label, Panel, RichText, Ui, WidgetInfo, WidgetType};
use box_scenarios::dissertation::Stepper;

use super::format::number;
use super::view::{DemoView, PanelView};
use super::widgets::button;
use crate::action::Action;
use crate::demo_2012::FAULTS;

/// Across the top of the picture, in that scene alone.
pub(super) fn show(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let Some(demo) = &view.demo else {
        return;
    };
    Panel::top("2012").show(ui, |ui| {
        ui.horizontal_wrapped(|ui| choices(ui, demo, out));
        match demo.stepper {
            Some(stepper) => {
                ui.add(Label::new(RichText::new(stepper.fault()).strong()).wrap());
                let all = format!("All three: {}.", FAULTS.join("; "));
                ui.add(Label::new(RichText::new(all).small()).wrap());
            }
            None => {
                let text = format!(
                    "{}: pushes add up, the fall is a parabola, contact acts at the corners.",
                    view.integrator.name()
                );
                ui.add(Label::new(text).wrap());
            }
        }
        if demo.stepper.is_some() {
            ui.horizontal_wrapped(|ui| log(ui, demo, out));
        }
    });
}

fn choices(ui: &mut Ui, demo: &DemoView, out: &mut Vec<Action>) {
    let of_2012 = Stepper::ALL.map(Some);
    for stepper in of_2012.into_iter().chain([None]) {
        let chosen = demo.stepper == stepper;
        let name = stepper.map_or("box_physics", Stepper::name);
        let button = ui.add(Button::selectable(chosen, name).frame_when_inactive(true));
        button.widget_info(|| WidgetInfo::selected(WidgetType::RadioButton, true, chosen, name));
        let hint = stepper.map_or(
            "The plugin, with the integrator selected on the right.",
            Stepper::fault,
        );
        if button.on_hover_text(hint).clicked() && !chosen {
            out.push(Action::SetDemo(stepper));
        }
    }
}

fn log(ui: &mut Ui, demo: &DemoView, out: &mut Vec<Action>) {
    let name = if demo.log.is_some() {
        "Stop cycle log"
    } else {
        "Start cycle log"
    };
    let hint = "Write the time of every integration cycle to a text file, as in 2012.";
    if button(ui, name, hint) {
        out.push(Action::ToggleDemoLog);
    }
    let cycle = number((demo.cycle_us * 100.0).round() / 100.0);
    ui.label(RichText::new(format!("last cycle {cycle} µs")).small());
    if let Some((path, cycles)) = &demo.log {
        ui.label(RichText::new(format!("{path} · {cycles} cycles")).small());
    }
}
