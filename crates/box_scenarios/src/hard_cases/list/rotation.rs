//! Cases 1 to 12: free rotation.

use glam::DVec3;

use super::{GAME_STEPS, brick, case, needle, plate, solid, spin};
use crate::hard_cases::{Check, HardCase};

/// Values of |ω|·h from small to extreme.
const SWEEP: [f64; 10] = [0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 50.0];

#[rustfmt::skip]
pub(super) fn cases() -> Vec<HardCase> {
    let square_bar = |gap: f64| solid([0.25, 0.5, 0.25 * (1.0 + gap)], 6.0);
    let (tumble, flip) = ([1.5, 2.5, 1.0], [1.0 / 128.0, 8.0, -1.0 / 256.0]);
    let mut cases = vec![
        case(1, "flip", "Flips next to the separatrix", spin(brick(), flip, 10.0), GAME_STEPS,
            Check::Attitude(1e-2)),
        // The error grows by the factor e every 1/λ ≈ 0.13 s: a rounding error of 1e-16 becomes 1e-6 after 3 s.
        case(2, "separatrix", "1e-12 from the separatrix", spin(brick(), [1e-12, 8.0, 1e-12], 3.0), GAME_STEPS,
            Check::Attitude(1e-5)),
        case(3, "symmetric-top", "Steady precession of a square bar", spin(square_bar(0.0), [2.0, 6.0, 0.0], 10.0),
            GAME_STEPS, Check::Attitude(1e-12)),
        case(4, "cube", "Constant spin of a cube", spin(solid([0.5; 3], 6.0), [3.0, -4.0, 5.0], 10.0), GAME_STEPS,
            Check::Attitude(1e-12)),
        case(5, "thin-plate", "Tumbling plate, 64:1", spin(plate(), [3.0, 0.5, 4.0], 10.0), GAME_STEPS,
            Check::Attitude(1e-3)),
        case(6, "needle", "Needle, moments 800:1", spin(needle(), [20.0, 1.0, 0.5], 5.0), GAME_STEPS,
            Check::Attitude(1e-3)),
        case(7, "near-symmetric-1e-2", "Moments that differ by 1e-2", spin(square_bar(1e-2), [2.0, 6.0, 0.3], 10.0),
            GAME_STEPS, Check::Attitude(1e-3)),
        case(7, "near-symmetric-1e-6", "Moments that differ by 1e-6", spin(square_bar(1e-6), [2.0, 6.0, 0.3], 10.0),
            GAME_STEPS, Check::Attitude(1e-7)),
        case(7, "near-symmetric-1e-12", "Moments that differ by 1e-12",
            spin(square_bar(1e-12), [2.0, 6.0, 0.3], 10.0), GAME_STEPS, Check::Attitude(1e-10)),
        case(8, "aliasing", "4.2 rad per step", spin(solid([0.5; 3], 6.0), [0.0, 150.0, 200.0], 2.0), [1.0 / 60.0],
            Check::Attitude(1e-11)),
    ];
    for (id, title, body, omega) in [
        ("sweep-brick", "Any |ω|·h, ordinary box", brick(), tumble),
        ("sweep-plate", "Any |ω|·h, plate", plate(), [3.0, 0.5, 4.0]),
        ("sweep-needle", "Any |ω|·h, needle", needle(), [20.0, 1.0, 0.5]),
    ] {
        let speed = DVec3::from_array(omega).length();
        let check = Check::Bounded {
            steps: 2000,
            bound: 1e-11,
        };
        cases.push(case(9, id, title, spin(body, omega, 10.0), SWEEP.map(|x| x / speed), check));
    }
    cases.extend([
        case(10, "long-run", "A million steps", spin(brick(), tumble, 10.0), [1.0 / 60.0],
            Check::Trend { steps: 1_000_000, bound: 1e-9 }),
        case(11, "return", "600 steps forward, 600 backward", spin(brick(), tumble, 10.0), GAME_STEPS,
            Check::Return { steps: 600, bound: 1e-11 }),
        case(12, "unit-length", "Quaternion norm", spin(brick(), tumble, 10.0), [1.0 / 60.0],
            Check::UnitLength { steps: 100_000, bound: 1e-15 }),
    ]);
    cases
}
