//! Cases 20 to 24: extreme sizes, steps and positions.

use glam::DVec3;
use libm::{cos, sin};

use super::{GAME_STEPS, brick, case, solid, spin};
use crate::hard_cases::{Check, HardCase};
use crate::setup::TimedImpulse;

#[rustfmt::skip]
pub(super) fn cases() -> Vec<HardCase> {
    let scaled = |size: f64, mass| {
        spin(
            solid([0.5 * size, 0.25 * size, 0.125 * size], mass),
            [1.5, 2.5, 1.0],
            10.0,
        )
    };
    let tumbling = |duration| spin(brick(), [1.5, 2.5, 1.0], duration);
    let mut moving = tumbling(1.0);
    moving.initial.velocity = DVec3::new(1.0, 2.0, 3.0);
    let mut far = moving.clone();
    far.initial.position = DVec3::new(1e5, 0.0, 0.0);
    far.initial.velocity = DVec3::new(0.1, 0.0, 0.0);
    far.duration = 60.0;
    let mut hit = moving.clone();
    // 500 impulses and their opposites, at 500 points of the body.
    let push = |k: u32| {
        let a = f64::from(k);
        TimedImpulse {
            t: 0.0,
            impulse: DVec3::new(sin(a), cos(2.0 * a), sin(3.0 * a)),
            body_point: DVec3::new(cos(5.0 * a) * 0.5, sin(7.0 * a) * 0.25, 0.1),
        }
    };
    let back = |i: TimedImpulse| TimedImpulse {
        impulse: -i.impulse,
        ..i
    };
    hit.impulses = (0..500)
        .map(push)
        .chain((0..500).map(push).map(back))
        .collect();
    vec![
        case(20, "tiny", "A millimeter box of a microgram: 1e-9 kg", scaled(1e-3, 1e-9), GAME_STEPS,
            Check::Attitude(1e-3)),
        case(20, "huge", "A box of 100 m and 1e9 kg", scaled(1e2, 1e9), GAME_STEPS, Check::Attitude(1e-3)),
        case(21, "tiny-step", "Steps of 1e-7 s", tumbling(1e-3), [1e-7], Check::Attitude(1e-11)),
        case(21, "huge-step", "Steps of a second", tumbling(1e3), [1.0],
            Check::Bounded { steps: 1000, bound: 1e-11 }),
        case(21, "zero-step", "Steps of zero length", moving, [0.0], Check::Unchanged),
        case(22, "spikes", "A hitch of 0.5 s every hundred steps", tumbling(10.0), [1.0 / 60.0],
            Check::Spikes(1e-12)),
        // Half a unit in the last place of 1e5 m is 7e-12 m; in the worst case it adds up over 14 400 steps.
        case(23, "far", "100 km from the origin at 0.1 m/s", far, GAME_STEPS, Check::Position(1.1e-7)),
        case(24, "impulses", "A thousand simultaneous impulses", hit, [1.0 / 60.0], Check::Restored(1e-13)),
    ]
}
