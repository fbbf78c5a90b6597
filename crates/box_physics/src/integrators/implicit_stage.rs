//! The stage equations of `implicit-midpoint` (τ = h/2) and `backward-euler` (τ = h):
//!
//! ```text
//! v  = v₀ + τ (a − (c₁ + k₂|v|) v/m + F/m)
//! Iω = L₀ + τ (Iω×ω − γ Iω − c_ω ω + T)                  body axes
//! ```
//!
//! F, T is the wrench at the pose and velocities of the stage. For a *given* wrench both equations have a root that can
//! always be found (`stage_equations`). The unknown of the coupled problem is therefore the wrench, six numbers.
//! Without a wrench there is no unknown.

use glam::DVec3;

use super::StepOutcome;
use super::newton::{Scales, Six, fixed_point};
use super::split;
use super::stage_equations::{Equations, Stage};
use crate::body::RigidBox;
use crate::force::{ForceModel, Wrench};
use crate::math::AnyArgument;
use crate::state::BodyState;

/// Maximum number of parts into which a step is divided.
const MAX_PARTS: u32 = 1024;

/// Result of a step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Attempt {
    Solved(Stage),
    /// No convergence, after this many evaluations.
    Unconverged(u32),
    /// The equations have no solution: a negative step cancels the dissipation, or the state is not finite.
    Unsolvable,
}

/// Takes a whole step with `one`, which leaves the state unchanged unless it solves its equations.
///
/// The equations may not converge if a stiff spring turns the box by more than a radian per step. The step is then
/// divided into 4, 16, … 1024 shorter ones, each as stable as the whole, and reported as unconverged. If that also
/// fails, `split` takes the step, which is reported as a fallback.
#[inline(always)]
pub(super) fn shortened<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
    one: impl Fn(&RigidBox, &mut BodyState, &F, f64) -> Attempt,
) -> StepOutcome {
    match one(body, state, force, h) {
        Attempt::Solved(stage) => StepOutcome::plain(stage.evaluations),
        failed => in_parts(body, state, force, h, one, failed),
    }
}

#[cold]
fn in_parts<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
    one: impl Fn(&RigidBox, &mut BodyState, &F, f64) -> Attempt,
    mut failed: Attempt,
) -> StepOutcome {
    let mut outcome = StepOutcome::default();
    let start = *state;
    let mut parts = 1;
    while let Attempt::Unconverged(evaluations) = failed {
        outcome.evaluations += u64::from(evaluations);
        outcome.unconverged = 1;
        if parts == MAX_PARTS {
            break;
        }
        parts *= 4;
        *state = start;
        let mut left = parts;
        while left > 0 {
            match one(body, state, force, h / f64::from(parts)) {
                Attempt::Solved(stage) => outcome.evaluations += u64::from(stage.evaluations),
                other => {
                    failed = other;
                    break;
                }
            }
            left -= 1;
        }
        if left == 0 {
            return outcome;
        }
    }
    *state = start;
    outcome.evaluations += u64::from(split::step(body, state, force, h, &mut AnyArgument));
    outcome.fallbacks = 1;
    outcome
}

/// Solves the stage equations. `wrench_at` returns the wrench for the velocity and angular velocity of the
/// stage, with `each` evaluations of the force.
///
/// With a wrench the unknowns are z = (τF/m, τ ρ I⁻¹T), two velocities [m/s], with ρ the radius of the box.
/// They are iterated to 2e-15 of the velocities involved, or to the rounding of the pose, ε(|x| + ρ)/τ
/// ([`Scales`]).
#[inline(always)]
pub(super) fn solve<F: ForceModel>(
    body: &RigidBox,
    start: &BodyState,
    force: &F,
    tau: f64,
    each: u32,
    wrench_at: impl Fn(DVec3, DVec3) -> Wrench,
) -> Attempt {
    let Some(equations) = Equations::new(body, start, force, tau) else {
        return Attempt::Unsolvable;
    };
    if !force.has_wrench() {
        return match equations.solve_for(DVec3::ZERO, DVec3::ZERO) {
            Some(stage) if stage.converged => Attempt::Solved(stage),
            Some(stage) => Attempt::Unconverged(stage.evaluations),
            None => Attempt::Unsolvable,
        };
    }
    let radius = body.radius();
    let (to_velocity, to_spin) = (
        tau * body.inverse_mass(),
        tau * radius * body.inverse_inertia(),
    );
    let stage_of = |z: &Six| {
        let [a, b, c, d, e, f] = *z;
        let angular = body.inertia() * DVec3::new(d, e, f) / radius;
        equations.solve_for(DVec3::new(a, b, c), angular)
    };
    let response = |z: &Six| -> Six {
        let Some(stage) = stage_of(z) else {
            return [f64::NAN; 6];
        };
        let w = wrench_at(stage.velocity, stage.omega);
        let (v, s) = (to_velocity * w.force, to_spin * w.torque);
        [v.x, v.y, v.z, s.x, s.y, s.z]
    };
    let reach = radius / tau.abs();
    let scales = Scales {
        size: start.velocity.length()
            + radius * equations.omega.length()
            + (tau * equations.acceleration).length(),
        rounding: f64::EPSILON * (start.position.length() / tau.abs() + reach),
        small: 1e-3 * reach,
    };
    let root = fixed_point([0.0; 6], scales, response);
    match stage_of(&root.z) {
        Some(stage) if root.converged && stage.converged => Attempt::Solved(Stage {
            evaluations: each * root.evaluations,
            ..stage
        }),
        _ => Attempt::Unconverged(each * root.evaluations),
    }
}
