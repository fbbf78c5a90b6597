//! Two corners with Coulomb's friction: an edge, the most common problem without a closed form.
//!
//! Each corner sticks, slides or leaves. Every case is a small problem, and the case whose solution obeys Coulomb's law
//! applies. With A the blocks of W:
//!
//! - one leaves: p = 0 there, and the other is alone (`single`);
//! - both slide, along the unit vectors t̂_k: p_k = p_kn s_k, s_k = n − µt̂_k, and w_kn = 0 gives both p_kn from two
//!   linear equations. The two angles with t̂_k × w_kt = 0 remain: Newton's method;
//! - one sticks: w_i = 0 gives p_i = −A_ii⁻¹(b_i + A_ij p_j), and the other is alone with
//!   A_jj − A_ji A_ii⁻¹ A_ij;
//! - both stick: w = 0, a linear problem.

use glam::{DMat3, DVec3};

use super::super::projection::Pair;
use super::{Cone, answered, single};

/// Maximum number of Newton steps for the two angles; slips that turn little take three.
const STEPS: u32 = 12;
/// Largest turn in one of them \[rad\].
const LARGEST_TURN: f64 = 0.7;

/// b + Ap for two corners.
pub(super) struct Edge<'a> {
    pub(super) cone: &'a Cone<'a>,
    /// The blocks of A.
    pub(super) pair: &'a Pair,
    pub(super) b: [DVec3; 2],
    /// The impulses of a similar problem, or zero.
    pub(super) near: [DVec3; 2],
}

impl Edge<'_> {
    /// w = b + Ap.
    #[inline(always)]
    fn velocities(&self, p: [DVec3; 2]) -> [DVec3; 2] {
        [
            self.b[0] + (self.pair.own[0] * p[0] + self.pair.other[0] * p[1]),
            self.b[1] + (self.pair.own[1] * p[1] + self.pair.other[1] * p[0]),
        ]
    }

    /// Returns `true` if the slips are so fast that both corners most likely continue to slide.
    fn is_fast(&self) -> bool {
        let fast = |u: DVec3| u.x * u.x + u.z * u.z;
        let approach = (-self.b[0].y).max(-self.b[1].y);
        let bound = 4.0 * self.cone.friction * approach;
        fast(self.b[0]).min(fast(self.b[1])) > bound * bound
    }

    /// Returns the impulses of the first case that applies, in the order of likelihood.
    pub(super) fn solve(&self) -> Option<[DVec3; 2]> {
        let smooth = self.smooth_normals();
        let likely = usize::from(smooth[1] < smooth[0]);
        let leaves = smooth[likely] <= 0.0;
        let first = leaves.then(|| self.one_leaves(likely)).flatten();
        if first.is_some() {
            answered("edge: likeliest case");
            return first;
        }
        let start = self.first_directions(smooth);
        let start = start.and_then(|t| Some((t, self.sliding(t)?)));
        // Full friction that reverses no slip is the solution or close to it.
        let forward = !leaves && start.as_ref().is_some_and(|(_, s)| s.forward);
        if !leaves && !forward {
            let stuck = self.both_stick();
            if stuck.is_some() {
                answered("edge: likeliest case");
                return stuck;
            }
        }
        let case = ["edge: both slide", "edge: likeliest case"][usize::from(forward)];
        let slide = start.and_then(|(t, first)| self.slide(t, first));
        slide.inspect(|_| answered(case)).or_else(|| {
            let found = self.one_sticks(0).or_else(|| self.one_sticks(1));
            found.inspect(|_| answered("edge: one sticks"))
        })
    }

    /// The normal impulses that would stop both corners if there were no friction.
    fn smooth_normals(&self) -> [f64; 2] {
        let [a, d] = self.pair.own.map(|m| m.y_axis.y);
        let c = self.pair.other[0].y_axis.y;
        let inverse = 1.0 / (a * d - c * c);
        let (x, y) = (-self.b[0].y, -self.b[1].y);
        [inverse * (d * x - c * y), inverse * (a * y - c * x)]
    }

    /// Projects an impulse onto the cone: the normal part to ≥ 0, the tangential part to the disc of radius µ p_n.
    fn project(&self, p: DVec3) -> DVec3 {
        let n = p.y.max(0.0);
        let t = (p.x * p.x + p.z * p.z).sqrt();
        if t <= self.cone.friction * n {
            DVec3::new(p.x, n, p.z)
        } else {
            let scale = self.cone.friction * n / t;
            DVec3::new(scale * p.x, n, scale * p.z)
        }
    }

    /// Returns `true` if |p − P(p − w/L)| L is within the tolerance of w, with L the upper bound of W.
    fn obeys(&self, p: [DVec3; 2]) -> bool {
        let (w, norm) = (self.velocities(p), self.cone.operator.norm_bound());
        let step = 1.0 / norm;
        let wrong = |i: usize| (p[i] - self.project(p[i] - step * w[i])).length_squared();
        norm * wrong(0).max(wrong(1)).sqrt() <= self.cone.target
    }

    fn checked(&self, p: [DVec3; 2]) -> Option<[DVec3; 2]> {
        self.obeys(p).then_some(p)
    }

    /// The impulses if corner `i` leaves.
    fn one_leaves(&self, i: usize) -> Option<[DVec3; 2]> {
        let j = 1 - i;
        let mut p = [DVec3::ZERO; 2];
        p[j] = single::solve(
            &self.pair.own[j],
            self.b[j],
            self.cone.friction,
            self.near[j],
        )?;
        self.checked(p)
    }

    /// The impulses if both corners stick. No further check: corners at a constant distance can be stopped to the
    /// rounding of b. That may exceed the target if b is a small difference of large velocities.
    fn both_stick(&self) -> Option<[DVec3; 2]> {
        let mu = self.cone.friction;
        let holds = |p: &DVec3| p.y > 0.0 && p.x * p.x + p.z * p.z <= (mu * p.y) * (mu * p.y);
        Some(self.pair.stop(self.b, true)).filter(|p| p.iter().all(holds))
    }

    /// The impulses if corner `i` sticks and the other one slides.
    fn one_sticks(&self, i: usize) -> Option<[DVec3; 2]> {
        let inverse = self.pair.own[i].inverse();
        let (reduced, b) = self.pair.without(i, &inverse, self.b);
        let slide = single::slide(&reduced, b, self.cone.friction, self.near[1 - i])?;
        let mut p = [slide; 2];
        p[i] = -(inverse * (self.b[i] + self.pair.other[i] * slide));
        self.checked(p)
    }

    /// Estimated directions of slip. They oppose the friction of the similar problem if both corners slid there.
    /// Otherwise they follow `b` if it is fast, or else the frictionless solution. `None` if one does not slip.
    fn first_directions(&self, smooth: [f64; 2]) -> Option<[(f64, f64); 2]> {
        let plane = |u: DVec3| (u.x * u.x + u.z * u.z).sqrt();
        let full = |p: DVec3| p.y > 0.0 && plane(p) >= (1.0 - 1e-12) * self.cone.friction * p.y;
        let slip = if full(self.near[0]) && full(self.near[1]) {
            [-self.near[0], -self.near[1]]
        } else if self.is_fast() {
            [self.b[0], self.b[1]]
        } else {
            self.velocities(smooth.map(|p| DVec3::Y * p.max(0.0)))
        };
        let speed = slip.map(plane);
        let direction = |i: usize| (slip[i].x / speed[i], slip[i].z / speed[i]);
        (speed[0].min(speed[1]) > self.cone.target).then(|| [direction(0), direction(1)])
    }

    /// The impulses if both corners slide. `t` and `now` are the initial directions and their residuals.
    fn slide(&self, mut t: [(f64, f64); 2], mut now: Sliding) -> Option<[DVec3; 2]> {
        for _ in 0..STEPS {
            let (f, j) = (now.residual, now.slope);
            let determinant = j[0][0] * j[1][1] - j[0][1] * j[1][0];
            let turn = [
                (j[0][1] * f[1] - j[1][1] * f[0]) / determinant,
                (j[1][0] * f[0] - j[0][0] * f[1]) / determinant,
            ];
            let largest = turn[0].abs().max(turn[1].abs());
            if !largest.is_finite() {
                return None;
            }
            if largest <= 1e-15 {
                return (now.wrong <= self.cone.target).then_some(now.p);
            }
            let scale = (LARGEST_TURN / largest).min(1.0);
            for (t, turn) in t.iter_mut().zip(turn) {
                let step = scale * turn;
                *t = single::on_circle(t.0 - step * t.1, t.1 + step * t.0);
            }
            now = self.sliding(t)?;
            // Quadratic convergence: the next step would be negligible.
            if largest <= 1e-8 {
                return (now.wrong <= self.cone.target).then_some(now.p);
            }
        }
        None
    }

    /// Impulses and residuals for the two directions; `None` if a normal impulse would pull.
    fn sliding(&self, t: [(f64, f64); 2]) -> Option<Sliding> {
        let mu = self.cone.friction;
        // q_ij = A_ij s_j and its derivative by the angle of t̂_j
        let column = |a: &DMat3, (c, s): (f64, f64)| {
            (
                a.y_axis - mu * (c * a.x_axis + s * a.z_axis),
                mu * (s * a.x_axis - c * a.z_axis),
            )
        };
        let (q00, r00) = column(&self.pair.own[0], t[0]);
        let (q11, r11) = column(&self.pair.own[1], t[1]);
        let (q01, r01) = column(&self.pair.other[0], t[1]);
        let (q10, r10) = column(&self.pair.other[1], t[0]);
        let determinant = q00.y * q11.y - q01.y * q10.y;
        if determinant.is_nan() || determinant <= 0.0 {
            return None;
        }
        let inverse = 1.0 / determinant;
        let normals = |x: f64, y: f64| {
            (
                inverse * (q11.y * x - q01.y * y),
                inverse * (q00.y * y - q10.y * x),
            )
        };
        let (p0, p1) = normals(-self.b[0].y, -self.b[1].y);
        if !(p0 > 0.0 && p1 > 0.0) {
            return None;
        }
        let w0 = self.b[0] + (p0 * q00 + p1 * q01);
        let w1 = self.b[1] + (p1 * q11 + p0 * q10);
        // t̂ × w and t̂·w in the plane
        let cross = |(c, s): (f64, f64), w: DVec3| c * w.z - s * w.x;
        let along = |(c, s): (f64, f64), w: DVec3| c * w.x + s * w.z;
        // The derivative by the angle of t̂_0, then by that of t̂_1. The normal impulses depend on the angles.
        let (a0, a1) = normals(-p0 * r00.y, -p0 * r10.y);
        let (b0, b1) = normals(-p1 * r01.y, -p1 * r11.y);
        let slope = [
            [
                cross(t[0], p0 * r00 + a0 * q00 + a1 * q01) - along(t[0], w0),
                cross(t[0], p1 * r01 + b0 * q00 + b1 * q01),
            ],
            [
                cross(t[1], p0 * r10 + a0 * q10 + a1 * q11),
                cross(t[1], p1 * r11 + b0 * q10 + b1 * q11) - along(t[1], w1),
            ],
        ];
        let impulse = |p: f64, (c, s): (f64, f64)| DVec3::new(-mu * p * c, p, -mu * p * s);
        let (residual, forward) = (
            [cross(t[0], w0), cross(t[1], w1)],
            along(t[0], w0).min(along(t[1], w1)),
        );
        let across = residual[0].abs().max(residual[1].abs());
        Some(Sliding {
            p: [impulse(p0, t[0]), impulse(p1, t[1])],
            forward: forward > 0.0,
            residual,
            slope,
            wrong: (across + (1.0 + mu) * w0.y.abs().max(w1.y.abs())).max(-forward),
        })
    }
}

/// Both corners sliding along given directions.
#[derive(Clone, Copy)]
struct Sliding {
    p: [DVec3; 2],
    /// `true` if the slips point along the directions, not against them.
    forward: bool,
    /// t̂_k × w_k: zero if the slips are parallel to the directions.
    residual: [f64; 2],
    /// Derivatives of `residual` with respect to the two angles.
    slope: [[f64; 2]; 2],
    /// Violation of Coulomb's law [m/s].
    wrong: f64,
}
