//! The right stick of a gamepad turns the camera.

use bevy::input::gamepad::Gamepad;
use bevy::prelude::*;

use super::orbit::OrbitCamera;

/// Full deflection of the stick turns the camera this fast [rad/s].
const TURN: f32 = 2.5;

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
