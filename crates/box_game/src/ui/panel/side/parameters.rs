//! The sections for numbers: each row sends one action, and each section ends with a reset button.

use bevy_egui::egui::{Button, Ui, WidgetInfo, WidgetType, vec2};
use box_physics::prelude::DVec3;

use super::super::format::{number, step_size};
use super::super::row::row;
use super::super::widgets::{Panel, button, identify, mark, text};
use crate::action::{Action, Push};
use crate::parameters::Parameter;

/// Step sizes with a button each \[Hz\].
const RATES: [u32; 4] = [30, 60, 120, 240];

/// Gravity, floor and drag.
pub(super) const WORLD: &[Parameter] = &[
    Parameter::Gravity,
    Parameter::Restitution,
    Parameter::RestitutionLaw,
    Parameter::Friction,
    Parameter::LinearDrag,
    Parameter::AngularDamping,
];
pub(super) const BOX: &[Parameter] = &[
    Parameter::HalfX,
    Parameter::HalfY,
    Parameter::HalfZ,
    Parameter::Mass,
];

pub(super) fn world(ui: &mut Ui, panel: &mut Panel<'_>) {
    rows(ui, panel, WORLD);
    reset(ui, panel, "world", WORLD);
}

pub(super) fn size(ui: &mut Ui, panel: &mut Panel<'_>) {
    rows(ui, panel, BOX);
    reset(ui, panel, "box", BOX);
}

fn rows(ui: &mut Ui, panel: &mut Panel<'_>, parameters: &[Parameter]) {
    for &parameter in parameters {
        if parameter.info().choices.is_empty() {
            row(ui, parameter, panel);
        } else {
            choices(ui, parameter, panel);
        }
    }
}

/// A parameter that is a choice, with a button for each value.
fn choices(ui: &mut Ui, parameter: Parameter, panel: &mut Panel<'_>) {
    let Some(now) = panel.view.parameters.get(parameter) else {
        return;
    };
    let info = parameter.info();
    let row = ui.horizontal_wrapped(|ui| {
        ui.label(info.label).on_hover_text(info.hint);
        for (k, name) in info.choices.iter().enumerate() {
            let action = Action::Set(parameter, k as f64);
            panel.choice(ui, now == k as f64, text(name, info.hint), action);
        }
    });
    mark(ui, panel.memory, info.label, &row.response);
}

/// A button that resets these parameters to the scene's defaults.
fn reset(ui: &mut Ui, panel: &mut Panel<'_>, what: &str, parameters: &[Parameter]) {
    let name = format!("Reset {what}");
    let words = text(&name, "Restore the scene's values.");
    if button(ui, words, &name) {
        // A scene without a floor has no restitution to reset.
        let (now, own) = (&panel.view.parameters, &panel.view.defaults);
        let present = parameters.iter().filter(|&&p| now.get(p).is_some());
        let actions = present.filter_map(|&p| Some(Action::Set(p, own.get(p)?)));
        panel.out.extend(actions);
    }
}

pub(super) fn step(ui: &mut Ui, panel: &mut Panel<'_>) {
    rows(ui, panel, &[Parameter::Step]);
    ui.horizontal(|ui| {
        let now = panel.view.parameters.step;
        for hertz in RATES {
            let dt = 1.0 / f64::from(hertz);
            let (name, hint) = (format!("{hertz} Hz"), format!("dt = {}", step_size(dt)));
            let action = Action::Set(Parameter::Step, dt);
            panel.choice(ui, now == dt, text(&name, &hint), action);
        }
    });
    rows(ui, panel, &[Parameter::Substeps]);
    let both = [Parameter::Step, Parameter::Substeps];
    reset(ui, panel, "step", &both);
}

pub(super) fn push(ui: &mut Ui, panel: &mut Panel<'_>) {
    rows(ui, panel, &[Parameter::Impulse]);
    let strength = number(panel.view.parameters.impulse);
    let modifiers = ui.input(|i| i.modifiers);
    let off_center = panel.memory.push_off_center || modifiers.shift;
    let world = panel.memory.push_world || modifiers.alt;
    let axes = if world { "world" } else { "body" };
    let place = ["", ", at the edge of the face"][usize::from(off_center)];
    let opposite = [DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    for (sign, directions) in [("+", DVec3::AXES), ("−", opposite)] {
        ui.horizontal(|ui| {
            for (direction, axis) in directions.into_iter().zip(["x", "y", "z"]) {
                let name = format!("{sign}{axis}");
                let size = vec2(64.0, ui.spacing().interact_size.y);
                let button = ui.add_sized(size, Button::new(name.as_str()));
                let accessible = format!("Push {name}");
                button.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, &accessible));
                identify(&button, format!("push {name}"));
                let hint = format!("{strength} N s along {name} ({axes} axes){place}.");
                if button.on_hover_text(hint).clicked() {
                    panel.ask(Action::Push(Push {
                        direction,
                        world,
                        off_center,
                    }));
                }
            }
        });
    }
    let memory = &mut *panel.memory;
    ui.horizontal_wrapped(|ui| {
        let off = ui.checkbox(&mut memory.push_off_center, "off-center (Shift)");
        identify(&off, "off-center");
        off.on_hover_text("Push at the edge of the face, so that the box spins.");
        let world = ui.checkbox(&mut memory.push_world, "world axes (Alt)");
        identify(&world, "world axes");
        world.on_hover_text("Push along world axes instead of body axes.");
    });
    reset(ui, panel, "push", &[Parameter::Impulse]);
}

pub(super) fn load(ui: &mut Ui, panel: &mut Panel<'_>) {
    rows(ui, panel, &[Parameter::Boxes]);
    let view = panel.view;
    ui.label(format!("frame time: {} ms", number(view.frame_time_ms)));
    ui.label(format!(
        "dropped by slow frames: {} s",
        number(view.dropped)
    ));
    reset(ui, panel, "load", &[Parameter::Boxes]);
}
