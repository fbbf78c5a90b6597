//! `split`, the default: every part of the law by its own exact flow, composed symmetrically (Strang).

use glam::DVec3;

use super::{
    EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Keeps, Limit, MemorySlot, MenuGroup,
    Order, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel};
use crate::free_motion::free_rotation_by;
use crate::math::{Exponential, Trigonometry, exp};
use crate::state::BodyState;
use crate::translation::{exponential_step, quadratic_drag_flow};

/// Strang splitting into exact flows.
///
/// ```text
/// ½ damper, ½ kick (wrench), ½ quadratic drag, ½ angular drag,
///   whole: gravity + linear drag (exponential), free rotation + angular damping,
/// ½ angular drag, ½ quadratic drag, ½ kick, ½ damper
/// ```
///
/// Free rotation is the algebraic map of [`free_rotation`](crate::free_motion::free_rotation), right to rounding at
/// any step. Angular damping −γL only rescales time: the free rotation over s = (1 − e^{−γh})/γ, then L ← e^{−γh} L, is exact. Nothing here has
/// a step limit except the kicks of a stiff spring.
pub struct Split;

impl Integrate for Split {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "split",
        name: "Split",
        group: MenuGroup::Ours,
        summary: "The default: free flight right to rounding at the price of RK4; exact pieces composed symmetrically under forces, at any step.",
        source: "Strang 1968; free rotation: `free_motion::free_rotation`; McLachlan, Perlmutter 2001 (damping)",
        orders: Orders {
            gravity: Order::Exact,
            linear_drag: Order::Exact,
            rotation: Order::Exact,
            angular_damping: Order::Exact,
            ..Orders::all(2)
        },
        evaluations: Evaluations::fixed(1, 2),
        stability: Stability {
            rotation: Limit::None,
            drag: Limit::None,
            oscillator: Limit::Below(2.0),
        },
        keeps: Keeps {
            energy: EnergyBehavior::Exact,
            momentum_magnitude: true,
            momentum: true,
            reversible: true,
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
        StepOutcome::plain(step(body, state, force, h, trigonometry))
    }
}

/// The step of [`Split`], for integrators that give way to it. Returns the number of force evaluations.
#[inline(always)]
pub(super) fn step<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) -> u32 {
    split_step(body, state, force, h, &mut ExactRotation(trigonometry))
}

/// A flow of the free rotation: what the integrators made of these pieces differ in. (A trait and not a closure,
/// which cannot be marked to be inlined, and would keep the loop over many bodies from being vectorized.)
pub(crate) trait FreeRotationFlow {
    /// Over `h` \[s\].
    fn flow(&mut self, body: &RigidBox, state: &mut BodyState, h: f64);
}

/// [`free_rotation`](crate::free_motion::free_rotation), with this sine and cosine.
pub(super) struct ExactRotation<'a, T>(pub(super) &'a mut T);

impl<T: Trigonometry> FreeRotationFlow for ExactRotation<'_, T> {
    #[inline(always)]
    fn flow(&mut self, body: &RigidBox, state: &mut BodyState, h: f64) {
        free_rotation_by(body, state, h, self.0);
    }
}

/// Strang's composition with a given flow of the free rotation. Returns the number of force evaluations.
#[inline(always)]
pub(crate) fn split_step<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
    free_rotation: &mut impl FreeRotationFlow,
) -> u32 {
    if !force.has_wrench() {
        drift(body, state, force, h, free_rotation);
        return 1;
    }
    force.damp(body, state, 0.5 * h);
    kick(body, state, force, 0.5 * h);
    drift(body, state, force, h, free_rotation);
    kick(body, state, force, 0.5 * h);
    force.damp(body, state, 0.5 * h);
    2
}

/// v += τF/m, L += τT at a fixed pose: one evaluation of the wrench.
#[inline(always)]
pub(crate) fn kick<F: ForceModel>(body: &RigidBox, state: &mut BodyState, force: &F, tau: f64) {
    let w = force.elastic_wrench(body, state);
    state.velocity += (tau * body.inverse_mass()) * w.force;
    state.angular_momentum += tau * w.torque;
}

/// Everything but the wrench over `h`: the exact pieces round the exact middle.
#[inline(always)]
pub(crate) fn drift<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
    free_rotation: &mut impl FreeRotationFlow,
) {
    let d = force.dissipation();
    let a = force.acceleration();
    if d == Dissipation::NONE {
        exponential_step(state, a, 0.0, h);
        free_rotation.flow(body, state, h);
        return;
    }
    half_dissipation(body, state, &d, 0.5 * h);
    exact_drift(body, state, a, &d, h, free_rotation);
    half_dissipation(body, state, &d, 0.5 * h);
}

/// Gravity with linear drag, and free rotation with angular damping, over `h`: both exact, but for
/// the flow of the free rotation itself.
#[inline(always)]
pub(crate) fn exact_drift(
    body: &RigidBox,
    state: &mut BodyState,
    a: DVec3,
    d: &Dissipation,
    h: f64,
    free_rotation: &mut impl FreeRotationFlow,
) {
    exponential_step(state, a, d.linear_drag * body.inverse_mass(), h);
    let damping = Exponential::new(d.angular_damping * h);
    free_rotation.flow(body, state, h * damping.phi1);
    state.angular_momentum *= damping.decay;
}

/// Quadratic and angular drag by their exact flows over `tau`; L_i ← L_i e^{−c_ω τ/I_i}.
#[inline(always)]
pub(crate) fn half_dissipation(body: &RigidBox, state: &mut BodyState, d: &Dissipation, tau: f64) {
    if d.quadratic_drag != 0.0 {
        let rate = d.quadratic_drag * body.inverse_mass();
        state.velocity = quadratic_drag_flow(state.velocity, rate, tau);
    }
    if d.angular_drag != 0.0 {
        let rates = body.inverse_inertia() * (-d.angular_drag * tau);
        state.angular_momentum *= DVec3::new(exp(rates.x), exp(rates.y), exp(rates.z));
    }
}

#[cfg(test)]
mod tests {
    use super::super::IntegratorMemory;
    use super::*;
    use crate::force::Forces;

    /// Free fall with linear drag from any start is exact at any step: one step equals many.
    #[test]
    fn one_step_equals_many_where_it_is_exact() {
        let body = RigidBox::new(DVec3::new(0.25, 0.5, 0.25), 6.0).expect("valid");
        let d = Dissipation {
            linear_drag: 2.0,
            angular_damping: 0.25,
            ..Dissipation::NONE
        };
        let law = Forces {
            acceleration: DVec3::new(0.0, -9.81, 0.0),
            dissipation: d,
            ..Default::default()
        };
        let start = BodyState::at(DVec3::Y)
            .with_velocity(DVec3::new(3.0, 9.0, -1.0))
            .with_body_angular_velocity(&body, DVec3::new(1.0, 12.0, 0.5));
        let (mut one, mut many) = (start, start);
        let mut memory = IntegratorMemory::default();
        Split::step(&body, &mut one, &law, 2.0, &mut memory);
        for _ in 0..256 {
            Split::step(&body, &mut many, &law, 2.0 / 256.0, &mut memory);
        }
        assert!((one.position - many.position).length() < 1e-13);
        assert!((one.velocity - many.velocity).length() < 1e-13);
        assert!((one.angular_momentum - many.angular_momentum).length() < 1e-12);
        assert!(one.attitude_difference(&many) < 1e-12);
    }

    #[test]
    fn finite_and_sane_at_any_step() {
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid");
        let d = Dissipation {
            linear_drag: 3.0,
            quadratic_drag: 3.0,
            angular_damping: 1.0,
            angular_drag: 1.0,
        };
        for dissipation in [Dissipation::NONE, d] {
            let law = Forces {
                dissipation,
                ..Default::default()
            };
            for h in [1e-7, 1e-3, 1.0, 10.0, 1000.0] {
                let start = BodyState::default()
                    .with_velocity(DVec3::X)
                    .with_body_angular_velocity(&body, DVec3::new(0.6, 0.0, 0.8));
                let mut s = start;
                for _ in 0..1000 {
                    Split::step(&body, &mut s, &law, h, &mut IntegratorMemory::default());
                }
                assert!(s.is_finite());
                assert!(s.velocity.x >= 0.0 && s.velocity.x <= 1.0);
                let (l, l0) = (s.angular_momentum.length(), start.angular_momentum.length());
                assert!(l <= l0 * (1.0 + 1e-12));
                assert!((s.rotation.length() - 1.0).abs() < 1e-14);
            }
        }
    }
}
