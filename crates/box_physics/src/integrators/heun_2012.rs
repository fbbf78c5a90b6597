//! `heun-2012`: the method that the 2012 dissertation called "implicit Euler".

use super::slope::turn;
use super::{
    Evaluations, Integrate, IntegratorInfo, MemorySlot, MenuGroup, SemiImplicitEuler, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::{ForceModel, rates};
use crate::math::Trigonometry;
use crate::state::BodyState;

/// k₁ = f(v), k₂ = f(v + h k₁), v += h/2 (k₁ + k₂), x += h v_new. The angular momentum uses the same formula, then q ←
/// q∘exp(h ω_new).
///
/// The method is explicit: it is Heun's method applied to the velocity. Because the position moves by the new velocity,
/// the second order is lost: under gravity the position is ahead by exactly ½ g h t.
pub struct Heun2012;

impl Integrate for Heun2012 {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "heun-2012",
        name: "Heun (2012)",
        group: MenuGroup::Dissertation2012,
        summary: "The dissertation's \"implicit Euler\": actually an explicit Heun step with a first-order position.",
        source: "Heun 1900; V. Stojanovic, dissertation 2012 (listing), extended to rotation",
        evaluations: Evaluations::fixed(2, 2),
        ..SemiImplicitEuler::INFO
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
        let (v1, l1) = rates(body, state, force);
        let mut ahead = *state;
        ahead.velocity += h * v1;
        ahead.angular_momentum += h * l1;
        let (v2, l2) = rates(body, &ahead, force);
        state.velocity += (0.5 * h) * (v1 + v2);
        state.position += h * state.velocity;
        state.angular_momentum += (0.5 * h) * (l1 + l2);
        turn(body, state, h, trigonometry);
        StepOutcome::plain(2)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{expect_damping, expect_new_velocities};
    use super::*;
    use glam::DVec3;

    /// R(z) = 1 + z + z²/2 on v and L; x by the new velocity.
    #[test]
    fn amplification_factor_and_position() {
        let (h, z) = (0.1, -0.07);
        expect_damping::<Heun2012>(h, DVec3::ZERO, |v, _| {
            let v = v * (1.0 + z + 0.5 * z * z);
            (v, h * v)
        });
        expect_new_velocities::<Heun2012>();
    }
}
