//! Coulomb's law as an equation, solved by Newton's method on the twist of the body.
//!
//! With P the projection onto the cone of a contact and any ρ > 0, Coulomb's law (`law`) is F = p − P(q) = 0, q = p −
//! ρw, w = b + Wp. F is piecewise smooth: a contact leaves (q_n ≤ 0), sticks, or slides along q_t. Newton's method with
//! the derivative of that piece converges quadratically (Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991)
//! 353; Qi, Sun, Math. Program. 58 (1993) 353). All contacts act on one body, so the change of w is that of a twist ξ:
//! u_k = G_kξ with G_k the velocity of the contact. The step of each contact is
//!
//! ```text
//! leaves  dp = −p
//! sticks  dp = −(ρ/ε) (w + u)
//! slides  dp_n = −(F_n + ρu_n)/ε,   along  µ dp_n − F_t − µρu_n,   across  −(F_t + ρκu_t)/(1 − κ),   κ = µq_n/|q_t|
//! ```
//!
//! linear in ξ, and Mξ = Σ G_kᵀdp_k is six linear equations. ε regularizes: of equivalent impulses the step takes the
//! smallest (four corners have only six independent numbers). A remainder ε is left to the next step (the proximal
//! method: Rockafellar, SIAM J. Control Optim. 14 (1976) 877).

use glam::{DMat3, DVec3};

use super::ground::Ground;
use super::law::Law;

/// Relative remainder of a step.
const EPSILON: f64 = 1e-8;
/// Values of ρ in units of one over the norm, in the order of the trials.
const SCALES: [f64; 7] = [1.0, 10.0, 0.1, 100.0, 0.01, 1e3, 1e-3];
/// Maximum number of steps from one start.
const STEPS: u32 = 40;
/// Maximum number of these that do not descend.
const UPHILL: u32 = 4;
/// The smallest fraction of a step that is tried.
const SMALLEST: f64 = 1.0 / 256.0;

/// Finds the impulses for the velocities `b` to |w| within `target`, by steps from `start`, unless `iterations` reaches
/// `limit`.
pub(super) fn descend<G: Ground<N>, const N: usize>(
    law: &Law<'_, G, N>,
    b: &[DVec3; N],
    target: f64,
    start: &[DVec3; N],
    limit: u32,
    iterations: &mut u32,
) -> Option<[DVec3; N]> {
    let norm = law.operator.norm_bound();
    SCALES.iter().find_map(|scale| {
        let problem = Problem {
            law,
            b,
            rho: scale / norm,
            // |F| decreases with ρ, at most in proportion.
            tolerance: target / norm * scale.min(1.0),
        };
        problem.descend(start, limit, iterations)
    })
}

struct Problem<'a, G: Ground<N>, const N: usize> {
    law: &'a Law<'a, G, N>,
    b: &'a [DVec3; N],
    rho: f64,
    /// Tolerance of |F|.
    tolerance: f64,
}

/// Impulses, with the values of q, F and |F|².
struct Point<const N: usize> {
    p: [DVec3; N],
    q: [DVec3; N],
    f: [DVec3; N],
    square: f64,
}

impl<G: Ground<N>, const N: usize> Problem<'_, G, N> {
    /// Finds the zero of F reached from `start`.
    fn descend(&self, start: &[DVec3; N], limit: u32, iterations: &mut u32) -> Option<[DVec3; N]> {
        let operator = self.law.operator;
        let mut here = self.at(start, start, 0.0);
        let mut uphill = 0;
        for _ in 0..STEPS.min(limit.saturating_sub(*iterations)) {
            *iterations += 1;
            let step = self.step(&here);
            let mut next = self.at(&here.p, &step, 1.0);
            // After convergence, one more step reaches rounding.
            let found =
                |point: &Point<N>, part: f64| operator.largest(&point.f) <= part * self.tolerance;
            if found(&next, 1e-2) || found(&here, 1.0) {
                let end = if next.square < here.square {
                    next
                } else {
                    here
                };
                let mut p = end.p;
                for i in 0..operator.count {
                    p[i] = self.law.project(i, p[i]);
                }
                return Some(p);
            }
            let mut size = 0.5;
            while next.square >= here.square && size >= SMALLEST {
                let shorter = self.at(&here.p, &step, size);
                if shorter.square < next.square {
                    next = shorter;
                }
                size *= 0.5;
            }
            uphill += u32::from(next.square >= here.square);
            if uphill > UPHILL || next.square.is_nan() {
                return None;
            }
            here = next;
        }
        None
    }

    /// The point after a fraction `size` of a step.
    fn at(&self, p: &[DVec3; N], step: &[DVec3; N], size: f64) -> Point<N> {
        let operator = self.law.operator;
        let mut p = *p;
        for i in 0..operator.count {
            p[i] += size * step[i];
        }
        let w = operator.after(self.b, &p);
        let (mut q, mut f) = ([DVec3::ZERO; N], [DVec3::ZERO; N]);
        for i in 0..operator.count {
            q[i] = p[i] - self.rho * w[i];
            f[i] = p[i] - self.law.project(i, q[i]);
        }
        let square = operator.dot(&f, &f);
        Point { p, q, f, square }
    }

    /// The change dp = −c − S u of the impulses.
    fn step(&self, here: &Point<N>) -> [DVec3; N] {
        let operator = self.law.operator;
        // In units of the first lever's length, so that forces and torques are comparable.
        let unit = operator.lever[0].length();
        let (mut c, mut s) = ([DVec3::ZERO; N], [DMat3::ZERO; N]);
        // A = Σ Gᵀ S G in blocks, and −Σ Gᵀ c
        let mut a = [[DMat3::ZERO; 2]; 2];
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        for i in 0..operator.count {
            (c[i], s[i]) = self.linear(i, here.q[i], here.f[i]);
            if c[i] == DVec3::ZERO && s[i] == DMat3::ZERO {
                continue;
            }
            let r = operator.lever[i] / unit;
            let turned = |m: &DMat3| {
                DMat3::from_cols(r.cross(m.x_axis), r.cross(m.y_axis), r.cross(m.z_axis))
            };
            let arm = turned(&s[i].transpose()).transpose(); // −S [r]×
            force -= c[i];
            torque -= r.cross(c[i]);
            a[0][0] += s[i];
            a[0][1] += arm;
            a[1][0] += turned(&s[i]);
            a[1][1] += turned(&arm);
        }
        // (1 + A M⁻¹) y = −Σ Gᵀ c for the force and torque y
        let inverse_mass = operator.inverse_mass;
        let inverse_inertia = operator.inverse_inertia * (unit * unit);
        let mut rows = [[0.0; 7]; 6];
        for (k, row) in rows.iter_mut().enumerate() {
            let [direct, arm] = a[k / 3];
            let left = [direct * inverse_mass, arm * inverse_inertia];
            for column in 0..6 {
                row[column] = left[column / 3].col(column % 3)[k % 3];
            }
            row[k] += 1.0;
            row[6] = if k < 3 { force[k] } else { torque[k - 3] };
        }
        let y = eliminate(rows);
        let v = DVec3::new(y[0], y[1], y[2]) * inverse_mass;
        let omega = inverse_inertia * DVec3::new(y[3], y[4], y[5]) / unit;
        let u = operator.velocities((v, omega));
        let mut step = [DVec3::ZERO; N];
        for i in 0..operator.count {
            step[i] = -(c[i] + s[i] * u[i]);
        }
        step
    }

    /// c and S of one contact.
    #[inline(always)]
    fn linear(&self, i: usize, q: DVec3, f: DVec3) -> (DVec3, DMat3) {
        let ((normal, mu), rho) = (self.law.surface(i), self.rho);
        let height = normal.dot(q);
        // Within the tolerance, rounding would decide.
        if height <= self.tolerance {
            return (f, DMat3::ZERO);
        }
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        let up = normal.dot(f) / EPSILON;
        if mu == 0.0 {
            // The part along the plane is removed at once.
            let c = normal * up + (f - normal * normal.dot(f));
            return (c, outer(normal * (rho / EPSILON), normal));
        }
        let tangential = q - normal * height;
        let slip = tangential.length();
        if slip <= mu * height {
            let s = DMat3::from_diagonal(DVec3::splat(rho / EPSILON));
            return (f / EPSILON, s);
        }
        let along = tangential / slip;
        let across = normal.cross(along);
        let kappa = mu * height / slip;
        let loose = 1.0 / (1.0 - kappa).max(EPSILON);
        let c = normal * up + along * (mu * up + f.dot(along)) + across * (f.dot(across) * loose);
        let push = (normal + mu * (1.0 + EPSILON) * along) * (rho / EPSILON);
        let turn = across * (rho * kappa * loose);
        (c, outer(push, normal) + outer(turn, across))
    }
}

/// Solves six equations, the right side in the last column, by Gauss's elimination with pivots by rows.
fn eliminate(mut m: [[f64; 7]; 6]) -> [f64; 6] {
    for k in 0..6 {
        for i in k + 1..6 {
            if m[i][k].abs() > m[k][k].abs() {
                m.swap(k, i);
            }
        }
        let above = m[k];
        let inverse = 1.0 / above[k];
        for row in &mut m[k + 1..] {
            let factor = row[k] * inverse;
            for c in k + 1..7 {
                row[c] -= factor * above[c];
            }
        }
    }
    let mut x = [0.0; 6];
    for k in (0..6).rev() {
        let mut value = m[k][6];
        for c in k + 1..6 {
            value -= m[k][c] * x[c];
        }
        x[k] = value / m[k][k];
    }
    x
}
