//! Gamepads (feature `gamepad`): the same actions as the keys.
//!
//! Directional pad and face buttons push, shoulders change the integrator, Start pauses, Select restarts. The
//! right stick turns the camera.

use bevy::input::gamepad::{Gamepad, GamepadButton};
use bevy::prelude::*;
use box_physics::prelude::{DVec3, GlobalIntegrator, Integrator};

use crate::action::{Action, Actions, Push};

const PUSHES: [(GamepadButton, DVec3); 6] = [
    (GamepadButton::DPadRight, DVec3::X),
    (GamepadButton::DPadLeft, DVec3::NEG_X),
    (GamepadButton::North, DVec3::Y),
    (GamepadButton::South, DVec3::NEG_Y),
    (GamepadButton::DPadDown, DVec3::Z),
    (GamepadButton::DPadUp, DVec3::NEG_Z),
];

/// Reads the buttons. With the west button held, pushes act off-center.
pub(super) fn read_buttons(
    pads: Query<&Gamepad>,
    integrator: Res<GlobalIntegrator>,
    mut actions: ResMut<Actions>,
) {
    for pad in &pads {
        for (button, direction) in PUSHES {
            if pad.just_pressed(button) {
                actions.0.push(Action::Push(Push {
                    direction,
                    world: false,
                    off_center: pad.pressed(GamepadButton::West),
                }));
            }
        }
        let count = Integrator::ALL.len();
        let next = |by| Action::SetIntegrator(Integrator::ALL[(integrator.0.index() + by) % count]);
        for (button, action) in [
            (GamepadButton::LeftTrigger, next(count - 1)),
            (GamepadButton::RightTrigger, next(1)),
            (GamepadButton::Start, Action::TogglePause),
            (GamepadButton::Select, Action::Restart),
        ] {
            if pad.just_pressed(button) {
                actions.0.push(action);
            }
        }
    }
}
