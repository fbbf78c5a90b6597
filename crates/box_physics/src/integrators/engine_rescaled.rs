//! `engine-rescaled`: the gyroscopic step of Jolt, Avian and Rapier, explicit and rescaled to |L|.

use glam::DVec3;

use super::engine_newton::damping_rates;
use super::slope::turn;
use super::{
    Conserved, EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Limit, MemorySlot,
    MenuGroup, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel, wrench_of};
use crate::math::Trigonometry;
use crate::state::BodyState;

/// The gyroscopic step of Jolt, Avian and Rapier, velocities first:
///
/// ```text
/// L* = (L − hω×L)·|L|/|L − hω×L|,  L ← (L* + hτ)·max(0, 1 − hγ),  q ← q∘exp(hω_new)
/// v ← (v + h(a + F/m))·max(0, 1 − hc/m),  x += h v_new
/// ```
///
/// The explicit step L − hω×L is longer than L by the factor √(1 + h²|ω×L|²/|L|²), because the two terms are
/// orthogonal. Rescaling removes that growth and with it the blow-up. The error in direction remains and drives every
/// spin toward the middle axis: `E → L²/2I_mid`.
///
/// Damping is the clamped factor of Jolt (`ApplyForceTorqueAndDragInternal`). Quadratic and angular drag, which no
/// engine has, use their coefficient at the start of the step, `c = c₁ + k₂|v|`, `γ_i = γ + c_ω/I_i`.
pub struct EngineRescaled;

impl Integrate for EngineRescaled {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "engine-rescaled",
        name: "Engine: rescaled",
        group: MenuGroup::Engines,
        summary: "The step of Jolt, Avian and Rapier with gyroscopic forces: never diverges and conserves |L|, but energy and axis drift.",
        source: "Jolt MotionProperties::ApplyGyroscopicForceInternal; avian PR #738, #745",
        orders: Orders::all(1),
        evaluations: Evaluations::fixed(1, 1),
        stability: Stability {
            rotation: Limit::None,
            drag: Limit::None,
            damper: Limit::Below(2.0),
            oscillator: Limit::Below(2.0),
        },
        conserved: Conserved {
            energy: EnergyBehavior::Drifts,
            momentum_magnitude: true,
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
        let (d, w) = (force.dissipation(), wrench_of(body, state, force));
        let (c, gamma) = damping_rates(body, state, &d);
        state.angular_momentum = rescaled_gyroscopic_step(body, state, h) + h * w.torque;
        state.velocity += h * (force.acceleration() + w.force * body.inverse_mass());
        if d != Dissipation::NONE {
            state.velocity = d.in_air(state.velocity, |v| v * (1.0 - h * c).max(0.0));
            state.angular_momentum *= (1.0 - h * gamma).max(DVec3::ZERO);
        }
        state.position += h * state.velocity;
        turn(body, state, h, trigonometry);
        StepOutcome::plain(1)
    }
}

/// (L − hω×L) scaled back to |L|.
#[inline(always)]
fn rescaled_gyroscopic_step(body: &RigidBox, state: &BodyState, h: f64) -> DVec3 {
    let l = state.angular_momentum;
    let stepped = l + h * l.cross(state.body_angular_velocity(body));
    let squared = stepped.length_squared();
    if squared > 0.0 {
        stepped * (l.length_squared() / squared).sqrt()
    } else {
        DVec3::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{brick, expect_damping, expect_new_velocities, run};
    use super::*;
    use crate::force::Gravity;

    /// R = max(0, 1 − ch/m) on v and L; x by the new velocity.
    #[test]
    fn clamped_damping() {
        for (h, r) in [(0.1, 0.93), (1.0, 0.3), (10.0, 0.0), (1000.0, 0.0)] {
            expect_damping::<EngineRescaled>(h, DVec3::NEG_Y * 9.81, |v, g| {
                let v = (v + h * g) * r;
                (v, h * v)
            });
        }
        expect_new_velocities::<EngineRescaled>();
    }

    /// The energy tends to L²/2I of the middle axis.
    #[test]
    fn the_energy_tends_to_the_middle_axis() {
        let body = brick();
        for axis in [DVec3::X, DVec3::Z] {
            let start =
                BodyState::default().with_body_angular_velocity(&body, axis + DVec3::splat(0.05));
            let s =
                run::<EngineRescaled>(&body, start, &Gravity(DVec3::ZERO), 1e6 / 60.0, 1_000_000);
            let middle = start.angular_momentum.length_squared() / (2.0 * body.inertia().y);
            assert!(
                (s.rotational_energy(&body) / middle - 1.0).abs() < 1e-3,
                "{axis}"
            );
        }
    }
}
