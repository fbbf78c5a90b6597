//! Impact resolution: the velocities of all touching corners change at one instant.

use glam::{DMat3, DVec3};

use super::RestitutionLaw;
use super::geometry::{has, set};
use super::ground::Ground;
use super::law::Law;
use super::operator::DelassusOperator;
use crate::state::BodyState;

/// Result of an impact.
pub(super) struct ImpactOutcome<const N: usize> {
    /// Impulses, by place \[N s\].
    pub(super) impulse: [DVec3; N],
    /// `true` if the solver reached its maximum number of iterations.
    pub(super) capped: bool,
    /// Removed gain of energy under Newton's law \[J\].
    pub(super) repaired: Option<f64>,
    /// Solver iterations.
    pub(super) iterations: u32,
}

/// Solves the impact for the motion `twist` and applies it. Along the normal, 0 ≤ p_n ⊥ u⁺_n + e min(u⁻_n, 0) ≥ 0
/// (Newton). Friction in the round cone opposes the slip u⁺_t after the impact (Coulomb). [`RestitutionLaw`] limits the
/// energy, with the largest restitution of surfaces hit faster than the threshold. If `ordinary` is `false`, because
/// the step has too many impacts, all touching corners stop along the normal.
pub(super) fn resolve_impact<G: Ground<N>, const N: usize>(
    ground: &G,
    state: &mut BodyState,
    twist: (DVec3, DVec3),
    touching: u64,
    ordinary: bool,
) -> ImpactOutcome<N> {
    let (body, settings) = (ground.level().context.body, ground.level().context.settings);
    let attitude = DMat3::from_quat(state.rotation);
    let operator = &ground.operator(attitude, touching);
    let n = operator.count;
    let place = |i: usize| usize::from(operator.place[i]);
    let before = ground.velocities(operator, twist);
    let mut normal = [0.0; N];
    let (mut fastest, mut extreme) = (0.0_f64, 0.0_f64);
    for i in 0..n {
        normal[i] = ground.normal(place(i)).dot(before[i]);
        (fastest, extreme) = (fastest.max(-normal[i]), extreme.max(normal[i].abs()));
    }
    let restitution = |i: usize| ground.surface(place(i)).restitution;
    let (mut e, threshold) = (0.0_f64, settings.restitution_threshold);
    for i in (0..n).filter(|&i| -normal[i] > threshold) {
        e = e.max(restitution(i));
    }
    let bounces = ordinary && fastest > threshold && (0..n).any(|i| restitution(i) > 0.0);

    let mut law = Law::new(ground, operator, false);
    let mut solution = law.solve(&before, &[DVec3::ZERO; N]);
    let mut repaired = None;

    if bounces {
        let plastic = solution;
        // Newton's law: u⁻ shifted by e·min(u⁻_n, 0) makes it the plain complementarity of the cone problem.
        let mut shifted = before;
        for i in 0..n {
            let back = restitution(i) * normal[i].min(0.0);
            shifted[i] += ground.normal(place(i)) * back;
        }
        solution = law.solve(&shifted, &plastic.p);
        solution.iterations += plastic.iterations;
        solution.converged &= plastic.converged;
        let way = Way::between(ground, operator, twist, [&plastic.p, &solution.p]);

        let tiny = 1e-12 * state.kinetic_energy(body);
        let energetic = settings.restitution == RestitutionLaw::Energetic;
        let lost = way.lost.min(0.0);
        let allowed = if energetic { (1.0 - e * e) * lost } else { 0.0 };
        if way.gained > allowed + tiny {
            let part = way.part(lost - allowed);
            for i in 0..n {
                solution.p[i] = plastic.p[i] + part * (solution.p[i] - plastic.p[i]);
            }
            repaired = (!energetic).then_some(way.gained);
        }
    }
    // A landing on a face below the threshold, or the last allowed impact, also stops rocking. Otherwise ever smaller
    // impacts would follow ever more frequently (Housner 1963).
    let quiet = extreme < threshold;
    let stopped = match (ordinary, quiet) {
        (false, _) => touching,
        (true, true) => ground.on_faces(touching),
        (true, false) => 0,
    };
    if stopped != 0 {
        let kept = set::<N>(|i| i < n && has(stopped, place(i)));
        let held = law.stop(kept, &operator.after(&before, &solution.p));
        for i in 0..n {
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

/// Change of the kinetic energy due to the impulses p₀ + λd between the plastic solution p₀ and Newton's p₁ = p₀ + d.
/// With friction or several corners, Newton's law may return more than the fraction e² of the energy, or even create
/// energy (Kane, Levinson 1985; Stronge 1990). The change is Aλ² + Bλ + C with A = ½ d·Wd, B = d·(u⁻ + Wp₀). Every λ in
/// (0, 1) is inside the convex cones and does not lead into the floor.
struct Way {
    a: f64,
    b: f64,
    /// C ≤ 0 \[J\].
    lost: f64,
    /// Change due to p₁ \[J\].
    gained: f64,
}

impl Way {
    /// Computes the coefficients from the motion (v, ω).
    fn between<G: Ground<N>, const N: usize>(
        ground: &G,
        operator: &DelassusOperator<N>,
        (v, omega): (DVec3, DVec3),
        solutions: [&[DVec3; N]; 2],
    ) -> Self {
        let [first, last] = solutions.map(|p| operator.resultant(p));
        let way = (last.0 - first.0, last.1 - first.1);
        let (dv, dw) = operator.twist_of(first);
        let (av, aw) = operator.twist_of(way);
        let a = 0.5 * (way.0.dot(av) + way.1.dot(aw));
        let mut b = way.0.dot(v + dv) + way.1.dot(omega + dw);
        let mut lost = first.0.dot(v + 0.5 * dv) + first.1.dot(omega + 0.5 * dw);
        if !ground.is_fixed() {
            // Energy is relative to the surfaces.
            for i in 0..operator.count {
                let drift = ground.drift(usize::from(operator.place[i]));
                lost -= solutions[0][i].dot(drift);
                b -= (solutions[1][i] - solutions[0][i]).dot(drift);
            }
        }
        Self {
            a,
            b,
            lost,
            gained: a + b + lost,
        }
    }

    /// The λ between 0 and 1 at which Aλ² + Bλ + c, with c ≤ 0, is zero.
    fn part(&self, c: f64) -> f64 {
        let (a, b) = (self.a, self.b);
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
}
