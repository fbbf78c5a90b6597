//! Impact: the velocities of all touching corners change at one instant.

use glam::{DMat3, DVec3};

use super::cone::Cone;
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
pub(super) struct ImpactOutcome<const N: usize> {
    /// Impulses, by place \[N s\].
    pub(super) impulse: [DVec3; N],
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
) -> ImpactOutcome<8> {
    let &FloorContext {
        floor,
        settings,
        body,
        ..
    } = context;
    let attitude = DMat3::from_quat(state.rotation);
    let operator = DelassusOperator::new(body, attitude, &corners.lever, touching);
    let twist = (state.velocity, state.angular_velocity(body));
    let before = operator.velocities(twist);
    let normals = before[..operator.count].iter().map(|u| u.y);
    let fastest = normals.clone().fold(0.0, |a: f64, u| a.max(-u));
    let extreme = normals.fold(0.0, |a: f64, u| a.max(u.abs()));
    let bounces = kind == ImpactKind::Ordinary && fastest > settings.restitution_threshold;
    let e = if bounces { floor.restitution } else { 0.0 };
    let cone = Cone::new(&operator, floor.friction, settings);

    let mut solution = cone.solve(&before, &[DVec3::ZERO; 8]);
    let mut repaired = None;

    if e > 0.0 {
        let plastic = solution;
        // Newton's law: u⁻ shifted by e·min(u⁻_n, 0) makes it the plain complementarity of the cone problem.
        let mut shifted = before;
        for u in &mut shifted[..operator.count] {
            u.y += e * u.y.min(0.0);
        }
        solution = cone.solve(&shifted, &plastic.p);
        solution.iterations += plastic.iterations;
        solution.converged &= plastic.converged;
        let path = Path::new(&operator, twist, &plastic.p, &solution.p);

        let tiny = 1e-12 * state.kinetic_energy(body);
        let energetic = settings.restitution == RestitutionLaw::Energetic;
        let lost = path.lost.min(0.0);
        let allowed = if energetic { (1.0 - e * e) * lost } else { 0.0 };
        if path.gained() > allowed + tiny {
            let part = part_of_way(path.a, path.b, lost - allowed);
            for i in 0..operator.count {
                solution.p[i] = plastic.p[i] + part * (solution.p[i] - plastic.p[i]);
            }
            repaired = (!energetic).then_some(path.gained());
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

    operator.apply(state, &solution.p);
    ImpactOutcome {
        impulse: operator.by_place(&solution.p),
        capped: !solution.converged,
        repaired,
        iterations: solution.iterations,
    }
}

/// The kinetic energy between the plastic solution p₀ and Newton's p₁. Newton's law with friction or several corners may
/// return more than the part e² of the energy, and even create some (Kane, Levinson 1985; Stronge 1990). Of p₀ + λd,
/// d = p₁ − p₀, the energy is Aλ² + Bλ + C above that before, with A = ½ d·Wd, B = d·(u⁻ + Wp₀): a quadratic. Every
/// λ in (0, 1) is inside the cones (they are convex), and not into the floor.
struct Path {
    a: f64,
    b: f64,
    /// C ≤ 0 \[J\].
    lost: f64,
}

impl Path {
    fn new(
        operator: &DelassusOperator,
        (v, omega): (DVec3, DVec3),
        plastic: &Corner3,
        newton: &Corner3,
    ) -> Self {
        let first = operator.resultant(plastic);
        let last = operator.resultant(newton);
        let way = (last.0 - first.0, last.1 - first.1);
        let (dv, dw) = operator.twist_of(first);
        let (av, aw) = operator.twist_of(way);
        Self {
            a: 0.5 * (way.0.dot(av) + way.1.dot(aw)),
            b: way.0.dot(v + dv) + way.1.dot(omega + dw),
            lost: first.0.dot(v + 0.5 * dv) + first.1.dot(omega + 0.5 * dw),
        }
    }

    /// What p₁ adds \[J\].
    fn gained(&self) -> f64 {
        self.a + self.b + self.lost
    }
}

/// The λ between 0 and 1 at which Aλ² + Bλ + C, with C ≤ 0, is zero.
pub(super) fn part_of_way(a: f64, b: f64, c: f64) -> f64 {
    let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
    let lambda = if b > 0.0 {
        -2.0 * c / (b + root)
    } else if a > 0.0 {
        (root - b) / (2.0 * a)
    } else {
        0.0
    };
    lambda.clamp(0.0, 1.0)
}
