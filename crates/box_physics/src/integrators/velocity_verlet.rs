//! `velocity-verlet`: kick–drift–kick as in textbooks; drag lags by half a step.

use super::{
    Conserved, EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Limit, MemorySlot,
    MenuGroup, Order, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::{ForceModel, applied_rates};
use crate::math::Trigonometry;
use crate::rotation::free_rotation_three_axes;
use crate::state::BodyState;

/// v += h/2 a(x, v); x += h v; v += h/2 a(x, v), and the same for L with the torques. The drift consists of five planar
/// rotations x½ y½ z y½ x½ (`McLachlan` 1993; Reich 1994), which contain the gyroscopic term.
///
/// The first kick uses the drag at `v_n`, the second at `v_{n+½}`. Each multiplies v by 1 + z/2; together they multiply it
/// by R(z) = 1 + z + z²/4 with z = −ch/m. This is stable for z ≥ −4 but equals e^z only to first order, so order 2 holds
/// only for forces that depend on the pose alone. (A first kick that reuses the last acceleration, as in "one evaluation
/// per step", would have R = 1 + z from half step to half step: stable only to −2, with twice the error.)
pub struct VelocityVerlet;

impl Integrate for VelocityVerlet {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "velocity-verlet",
        name: "Velocity Verlet",
        group: MenuGroup::Textbook,
        summary: "The classic of molecular dynamics: reversible and conserves L, but drops to first order with drag.",
        source: "Swope, Andersen, Berens, Wilson 1982; McLachlan, PRL 71 (1993) 3043; Reich, Physica D 76 (1994) 375",
        orders: Orders {
            gravity: Order::Exact,
            linear_drag: Order::Of(1),
            quadratic_drag: Order::Of(1),
            angular_damping: Order::Of(1),
            angular_drag: Order::Of(1),
            ..Orders::all(2)
        },
        evaluations: Evaluations::fixed(2, 2),
        stability: Stability {
            rotation: Limit::None,
            drag: Limit::Below(4.0),
            damper: Limit::Below(4.0),
            oscillator: Limit::Below(2.0),
        },
        conserved: Conserved::all_else(EnergyBehavior::Bounded),
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
        half_kick(body, state, force, 0.5 * h);
        state.position += h * state.velocity;
        free_rotation_three_axes(body, state, h, trigonometry);
        half_kick(body, state, force, 0.5 * h);
        StepOutcome::plain(2)
    }
}

/// Applies all terms except the gyroscopic one at the current state, with one evaluation.
#[inline(always)]
pub(super) fn half_kick<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    tau: f64,
) {
    let (dv, torque) = applied_rates(body, state, force);
    state.velocity += tau * dv;
    state.angular_momentum += tau * torque;
}

#[cfg(test)]
mod tests {
    use super::super::testing::{expect_damping, on, run, spring};
    use super::*;
    use glam::DVec3;

    /// R(z) = 1 + z + z²/4 on v and L; x moves by the half-step velocity.
    #[test]
    fn amplification_factor_and_position() {
        let (h, z) = (0.1, -0.07);
        expect_damping::<VelocityVerlet>(h, DVec3::ZERO, |v, _| {
            (v * (1.0 + z + 0.25 * z * z), h * (1.0 + 0.5 * z) * v)
        });
    }

    /// On a central spring one step has trace 2 − (ωh)²: `x_n = cos(nθ)`, cos θ = 1 − (ωh)²/2.
    #[test]
    fn oscillator_phase() {
        let body = RigidBox::cube(1.0, 2.0).expect("valid");
        let springs = spring(DVec3::ZERO, 8.0);
        let (w, h, n) = (2.0, 0.05_f64, 300);
        let (start, t) = (BodyState::at(DVec3::X), h * f64::from(n));
        let s = run::<VelocityVerlet>(&body, start, &on(&springs), t, n);
        let theta = libm::acos(1.0 - 0.5 * (w * h) * (w * h));
        assert!((s.position.x - libm::cos(f64::from(n) * theta)).abs() < 1e-12);
    }
}
