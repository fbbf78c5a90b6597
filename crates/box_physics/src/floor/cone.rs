//! Coulomb's law for all touching corners at once.
//!
//! Given velocities b and the operator αW, find impulses p with w = b + αWp and, for every corner,
//!
//! ```text
//! 0 ≤ p_n ⊥ w_n ≥ 0,   |p_t| ≤ µ p_n,   p_t = −µ p_n w_t/|w_t| where it slips.
//! ```
//!
//! Each corner sticks, slides or leaves, and most cases are small problems of their own:
//!
//! 1. One corner is solved directly (`single`), an edge and a face by cases (`edge`, `face`).
//! 2. If the corners of a face move alike and friction cannot stop them, it is one block's friction
//!    (`uniform`).
//! 3. Where no case fits: the law says p = P(p − ρw) for any ρ > 0, P taking p_n to max(p_n, 0) and p_t into
//!    the disc of radius µp_n. Its fixed point is found by accelerated projected gradients (Nesterov 1983;
//!    restart after O'Donoghue, Candès, Found. Comput. Math. 15 (2015) 715; for contact: Mazhar et al.,
//!    ACM TOG 34 (2015) 32), from zero and all corners alike. (De Saxcé's form of the law, Math. Comput.
//!    Modelling 28 (1998) 225, converges as fast below µ = 0.5, but not for µ above 2.)
//! 4. What has not converged soon is left to Newton's method on the same equation (`newton`).
//!
//! Of the many distributions of load on four corners the closed forms pick the smallest, so that a symmetric
//! landing keeps its symmetry.

mod edge;
mod newton;
mod single;

use edge::Edge;
use glam::DVec3;

use super::geometry::{Corner3, DelassusOperator, has, mask};
use super::projection::cancel;

/// What the solver found.
pub(super) struct ConeSolution {
    /// The impulses p \[N s\].
    pub(super) p: Corner3,
    /// w = b + αWp [m/s].
    pub(super) w: Corner3,
    /// Iterations used.
    pub(super) iterations: u32,
    /// Whether the residual came below the tolerance.
    pub(super) converged: bool,
}

/// The normal part made positive, the tangential one cut to the disc that belongs to it.
#[inline(always)]
fn project(p: DVec3, friction: f64) -> DVec3 {
    let n = p.y.max(0.0);
    let t = (p.x * p.x + p.z * p.z).sqrt();
    if t <= friction * n {
        DVec3::new(p.x, n, p.z)
    } else {
        let scale = friction * n / t;
        DVec3::new(scale * p.x, n, scale * p.z)
    }
}

/// Solves it; `tolerance` is relative to the largest |b_k|. What does not converge in half of the iterations is
/// solved with a quarter of the friction in a quarter of them, and so on, and at last with none, directly: the
/// result always keeps the normal law and never gains energy; `converged` tells that it had to give way.
pub(super) fn solve(
    operator: &DelassusOperator,
    b: &Corner3,
    alpha: f64,
    friction: f64,
    tolerance: f64,
    max_iterations: u32,
) -> ConeSolution {
    let n = operator.count;
    let mut solution = ConeSolution {
        p: [DVec3::ZERO; 8],
        w: *b,
        iterations: 0,
        converged: true,
    };
    if b[..n].iter().all(|u| u.y >= 0.0) {
        return solution; // nothing approaches: p = 0 is the solution
    }
    let target = tolerance * operator.largest(b);
    let mut coefficient = friction;
    for share in [2, 4, 4] {
        if coefficient == 0.0 {
            break;
        }
        let limit = solution.iterations + max_iterations / share;
        attempt(
            operator,
            b,
            alpha,
            coefficient,
            target,
            limit,
            &mut solution,
        );
        if solution.converged {
            break;
        }
        coefficient *= 0.25;
    }
    if coefficient == 0.0 || !solution.converged {
        solution.p = smooth(operator, b, alpha);
    }
    solution.converged = coefficient == friction;
    let (v, omega) = operator.twist(&solution.p);
    for i in 0..n {
        solution.w[i] = b[i] + alpha * (v + omega.cross(operator.lever[i]));
    }
    solution
}

/// The impulses without friction: the smallest that stop all corners along the normal, if they all push;
/// otherwise corner after corner is stopped as long as one approaches, and let go where it would have to pull
/// (Lawson, Hanson, *Solving Least Squares Problems*, 1974, §23: the energy falls with every round, so that it ends).
fn smooth(operator: &DelassusOperator, b: &Corner3, alpha: f64) -> Corner3 {
    let stop = |stopped: u8| {
        let part = operator.part(stopped);
        let mut own = [DVec3::ZERO; 8];
        let places = (0..operator.count).filter(|&i| has(stopped, i));
        for (u, i) in own.iter_mut().zip(places.clone()) {
            *u = b[i];
        }
        let found = cancel(&part, &own, &[DVec3::Y; 8]);
        let mut p = [DVec3::ZERO; 8];
        for (q, i) in found.iter().zip(places) {
            p[i] = *q / alpha;
        }
        p
    };
    let all = stop(mask(|i| i < operator.count));
    if all[..operator.count].iter().all(|p| p.y >= 0.0) {
        return all;
    }
    let tiny = 1e-14 * operator.largest(b);
    let (mut p, mut stopped) = ([DVec3::ZERO; 8], 0);
    for _ in 0..4 * operator.count {
        let w = add(b, &operator.response(&p), alpha, operator.count);
        let free = (0..operator.count).filter(|&i| !has(stopped, i));
        let Some(next) = free.min_by(|&i, &j| w[i].y.total_cmp(&w[j].y)) else {
            break;
        };
        if w[next].y >= -tiny {
            break;
        }
        stopped |= 1 << next;
        while stopped != 0 {
            let wanted = stop(stopped);
            // As far that way as no corner pulls.
            let mut way = 1.0_f64;
            for i in (0..operator.count).filter(|&i| has(stopped, i) && wanted[i].y <= 0.0) {
                way = way.min(p[i].y / (p[i].y - wanted[i].y).max(f64::MIN_POSITIVE));
            }
            for i in 0..operator.count {
                p[i] += way * (wanted[i] - p[i]);
            }
            if way == 1.0 {
                break;
            }
            let pulled = mask(|i| has(stopped, i) && wanted[i].y <= 0.0 && p[i].y <= 0.0);
            // Rounding may leave the corner that stopped it a little above zero.
            let least = (0..operator.count)
                .filter(|&i| has(stopped, i) && wanted[i].y <= 0.0)
                .min_by(|&i, &j| p[i].y.total_cmp(&p[j].y));
            let out = pulled | least.map_or(0, |i| 1 << i);
            stopped &= !out;
            for i in (0..operator.count).filter(|&i| has(out, i)) {
                p[i] = DVec3::ZERO;
            }
        }
    }
    p
}

/// With friction, until `solution.iterations` is `limit`.
fn attempt(
    operator: &DelassusOperator,
    b: &Corner3,
    alpha: f64,
    friction: f64,
    target: f64,
    limit: u32,
    solution: &mut ConeSolution,
) {
    solution.converged = true;
    match operator.count {
        1 => {
            let found;
            (solution.p[0], found) = single::solve(&operator.block(0, 0, alpha), b[0], friction);
            if found {
                return;
            }
        }
        2 => {
            let edge = Edge::new(operator, b, alpha, friction, target);
            if let Some(p) = edge.solve() {
                solution.p[..2].copy_from_slice(&p);
                return;
            }
        }
        _ => {}
    }
    newton::solve(operator, b, alpha, friction, target, limit, solution);
}

/// Accelerated projected gradients.
fn gradient(
    operator: &DelassusOperator,
    b: &Corner3,
    alpha: f64,
    friction: f64,
    target: f64,
    steps: u32,
    solution: &mut ConeSolution,
) {
    let n = operator.count;
    let norm = alpha * operator.norm_bound();
    let step = 1.0 / norm;
    let mut previous = [DVec3::ZERO; 8];
    let mut y = previous;
    let mut theta = 1.0_f64;
    solution.converged = false;
    for _ in 0..steps {
        let w = add(b, &operator.response(&y), alpha, n);
        let mut next = [DVec3::ZERO; 8];
        let (mut residual, mut turn) = (0.0_f64, 0.0);
        for i in 0..n {
            next[i] = project(y[i] - step * w[i], friction);
            let change = y[i] - next[i];
            residual = residual.max(change.length_squared());
            turn += change.dot(next[i] - previous[i]);
        }
        solution.iterations += 1;
        if norm * residual.sqrt() <= target {
            solution.converged = true;
            previous = next;
            break;
        }
        if turn > 0.0 {
            theta = 1.0;
            y = next;
        } else {
            let theta_next = 0.5 * (1.0 + (1.0 + 4.0 * theta * theta).sqrt());
            let beta = (theta - 1.0) / theta_next;
            for i in 0..n {
                y[i] = next[i] + beta * (next[i] - previous[i]);
            }
            theta = theta_next;
        }
        previous = next;
    }
    solution.p = previous;
}

fn add(b: &Corner3, c: &Corner3, alpha: f64, n: usize) -> Corner3 {
    let mut sum = [DVec3::ZERO; 8];
    for i in 0..n {
        sum[i] = b[i] + alpha * c[i];
    }
    sum
}

#[cfg(test)]
mod tests;
