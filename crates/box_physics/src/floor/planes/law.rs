//! Coulomb's law for contacts with several normals: the law of `cone`, each contact with its own normal n and friction,
//! solved by the same Newton method on the twist of the body (`cone::newton` has the derivation).
//!
//! With P the projection onto the cone of a contact the law says F = p − P(q) = 0, q = p − ρw, w = b + αWp. The steps
//! start from zero impulses, or from what projected Gauss–Seidel sweeps make of them (M. Jean, Comput. Methods Appl.
//! Mech. Eng. 177 (1999) 235), and of the impulses that do the same they take the smallest.

use glam::{DMat3, DVec3};

use super::contacts::{Contacts, Each, NONE, PAIRS};
use crate::floor::ContactSettings;
use crate::floor::cone::newton::eliminate;

/// The part that a step leaves.
const EPSILON: f64 = 1e-8;
/// ρ in units of one over the norm, in the order in which they are tried.
const SCALES: [f64; 7] = [1.0, 10.0, 0.1, 100.0, 0.01, 1e3, 1e-3];
/// Sweeps that lead to the starts.
const SWEEPS: [u32; 4] = [0, 10, 100, 400];
/// Newton steps from one start; of these as many may not descend; the smallest part of one that is tried.
const STEPS: u32 = 40;
const UPHILL: u32 = 4;
const SMALLEST: f64 = 1.0 / 256.0;
/// Sweeps without friction, where nothing else converged: each takes energy, however few there are.
const LAST_SWEEPS: u32 = 1000;

/// What the solver found.
pub(super) struct Solution {
    /// The impulses p \[N s\].
    pub(super) p: Each,
    pub(super) iterations: u32,
    /// Whether the law holds to the tolerance.
    pub(super) converged: bool,
}

/// The law at some contacts.
#[derive(Clone, Copy)]
pub(super) struct Law<'a> {
    pub(super) contacts: &'a Contacts,
    pub(super) alpha: f64,
    /// Of the contacts.
    pub(super) friction: [f64; PAIRS],
    pub(super) settings: &'a ContactSettings,
    norm: f64,
}

impl<'a> Law<'a> {
    pub(super) fn new(
        contacts: &'a Contacts,
        alpha: f64,
        friction: [f64; PAIRS],
        settings: &'a ContactSettings,
    ) -> Self {
        Self {
            contacts,
            alpha,
            friction,
            settings,
            norm: alpha * contacts.norm_bound(),
        }
    }

    /// Solves it for `b`. What does not converge is solved with less friction, and at last with none; it never gains
    /// energy, and `converged` tells that it had to give way.
    pub(super) fn solve(&self, b: &Each) -> Solution {
        let contacts = self.contacts;
        let mut solution = Solution {
            p: NONE,
            iterations: 0,
            converged: true,
        };
        if (0..contacts.count).all(|i| contacts.normal[i].dot(b[i]) >= 0.0) {
            return solution; // nothing approaches: p = 0 is the solution
        }
        let target = self.settings.tolerance * contacts.largest(b);
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

    /// b + αWp.
    pub(super) fn velocities(&self, b: &Each, p: &Each) -> Each {
        let (v, omega) = self.contacts.twist(p);
        let change = self
            .contacts
            .velocities((self.alpha * v, self.alpha * omega));
        let mut w = *b;
        for i in 0..self.contacts.count {
            w[i] += change[i];
        }
        w
    }

    /// The normal part made positive, the tangential one cut to the disc that belongs to it.
    fn project(&self, i: usize, p: DVec3) -> DVec3 {
        let normal = self.contacts.normal[i];
        let n = normal.dot(p).max(0.0);
        let along = self.contacts.along(i, p);
        let (length, limit) = (along.length(), self.friction[i] * n);
        if length <= limit {
            n * normal + along
        } else {
            n * normal + along * (limit / length)
        }
    }

    /// One contact after the other takes the impulse that its own block of αW asks for.
    fn sweep(&self, b: &Each, p: &mut Each) {
        let contacts = self.contacts;
        let (mut v, mut omega) = contacts.twist(p);
        for i in 0..contacts.count {
            let (r, n) = (contacts.lever[i], contacts.normal[i]);
            let answer = |p: DVec3| contacts.inverse_inertia * r.cross(p);
            let w = b[i] + self.alpha * (v + omega.cross(r));
            let own = if self.friction[i] == 0.0 {
                contacts.inverse_mass + answer(n).cross(r).dot(n)
            } else {
                // A bound of the block.
                let j = &contacts.inverse_inertia;
                let trace = j.x_axis.x + j.y_axis.y + j.z_axis.z;
                contacts.inverse_mass + trace * r.length_squared()
            };
            let next = self.project(i, p[i] - w / (self.alpha * own));
            let change = next - p[i];
            v += change * contacts.inverse_mass;
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
            for scale in SCALES {
                let problem = Problem {
                    law: self,
                    b,
                    rho: scale / self.norm,
                    // |F| falls with ρ, at most in proportion.
                    tolerance: target / self.norm * scale.min(1.0),
                };
                let found = problem.descend(start, limit, iterations);
                if found.is_some() {
                    return found;
                }
            }
        }
        None
    }
}

struct Problem<'a> {
    law: &'a Law<'a>,
    b: &'a Each,
    rho: f64,
    /// |F| that is left.
    tolerance: f64,
}

/// Impulses, with q, F and |F|² there.
struct Point {
    p: Each,
    q: Each,
    f: Each,
    square: f64,
}

impl Problem<'_> {
    /// The zero of F that is reached from `start`.
    fn descend(&self, start: Each, limit: u32, iterations: &mut u32) -> Option<Each> {
        let mut here = self.at(&start, &start, 0.0);
        let mut uphill = 0;
        for _ in 0..STEPS.min(limit.saturating_sub(*iterations)) {
            *iterations += 1;
            let step = self.step(&here);
            let mut next = self.at(&here.p, &step, 1.0);
            // Found: then one step more, to rounding.
            let found = |point: &Point, part: f64| {
                self.law.contacts.largest(&point.f) <= part * self.tolerance
            };
            if found(&next, 1e-2) || found(&here, 1.0) {
                let end = if next.square < here.square {
                    next
                } else {
                    here
                };
                let mut p = end.p;
                for i in 0..self.law.contacts.count {
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

    /// A part of a step further.
    fn at(&self, p: &Each, step: &Each, size: f64) -> Point {
        let n = self.law.contacts.count;
        let mut p = *p;
        for i in 0..n {
            p[i] += size * step[i];
        }
        let w = self.law.velocities(self.b, &p);
        let (mut q, mut f) = (NONE, NONE);
        for i in 0..n {
            q[i] = p[i] - self.rho * w[i];
            f[i] = p[i] - self.law.project(i, q[i]);
        }
        let square = self.law.contacts.dot(&f, &f);
        Point { p, q, f, square }
    }

    /// The change of the impulses dp = −c − S u.
    fn step(&self, here: &Point) -> Each {
        let (law, contacts) = (self.law, self.law.contacts);
        let n = contacts.count;
        // In units of the first lever's length, so that forces and torques compare.
        let unit = contacts.lever[0].length();
        let (mut c, mut s) = (NONE, [DMat3::ZERO; PAIRS]);
        // A = α Σ Gᵀ S G in blocks, and −Σ Gᵀ c
        let mut a = [[DMat3::ZERO; 2]; 2];
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        for i in 0..n {
            (c[i], s[i]) = self.linear(i, here.q[i], here.f[i]);
            let r = contacts.lever[i] / unit;
            let turned = |m: &DMat3| {
                DMat3::from_cols(r.cross(m.x_axis), r.cross(m.y_axis), r.cross(m.z_axis))
            };
            let direct = law.alpha * s[i];
            let arm = turned(&direct.transpose()).transpose(); // −αS [r]×
            force -= c[i];
            torque -= r.cross(c[i]);
            a[0][0] += direct;
            a[0][1] += arm;
            a[1][0] += turned(&direct);
            a[1][1] += turned(&arm);
        }
        // (1 + A M⁻¹) y = −Σ Gᵀ c for the force and torque y
        let inverse_inertia = contacts.inverse_inertia * (unit * unit);
        let mut rows = [[0.0; 7]; 6];
        for (k, row) in rows.iter_mut().enumerate() {
            let [direct, arm] = a[k / 3];
            let left = [direct * contacts.inverse_mass, arm * inverse_inertia];
            for column in 0..6 {
                row[column] = left[column / 3].col(column % 3)[k % 3];
            }
            row[k] += 1.0;
            row[6] = if k < 3 { force[k] } else { torque[k - 3] };
        }
        let y = eliminate(rows);
        let v = DVec3::new(y[0], y[1], y[2]) * contacts.inverse_mass;
        let omega = inverse_inertia * DVec3::new(y[3], y[4], y[5]) / unit;
        let u = contacts.velocities((law.alpha * v, law.alpha * omega));
        let mut step = NONE;
        for i in 0..n {
            step[i] = -(c[i] + s[i] * u[i]);
        }
        step
    }

    /// c and S of one contact.
    fn linear(&self, i: usize, q: DVec3, f: DVec3) -> (DVec3, DMat3) {
        let (normal, mu, rho) = (self.law.contacts.normal[i], self.law.friction[i], self.rho);
        let height = normal.dot(q);
        let tangential = self.law.contacts.along(i, q);
        let slip = tangential.length();
        if height <= 0.0 {
            return (f, DMat3::ZERO);
        }
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        if mu == 0.0 {
            // The part along the plane is gone at once.
            let up = normal.dot(f) / EPSILON;
            let c = normal * up + self.law.contacts.along(i, f);
            return (c, outer(normal * (rho / EPSILON), normal));
        }
        if slip <= mu * height {
            let s = DMat3::from_diagonal(DVec3::splat(rho / EPSILON));
            return (f / EPSILON, s);
        }
        let along = tangential / slip;
        let across = normal.cross(along);
        let kappa = mu * height / slip;
        let loose = 1.0 / (1.0 - kappa).max(EPSILON);
        let up = normal.dot(f) / EPSILON;
        let c = normal * up + along * (mu * up + f.dot(along)) + across * (f.dot(across) * loose);
        let push = (normal + mu * (1.0 + EPSILON) * along) * (rho / EPSILON);
        let turn = across * (rho * kappa * loose);
        (c, outer(push, normal) + outer(turn, across))
    }
}
