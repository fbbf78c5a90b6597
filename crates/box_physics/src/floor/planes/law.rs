//! Coulomb's law for contacts with several normals: the law of `cone`, each contact with its own normal n and friction,
//! solved by the same Newton method on the twist of the body.
//!
//! The steps start from zero impulses, or from what projected Gauss–Seidel sweeps make of them (M. Jean, Comput. Methods
//! Appl. Mech. Eng. 177 (1999) 235), and of the impulses that do the same they take the smallest.

use glam::DVec3;

use super::Plane;
use super::contacts::{Each, NONE, PAIRS};
use crate::floor::newton::{CoulombLaw, Solution, descend};
use crate::floor::operator::DelassusOperator;
use crate::floor::{ContactSettings, Floor};

/// Sweeps that lead to the starts.
const SWEEPS: [u32; 4] = [0, 10, 100, 400];
/// Sweeps without friction, where nothing else converged: each takes energy, however few there are.
const LAST_SWEEPS: u32 = 1000;

/// The law at some contacts.
#[derive(Clone, Copy)]
pub(super) struct Law<'a> {
    operator: &'a DelassusOperator<PAIRS>,
    settings: &'a ContactSettings,
    /// Of the contacts.
    normal: Each,
    friction: [f64; PAIRS],
    norm: f64,
}

impl CoulombLaw<PAIRS> for Law<'_> {
    fn operator(&self) -> &DelassusOperator<PAIRS> {
        self.operator
    }

    fn norm(&self) -> f64 {
        self.norm
    }

    fn surface(&self, i: usize) -> (DVec3, f64) {
        (self.normal[i], self.friction[i])
    }

    fn project(&self, i: usize, p: DVec3) -> DVec3 {
        let normal = self.normal[i];
        let n = normal.dot(p).max(0.0);
        let along = p - normal * normal.dot(p);
        let (length, limit) = (along.length(), self.friction[i] * n);
        let part = if length <= limit { 1.0 } else { limit / length };
        n * normal + along * part
    }

    fn solve(&self, b: &Each, _: &Each) -> Solution<PAIRS> {
        let operator = self.operator;
        let mut solution = Solution::NONE;
        if (0..operator.count).all(|i| self.normal[i].dot(b[i]) >= 0.0) {
            return solution; // nothing approaches: p = 0 is the solution
        }
        let target = self.settings.tolerance * operator.largest(b);
        let mut law = *self;
        for attempt in 0..3 {
            let limit = self.settings.max_iterations / 4 * (2 + attempt);
            if let Some(p) = law.newton(b, target, limit, &mut solution.iterations) {
                (solution.p, solution.converged) = (p, attempt == 0);
                return solution;
            }
            law.friction = law.friction.map(|mu| 0.25 * mu);
        }
        law.friction = [0.0; PAIRS];
        for _ in 0..LAST_SWEEPS {
            law.sweep(b, &mut solution.p);
        }
        solution.converged = false;
        solution
    }
}

impl<'a> Law<'a> {
    /// The contacts of an operator with these planes; `friction` selects a coefficient of their surfaces.
    pub(super) fn new(
        operator: &'a DelassusOperator<PAIRS>,
        planes: &[Plane],
        friction: impl Fn(&Floor) -> f64,
        settings: &'a ContactSettings,
    ) -> Self {
        let mut law = Self {
            operator,
            settings,
            normal: NONE,
            friction: [0.0; PAIRS],
            norm: operator.bound(),
        };
        for i in 0..operator.count {
            let plane = &planes[usize::from(operator.place[i]) / 8];
            law.normal[i] = plane.shape.normal;
            law.friction[i] = friction(&plane.surface);
        }
        law
    }

    /// One contact after the other takes the impulse that its own block of W asks for.
    fn sweep(&self, b: &Each, p: &mut Each) {
        let operator = self.operator;
        let (mut v, mut omega) = operator.twist(p);
        for i in 0..operator.count {
            let (r, n) = (operator.lever[i], self.normal[i]);
            let answer = |p: DVec3| operator.inverse_inertia * r.cross(p);
            let w = b[i] + (v + omega.cross(r));
            let own = if self.friction[i] == 0.0 {
                operator.inverse_mass + answer(n).cross(r).dot(n)
            } else {
                // A bound of the block.
                let j = &operator.inverse_inertia;
                let trace = j.x_axis.x + j.y_axis.y + j.z_axis.z;
                operator.inverse_mass + trace * r.length_squared()
            };
            let next = self.project(i, p[i] - w / own);
            let change = next - p[i];
            v += change * operator.inverse_mass;
            omega += answer(change);
            p[i] = next;
        }
    }

    /// The impulses to |w| within `target`, unless `iterations` comes to `limit`.
    fn newton(&self, b: &Each, target: f64, limit: u32, iterations: &mut u32) -> Option<Each> {
        let mut start = NONE;
        let mut swept = 0;
        for sweeps in SWEEPS {
            while swept < sweeps && *iterations < limit {
                self.sweep(b, &mut start);
                swept += 1;
                *iterations += 1;
            }
            let found = descend(self, b, target, &start, limit, iterations);
            if found.is_some() {
                return found;
            }
        }
        None
    }
}
