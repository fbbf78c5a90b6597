//! The stage equations of `implicit-midpoint` (τ = h/2) and `backward-euler` (τ = h):
//!
//! ```text
//! v  = v₀ + τ (a − (c₁ + k₂|v|) v/m + F/m)
//! Iω = L₀ + τ (Iω×ω − γ Iω − c_ω ω + T)                  body axes
//! ```
//!
//! where F, T is the wrench at the stage's own pose and velocities. For a *given* wrench both have a
//! root that can always be found (`stage_equations`). So the unknown of the coupled problem is the
//! wrench, six numbers, and without a wrench there is none.

use glam::DVec3;

use super::StepOutcome;
use super::newton::{Scales, Six, fixed_point};
use super::split;
use super::stage_equations::{Equations, Stage};
use crate::body::RigidBox;
use crate::force::{ForceModel, Wrench};
use crate::math::AnyArgument;
use crate::state::BodyState;

/// Shortest part of a step that is tried: a 1024th.
const MOST_PARTS: u32 = 1024;

/// What came of a step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Attempt {
    Solved(Stage),
    /// No convergence, after so many evaluations.
    Unconverged(u32),
    /// The equations have no solution: a negative step that cancels the dissipation, or no finite state.
    Unsolvable,
}

/// A whole step by `one`, which leaves the state alone unless it solves its equations. Where they do
/// not converge (a stiff spring that turns the box by more than a radian a step), the step is taken in
/// 4, 16, … 1024 shorter ones, each as stable as the whole, and reported as unconverged; a step that even
/// so cannot be taken is `split`'s, and reported as a fallback.
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
        outcome.evaluations += evaluations;
        outcome.unconverged = 1;
        if parts == MOST_PARTS {
            break;
        }
        parts *= 4;
        *state = start;
        let mut left = parts;
        while left > 0 {
            match one(body, state, force, h / f64::from(parts)) {
                Attempt::Solved(stage) => outcome.evaluations += stage.evaluations,
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
    outcome.evaluations += split::step(body, state, force, h, &mut AnyArgument);
    outcome.fallbacks = 1;
    outcome
}

/// Solves the stage equations. `wrench_at` gives the wrench for the stage's velocity and angular
/// velocity, by as many evaluations of the force as `each` says.
///
/// With a wrench the unknowns are z = (τF/m, τ ρ I⁻¹T), two velocities [m/s] (ρ the box's radius); they
/// are iterated to 2e-15 of the velocities about, or to what rounding of the pose amounts to,
/// ε(|x| + ρ)/τ ([`Scales`]).
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
