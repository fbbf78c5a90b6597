//! Cases 17 to 19: the center of mass under gravity and drag.

use box_physics::state::BodyState;
use glam::DVec3;

use super::{GAME_STEPS, case, solid};
use crate::forces::ForceSet;
use crate::hard_cases::{Check, HardCase};
use crate::setup::Setup;

#[rustfmt::skip]
pub(super) fn cases() -> Vec<HardCase> {
    let g = ForceSet::gravity(9.81);
    let cube = solid([0.5; 3], 2.0);
    let moving = |v: [f64; 3], forces: ForceSet, duration| {
        let start = BodyState::at(DVec3::Y).with_velocity(DVec3::from_array(v));
        Setup::new(cube, start, forces, duration)
    };
    let stiff = ForceSet {
        linear_drag: 2000.0,
        ..g.clone()
    };
    let air = ForceSet {
        quadratic_drag: 0.0625,
        ..g.clone()
    };
    let in_a_void = ForceSet {
        gravity: DVec3::ZERO,
        ..air.clone()
    };
    vec![
        case(17, "parabola", "Parabola", moving([4.0, 9.0, -2.0], g, 4.0), GAME_STEPS, Check::Position(1e-9)),
        case(18, "stiff-drag", "Drag with c·h/m from 0.1 to 1000", moving([10.0, 20.0, -5.0], stiff.clone(), 2.0),
            [1e-3, 1.0 / 60.0, 0.1, 1.0], Check::Position(1e-9)),
        case(18, "stiff-drag-reversal", "Drag must not reverse a velocity", moving([10.0, 20.0, -5.0], stiff, 2.0),
            [1e-4, 1e-3, 3e-3, 1e-2, 0.1, 1.0], Check::NoReversal(1e-15)),
        case(19, "air-from-rest", "Fall through air from rest", moving([0.0; 3], air.clone(), 15.0), GAME_STEPS,
            Check::Position(1e-2)),
        case(19, "air-upwards", "Upward throw through air", moving([0.0, 45.0, 0.0], air, 8.0), GAME_STEPS,
            Check::Position(1e-2)),
        case(19, "overspeed", "Entry into air at 10 km/s", moving([1e4, 0.0, 0.0], in_a_void, 2.0),
            [1.0 / 240.0, 1.0 / 60.0, 1.0], Check::NoReversal(1e-15)),
    ]
}
