//! `explicit-euler`: the simplest method, for teaching.

use super::slope::Slope;
use super::{
    EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Keeps, Limit, MemorySlot, MenuGroup,
    Orders, Stability, StepOutcome,
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
        keeps: Keeps {
            energy: EnergyBehavior::Gains,
            momentum_magnitude: false,
            momentum: false,
            reversible: false,
        },
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
        *state = Slope::at(body, state, force).from(state, h);
        state.rotation = state.rotation * (1.0 / state.rotation.length());
        StepOutcome::plain(1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::IntegratorMemory;
    use super::*;
    use crate::force::Gravity;
    use glam::DVec3;

    /// x_n = x₀ + n h v₀ + ½ g h² n(n−1): the parabola minus exactly ½ g h t.
    #[test]
    fn free_fall_closed_form() {
        let body = RigidBox::default();
        let (g, h) = (DVec3::NEG_Y * 9.81, 1.0 / 60.0);
        let mut s = BodyState::default().with_velocity(DVec3::new(3.0, 9.0, 0.0));
        for n in 1..=240 {
            ExplicitEuler::step(
                &body,
                &mut s,
                &Gravity(g),
                h,
                &mut IntegratorMemory::default(),
            );
            let n = f64::from(n);
            let x = DVec3::new(3.0, 9.0, 0.0) * (n * h) + g * (0.5 * h * h * n * (n - 1.0));
            assert!((s.position - x).length() < 1e-12);
        }
    }

    /// A principal spin turns by 2 atan(ωh/2) per step instead of ωh.
    #[test]
    fn principal_spin_closed_form() {
        let body = RigidBox::default();
        let (w, h, n) = (8.0, 1.0 / 60.0, 300);
        let mut s = BodyState::default().with_body_angular_velocity(&body, DVec3::X * w);
        for _ in 0..n {
            ExplicitEuler::step(
                &body,
                &mut s,
                &Gravity(DVec3::ZERO),
                h,
                &mut IntegratorMemory::default(),
            );
        }
        let half = libm::atan(0.5 * w * h) * f64::from(n);
        assert!((s.rotation.x - libm::sin(half)).abs() < 1e-12);
        assert!((s.rotation.w - libm::cos(half)).abs() < 1e-12);
    }
}
