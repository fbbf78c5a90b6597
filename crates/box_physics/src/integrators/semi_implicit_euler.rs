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
        keeps: Keeps::nothing_else(EnergyBehavior::Gains),
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
    use super::super::testing::{brick, run};
    use super::*;
    use crate::force::Gravity;
    use crate::rotation::exponential_map;
    use glam::DVec3;

    /// x_n = x₀ + n h v₀ + ½ g h² n(n+1), the parabola plus exactly ½ g h t; a spin about a principal axis is exact.
    #[test]
    fn closed_forms() {
        let (body, w) = (brick(), DVec3::Y * 7.0);
        let (v, g) = (DVec3::new(3.0, 9.0, 0.0), DVec3::NEG_Y * 9.81);
        let (t, h) = (4.0, 1.0 / 60.0);
        let start = BodyState::default()
            .with_velocity(v)
            .with_body_angular_velocity(&body, w);
        let s = run::<SemiImplicitEuler>(&body, start, &Gravity(g), t, 240);
        assert!((s.position - (v * t + 0.5 * g * t * (t + h))).length() < 1e-12);
        assert!((s.rotation.dot(exponential_map(w * t)).abs() - 1.0).abs() < 1e-12);
    }
}
