//! `explicit-euler`: the simplest method, for teaching.

use super::slope::Slope;
use super::{
    Conserved, EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Limit, MemorySlot,
    MenuGroup, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::math::Trigonometry;
use crate::state::BodyState;

/// y += h f(y) for position, attitude, velocity and angular momentum; q normalized.
pub struct ExplicitEuler;

impl Integrate for ExplicitEuler {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "explicit-euler",
        name: "Explicit Euler",
        group: MenuGroup::Textbook,
        summary: "The simplest method: every spin and every spring gains energy at any step.",
        source: "Euler 1768; Hairer, Nørsett, Wanner, Solving ODEs I, I.7",
        orders: Orders::all(1),
        evaluations: Evaluations::fixed(1, 1),
        stability: Stability {
            rotation: Limit::AlwaysGrows,
            drag: Limit::Below(2.0),
            damper: Limit::Below(2.0),
            oscillator: Limit::AlwaysGrows,
        },
        conserved: Conserved::nothing_else(EnergyBehavior::Gains),
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
        *state = Slope::at(body, state, force).step(state, h);
        StepOutcome::plain(1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{expect_turn, run};
    use super::*;
    use crate::force::Gravity;
    use glam::DVec3;

    /// x_n = x₀ + n h v₀ + ½ g h² n(n−1): the parabola minus exactly ½ g h t.
    #[test]
    fn free_fall_closed_form() {
        let (v, g) = (DVec3::new(3.0, 9.0, 0.0), DVec3::NEG_Y * 9.81);
        let (t, h) = (4.0, 1.0 / 60.0);
        let start = BodyState::default().with_velocity(v);
        let s = run::<ExplicitEuler>(&RigidBox::default(), start, &Gravity(g), t, 240);
        assert!((s.position - (v * t + 0.5 * g * t * (t - h))).length() < 1e-12);
    }

    /// A principal spin turns by 2 atan(ωh/2) per step instead of ωh.
    #[test]
    fn principal_spin_closed_form() {
        let turn = 8.0 / 60.0;
        expect_turn::<ExplicitEuler>(turn, 2.0 * libm::atan(0.5 * turn));
    }
}
