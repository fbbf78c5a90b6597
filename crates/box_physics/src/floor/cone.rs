//! Coulomb's law for all touching corners at once.
//!
//! Given velocities b and the operator W, find impulses p with w = b + Wp and, for every corner,
//!
//! ```text
//! 0 ≤ p_n ⊥ w_n ≥ 0,   |p_t| ≤ µ p_n,   p_t = −µ p_n w_t/|w_t| where it slips.
//! ```
//!
//! Each corner sticks, slides or leaves. One corner is solved directly (`single`), an edge by its likely cases
//! (`edge`): nine of ten problems are one of these. Everything else is Newton's method on the twist of the body
//! (`super::newton`), which four corners take as few steps as two. Without friction the law is a convex problem with an
//! active set (`Cone::smooth`).
//!
//! Of the many distributions of load on four corners the smallest is found, so that a symmetric landing keeps its
//! symmetry.

mod descent;
mod edge;
mod single;

use edge::Edge;
use glam::{DMat3, DVec3};

use super::ContactSettings;
use super::geometry::{Corner3, has, mask};
use super::newton::{CoulombLaw, Solution};
use super::operator::DelassusOperator;
use super::projection::cancel;

/// Notes in tests which case answered.
#[inline(always)]
fn answered(case: &'static str) {
    #[cfg(test)]
    ANSWERS.with_borrow_mut(|answers| *answers.entry(case).or_default() += 1);
    #[cfg(not(test))]
    let _ = case;
}

#[cfg(test)]
thread_local! {
    /// How often each case answered.
    pub(super) static ANSWERS: std::cell::RefCell<std::collections::BTreeMap<&'static str, u32>> =
        std::cell::RefCell::default();
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

/// Coulomb's law at a few corners of a body.
#[derive(Clone, Copy)]
pub(super) struct Cone<'a> {
    operator: &'a DelassusOperator,
    friction: f64,
    settings: &'a ContactSettings,
    /// A bound of W [1/kg].
    norm: f64,
    /// W_00 and W_11, W_01 and W_10 of no more than two corners.
    own: [DMat3; 2],
    other: [DMat3; 2],
}

impl<'a> Cone<'a> {
    pub(super) fn new(
        operator: &'a DelassusOperator,
        friction: f64,
        settings: &'a ContactSettings,
    ) -> Self {
        let (mut own, mut other) = ([DMat3::ZERO; 2], [DMat3::ZERO; 2]);
        if operator.count <= 2 {
            let first = operator.swing(0);
            own[0] = operator.block(0, &first);
            if operator.count == 2 {
                let second = operator.swing(1);
                own[1] = operator.block(1, &second);
                let cross = operator.block(0, &second);
                other = [cross, cross.transpose()];
            }
        }
        Self {
            operator,
            friction,
            settings,
            norm: operator.norm_bound(),
            own,
            other,
        }
    }

    #[cold]
    fn give_way(&self, b: &Corner3, target: f64, solution: &mut Solution) {
        let mut weaker = *self;
        for _ in 0..2 {
            weaker.friction *= 0.25;
            let limit = solution.iterations + self.settings.max_iterations / 4;
            weaker.attempt(b, &[DVec3::ZERO; 8], target, limit, solution);
            if solution.converged {
                solution.converged = false;
                return;
            }
        }
        solution.p = self.smooth(b);
    }

    /// The impulses without friction: the smallest that stop all corners along the normal, if they all push;
    /// otherwise corner after corner is stopped as long as one approaches, and let go where it would have to pull
    /// (Lawson, Hanson, *Solving Least Squares Problems*, 1974, §23: the energy falls with every round, so that it ends).
    fn smooth(&self, b: &Corner3) -> Corner3 {
        let operator = self.operator;
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
                p[i] = *q;
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
            let w = operator.after(b, &p);
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
        &self,
        b: &Corner3,
        near: &Corner3,
        target: f64,
        limit: u32,
        solution: &mut Solution,
    ) {
        solution.converged = true;
        match self.operator.count {
            1 => {
                if let Some(p) = single::solve(&self.own[0], b[0], self.friction, near[0]) {
                    solution.p[0] = p;
                    return;
                }
            }
            2 => {
                let edge = Edge {
                    cone: self,
                    b,
                    near,
                    target,
                };
                if let Some(p) = edge.solve() {
                    solution.p[..2].copy_from_slice(&p);
                    return;
                }
            }
            _ => {
                // A box that rocks strikes with two corners and leaves with the others.
                let strikes = mask(|i| i < self.operator.count && b[i].y < -target);
                let two = || {
                    let (i, j) = (strikes.trailing_zeros(), strikes.leading_zeros());
                    self.two_alone(b, target, i as usize, 7 - j as usize)
                };
                let pair = (strikes.count_ones() == 2).then(two).flatten();
                let pair = pair.inspect(|_| answered("face: two corners as an edge"));
                let stick = || {
                    self.all_stick(b, target)
                        .inspect(|_| answered("face: all stick"))
                };
                if let Some(p) = pair.or_else(stick) {
                    solution.p = p;
                    return;
                }
            }
        }
        self.newton(b, target, limit, solution);
    }

    /// The smallest impulses that stop three or more corners, if they are in the cones: about the center of the
    /// corners, with the arms ρ_i, they are a + β × ρ_i, and β is told by S = Σ (|ρ_i|² − ρ_iρ_iᵀ), which tells the twist
    /// as well.
    fn all_stick(&self, b: &Corner3, target: f64) -> Option<Corner3> {
        let (operator, n) = (self.operator, self.operator.count);
        let part = 1.0 / n as f64;
        let center = part * operator.lever[..n].iter().sum::<DVec3>();
        let mean = part * b[..n].iter().sum::<DVec3>();
        let (mut spread, mut turn) = (DMat3::ZERO, DVec3::ZERO);
        for i in 0..n {
            let r = operator.lever[i] - center;
            spread += DMat3::from_diagonal(DVec3::splat(r.length_squared()))
                - DMat3::from_cols(r * r.x, r * r.y, r * r.z);
            turn += r.cross(b[i] - mean);
        }
        let inverse = spread.inverse();
        let omega = -(inverse * turn);
        let force = (-mean - omega.cross(center)) / operator.inverse_mass;
        let torque = operator.inverse_inertia.inverse() * omega - center.cross(force);
        let beta = inverse * torque;
        let mut p = [DVec3::ZERO; 8];
        for i in 0..n {
            p[i] = part * force + beta.cross(operator.lever[i] - center);
            let t = (p[i].x * p[i].x + p[i].z * p[i].z).sqrt();
            if p[i].y <= 0.0 || t > self.friction * p[i].y {
                return None;
            }
        }
        let left = operator.largest(&operator.after(b, &p));
        (left <= target).then_some(p)
    }

    /// Two corners as an edge, if all others leave then.
    fn two_alone(&self, b: &Corner3, target: f64, i: usize, j: usize) -> Option<Corner3> {
        let part = self.operator.part(1 << i | 1 << j);
        let cone = Cone::new(&part, self.friction, self.settings);
        let mut own = [DVec3::ZERO; 8];
        (own[0], own[1]) = (b[i], b[j]);
        let edge = Edge {
            cone: &cone,
            b: &own,
            near: &[DVec3::ZERO; 8],
            target,
        };
        let found = edge.solve()?;
        let mut p = [DVec3::ZERO; 8];
        (p[i], p[j]) = found.into();
        let w = self.operator.after(b, &p);
        let leaves = |w: &DVec3| w.y >= -target;
        w[..self.operator.count].iter().all(leaves).then_some(p)
    }
}

impl CoulombLaw<8> for Cone<'_> {
    fn operator(&self) -> &DelassusOperator {
        self.operator
    }

    fn norm(&self) -> f64 {
        self.norm
    }

    #[inline(always)]
    fn surface(&self, _: usize) -> (DVec3, f64) {
        (DVec3::Y, self.friction)
    }

    #[inline(always)]
    fn project(&self, _: usize, p: DVec3) -> DVec3 {
        project(p, self.friction)
    }

    /// What does not converge in half of the iterations is solved with a quarter of the friction in a quarter of them,
    /// and so on, and at last with none, directly.
    fn solve(&self, b: &Corner3, near: &Corner3) -> Solution {
        let operator = self.operator;
        let n = operator.count;
        let mut solution = Solution::NONE;
        if b[..n].iter().all(|u| u.y >= 0.0) {
            return solution; // nothing approaches: p = 0 is the solution
        }
        let target = self.settings.tolerance * operator.largest(b);
        if self.friction == 0.0 {
            answered("frictionless");
            solution.p = self.smooth(b);
            return solution;
        }
        let limit = self.settings.max_iterations / 2;
        self.attempt(b, near, target, limit, &mut solution);
        if !solution.converged {
            answered("gave way");
            self.give_way(b, target, &mut solution);
        }
        solution
    }
}

#[cfg(test)]
mod tests;
