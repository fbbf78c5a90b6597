//! `midpoint`: the explicit midpoint rule, the simplest Runge–Kutta method of order 2.

use super::slope::Slope;
use super::{
    Evaluations, ExplicitEuler, Integrate, IntegratorInfo, MemorySlot, Order, Orders, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::math::Trigonometry;
use crate::state::BodyState;

/// k₁ = f(y), k₂ = f(y + h/2 k₁), y += h k₂ on (x, q, v, L); the quaternion is normalized after the step.
///
/// On y' = λy a step multiplies y by R(z) = 1 + z + z²/2, z = λh, so |R(iy)|² = 1 + y⁴/4 > 1. Every undamped
/// oscillation and every spin gains energy, slowly at small steps.
pub struct Midpoint;

impl Integrate for Midpoint {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "midpoint",
        name: "Midpoint (RK2)",
        summary: "The explicit midpoint rule: second order for two evaluations, but slowly gains energy.",
        source: "Runge 1895; Hairer, Nørsett, Wanner, Solving ODEs I, II.1",
        orders: Orders {
            gravity: Order::Exact,
            ..Orders::all(2)
        },
        evaluations: Evaluations::fixed(2, 2),
        ..ExplicitEuler::INFO
    };

    type Memory = ();

    #[inline(always)]
    fn advance<F: ForceModel>(
        body: &RigidBox,
        state: &mut BodyState,
        force: &F,
        h: f64,
        _memory: &mut MemorySlot<'_, Self>,
        _trigonometry: &mut impl Trigonometry,
    ) -> StepOutcome {
        let k1 = Slope::at(body, state, force);
        let k2 = Slope::at(body, &k1.from(state, 0.5 * h), force);
        *state = k2.step(state, h);
        StepOutcome::plain(2)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{expect_damping, expect_turn, run};
    use super::*;
    use crate::force::Gravity;
    use glam::DVec3;

    /// R(z) = 1 + z + z²/2 on v and L, the position by the velocity in the middle; the parabola to rounding.
    #[test]
    fn amplification_factor_and_parabola() {
        let (h, z) = (0.1, -0.07);
        expect_damping::<Midpoint>(h, DVec3::ZERO, |v, _| {
            (v * (1.0 + z + 0.5 * z * z), h * (1.0 + 0.5 * z) * v)
        });
        let (v, g) = (DVec3::new(3.0, 9.0, 0.0), DVec3::NEG_Y * 9.81);
        let start = BodyState::default().with_velocity(v);
        let s = run::<Midpoint>(&RigidBox::default(), start, &Gravity(g), 4.0, 240);
        assert!((s.position - (4.0 * v + 8.0 * g)).length() < 1e-12);
    }

    /// Spin about a principal axis: the quaternion turns by arg(1 + iy − y²/2), y = ωh/2.
    #[test]
    fn phase_of_a_fixed_axis_spin() {
        let y: f64 = 2.5 / 60.0;
        expect_turn::<Midpoint>(2.0 * y, 2.0 * libm::atan2(y, 1.0 - 0.5 * y * y));
    }
}
