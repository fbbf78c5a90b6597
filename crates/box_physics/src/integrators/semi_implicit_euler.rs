//! `semi-implicit-euler`: velocities first, then the pose by the new velocities; explicit gyroscopic term.

use super::slope::turn;
use super::{
    Conserved, EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Limit, MemorySlot,
    MenuGroup, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::{ForceModel, rates};
use crate::math::Trigonometry;
use crate::state::BodyState;

/// v += h f(x, v), x += h v; L += h(L×ω + τ), q ← q∘exp(h ω_new).
///
/// The method is symplectic for forces that depend only on position. It is not symplectic for rotation: the explicit
/// gyroscopic term adds energy to every tumbling body.
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
        trigonometry: &mut impl Trigonometry,
    ) -> StepOutcome {
        let (dv, dl) = rates(body, state, force);
        state.velocity += h * dv;
        state.position += h * state.velocity;
        state.angular_momentum += h * dl;
        turn(body, state, h, trigonometry);
        StepOutcome::plain(1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::expect_new_velocities;
    use super::*;

    #[test]
    fn closed_forms() {
        expect_new_velocities::<SemiImplicitEuler>();
    }
}
