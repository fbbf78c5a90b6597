//! The starts of Newton's method: zero, the frictionless impulses, and what gradient steps make of zero.

use glam::DVec3;

use super::super::geometry::Corner3;
use super::super::newton::{Solution, descend};
use super::{Cone, answered, project};

/// Gradient steps that lead to further starts, where neither zero nor the frictionless impulses led to the end.
const GRADIENT_STEPS: [u32; 3] = [50, 200, 1000];

impl Cone<'_> {
    /// Solves it to |w| within `target`, or until `solution.iterations` is `limit`; says in
    /// `converged` whether it could.
    pub(super) fn newton(&self, b: &Corner3, target: f64, limit: u32, solution: &mut Solution) {
        let descends = |solution: &mut Solution| {
            let (start, iterations) = (&solution.p, &mut solution.iterations);
            let found = descend(self, b, target, start, limit, iterations);
            solution.converged = found.is_some();
            solution.p = found.unwrap_or(solution.p);
            solution.converged
        };
        solution.p = [DVec3::ZERO; 8];
        if descends(solution) {
            answered("Newton from zero");
            return;
        }
        solution.p = self.smooth(b);
        if descends(solution) {
            answered("Newton from the frictionless impulses");
            return;
        }
        for steps in GRADIENT_STEPS {
            let steps = steps.min(limit.saturating_sub(solution.iterations));
            self.gradient(b, target, steps, solution);
            if solution.converged || descends(solution) {
                answered("Newton after gradients");
                return;
            }
        }
    }

    /// Accelerated projected gradients (Nesterov 1983; restart after O'Donoghue, Candès, Found. Comput. Math. 15 (2015)
    /// 715; for contact: Mazhar et al., ACM TOG 34 (2015) 32): p = P(p − ρw), P taking p_n to max(p_n, 0) and p_t into
    /// the disc of radius µp_n.
    fn gradient(&self, b: &Corner3, target: f64, steps: u32, solution: &mut Solution) {
        let (n, norm, friction) = (self.operator.count, self.norm, self.friction);
        let step = 1.0 / norm;
        let mut previous = [DVec3::ZERO; 8];
        let mut y = previous;
        let mut theta = 1.0_f64;
        solution.converged = false;
        for _ in 0..steps {
            let w = self.operator.after(b, &y);
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
}
