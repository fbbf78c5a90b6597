//! `engine-newton`: the gyroscopic step of Bullet and box3d, one Newton iteration of backward Euler.

use glam::{DMat3, DVec3};

use super::slope::turn;
use super::{
    Conserved, EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Limit, MemorySlot,
    MenuGroup, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel, wrench_of};
use crate::math::Trigonometry;
use crate::state::BodyState;

/// The gyroscopic step of Bullet and box3d, velocities first:
///
/// ```text
/// v ← v/(1 + hc/m) + h(a + F/m),  x += h v_new
/// L ← L/(1 + hγ) + hτ,  ω = L/I,
/// ω₁ = ω − (I + h([ω]I − [Iω]))⁻¹ hω×Iω,  q ← q∘exp(hω₁)
/// ```
///
/// The third line is one Newton step from ω on I(ω₁ − ω) + hω₁×Iω₁ = 0; by design it is not iterated. For small |ω|h it
/// dissipates like backward Euler, which it approximates.
///
/// The matrix may be singular. Df = ∂(I⁻¹(Iω×ω))/∂ω has real eigenvalues up to |ω| near the middle axis, where the
/// motion diverges; 1 − hDf is singular if one of them is 1/h. For |ω|h ≥ 1, a step close to that multiplies the
/// energy, by up to 1e9 for random boxes.
///
/// Damping is box3d's implicit factor, applied to the old velocity only. Quadratic and angular drag, which no engine
/// has, use their coefficient at the start of the step, `c = c₁ + k₂|v|`, `γ_i = γ + c_ω/I_i`.
pub struct EngineNewton;

impl Integrate for EngineNewton {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "engine-newton",
        name: "Engine: one Newton step",
        group: MenuGroup::Engines,
        summary: "The step of Bullet and box3d: one Newton iteration of implicit Euler, so a tumbling body soon stops tumbling.",
        source: "E. Catto, Numerical Methods, GDC 2015; Bullet computeGyroscopicImpulseImplicit; box3d solver.c",
        orders: Orders::all(1),
        evaluations: Evaluations::fixed(1, 1),
        stability: Stability {
            rotation: Limit::Below(1.0),
            drag: Limit::None,
            damper: Limit::Below(2.0),
            oscillator: Limit::Below(2.0),
        },
        conserved: Conserved::nothing_else(EnergyBehavior::Dissipates),
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
        velocities_first(body, state, force, h);
        state.angular_momentum -= newton_correction(body, state, h);
        turn(body, state, h, trigonometry);
        StepOutcome::plain(1)
    }
}

/// Updates everything except the gyroscopic term and the attitude: damping by implicit factors, then forces and
/// torques.
#[inline(always)]
pub(super) fn velocities_first<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
) {
    let (d, w) = (force.dissipation(), wrench_of(body, state, force));
    let (c, gamma) = damping_rates(body, state, &d);
    if d != Dissipation::NONE {
        state.velocity = d.in_air(state.velocity, |v| v / (1.0 + h * c));
        state.angular_momentum /= 1.0 + h * gamma;
    }
    state.velocity += h * (force.acceleration() + w.force * body.inverse_mass());
    state.position += h * state.velocity;
    state.angular_momentum += h * w.torque;
}

/// The damping rates c/m and γ_i [1/s], with the speed at the start of the step.
#[inline(always)]
pub(super) fn damping_rates(body: &RigidBox, state: &BodyState, d: &Dissipation) -> (f64, DVec3) {
    let speed = (state.velocity - d.wind).length();
    let c = (d.linear_drag + d.quadratic_drag * speed) * body.inverse_mass();
    let gamma = d.angular_damping + d.angular_drag * body.inverse_inertia();
    (c, gamma)
}

/// Computes I (I + h([ω]I − [Iω]))⁻¹ hω×Iω. Each row is divided by its moment, so that nothing overflows for any body
/// size. With `α_x = (I_z − I_y)/I_x`, cyclic:
///
/// ```text
///         ⎡  0    α_xω_z  α_xω_y ⎤                    ⎡ α_x ω_yω_z ⎤
/// 1 + h   ⎢α_yω_z    0    α_yω_x ⎥   on the left,  h  ⎢ α_y ω_zω_x ⎥  on the right
///         ⎣α_zω_y  α_zω_x    0   ⎦                    ⎣ α_z ω_xω_y ⎦
/// ```
#[inline(always)]
fn newton_correction(body: &RigidBox, state: &BodyState, h: f64) -> DVec3 {
    let (i, w) = (body.inertia(), state.body_angular_velocity(body));
    let a = h * DVec3::new(i.z - i.y, i.x - i.z, i.y - i.x) * body.inverse_inertia();
    let matrix = DMat3::from_cols(
        DVec3::new(1.0, a.y * w.z, a.z * w.y),
        DVec3::new(a.x * w.z, 1.0, a.z * w.x),
        DVec3::new(a.x * w.y, a.y * w.x, 1.0),
    );
    i * (matrix.inverse() * (a * DVec3::new(w.y * w.z, w.z * w.x, w.x * w.y)))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Case, expect_damping, expect_new_velocities, run};
    use super::*;
    use crate::force::Gravity;

    /// v ← v/(1 + ch/m) + hg, x by the new velocity, L likewise, at any step.
    #[test]
    fn implicit_damping() {
        for h in [0.1, 10.0, 1000.0 / 0.7] {
            expect_damping::<EngineNewton>(h, DVec3::NEG_Y * 9.81, |v, g| {
                let v = v / (1.0 + 0.7 * h) + h * g;
                (v, h * v)
            });
        }
        expect_new_velocities::<EngineNewton>();
    }

    /// The step solves the equation linearized about ω: I(ω₁ − ω) + h(ω₁×Iω + ω×Iω₁ − ω×Iω) = 0.
    #[test]
    fn one_newton_step() {
        let Case { body, start, .. } = Case::free();
        for h in [0.01, 0.1, 10.0] {
            let s = run::<EngineNewton>(&body, start, &Gravity(DVec3::ZERO), h, 1);
            let (w, w1) = (
                start.body_angular_velocity(&body),
                s.body_angular_velocity(&body),
            );
            let (l, l1) = (start.angular_momentum, s.angular_momentum);
            let residual = l1 - l + h * (w1.cross(l) + w.cross(l1) - w.cross(l));
            assert!(residual.length() < 1e-13 * (1.0 + 10.0 * h));
        }
    }
}
