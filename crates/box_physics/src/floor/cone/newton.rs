//! Coulomb's law as an equation, solved by Newton's method on the twist of the body.
//!
//! With P the projection of the parent module and any ρ > 0 the law says F = p − P(q) = 0, q = p − ρw,
//! w = b + Wp. F is piecewise smooth: a corner leaves (q_n ≤ 0), sticks, or slides along q_t, and Newton's method
//! with the derivative that belongs to that ends quadratically (Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92
//! (1991) 353; Qi, Sun, Math. Program. 58 (1993) 353). All corners act on one body, so that the change of w is that
//! of a twist ξ, u_k = G_kξ with G_k the velocity of the corner. Corner by corner the step is then
//!
//! ```text
//! leaves  dp = −p
//! sticks  dp = −(ρ/ε) (w + u)
//! slides  dp_n = −(F_n + ρu_n)/ε,   along  µ dp_n − F_t − µρu_n,   across  −(F_t + ρκu_t)/(1 − κ),   κ = µq_n/|q_t|
//! ```
//!
//! linear in ξ, and Mξ = Σ G_kᵀdp_k is six linear equations. ε regularizes: of the impulses that do the same the
//! step takes the smallest (four corners tell six numbers), and it reaches its aim but for a part ε, which the next
//! step takes (the proximal method: Rockafellar, SIAM J. Control Optim. 14 (1976) 877).

use glam::{DMat3, DVec3};

use super::super::geometry::Corner3;
use super::{Cone, ConeSolution, answered, project};

/// The part that a step leaves.
const EPSILON: f64 = 1e-8;
/// ρ in units of one over the norm, in the order in which they are tried.
const SCALES: [f64; 7] = [1.0, 10.0, 0.1, 100.0, 0.01, 1e3, 1e-3];
/// Gradient steps that lead to further starts, where neither zero nor the frictionless impulses led to the end.
const GRADIENT_STEPS: [u32; 3] = [50, 200, 1000];
/// Steps from one start.
const STEPS: u32 = 40;
/// Of these as many may not descend.
const UPHILL: u32 = 4;
/// The smallest part of a step that is tried.
const SMALLEST: f64 = 1.0 / 256.0;

impl Cone<'_> {
    /// Solves it to |w| within `target`, or until `solution.iterations` is `limit`; says in
    /// `converged` whether it could.
    pub(super) fn newton(&self, b: &Corner3, target: f64, limit: u32, solution: &mut ConeSolution) {
        let descend = |solution: &mut ConeSolution| {
            SCALES.iter().any(|scale| {
                let problem = Problem {
                    cone: self,
                    b,
                    rho: scale / self.norm,
                    // |F| falls with ρ, at most in proportion.
                    tolerance: target / self.norm * scale.min(1.0),
                };
                let found = problem.descend(solution.p, limit, &mut solution.iterations);
                solution.converged = found.is_some();
                solution.p = found.unwrap_or(solution.p);
                solution.converged
            })
        };
        for start in 0..2 {
            solution.p = match start {
                0 => [DVec3::ZERO; 8],
                _ => self.smooth(b),
            };
            if descend(solution) {
                answered(match start {
                    0 => "Newton from zero",
                    _ => "Newton from the frictionless impulses",
                });
                return;
            }
        }
        for steps in GRADIENT_STEPS {
            let steps = steps.min(limit.saturating_sub(solution.iterations));
            self.gradient(b, target, steps, solution);
            if solution.converged || descend(solution) {
                answered("Newton after gradients");
                return;
            }
        }
    }
}

struct Problem<'a> {
    cone: &'a Cone<'a>,
    b: &'a Corner3,
    rho: f64,
    /// |F| that is left.
    tolerance: f64,
}

/// Impulses, with q, F and |F|² there.
struct Point {
    p: Corner3,
    q: Corner3,
    f: Corner3,
    square: f64,
}

impl Problem<'_> {
    /// The zero of F that is reached from `start`.
    fn descend(&self, start: Corner3, limit: u32, iterations: &mut u32) -> Option<Corner3> {
        let mut here = self.at(&start, &start, 0.0);
        let mut uphill = 0;
        for _ in 0..STEPS.min(limit.saturating_sub(*iterations)) {
            *iterations += 1;
            let step = self.step(&here);
            let mut next = self.at(&here.p, &step, 1.0);
            // Found: then one step more, to rounding.
            let found = |point: &Point, part: f64| {
                self.cone.operator.largest(&point.f) <= part * self.tolerance
            };
            if found(&next, 1e-2) || found(&here, 1.0) {
                let end = if next.square < here.square {
                    next
                } else {
                    here
                };
                return Some(end.p.map(|p| project(p, self.cone.friction)));
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

    /// A part of a step further.
    fn at(&self, p: &Corner3, step: &Corner3, size: f64) -> Point {
        let n = self.cone.operator.count;
        let mut p = *p;
        for i in 0..n {
            p[i] += size * step[i];
        }
        let w = self.cone.velocities(self.b, &p);
        let (mut q, mut f) = ([DVec3::ZERO; 8], [DVec3::ZERO; 8]);
        for i in 0..n {
            q[i] = p[i] - self.rho * w[i];
            f[i] = p[i] - project(q[i], self.cone.friction);
        }
        let square = self.cone.operator.dot(&f, &f);
        Point { p, q, f, square }
    }

    /// The change of the impulses dp = −c − S u.
    fn step(&self, here: &Point) -> Corner3 {
        let (operator, n) = (self.cone.operator, self.cone.operator.count);
        // In units of the first lever's length, so that forces and torques compare.
        let unit = operator.lever[0].length();
        let (mut c, mut s) = ([DVec3::ZERO; 8], [DMat3::ZERO; 8]);
        // A = Σ Gᵀ S G in blocks, and −Σ Gᵀ c
        let mut a = [[DMat3::ZERO; 2]; 2];
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        for i in 0..n {
            (c[i], s[i]) = self.linear(here.q[i], here.f[i]);
            if c[i] == DVec3::ZERO && here.q[i].y <= 0.0 {
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
        let inverse_mass = operator.inverse_mass();
        let inverse_inertia = operator.inverse_inertia() * (unit * unit);
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
        let mut step = [DVec3::ZERO; 8];
        for i in 0..n {
            step[i] = -(c[i] + s[i] * u[i]);
        }
        step
    }

    /// c and S of one corner.
    fn linear(&self, q: DVec3, f: DVec3) -> (DVec3, DMat3) {
        let (mu, rho) = (self.cone.friction, self.rho);
        let slip = (q.x * q.x + q.z * q.z).sqrt();
        if q.y <= 0.0 {
            return (f, DMat3::ZERO);
        }
        if slip <= mu * q.y {
            let s = DMat3::from_diagonal(DVec3::splat(rho / EPSILON));
            return (f / EPSILON, s);
        }
        let along = DVec3::new(q.x / slip, 0.0, q.z / slip);
        let across = DVec3::new(-along.z, 0.0, along.x);
        let kappa = mu * q.y / slip;
        let loose = 1.0 / (1.0 - kappa).max(EPSILON);
        let normal = f.y / EPSILON;
        let c = DVec3::Y * normal
            + along * (mu * normal + f.dot(along))
            + across * (f.dot(across) * loose);
        let push = (DVec3::Y + mu * (1.0 + EPSILON) * along) * (rho / EPSILON);
        let turn = across * (rho * kappa * loose);
        (c, DMat3::from_cols(turn * across.x, push, turn * across.z))
    }
}

/// Solves six equations, the right side in the last column, by Gauss's elimination with pivots by rows.
pub(in crate::floor) fn eliminate(mut m: [[f64; 7]; 6]) -> [f64; 6] {
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
