//! The sections that set numbers: each row sends one action, each section ends in its reset.

use bevy_egui::egui::{Button, Response, Ui, WidgetInfo, WidgetType, vec2};
use box_physics::prelude::DVec3;

use super::super::format::{number, step_size};
use super::super::memory::PanelMemory;
use super::super::row::row;
use super::super::view::PanelView;
use super::super::widgets::{choice, identify, own_button, text};
use crate::action::{Action, Push};
use crate::parameters::Parameter;

/// Step sizes by one click \[Hz\].
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
/// Size and mass.
pub(super) const BOX: &[Parameter] = &[
    Parameter::HalfX,
    Parameter::HalfY,
    Parameter::HalfZ,
    Parameter::Mass,
];

fn rows(
    ui: &mut Ui,
    view: &PanelView,
    parameters: &[Parameter],
    memory: &mut PanelMemory,
    out: &mut Vec<Action>,
) {
    for &parameter in parameters {
        if !parameter.info().choices.is_empty() {
            choices(ui, view, parameter, out);
            continue;
        }
        out.extend(row(ui, parameter, &view.parameters, &view.defaults, memory));
    }
}

/// A parameter that is a choice: a button for each.
fn choices(ui: &mut Ui, view: &PanelView, parameter: Parameter, out: &mut Vec<Action>) {
    let Some(now) = view.parameters.get(parameter) else {
        return;
    };
    let info = parameter.info();
    ui.horizontal_wrapped(|ui| {
        ui.label(info.label).on_hover_text(info.hint);
        for (k, name) in info.choices.iter().enumerate() {
            let value = k as f64;
            let action = Action::Set(parameter, value);
            choice(ui, now == value, text(name, info.hint), action, out);
        }
    });
}

/// A button that sets these parameters to the scene's own.
fn reset(
    ui: &mut Ui,
    view: &PanelView,
    what: &str,
    parameters: &[Parameter],
    out: &mut Vec<Action>,
) {
    let name = format!("Reset {what}");
    if own_button(ui, text(&name, "Restore the scene's own values."), &name) {
        // A scene without a floor has no restitution to reset.
        let present = parameters
            .iter()
            .filter(|&&p| view.parameters.get(p).is_some());
        out.extend(present.filter_map(|&p| Some(Action::Set(p, view.defaults.get(p)?))));
    }
}

/// A section of rows and nothing else.
pub(super) fn plain(
    ui: &mut Ui,
    view: &PanelView,
    what: &str,
    parameters: &[Parameter],
    memory: &mut PanelMemory,
    out: &mut Vec<Action>,
) {
    rows(ui, view, parameters, memory, out);
    reset(ui, view, what, parameters, out);
}

pub(super) fn step(ui: &mut Ui, view: &PanelView, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    rows(ui, view, &[Parameter::Step], memory, out);
    ui.horizontal(|ui| {
        for hertz in RATES {
            let dt = 1.0 / f64::from(hertz);
            let (name, hint) = (format!("{hertz} Hz"), format!("dt = {}", step_size(dt)));
            let action = Action::Set(Parameter::Step, dt);
            choice(
                ui,
                view.parameters.step == dt,
                text(&name, &hint),
                action,
                out,
            );
        }
    });
    rows(ui, view, &[Parameter::Substeps], memory, out);
    reset(
        ui,
        view,
        "step",
        &[Parameter::Step, Parameter::Substeps],
        out,
    );
}

/// The six buttons: name and direction.
const PUSHES: [(&str, DVec3); 6] = [
    ("+x", DVec3::X),
    ("+y", DVec3::Y),
    ("+z", DVec3::Z),
    ("−x", DVec3::NEG_X),
    ("−y", DVec3::NEG_Y),
    ("−z", DVec3::NEG_Z),
];

pub(super) fn push(ui: &mut Ui, view: &PanelView, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    rows(ui, view, &[Parameter::Impulse], memory, out);
    let now = view.parameters.impulse;
    let (shift, alt) = ui.input(|i| (i.modifiers.shift, i.modifiers.alt));
    let (off_center, world) = (memory.push_off_center || shift, memory.push_world || alt);
    for half in PUSHES.chunks(3) {
        ui.horizontal(|ui| {
            for &(name, direction) in half {
                if push_button(ui, name, now, off_center, world).clicked() {
                    out.push(Action::Push(Push {
                        direction,
                        world,
                        off_center,
                    }));
                }
            }
        });
    }
    ui.horizontal_wrapped(|ui| {
        let off = ui.checkbox(&mut memory.push_off_center, "off-center (Shift)");
        identify(&off, "off-center");
        off.on_hover_text("Push at the edge of the face, so that the box spins.");
        let world = ui.checkbox(&mut memory.push_world, "world axes (Alt)");
        identify(&world, "world axes");
        world.on_hover_text("Push along the world's axes instead of the box's own.");
    });
    reset(ui, view, "push", &[Parameter::Impulse], out);
}

fn push_button(ui: &mut Ui, name: &str, impulse: f64, off_center: bool, world: bool) -> Response {
    let button = ui.add_sized(vec2(64.0, ui.spacing().interact_size.y), Button::new(name));
    button.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, format!("Push {name}")));
    identify(&button, format!("push {name}"));
    button.on_hover_ui(|ui| {
        ui.label(format!(
            "{} N s along {name} of {}{}.",
            number(impulse),
            if world { "the world" } else { "the box" },
            if off_center {
                ", at the edge of the face"
            } else {
                ""
            },
        ));
    })
}

pub(super) fn load(ui: &mut Ui, view: &PanelView, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    rows(ui, view, &[Parameter::Boxes], memory, out);
    for text in [
        format!("one frame: {} ms", number(view.frame_time_ms)),
        format!("dropped by slow frames: {} s", number(view.dropped)),
    ] {
        ui.label(text);
    }
    reset(ui, view, "load", &[Parameter::Boxes], out);
}
