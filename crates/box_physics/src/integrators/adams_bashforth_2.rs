//! `adams-bashforth-2`: the two-step method of flight simulators, which stores one derivative.

use super::slope::Slope;
use super::{
    Conserved, EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Limit, MemorySlot,
    MenuGroup, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::math::Trigonometry;
use crate::state::BodyState;

/// `y_{n+1} = y_n + h (3/2 f_n − 1/2 f_{n−1})` on (x, q, v, L); the quaternion is normalized after each step.
///
/// The method needs one evaluation per step for order 2. As in `JSBSim`, the first step uses `f_{−1} = f_0`, which
/// makes it a step of Euler's method. The same holds after a change of state, body, forces or step size. It also holds
/// for a step that may reach the floor: contact changes the forces, and locating an impact needs other step lengths. As
/// with Euler's method, small bounces gain what restitution removes, so a dropped box does not come to rest.
///
/// On y' = λy the growth factor ζ solves ζ² = (1 + 3z/2) ζ − z/2, z = λh. The method is stable for real z down to −1,
/// half of Euler's range. On the imaginary axis |ζ| ≈ 1 + |z|⁴/4, so every oscillation and every spin gains energy.
pub struct AdamsBashforth2;

/// The derivative at the start of the last step, and the length of that step \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Previous {
    slope: Slope,
    h: f64,
}

impl Integrate for AdamsBashforth2 {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "adams-bashforth-2",
        name: "Adams–Bashforth 2",
        group: MenuGroup::Engines,
        summary: "The method of flight simulators: second order for one evaluation per step; restarts after every event and gains energy.",
        source: "Bashforth, Adams 1883; Hairer, Nørsett, Wanner, Solving ODEs I, III.1; JSBSim FGPropagate, FGMultiStepMethod",
        orders: Orders::all(2),
        evaluations: Evaluations::fixed(1, 1),
        stability: Stability {
            rotation: Limit::AlwaysGrows,
            drag: Limit::Below(1.0),
            damper: Limit::Below(1.0),
            oscillator: Limit::AlwaysGrows,
        },
        conserved: Conserved::nothing_else(EnergyBehavior::Gains),
    };

    const BRANCHES: bool = true;
    type Memory = Previous;
    const MULTISTEP: bool = true;

    #[inline]
    fn advance<F: ForceModel>(
        body: &RigidBox,
        state: &mut BodyState,
        force: &F,
        h: f64,
        memory: &mut MemorySlot<'_, Self>,
        _trigonometry: &mut impl Trigonometry,
    ) -> StepOutcome {
        let slope = Slope::at(body, state, force);
        let before = match memory.recall() {
            Some(previous) if same_step(previous.h, h) => previous.slope,
            _ => slope,
        };
        *state = before.step(&slope.from(state, 1.5 * h), -0.5 * h);
        memory.store(Previous { slope, h });
        StepOutcome::plain(1)
    }
}

/// Returns `true` if two step sizes are equal up to rounding. Dividing a time into steps yields sizes that are equal
/// only up to rounding.
#[inline(always)]
fn same_step(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Case, drag, run};
    use super::*;
    use crate::force::Gravity;
    use glam::DVec3;

    /// `v_{n+1} = (1 + 3z/2) v_n − z/2 v_{n−1}` with linear drag, from Euler's v₁ = (1 + z) v₀.
    #[test]
    fn recurrence() {
        let body = RigidBox::cube(1.0, 2.0).expect("valid");
        let (h, z) = (0.1, -0.07_f64);
        let (mut before, mut v) = (1.0, 1.0 + z);
        for n in 1..=50 {
            let start = BodyState::default().with_velocity(DVec3::X);
            let s = run::<AdamsBashforth2>(&body, start, &drag(1.4, 0.0), h * f64::from(n), n);
            assert!((s.velocity.x - v).abs() < 1e-12, "{n}");
            (before, v) = (v, (1.0 + 1.5 * z) * v - 0.5 * z * before);
        }
    }

    /// A parabola, except that Euler's first step lags by ½ g h².
    #[test]
    fn free_fall() {
        let (v, g, h) = (DVec3::new(3.0, 9.0, 0.0), DVec3::NEG_Y * 9.81, 1.0 / 60.0);
        let start = BodyState::default().with_velocity(v);
        let s = run::<AdamsBashforth2>(&RigidBox::default(), start, &Gravity(g), 4.0, 240);
        assert!((s.position - (4.0 * v + 8.0 * g - 0.5 * h * h * g)).length() < 1e-12);
    }

    /// The free top of van Zon and Schofield (2007), on which `JSBSim` 1.3.3 with this method has an error of
    /// 0.66 rad.
    #[test]
    fn error_of_a_flight_simulator() {
        let error = Case::van_zon_schofield().error::<AdamsBashforth2>(60);
        assert!((error - 0.66).abs() < 0.02, "{error}");
    }
}
