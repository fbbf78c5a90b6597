//! Gamepads (feature `gamepad`): the same actions as the keys.
//!
//! Directional pad and face buttons push, shoulders change the integrator, Start pauses, Select restarts,
//! the right stick turns the camera.

use bevy::input::gamepad::{Gamepad, GamepadButton};
use bevy::prelude::*;
use box_physics::prelude::{DVec3, GlobalIntegrator, Integrator};

use crate::action::{Action, Push};
use crate::apply::Asked;
use crate::camera::OrbitCamera;

/// Full deflection of the stick turns the camera this fast [rad/s].
const TURN: f32 = 2.5;

const PUSHES: [(GamepadButton, DVec3); 6] = [
    (GamepadButton::DPadRight, DVec3::X),
    (GamepadButton::DPadLeft, DVec3::NEG_X),
    (GamepadButton::North, DVec3::Y),
    (GamepadButton::South, DVec3::NEG_Y),
    (GamepadButton::DPadDown, DVec3::Z),
    (GamepadButton::DPadUp, DVec3::NEG_Z),
];

/// Reads the buttons. With the west button held, pushes act off-center.
pub fn read_buttons(
    pads: Query<&Gamepad>,
    integrator: Res<GlobalIntegrator>,
    mut asked: ResMut<Asked>,
) {
    for pad in &pads {
        for (button, direction) in PUSHES {
            if pad.just_pressed(button) {
                asked.0.push(Action::Push(Push {
                    direction,
                    world: false,
                    off_center: pad.pressed(GamepadButton::West),
                }));
            }
        }
        let count = Integrator::ALL.len();
        for (button, by) in [
            (GamepadButton::LeftTrigger, count - 1),
            (GamepadButton::RightTrigger, 1),
        ] {
            if pad.just_pressed(button) {
                let next = (integrator.0.index() + by) % count;
                asked.0.push(Action::SetIntegrator(Integrator::ALL[next]));
            }
        }
        for (button, action) in [
            (GamepadButton::Start, Action::TogglePause),
            (GamepadButton::Select, Action::Restart),
        ] {
            if pad.just_pressed(button) {
                asked.0.push(action);
            }
        }
    }
}

/// The right stick turns the camera.
pub fn turn_camera(
    pads: Query<&Gamepad>,
    time: Res<Time<Real>>,
    mut camera: Single<&mut OrbitCamera>,
) {
    for pad in &pads {
        let stick = pad.right_stick();
        if stick.length() > 0.1 {
            let turn = stick * TURN * time.delta_secs();
            camera.yaw -= turn.x;
            camera.pitch = (camera.pitch - turn.y).clamp(-1.5, 1.5);
        }
    }
}
