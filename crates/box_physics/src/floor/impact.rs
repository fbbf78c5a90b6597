//! Impact: the velocities of all touching corners change at one instant.

use glam::{DMat3, DVec3};

use super::cone::{self, ConeSolution};
use super::geometry::{Corner3, Corners, DelassusOperator, spans_face};
use super::projection::cancel;
use super::{ContactSettings, FloorContext};
use crate::state::BodyState;

/// How an impact is treated.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum ImpactKind {
    /// Newton's restitution above the threshold; below it e = 0, and on a face the box stays.
    Ordinary,
    /// Too many in this step: what touches stops along the normal.
    Resting,
}

/// What an impact did.
pub(super) struct ImpactOutcome {
    /// Impulses, by corner index \[N s\].
    pub(super) impulse: Corner3,
    /// Whether the solver ended at its cap.
    pub(super) capped: bool,
    /// The energy that Newton's restitution would have gained, if it was scaled down \[J\].
    pub(super) repaired: Option<f64>,
    /// Solver iterations.
    pub(super) iterations: u32,
}

/// Solves and applies it: normal 0 ≤ p_n ⊥ u⁺_n + e min(u⁻_n, 0) ≥ 0 (Newton), friction in the
/// round cone against the slip afterwards u⁺_t (Coulomb).
pub(super) fn resolve_impact<F>(
    context: &FloorContext<'_, F>,
    state: &mut BodyState,
    corners: &Corners,
    touching: u8,
    kind: ImpactKind,
) -> ImpactOutcome {
    let &FloorContext {
        floor,
        settings,
        body,
        ..
    } = context;
    let attitude = DMat3::from_quat(state.rotation);
    let operator = DelassusOperator::new(body, attitude, &corners.lever, touching);
    let before = operator.velocities((state.velocity, state.angular_velocity(body)));
    let normals = before[..operator.count].iter().map(|u| u.y);
    let fastest = normals.clone().fold(0.0, |a: f64, u| a.max(-u));
    let extreme = normals.fold(0.0, |a: f64, u| a.max(u.abs()));
    let bounces = kind == ImpactKind::Ordinary && fastest > settings.restitution_threshold;
    let e = if bounces { floor.restitution } else { 0.0 };
    let solve = |e: f64| newton(&operator, &before, e, floor.friction, settings);

    let mut solution = solve(e);
    let mut iterations = solution.iterations;
    let mut capped = !solution.converged;
    let mut repaired = None;
    let gained = if e > 0.0 {
        gain(&operator, &before, &solution.p)
    } else {
        0.0
    };
    if gained > 1e-12 * state.kinetic_energy(body) {
        let plastic = solve(0.0);
        iterations += plastic.iterations;
        capped |= !plastic.converged;
        solution.p = without_gain(&operator, &before, &plastic.p, &solution.p);
        repaired = Some(gained);
    }
    // A landing on a face below the threshold, or the last impact allowed: whatever still leaves the
    // floor by rocking is taken too. (A column rocks through ever smaller, ever more frequent impacts
    // otherwise: Housner 1963.)
    let quiet = extreme < settings.restitution_threshold && spans_face(touching);
    if kind == ImpactKind::Resting || quiet {
        let mut after = before;
        let change = operator.response(&solution.p);
        for i in 0..operator.count {
            after[i] += change[i];
        }
        let held = cancel(&operator, &after, &[DVec3::Y; 8]);
        for i in 0..operator.count {
            solution.p[i] += held[i];
        }
    }
    operator.apply(body, state, &solution.p);
    let mut impulse = [DVec3::ZERO; 8];
    for i in 0..operator.count {
        impulse[usize::from(operator.corner[i])] = solution.p[i];
    }
    ImpactOutcome {
        impulse,
        capped,
        repaired,
        iterations,
    }
}

/// Newton's restitution and Coulomb's friction: u⁻ shifted by e·min(u⁻_n, 0) makes the normal law the
/// plain complementarity of the cone problem.
fn newton(
    operator: &DelassusOperator,
    before: &Corner3,
    e: f64,
    friction: f64,
    settings: &ContactSettings,
) -> ConeSolution {
    let mut b = *before;
    for u in &mut b[..operator.count] {
        u.y += e * u.y.min(0.0);
    }
    cone::solve(
        operator,
        &b,
        1.0,
        friction,
        settings.tolerance,
        settings.max_iterations,
    )
}

/// The kinetic energy that the impulses add: p·u⁻ + ½ p·Wp \[J\].
fn gain(operator: &DelassusOperator, before: &Corner3, p: &Corner3) -> f64 {
    operator.dot(p, before) + 0.5 * operator.dot(p, &operator.response(p))
}

/// Newton's law with several corners can create energy (Kane, Levinson 1985; Stronge 1990). Between
/// the plastic solution p₀, which never does, and the wanted p₁ the energy is a quadratic in λ:
/// Aλ² + Bλ + C with d = p₁ − p₀, A = ½ d·Wd, B = d·(u⁻ + Wp₀), C = p₀·u⁻ + ½ p₀·Wp₀ ≤ 0. The result is
/// p₀ + λd at its root in (0, 1): no gain, inside the cones (they are convex), not into the floor.
fn without_gain(
    operator: &DelassusOperator,
    before: &Corner3,
    plastic: &Corner3,
    wanted: &Corner3,
) -> Corner3 {
    let n = operator.count;
    let mut d = [DVec3::ZERO; 8];
    for i in 0..n {
        d[i] = wanted[i] - plastic[i];
    }
    let a = 0.5 * operator.dot(&d, &operator.response(&d));
    let b = operator.dot(&d, before) + operator.dot(&d, &operator.response(plastic));
    let c = gain(operator, before, plastic).min(0.0);
    let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
    let lambda = if b > 0.0 {
        -2.0 * c / (b + root)
    } else if a > 0.0 {
        (root - b) / (2.0 * a)
    } else {
        0.0
    };
    let mut p = *plastic;
    for i in 0..n {
        p[i] += lambda.clamp(0.0, 1.0) * d[i];
    }
    p
}
