//! Cases 13 to 16: damping, torque, spring.

use box_physics::state::BodyState;
use glam::DVec3;

use super::{GAME_STEPS, brick, case, solid, spin};
use crate::forces::ForceSet;
use crate::hard_cases::{Check, HardCase};
use crate::reference::turn;
use crate::setup::Setup;

#[rustfmt::skip]
pub(super) fn cases() -> Vec<HardCase> {
    let with = |mut setup: Setup, forces: ForceSet| {
        setup.forces = forces;
        setup
    };
    let damping = |angular_damping| ForceSet {
        angular_damping,
        ..ForceSet::none()
    };
    let damped = |rate| with(spin(brick(), [1.0, 8.0, 2.0], 10.0), damping(rate));
    let drag = ForceSet {
        angular_drag: 0.0625,
        ..ForceSet::none()
    };
    let torque = ForceSet {
        body_torque: DVec3::Z * 0.25,
        ..ForceSet::none()
    };
    let bar = solid([0.25, 0.5, 0.25], 6.0);
    let top = Setup::new(
        bar,
        BodyState::at_pose(DVec3::ZERO, turn(DVec3::X, 0.7))
            .with_body_angular_velocity(&bar, DVec3::Y * 12.0),
        ForceSet::none().with_dipole(DVec3::NEG_Y * 4.0, DVec3::Y),
        5.0,
    );
    let mut swing = spin(brick(), [0.5, 1.0, -0.5], 10.0);
    swing.initial.position = DVec3::new(0.3, -0.5, 0.2);
    let swing = with(
        swing,
        ForceSet::none().with_spring(DVec3::new(0.5, 0.25, 0.125), DVec3::ZERO, 60.0, 0.0),
    );
    vec![
        case(13, "damped-tumbling", "Damping −γL, γ = 0.25 1/s", damped(0.25), GAME_STEPS, Check::Attitude(5e-3)),
        case(13, "strong-damping", "Damping −γL, γ·h = 1 at 60 Hz", damped(60.0), GAME_STEPS,
            Check::Attitude(2e-4)),
        case(13, "extreme-damping", "Damping −γL, γ·h = 1000 at 60 Hz", damped(6e4), GAME_STEPS,
            Check::Attitude(1e-9)),
        case(13, "axis-drag", "Drag −cω about an axis", with(spin(brick(), [12.0, 0.0, 0.0], 5.0), drag),
            GAME_STEPS, Check::Attitude(2e-4)),
        case(14, "axis-torque", "Constant torque about an axis", with(spin(brick(), [0.0, 0.0, 1.0], 8.0), torque),
            GAME_STEPS, Check::Attitude(1e-10)),
        case(15, "heavy-top", "Heavy top", top, GAME_STEPS, Check::Attitude(2e-3)),
        case(16, "corner-spring", "A spring at a corner", swing, GAME_STEPS, Check::Energy(2e-2)),
    ]
}
