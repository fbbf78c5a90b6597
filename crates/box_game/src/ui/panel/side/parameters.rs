//! The sections that set numbers: each row sends one action, each section ends in its reset.

use bevy_egui::egui::{Button, Response, Ui, WidgetInfo, WidgetType, vec2};
use box_physics::prelude::DVec3;

use super::super::fields::{
    ANGULAR_DAMPING, BOXES, FRICTION, Field, GRAVITY, HALF_EXTENTS, IMPULSE, LINEAR_DRAG, MASS,
    RATES, RESTITUTION, STEP, SUBSTEPS,
};
use super::super::format::{number, step_size};
use super::super::memory::PanelMemory;
use super::super::row::row;
use super::super::view::{PanelView, Parameters};
use crate::action::{Action, Push};

pub(super) fn step(ui: &mut Ui, view: &PanelView, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    if let Some(dt) = row(ui, &STEP, view.step, view.default_step, memory) {
        out.push(Action::SetStep(dt));
    }
    ui.horizontal(|ui| {
        for hertz in RATES {
            let dt = 1.0 / f64::from(hertz);
            let name = format!("{hertz} Hz");
            let button =
                ui.add(Button::selectable(view.step == dt, &name).frame_when_inactive(true));
            if button
                .on_hover_text(format!("dt = {}", step_size(dt)))
                .clicked()
                && view.step != dt
            {
                out.push(Action::SetStep(dt));
            }
        }
    });
    let (now, scene) = (f64::from(view.substeps), f64::from(view.default_substeps));
    if let Some(substeps) = row(ui, &SUBSTEPS, now, scene, memory) {
        out.push(Action::SetSubsteps(count(substeps)));
    }
    if reset(ui, "step") {
        out.push(Action::SetStep(view.default_step));
        out.push(Action::SetSubsteps(view.default_substeps));
    }
}

/// A plain parameter: where it is found and what sets it.
type Plain = (
    &'static Field,
    fn(&Parameters) -> Option<f64>,
    fn(f64) -> Action,
);

/// Gravity, floor, drag; the floor's own are absent without a floor.
const WORLD: [Plain; 5] = [
    (&GRAVITY, |p| Some(p.gravity), Action::SetGravity),
    (&RESTITUTION, |p| p.restitution, Action::SetRestitution),
    (&FRICTION, |p| p.friction, Action::SetFriction),
    (&LINEAR_DRAG, |p| Some(p.linear_drag), Action::SetLinearDrag),
    (
        &ANGULAR_DAMPING,
        |p| Some(p.angular_damping),
        Action::SetAngularDamping,
    ),
];

pub(super) fn world(
    ui: &mut Ui,
    view: &PanelView,
    memory: &mut PanelMemory,
    out: &mut Vec<Action>,
) {
    for (field, get, set) in WORLD {
        let Some(value) = get(&view.parameters) else {
            continue;
        };
        let default = get(&view.defaults).unwrap_or(value);
        out.extend(row(ui, field, value, default, memory).map(set));
    }
    if reset(ui, "world") {
        for (_, get, set) in WORLD {
            if get(&view.parameters).is_some() {
                out.extend(get(&view.defaults).map(set));
            }
        }
    }
}

pub(super) fn size_and_mass(
    ui: &mut Ui,
    view: &PanelView,
    memory: &mut PanelMemory,
    out: &mut Vec<Action>,
) {
    let (now, scene) = (view.parameters, view.defaults);
    for (axis, field) in HALF_EXTENTS.iter().enumerate() {
        let (size, default) = (now.half_extents[axis], scene.half_extents[axis]);
        if let Some(new) = row(ui, field, size, default, memory) {
            let mut half_extents = now.half_extents;
            half_extents[axis] = new;
            out.push(Action::SetHalfExtents(half_extents));
        }
    }
    out.extend(row(ui, &MASS, now.mass, scene.mass, memory).map(Action::SetMass));
    if reset(ui, "box") {
        out.push(Action::SetHalfExtents(scene.half_extents));
        out.push(Action::SetMass(scene.mass));
    }
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
    let (now, scene) = (view.parameters.impulse, view.defaults.impulse);
    out.extend(row(ui, &IMPULSE, now, scene, memory).map(Action::SetImpulse));
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
        ui.checkbox(&mut memory.push_off_center, "off-center (Shift)")
            .on_hover_text("Push at the edge of the face, so that the box spins.");
        ui.checkbox(&mut memory.push_world, "world axes (Alt)")
            .on_hover_text("Push along the world's axes instead of the box's own.");
    });
    if reset(ui, "push") {
        out.push(Action::SetImpulse(scene));
    }
}

fn push_button(ui: &mut Ui, name: &str, impulse: f64, off_center: bool, world: bool) -> Response {
    let button = ui.add_sized(vec2(64.0, ui.spacing().interact_size.y), Button::new(name));
    button.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, format!("Push {name}")));
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
    let (now, scene) = (
        f64::from(view.parameters.boxes),
        f64::from(view.defaults.boxes),
    );
    if let Some(boxes) = row(ui, &BOXES, now, scene, memory) {
        out.push(Action::SetBoxes(count(boxes)));
    }
    ui.label(format!(
        "one step, all boxes: {} µs",
        number(view.step_time_us)
    ));
    ui.label(format!("one frame: {} ms", number(view.frame_time_ms)));
    let hitch = ui.button("Frame hitch").on_hover_text(
        "One frame of three quarters of a second: of it a quarter is simulated, the rest is dropped and counted.",
    );
    if hitch.clicked() {
        out.push(Action::Hitch);
    }
    ui.label(format!(
        "dropped by slow frames: {} s",
        number(view.dropped)
    ));
    if reset(ui, "load") {
        out.push(Action::SetBoxes(view.defaults.boxes));
    }
}

fn reset(ui: &mut Ui, what: &str) -> bool {
    ui.small_button(format!("Reset {what}"))
        .on_hover_text("Back to the scene's own values.")
        .clicked()
}

/// A count from its slider, which allows whole numbers from 1 to 10 000 alone.
fn count(value: f64) -> u32 {
    value as u32
}
