//! Impact: the velocities of all touching corners change at one instant.

use glam::{DMat3, DVec3};

use super::cone::{Cone, ConeSolution};
use super::geometry::{Corner3, Corners, DelassusOperator, spans_face};
use super::projection::cancel;
use super::{FloorContext, RestitutionLaw};
use crate::state::BodyState;

/// How an impact is treated.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum ImpactKind {
    /// Restitution above the threshold; below it e = 0, and on a face the box stays.
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
    /// The energy that Newton's law alone would have gained, if it was scaled down \[J\].
    pub(super) repaired: Option<f64>,
    /// Solver iterations.
    pub(super) iterations: u32,
}

/// Solves and applies it: normal 0 ≤ p_n ⊥ u⁺_n + e min(u⁻_n, 0) ≥ 0 (Newton), friction in the
/// round cone against the slip afterwards u⁺_t (Coulomb), within the energy that the [`RestitutionLaw`] allows.
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
    let cone = Cone::new(&operator, 1.0, floor.friction, settings);
    let solve = |e: f64| newton(&cone, &before[..operator.count], e);

    let mut solution = solve(e);
    let mut iterations = solution.iterations;
    let mut capped = !solution.converged;
    let mut repaired = None;
    if e > 0.0 {
        let energetic = settings.restitution == RestitutionLaw::Energetic;
        let gained = gain(&operator, &before, &solution.p);
        let tiny = 1e-12 * state.kinetic_energy(body);
        if energetic || gained > tiny {
            let plastic = solve(0.0);
            iterations += plastic.iterations;
            capped |= !plastic.converged;
            let lost = gain(&operator, &before, &plastic.p).min(0.0);
            let allowed = if energetic { (1.0 - e * e) * lost } else { 0.0 };
            if gained > allowed + tiny {
                solution.p = within(&operator, &before, &plastic.p, &solution.p, lost - allowed);
                repaired = (!energetic).then_some(gained);
            }
        }
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
fn newton(cone: &Cone, before: &[DVec3], e: f64) -> ConeSolution {
    let mut b = [DVec3::ZERO; 8];
    for (b, u) in b.iter_mut().zip(before) {
        *b = *u + DVec3::Y * (e * u.y.min(0.0));
    }
    cone.solve(&b)
}

/// The kinetic energy that the impulses add: p·u⁻ + ½ p·Wp \[J\].
fn gain(operator: &DelassusOperator, before: &Corner3, p: &Corner3) -> f64 {
    operator.dot(p, before) + 0.5 * operator.work(p, p)
}

/// Newton's law with friction or several corners may return more than the part e² of the energy, and even create
/// some (Kane, Levinson 1985; Stronge 1990). Between the plastic solution p₀ and the wanted p₁ the energy is a
/// quadratic in λ: Aλ² + Bλ + C over what is allowed, with d = p₁ − p₀, A = ½ d·Wd, B = d·(u⁻ + Wp₀) and `c` ≤ 0 the
/// energy after p₀ less the allowed one. The result is p₀ + λd at its root in (0, 1): inside the cones (they are
/// convex), and not into the floor.
fn within(
    operator: &DelassusOperator,
    before: &Corner3,
    plastic: &Corner3,
    wanted: &Corner3,
    c: f64,
) -> Corner3 {
    let n = operator.count;
    let mut d = [DVec3::ZERO; 8];
    for i in 0..n {
        d[i] = wanted[i] - plastic[i];
    }
    let a = 0.5 * operator.work(&d, &d);
    let b = operator.dot(&d, before) + operator.work(&d, plastic);
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
