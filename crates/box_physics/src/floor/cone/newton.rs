//! Coulomb's law as an equation, solved by Newton's method.
//!
//! The law says F(p) = p − P(p − ρw) = 0, w = b + αWp, P the projection of the parent module. F is
//! segmentwise smooth, so Newton's method with any of its derivatives ends quadratically (Alart, Curnier,
//! Comput. Methods Appl. Mech. Eng. 92 (1991) 353; Qi, Sun, Math. Program. 58 (1993) 353); where it would
//! not descend, Marquardt's damping (J. SIAM 11 (1963) 431) shortens the step. It can end in a local
//! minimum of |F|: another ρ, or another start, has others. Of 100 000 random impacts with µ from 0.05 to
//! 10 none was left unsolved, and two of 20 000 with µ = 1000 (`coulombs_law_by_hand`).

use glam::DVec3;

use super::super::geometry::{Corner3, DelassusOperator};
use super::super::projection::cancel;
use super::{ConeSolution, add, project};

/// Three unknowns a corner.
const SIZE: usize = 24;
type Matrix = [[f64; SIZE]; SIZE];
type Vector = [f64; SIZE];

/// ρ in units of one over the norm, in the order in which they are tried.
const SCALES: [f64; 6] = [1.0, 10.0, 0.1, 100.0, 0.01, 1000.0];
/// Newton steps from one start.
const STEPS: u32 = 60;
/// Dampings tried for one step, each ten times the last.
const DAMPINGS: u32 = 12;

/// Improves `solution.p` until |w| is right to `target` or `solution.iterations` is `limit`; says in `converged`
/// whether it could.
pub(super) fn solve(
    operator: &DelassusOperator,
    b: &Corner3,
    alpha: f64,
    friction: f64,
    target: f64,
    limit: u32,
    solution: &mut ConeSolution,
) {
    let n = operator.count;
    let norm = alpha * operator.norm_bound();
    let entries = matrix(operator, alpha);
    let approach = b[..n].iter().map(|u| -u.y).sum::<f64>() / n as f64;
    let share = approach / (alpha * operator.inverse_mass() * n as f64);
    let mut even = [DVec3::ZERO; 8];
    even[..n].fill(DVec3::Y * share);
    let stop = cancel(operator, b, &[DVec3::ONE; 8]).map(|q| q / alpha);
    for scale in SCALES {
        let problem = Problem {
            operator,
            b,
            alpha,
            friction,
            rho: scale / norm,
            entries: &entries,
        };
        for start in [solution.p, [DVec3::ZERO; 8], even, stop] {
            if let Some(p) = problem.descend(start, target, limit, &mut solution.iterations) {
                solution.p = p.map(|q| project(q, friction));
                solution.converged = true;
                return;
            }
        }
    }
}

/// αW in full.
fn matrix(operator: &DelassusOperator, alpha: f64) -> Matrix {
    let mut w = [[0.0; SIZE]; SIZE];
    for column in 0..3 * operator.count {
        let mut unit = [DVec3::ZERO; 8];
        unit[column / 3][column % 3] = 1.0;
        let response = operator.response(&unit);
        for row in 0..3 * operator.count {
            w[row][column] = alpha * response[row / 3][row % 3];
        }
    }
    w
}

struct Problem<'a> {
    operator: &'a DelassusOperator,
    b: &'a Corner3,
    alpha: f64,
    friction: f64,
    rho: f64,
    entries: &'a Matrix,
}

impl Problem<'_> {
    /// The zero of F that is reached from `p`.
    fn descend(
        &self,
        mut p: Corner3,
        target: f64,
        limit: u32,
        iterations: &mut u32,
    ) -> Option<Corner3> {
        let n = self.operator.count;
        let mut damping = 1e-6;
        let (mut q, mut f) = self.residual(&p);
        let mut square = self.operator.dot(&f, &f);
        for _ in 0..STEPS.min(limit.saturating_sub(*iterations)) {
            *iterations += 1;
            if self.operator.largest(&f) <= target * self.rho {
                return Some(p);
            }
            let (normal, gradient) = self.normal_equations(&q, &f);
            let mut found = false;
            for _ in 0..DAMPINGS {
                if let Some(x) = solve_damped(&normal, &gradient, damping, 3 * n) {
                    let mut next = p;
                    for i in 0..n {
                        next[i] -= DVec3::new(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
                    }
                    let (next_q, next_f) = self.residual(&next);
                    let next_square = self.operator.dot(&next_f, &next_f);
                    if next_square < square * (1.0 - 1e-6) {
                        (p, q, f, square) = (next, next_q, next_f, next_square);
                        damping = (0.1 * damping).max(1e-14);
                        found = true;
                        break;
                    }
                }
                damping *= 10.0;
            }
            if !found {
                return None;
            }
        }
        None
    }

    /// q = p − ρw and F = p − P(q).
    fn residual(&self, p: &Corner3) -> (Corner3, Corner3) {
        let n = self.operator.count;
        let w = add(self.b, &self.operator.response(p), self.alpha, n);
        let (mut q, mut f) = ([DVec3::ZERO; 8], [DVec3::ZERO; 8]);
        for i in 0..n {
            q[i] = p[i] - self.rho * w[i];
            f[i] = p[i] - project(q[i], self.friction);
        }
        (q, f)
    }

    /// JᵀJ and JᵀF with J = 1 − P'(q)(1 − ραW).
    fn normal_equations(&self, q: &Corner3, f: &Corner3) -> (Matrix, Vector) {
        let size = 3 * self.operator.count;
        let mut j = [[0.0; SIZE]; SIZE];
        for i in 0..self.operator.count {
            let slope = projection_slope(q[i], self.friction);
            for (a, row) in slope.iter().enumerate() {
                for column in 0..size {
                    let mut sum = 0.0;
                    for (k, s) in row.iter().enumerate() {
                        let unit = f64::from(u8::from(3 * i + k == column));
                        sum += s * (unit - self.rho * self.entries[3 * i + k][column]);
                    }
                    j[3 * i + a][column] = f64::from(u8::from(3 * i + a == column)) - sum;
                }
            }
        }
        let (mut normal, mut gradient) = ([[0.0; SIZE]; SIZE], [0.0; SIZE]);
        for row in &j[..size] {
            for (r, a) in row[..size].iter().enumerate() {
                for (c, b) in row[..=r].iter().enumerate() {
                    normal[r][c] += a * b;
                }
            }
        }
        for r in 0..size {
            gradient[r] = (0..size).map(|k| j[k][r] * f[k / 3][k % 3]).sum();
        }
        (normal, gradient)
    }
}

/// P'(q), rows and columns in the order x, y (normal), z.
fn projection_slope(q: DVec3, friction: f64) -> [[f64; 3]; 3] {
    let t = (q.x * q.x + q.z * q.z).sqrt();
    if q.y <= 0.0 {
        return [[0.0; 3]; 3];
    }
    if t <= friction * q.y {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    // µ q_n t̂, t̂ = q_t/|q_t|
    let (x, z) = (q.x / t, q.z / t);
    let k = friction * q.y / t;
    [
        [k * (1.0 - x * x), friction * x, -k * x * z],
        [0.0, 1.0, 0.0],
        [-k * x * z, friction * z, k * (1.0 - z * z)],
    ]
}

/// (A + λ)x = g by Cholesky's factors, A given by its lower triangle; `None` if it is not positive
/// definite.
fn solve_damped(a: &Matrix, g: &Vector, lambda: f64, size: usize) -> Option<Vector> {
    let mut l = *a;
    for r in 0..size {
        for c in 0..=r {
            let mut v = l[r][c] + if r == c { lambda } else { 0.0 };
            for k in 0..c {
                v -= l[r][k] * l[c][k];
            }
            if r == c {
                if v.is_nan() || v <= 0.0 {
                    return None;
                }
                l[r][r] = v.sqrt();
            } else {
                l[r][c] = v / l[c][c];
            }
        }
    }
    let mut x = *g;
    for r in 0..size {
        for k in 0..r {
            x[r] -= l[r][k] * x[k];
        }
        x[r] /= l[r][r];
    }
    for r in (0..size).rev() {
        for k in r + 1..size {
            x[r] -= l[k][r] * x[k];
        }
        x[r] /= l[r][r];
    }
    Some(x)
}
