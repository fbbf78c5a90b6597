//! Coulomb's law for all contacts of a body, and its solver.
//!
//! Given velocities b and the operator W, find impulses p with w = b + Wp and, for every contact,
//!
//! ```text
//! 0 ≤ p_n ⊥ w_n ≥ 0,   |p_t| ≤ µ p_n,   p_t = −µ p_n w_t/|w_t| where it slips.
//! ```
//!
//! Each contact sticks, slides or leaves. The likely cases at few corners of a floor are solved directly (`cone`), all
//! others by Newton's method on the twist of the body (`newton`). Without friction the law is a convex problem with an
//! active set. Of the possible load distributions on four corners the smallest is chosen, so a symmetric landing
//! remains symmetric.

use glam::DVec3;

use super::cone::Blocks;
use super::geometry::{each, has, set};
use super::ground::Ground;
use super::newton::descend;
use super::operator::DelassusOperator;

/// Numbers of gradient steps to further starting points of Newton's method.
const GRADIENT_STEPS: [u32; 3] = [50, 200, 1000];

/// Result of the solver.
pub(super) struct Solution<const N: usize = 8> {
    /// The impulses p \[N s\].
    pub(super) p: [DVec3; N],
    /// Iterations used.
    pub(super) iterations: u32,
    /// `true` if the law holds to the tolerance.
    pub(super) converged: bool,
}

/// Records in tests which case found the solution.
#[inline(always)]
pub(super) fn answered(case: &'static str) {
    #[cfg(test)]
    ANSWERS.with_borrow_mut(|answers| *answers.entry(case).or_default() += 1);
    #[cfg(not(test))]
    let _ = case;
}

#[cfg(test)]
thread_local! {
    /// Number of solutions by case.
    pub(super) static ANSWERS: std::cell::RefCell<std::collections::BTreeMap<&'static str, u32>> =
        std::cell::RefCell::default();
}

/// Coulomb's law at the contacts of an operator.
pub(super) struct Law<'a, G: Ground<N>, const N: usize> {
    ground: &'a G,
    /// The contacts and their inverse-mass operator.
    pub(super) operator: &'a DelassusOperator<N>,
    /// Data for direct solutions.
    pub(super) blocks: Blocks,
    /// `true` if static friction acts.
    grips: bool,
    /// Factor applied to the friction.
    part: f64,
}

impl<'a, G: Ground<N>, const N: usize> Law<'a, G, N> {
    /// Creates the law, with static friction if `grips`.
    pub(super) fn new(ground: &'a G, operator: &'a DelassusOperator<N>, grips: bool) -> Self {
        Self {
            ground,
            operator,
            blocks: ground.blocks(operator),
            grips,
            part: 1.0,
        }
    }

    /// The normal and the friction coefficient of a contact.
    #[inline(always)]
    pub(super) fn surface(&self, i: usize) -> (DVec3, f64) {
        let place = usize::from(self.operator.place[i]);
        let surface = self.ground.surface(place);
        let friction = if self.grips {
            surface.grip()
        } else {
            surface.friction
        };
        (self.ground.normal(place), self.part * friction)
    }

    /// P: projects an impulse onto the cone, the normal part to ≥ 0 and the tangential part to the disc of that radius.
    #[inline(always)]
    pub(super) fn project(&self, i: usize, p: DVec3) -> DVec3 {
        let (normal, friction) = self.surface(i);
        let height = normal.dot(p);
        let along = p - normal * height;
        let (n, length) = (height.max(0.0), along.length());
        let part = if length <= friction * n {
            1.0
        } else {
            friction * n / length
        };
        n * normal + along * part
    }

    /// Solves the law for the velocities `b`; `near` is the solution of a similar problem, or zero. The result always
    /// obeys the normal law and never gains energy. If half of the iterations do not converge, two quarters follow with
    /// 1/4 and 1/16 of the friction. Finally, the problem without friction is solved directly. In these cases
    /// `converged` is `false`.
    pub(super) fn solve(&mut self, b: &[DVec3; N], near: &[DVec3; N]) -> Solution<N> {
        let (operator, n) = (self.operator, self.operator.count);
        let mut solution = Solution {
            p: [DVec3::ZERO; N],
            iterations: 0,
            converged: true,
        };
        if (0..n).all(|i| self.surface(i).0.dot(b[i]) >= 0.0) {
            return solution; // nothing approaches: p = 0 is the solution
        }
        let settings = self.ground.level().context.settings;
        let target = settings.tolerance * operator.largest(b);
        for attempt in 0..3 {
            let limit = settings.max_iterations / 4 * (2 + attempt);
            let (cases, p) = ((b, near), &mut solution.p);
            let mut found = self.ground.direct(self, cases, target, p).is_some();
            if !found && let Some(p) = self.newton(b, target, limit, &mut solution.iterations) {
                solution.p = p;
                found = true;
            }
            if found {
                solution.converged = attempt == 0;
                self.part = 1.0;
                return solution;
            }
            self.part *= 0.25;
        }
        self.part = 1.0;
        answered("gave way");
        solution.p = self.smooth(b);
        solution.converged = false;
        solution
    }

    /// Solves the law to |w| within `target`, unless `iterations` reaches `limit`.
    fn newton(
        &self,
        b: &[DVec3; N],
        target: f64,
        limit: u32,
        iterations: &mut u32,
    ) -> Option<[DVec3; N]> {
        let zero = [DVec3::ZERO; N];
        let mut found = descend(self, b, target, &zero, limit, iterations)
            .inspect(|_| answered("Newton from zero"))
            .or_else(|| {
                descend(self, b, target, &self.smooth(b), limit, iterations)
                    .inspect(|_| answered("Newton from the frictionless impulses"))
            });
        for steps in GRADIENT_STEPS {
            if found.is_none() {
                let steps = steps.min(limit.saturating_sub(*iterations));
                let start = self.gradient(b, steps);
                *iterations += steps;
                found = descend(self, b, target, &start, limit, iterations)
                    .inspect(|_| answered("Newton after gradients"));
            }
        }
        found
    }

    /// Accelerated projected gradients (Nesterov 1983; restart after O'Donoghue, Candès, Found. Comput. Math. 15 (2015)
    /// 715; for contact: Mazhar et al., ACM TOG 34 (2015) 32): p = P(p − ρw).
    fn gradient(&self, b: &[DVec3; N], steps: u32) -> [DVec3; N] {
        let (operator, step) = (self.operator, 1.0 / self.operator.norm_bound());
        let mut previous = [DVec3::ZERO; N];
        let mut y = previous;
        let mut theta = 1.0_f64;
        for _ in 0..steps {
            let w = operator.after(b, &y);
            let mut next = [DVec3::ZERO; N];
            let mut turn = 0.0;
            for i in 0..operator.count {
                next[i] = self.project(i, y[i] - step * w[i]);
                turn += (y[i] - next[i]).dot(next[i] - previous[i]);
            }
            if turn > 0.0 {
                theta = 1.0;
                y = next;
            } else {
                let theta_next = 0.5 * (1.0 + (1.0 + 4.0 * theta * theta).sqrt());
                let beta = (theta - 1.0) / theta_next;
                for i in 0..operator.count {
                    y[i] = next[i] + beta * (next[i] - previous[i]);
                }
                theta = theta_next;
            }
            previous = next;
        }
        previous
    }

    /// The smallest impulses that stop the contacts with the indices `kept` along their normals.
    pub(super) fn stop(&self, kept: u64, b: &[DVec3; N]) -> [DVec3; N] {
        let part = self.operator.part(kept);
        let (mut own, mut p) = ([DVec3::ZERO; N], [DVec3::ZERO; N]);
        for (u, i) in own.iter_mut().zip(each(kept)) {
            *u = b[i];
        }
        let found = self.ground.cancel(&part, &own, 0);
        for (q, i) in found.iter().zip(each(kept)) {
            p[i] = *q;
        }
        p
    }

    /// The impulses without friction: the smallest ones that stop all contacts along the normal, if all of them push.
    /// Otherwise an active set: approaching contacts are added one by one, and those that would pull are removed (Lawson,
    /// Hanson, *Solving Least Squares Problems*, 1974, §23; the energy falls with every round, so it terminates).
    pub(super) fn smooth(&self, b: &[DVec3; N]) -> [DVec3; N] {
        let (operator, n) = (self.operator, self.operator.count);
        let along = |i: usize, v: &[DVec3; N]| self.surface(i).0.dot(v[i]);
        let all = self.stop(set::<N>(|i| i < n), b);
        if (0..n).all(|i| along(i, &all) >= 0.0) {
            return all;
        }
        let tiny = 1e-14 * operator.largest(b);
        let (mut p, mut stopped) = ([DVec3::ZERO; N], 0_u64);
        for _ in 0..4 * n {
            let w = operator.after(b, &p);
            let free = (0..n).filter(|&i| !has(stopped, i));
            let Some(next) = free.min_by(|&i, &j| along(i, &w).total_cmp(&along(j, &w))) else {
                break;
            };
            if along(next, &w) >= -tiny {
                break;
            }
            stopped |= 1 << next;
            while stopped != 0 {
                let wanted = self.stop(stopped, b);
                let pulled = || each(stopped).filter(|&i| along(i, &wanted) <= 0.0);
                // Moves toward it until the first contact would pull.
                let mut way = 1.0_f64;
                for i in pulled() {
                    let (here, there) = (along(i, &p), along(i, &wanted));
                    way = way.min(here / (here - there).max(f64::MIN_POSITIVE));
                }
                for i in 0..n {
                    p[i] += way * (wanted[i] - p[i]);
                }
                if way == 1.0 {
                    break;
                }
                // Rounding may leave the limiting contact slightly above zero.
                let least = pulled().min_by(|&i, &j| along(i, &p).total_cmp(&along(j, &p)));
                let out = |i: usize| along(i, &p) <= 0.0 || Some(i) == least;
                let out = pulled().filter(|&i| out(i)).fold(0, |out, i| out | 1 << i);
                stopped &= !out;
                for i in each(out) {
                    p[i] = DVec3::ZERO;
                }
            }
        }
        p
    }
}
