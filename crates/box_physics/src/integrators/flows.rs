//! Exact flows for `split` and related integrators.

use glam::DVec3;

use super::damped_kick::{damp, damped_kick};
use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel};
use crate::free_motion::free_rotation_by;
use crate::math::{AnyArgument, Exponential, Trigonometry, exp};
use crate::state::BodyState;
use crate::translation::{exponential_step, quadratic_drag_flow};

/// A flow of the free rotation. The integrators composed of the flows of this module differ in it. (A trait, not a
/// closure: a closure cannot be marked `#[inline(always)]` and would prevent vectorization over many bodies.)
pub(crate) trait FreeRotationFlow {
    /// Advances the free rotation over `h` \[s\].
    fn flow(&mut self, body: &RigidBox, state: &mut BodyState, h: f64);
}

/// [`free_rotation`](crate::free_motion::free_rotation) with a given sine and cosine.
pub(super) struct ExactRotation<'a, T>(pub(super) &'a mut T);

impl<T: Trigonometry> FreeRotationFlow for ExactRotation<'_, T> {
    #[inline(always)]
    fn flow(&mut self, body: &RigidBox, state: &mut BodyState, h: f64) {
        free_rotation_by(body, state, h, self.0);
    }
}

/// A step of kick, drift, kick (Strang) with a given flow of the free rotation, or [`damped_step`]. Returns the number
/// of force evaluations.
#[inline(always)]
pub(crate) fn kick_drift_kick<F: ForceModel>(
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
    if damped_step(body, state, force, h, free_rotation) {
        return 1;
    }
    kick(body, state, force, 0.5 * h);
    drift(body, state, force, h, free_rotation);
    kick(body, state, force, 0.5 * h);
    2
}

/// The step without contact from which the floor computes the mean velocities of the corners. The initial wrench
/// displaces the body by ½h² times its whole acceleration, as if undamped and at a fixed pose, because a floor that
/// supports the body must balance that wrench. Dampers act only on the existing motion. Order 2; returns the number of
/// force evaluations.
pub(crate) fn impulse_step<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
) -> u32 {
    let rotation = &mut ExactRotation(&mut AnyArgument);
    if !force.has_wrench() {
        drift(body, state, force, h, rotation);
        return 1;
    }
    let damped = force.has_damping();
    if damped {
        damp(body, state, force, 0.5 * h);
    }
    kick(body, state, force, 0.5 * h);
    drift(body, state, force, h, rotation);
    kick(body, state, force, 0.5 * h);
    if damped {
        damp(body, state, force, 0.5 * h);
    }
    2
}

/// A step under a wrench that must be combined with the damping: ½ drift, whole kick, ½ drift; order 2, one evaluation.
/// A composition that ends with a kick would leave the velocity hF/2m instead of F/d. Returns `false` if no such step
/// is necessary.
///
/// With dampers, the kick contains all linear damping ([`damped_kick`]) and the weight, and the drifts contain neither.
/// For d → ∞ the kick ends at the terminal velocity F/d, with which the drifts move the body. If only the body's own
/// damping is fast (rate × step above 1), the drifts contain it exactly.
#[inline(always)]
pub(super) fn damped_step<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
    free_rotation: &mut impl FreeRotationFlow,
) -> bool {
    let d = force.dissipation();
    let half = 0.5 * h;
    if force.has_damping() {
        let rate = d.quadratic_drag * body.inverse_mass();
        state.velocity = d.in_air(state.velocity, |v| quadratic_drag_flow(v, rate, half));
        state.position += half * state.velocity;
        free_rotation.flow(body, state, half);
        damped_kick(body, state, force, h);
        state.position += half * state.velocity;
        free_rotation.flow(body, state, half);
        state.velocity = d.in_air(state.velocity, |v| quadratic_drag_flow(v, rate, half));
        return true;
    }
    let linear = d.linear_drag * body.inverse_mass();
    let angular = d.angular_damping + d.angular_drag * body.inverse_inertia().max_element();
    if linear.max(angular) * h.abs() <= 1.0 {
        return false;
    }
    drift(body, state, force, half, free_rotation);
    kick(body, state, force, h);
    drift(body, state, force, half, free_rotation);
    true
}

/// Applies v += τF/m, L += τT at a fixed pose, with one evaluation of the wrench.
#[inline(always)]
pub(super) fn kick<F: ForceModel>(body: &RigidBox, state: &mut BodyState, force: &F, tau: f64) {
    let w = force.elastic_wrench(body, state);
    state.velocity += (tau * body.inverse_mass()) * w.force;
    state.angular_momentum += tau * w.torque;
}

/// Chin's modified kick: a [`kick`] over τ with the wrench at a pose displaced by that wrench times c \[s²\], to first
/// order:
///
/// ```text
/// x̃ = x + c F/m,  q̃ = q∘exp(c e),  e = T/I:   v += τ F̃/m,  L += τ (T̃ + c e×T)
/// ```
///
/// This is the flow of the kick and its double commutator with the drift (Chin, Phys. Lett. A 226 (1997) 344). The term
/// e×T arises because torques are in body axes (Omelyan, J. Chem. Phys. 127 (2007) 044102). It takes two evaluations of
/// the wrench.
#[inline(always)]
pub(super) fn modified_kick<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    tau: f64,
    c: f64,
) {
    let w = force.elastic_wrench(body, state);
    let e = body.inverse_inertia() * w.torque;
    let shift = (c * body.inverse_mass()) * w.force;
    let there = force.displaced_wrench(body, state, shift, c * e);
    state.velocity += (tau * body.inverse_mass()) * there.force;
    state.angular_momentum += tau * (there.torque + c * e.cross(w.torque));
}

/// All terms except the wrench over `h`: half dissipation, exact drift, half dissipation.
#[inline(always)]
pub(super) fn drift<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
    free_rotation: &mut impl FreeRotationFlow,
) {
    let a = force.acceleration();
    if !force.has_dissipation() {
        exponential_step(state, a, 0.0, h);
        free_rotation.flow(body, state, h);
        return;
    }
    let d = force.dissipation();
    half_dissipation(body, state, &d, 0.5 * h);
    exact_drift(body, state, a, &d, h, free_rotation);
    half_dissipation(body, state, &d, 0.5 * h);
}

/// Gravity with linear drag, and free rotation with angular damping, over `h`. Exact except for the flow of
/// the free rotation itself.
#[inline(always)]
pub(super) fn exact_drift(
    body: &RigidBox,
    state: &mut BodyState,
    a: DVec3,
    d: &Dissipation,
    h: f64,
    free_rotation: &mut impl FreeRotationFlow,
) {
    let rate = d.linear_drag * body.inverse_mass();
    exponential_step(state, d.blown(a, rate), rate, h);
    if d.angular_damping == 0.0 {
        return free_rotation.flow(body, state, h);
    }
    let damping = Exponential::new(d.angular_damping * h);
    free_rotation.flow(body, state, h * damping.phi1);
    state.angular_momentum *= damping.decay;
}

/// Applies the exact flows of quadratic and angular drag over `tau`; for the latter, L_i ← L_i e^{−c_ω τ/I_i}.
#[inline(always)]
pub(super) fn half_dissipation(body: &RigidBox, state: &mut BodyState, d: &Dissipation, tau: f64) {
    if d.quadratic_drag != 0.0 {
        let rate = d.quadratic_drag * body.inverse_mass();
        state.velocity = d.in_air(state.velocity, |v| quadratic_drag_flow(v, rate, tau));
    }
    if d.angular_drag != 0.0 {
        let rates = body.inverse_inertia() * (-d.angular_drag * tau);
        state.angular_momentum *= DVec3::new(exp(rates.x), exp(rates.y), exp(rates.z));
    }
}
