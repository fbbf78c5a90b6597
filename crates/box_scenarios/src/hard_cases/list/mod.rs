//! The 24 cases. A bound is the result of a good second-order integrator, or rounding if an exact result is possible.

mod forced;
mod numbers;
mod rotation;
mod translation;

use box_physics::body::RigidBox;
use box_physics::state::BodyState;
use glam::DVec3;

use super::{Check, HardCase};
use crate::forces::ForceSet;
use crate::setup::Setup;

/// 60, 120 and 240 steps per second.
const GAME_STEPS: [f64; 3] = [1.0 / 60.0, 1.0 / 120.0, 1.0 / 240.0];

/// All cases, in the order of their numbers.
pub fn hard_cases() -> Vec<HardCase> {
    [
        rotation::cases(),
        forced::cases(),
        translation::cases(),
        numbers::cases(),
    ]
    .concat()
}

fn solid(half: [f64; 3], mass: f64) -> RigidBox {
    RigidBox::new(DVec3::from_array(half), mass)
        .expect("the numbers of a built-in case are valid: a test builds every one")
}

fn brick() -> RigidBox {
    solid([0.5, 0.25, 0.125], 3.0)
}

fn plate() -> RigidBox {
    solid([0.5, 1.0 / 128.0, 0.375], 3.0)
}

fn needle() -> RigidBox {
    solid([1.0, 1.0 / 64.0, 1.0 / 32.0], 3.0)
}

/// A free rotation with the angular velocity `omega` [rad/s], body axes.
fn spin(body: RigidBox, omega: [f64; 3], duration: f64) -> Setup {
    let start = BodyState::default().with_body_angular_velocity(&body, DVec3::from_array(omega));
    Setup::new(body, start, ForceSet::none(), duration)
}

fn case(
    number: u8,
    id: &'static str,
    title: &'static str,
    setup: Setup,
    steps: impl Into<Vec<f64>>,
    check: Check,
) -> HardCase {
    HardCase {
        number,
        id,
        title,
        setup,
        steps: steps.into(),
        check,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hard_cases::Verdict;
    use box_physics::integrators::Integrator;

    #[test]
    fn all_24_are_there() {
        let cases = hard_cases();
        for n in 1..=24 {
            assert!(cases.iter().any(|c| c.number == n), "{n}");
        }
        for (k, c) in cases.iter().enumerate() {
            assert!(
                cases[..k]
                    .iter()
                    .all(|d| d.id != c.id && d.number <= c.number),
                "{}",
                c.id
            );
            c.setup.validate().expect(c.id);
        }
    }

    /// The default integrator passes all cases.
    #[test]
    fn split_does_them_all() {
        for c in hard_cases() {
            for f in c.examine(Integrator::Split) {
                assert_eq!(
                    f.verdict(),
                    Verdict::Ok,
                    "{} at h = {}: {} = {:e}, ok up to {:e}",
                    c.id,
                    f.h,
                    f.quantity,
                    f.value,
                    f.bound
                );
            }
        }
    }
}
