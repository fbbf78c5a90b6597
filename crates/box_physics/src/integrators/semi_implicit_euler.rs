//! `semi-implicit-euler`: velocities first, then the pose by the new velocities; explicit gyroscopic term.

use super::{
    EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Keeps, Limit, MemorySlot, MenuGroup,
    Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::{ForceModel, rates};
use crate::math::Trigonometry;
use crate::rotation::{compose, exponential_map_by};
use crate::state::BodyState;

/// v += h f(x, v), x += h v; L += h(L×ω + τ), q ← q∘exp(h ω_new).
///
/// Symplectic for forces that depend on position alone. Not symplectic for rotation: the explicit gyroscopic
/// term adds energy to every tumbling body.
pub struct SemiImplicitEuler;

impl Integrate for SemiImplicitEuler {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "semi-implicit-euler",
        name: "Semi-implicit Euler",
        group: MenuGroup::Engines,
        summary: "The method of small engines: cheap and stable on springs, but a tumbling body gains energy without limit.",
        source: "de Vogelaere 1956; Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1.2",
        orders: Orders::all(1),
        evaluations: Evaluations::fixed(1, 1),
        stability: Stability {
            rotation: Limit::AlwaysGrows,
            drag: Limit::Below(2.0),
            damper: Limit::Below(2.0),
            oscillator: Limit::Below(2.0),
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
        trigonometry: &mut impl Trigonometry,
    ) -> StepOutcome {
        let (dv, dl) = rates(body, state, force);
        state.velocity += h * dv;
        state.position += h * state.velocity;
        state.angular_momentum += h * dl;
        let turn = exponential_map_by(h * state.body_angular_velocity(body), trigonometry);
        state.rotation = compose(state.rotation, turn);
        state.renormalize();
        StepOutcome::plain(1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::IntegratorMemory;
    use super::*;
    use crate::force::Gravity;
    use crate::rotation::exponential_map;
    use glam::DVec3;

    /// x_n = x₀ + n h v₀ + ½ g h² n(n+1): the parabola plus exactly ½ g h t.
    #[test]
    fn free_fall_closed_form() {
        let body = RigidBox::default();
        let (g, h) = (DVec3::NEG_Y * 9.81, 1.0 / 60.0);
        let mut s = BodyState::default().with_velocity(DVec3::new(3.0, 9.0, 0.0));
        for n in 1..=240 {
            SemiImplicitEuler::step(
                &body,
                &mut s,
                &Gravity(g),
                h,
                &mut IntegratorMemory::default(),
            );
            let n = f64::from(n);
            let x = DVec3::new(3.0, 9.0, 0.0) * (n * h) + g * (0.5 * h * h * n * (n + 1.0));
            assert!((s.position - x).length() < 1e-12);
        }
    }

    /// A spin about a principal axis is exact: q_n = exp(n h ω).
    #[test]
    fn principal_spin_closed_form() {
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid");
        let (w, h) = (DVec3::new(0.0, 7.0, 0.0), 1.0 / 60.0);
        let mut s = BodyState::default().with_body_angular_velocity(&body, w);
        for n in 1..=600 {
            SemiImplicitEuler::step(
                &body,
                &mut s,
                &Gravity(DVec3::ZERO),
                h,
                &mut IntegratorMemory::default(),
            );
            let exact = exponential_map(w * (h * f64::from(n)));
            assert!(
                (s.rotation.y - exact.y).abs() < 1e-12 && (s.rotation.w - exact.w).abs() < 1e-12
            );
        }
    }
}
