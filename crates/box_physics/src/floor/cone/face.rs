//! Three or four corners of a face with Coulomb's friction, where they do not all move alike.
//!
//! - **All slide**: then no corner moves along the normal, so the box turns about the normal alone, and its
//!   velocity V at the center and its spin Ω tell every slip, w_k = V + Ω n×r_k. Given these, p_k = π_k s_k,
//!   s_k = n − µ w_k/|w_k|, and the normal law is three linear equations for the π_k, of which the smallest are
//!   taken. The impulses give V and Ω anew. Only the direction u of (V, Ω) enters, so that what is asked for is
//!   the u that leads to itself: two angles, found by Broyden's method (Math. Comput. 19 (1965) 577) from the
//!   motion without friction, however little of it friction leaves.
//! - **All stick**: a linear problem.
//! - **Two leave**: the other two are an edge.
//!
//! What is found must obey the law of all corners to be taken.

use glam::{DMat2, DMat3, DVec2, DVec3};

use super::super::geometry::{Corner3, DelassusOperator};
use super::edge::Edge;
use super::project;

/// Steps of u: slips that turn little take five.
const STEPS: u32 = 24;
/// How often the friction is shared out anew.
const SHARINGS: u32 = 8;
/// The largest of them, and the one by which the slope is found \[rad\].
const LARGEST_TURN: f64 = 0.7;
const SMALL: f64 = 1e-4;

/// b + αWp for the corners of a face.
pub(super) struct Face<'a> {
    pub(super) operator: &'a DelassusOperator,
    pub(super) b: &'a Corner3,
    pub(super) alpha: f64,
    pub(super) friction: f64,
    /// |w| to which the law is to hold [m/s].
    pub(super) target: f64,
}

impl Face<'_> {
    /// The impulses, if one of the cases fits: the likeliest first.
    pub(super) fn solve(&self) -> Option<Corner3> {
        let fast = self.is_fast();
        if fast && let Some(p) = self.slide() {
            return Some(p);
        }
        let stop = self.stop();
        if self.sticks(&stop) {
            return Some(stop);
        }
        self.two_leave(&stop)
            .or_else(|| if fast { None } else { self.slide() })
    }

    /// Whether the slips are so fast that all corners sliding on is the likeliest.
    fn is_fast(&self) -> bool {
        let b = &self.b[..self.operator.count];
        let slow = b.iter().map(|u| u.x * u.x + u.z * u.z);
        let approach = b.iter().fold(0.0, |a: f64, u| a.max(-u.y));
        let bound = 4.0 * self.friction * approach;
        slow.fold(f64::INFINITY, f64::min) > bound * bound
    }

    /// w = b + αWp.
    fn velocities(&self, p: &Corner3) -> Corner3 {
        super::add(
            self.b,
            &self.operator.response(p),
            self.alpha,
            self.operator.count,
        )
    }

    /// The criterion of the gradient steps: L |p − P(p − w/L)| is the tolerated error of w.
    fn obeys(&self, p: &Corner3) -> bool {
        let w = self.velocities(p);
        let norm = self.alpha * self.operator.norm_bound();
        let mut worst = 0.0_f64;
        for i in 0..self.operator.count {
            let q = project(p[i] - w[i] / norm, self.friction);
            worst = worst.max((p[i] - q).length_squared());
        }
        norm * worst.sqrt() <= self.target
    }

    /// The impulses that stop all corners, the normal ones the smallest that do, the friction handed to the
    /// corners by their load.
    ///
    /// The change of (v, ω) that stops them, and with it the sum and the torque of the impulses, follow from b.
    /// The levers have one height, so that the two parts separate: π_k = A + B·r_k with the right sum and the
    /// right torque about the horizontal axes, and t_k = π_k² (C + D n×r_k) with the right sum and torque
    /// about the normal, the smallest in units of what a corner can hold. Where that is too much for one, those
    /// that can hold more are given more (Lawson's weights for the least maximum: C. L. Lawson, UCLA 1961).
    fn stop(&self) -> Corner3 {
        let (operator, n) = (self.operator, self.operator.count);
        let (r, b) = (&operator.lever, self.b);
        // −b as a motion of the floor's plane: opposite corners are neighbors, so 0, 1 and 2 span it.
        let (e, f) = (r[1] - r[0], r[2] - r[0]);
        let area = e.z * f.x - e.x * f.z;
        let (p, q) = (b[1].y - b[0].y, b[2].y - b[0].y);
        let slide = self.planar([b[0], b[1]]);
        let spin = self.spin_of(slide);
        // u_y = v_y + ω_z x − ω_x z
        let omega = -DVec3::new((e.x * q - f.x * p) / area, spin, (e.z * q - f.z * p) / area);
        let v = DVec3::new(-slide.x, -b[0].y, -slide.y) - omega.with_y(0.0).cross(r[0]);
        let (force, torque) = operator.impulse_for(v, omega);
        let (force, torque) = (force / self.alpha, torque / self.alpha);

        let height = r[0].y;
        let mut gram = DMat3::ZERO;
        for r in &r[..n] {
            let a = DVec3::new(1.0, r.x, r.z);
            gram += DMat3::from_cols(a * a.x, a * a.y, a * a.z);
        }
        let wanted = DVec3::new(
            force.y,
            torque.z + height * force.x,
            height * force.z - torque.x,
        );
        let load = gram.inverse() * wanted;
        let mut p = [DVec3::ZERO; 8];
        for (p, r) in p[..n].iter_mut().zip(r) {
            p.y = load.x + load.y * r.x + load.z * r.z;
        }
        let wanted = DVec3::new(force.x, force.z, torque.y);
        let mut weight = [0, 1, 2, 3].map(|i| p[i].y * p[i].y);
        for _ in 0..SHARINGS {
            let mut gram = DMat3::ZERO;
            for (weight, r) in weight[..n].iter().zip(r) {
                for a in [DVec3::new(1.0, 0.0, r.z), DVec3::new(0.0, 1.0, -r.x)] {
                    gram += *weight * DMat3::from_cols(a * a.x, a * a.y, a * a.z);
                }
            }
            let share = gram.inverse() * wanted;
            let mut most = 0.0_f64;
            for i in 0..n {
                p[i].x = weight[i] * (share.x + share.z * r[i].z);
                p[i].z = weight[i] * (share.y - share.z * r[i].x);
                let part = (p[i].x * p[i].x + p[i].z * p[i].z).sqrt() / (self.friction * p[i].y);
                most = if p[i].y > 0.0 {
                    most.max(part)
                } else {
                    f64::INFINITY
                };
                weight[i] /= part;
            }
            if most <= 1.0 || most > 1.5 {
                break;
            }
        }
        p
    }

    /// Whether these impulses hold every corner. That they stop it is checked only roughly, since what is left
    /// is the rounding of b: to see whether the corners can be stopped at all, which those that are to
    /// bounce differently cannot.
    fn sticks(&self, stop: &Corner3) -> bool {
        let left = self.operator.largest(&self.velocities(stop));
        super::in_cones(self.operator, stop, self.friction)
            && left <= 1e-9 * self.operator.largest(self.b)
    }

    /// Two corners leave: those that would have to pull most if all were stopped.
    fn two_leave(&self, stop: &Corner3) -> Option<Corner3> {
        let n = self.operator.count;
        let mut order = [0, 1, 2, 3];
        order[..n].sort_by(|&i, &j| stop[j].y.total_cmp(&stop[i].y));
        let pair = [order[0].min(order[1]), order[0].max(order[1])];
        let pair_operator = self.operator.part(1 << pair[0] | 1 << pair[1]);
        let mut b = [DVec3::ZERO; 8];
        (b[0], b[1]) = (self.b[pair[0]], self.b[pair[1]]);
        let edge = Edge::new(&pair_operator, &b, self.alpha, self.friction, self.target);
        let [first, second] = edge.solve()?;
        let mut p = [DVec3::ZERO; 8];
        (p[pair[0]], p[pair[1]]) = (first, second);
        self.obeys(&p).then_some(p)
    }

    /// All slide.
    fn slide(&self) -> Option<Corner3> {
        let start = self.planar([self.b[0], self.b[1]]);
        let mut u = start.try_normalize()?;
        // Two axes across u, along which it is turned.
        let mut across = u.any_orthonormal_pair();
        let residual = |x: DVec3, (e, f): (DVec3, DVec3)| DVec2::new(e.dot(x), f.dot(x));
        let (mut p, mut x) = self.sliding(u);
        let mut r = residual(x, across);
        // The inverse of the slope of r; the x of fast slips is nearly constant.
        let mut inverse = if self.is_fast() {
            DMat2::from_diagonal(DVec2::splat(-1.0 / x.dot(u)))
        } else {
            let slope = |axis: DVec3| {
                let image = self.sliding(u + SMALL * axis).1;
                (residual(image, across) - r) / SMALL
            };
            let along = DMat2::from_diagonal(DVec2::splat(x.dot(u)));
            (DMat2::from_cols(slope(across.0), slope(across.1)) - along).inverse()
        };
        for _ in 0..STEPS {
            if r.abs().max_element() <= 0.1 * self.target {
                break;
            }
            let step = (-(inverse * r)).clamp_length_max(LARGEST_TURN);
            u = (u + step.x * across.0 + step.y * across.1).try_normalize()?;
            let first = across.0.reject_from_normalized(u).try_normalize()?;
            across = (first, u.cross(first));
            (p, x) = self.sliding(u);
            let now = residual(x, across);
            let image = inverse * (now - r);
            let denominator = step.dot(image);
            if denominator == 0.0 || !denominator.is_finite() {
                break;
            }
            // Sherman, Morrison: B⁻¹ += (s − B⁻¹y)(sᵀB⁻¹)/(sᵀB⁻¹y)
            let row = inverse.transpose() * step;
            let gain = (step - image) / denominator;
            inverse += DMat2::from_cols(gain * row.x, gain * row.y);
            r = now;
        }
        let mut all = [DVec3::ZERO; 8];
        all[..4].copy_from_slice(&p);
        (x.dot(u) > 0.0 && self.obeys(&all)).then_some(all)
    }

    /// Ω of (V_x, V_z, Ω ℓ).
    fn spin_of(&self, x: DVec3) -> f64 {
        let arm = self.operator.lever[1] - self.operator.lever[0];
        2.0 * x.z / (arm.x * arm.x + arm.z * arm.z).sqrt()
    }

    /// (V_x, V_z, Ω ℓ) of these velocities of the first two corners, ℓ half the diagonal.
    fn planar(&self, w: [DVec3; 2]) -> DVec3 {
        let arm = self.operator.lever[1] - self.operator.lever[0];
        let square = arm.x * arm.x + arm.z * arm.z;
        let change = w[1] - w[0];
        // (Ω n × arm)·: Ω (arm_z, −arm_x)
        let spin = (change.x * arm.z - change.z * arm.x) / square;
        let r = self.operator.lever[0];
        DVec3::new(
            w[0].x - spin * r.z,
            w[0].z + spin * r.x,
            0.5 * spin * square.sqrt(),
        )
    }

    /// The impulses for the slips along those that x tells, and the x that they lead to. (One may have to pull.)
    fn sliding(&self, x: DVec3) -> ([DVec3; 4], DVec3) {
        let (operator, n) = (self.operator, self.operator.count);
        let spin = self.spin_of(x);
        let mut s = [DVec3::Y; 4];
        let mut twist = [(DVec3::ZERO, DVec3::ZERO); 4];
        let mut normal = [DVec3::ZERO; 4];
        let mut gram = DMat3::ZERO;
        for j in 0..n {
            let r = operator.lever[j];
            let slip = DVec3::new(x.x + spin * r.z, 0.0, x.y - spin * r.x);
            s[j] -= slip * (self.friction / slip.length());
            // Column j of the normal law, at the first three corners.
            let (v, omega) = operator.unit_twist(j, s[j]);
            let at = |i: usize| v.y + omega.z * operator.lever[i].x - omega.x * operator.lever[i].z;
            let a = DVec3::new(at(0), at(1), at(2));
            gram += DMat3::from_cols(a * a.x, a * a.y, a * a.z);
            (twist[j], normal[j]) = ((v, omega), a);
        }
        let b = self.b;
        let wanted = DVec3::new(b[0].y, b[1].y, b[2].y) * (-1.0 / self.alpha);
        let multiplier = gram.inverse() * wanted;
        let mut share = [0, 1, 2, 3].map(|j| normal[j].dot(multiplier));
        let least = (0..n).fold(0, |l, j| if share[j] < share[l] { j } else { l });
        if n == 4 && share[least] < 0.0 {
            // It would have to pull: the other three bear all.
            let three = [1, 2, 3].map(|d| (least + d) % 4);
            let [a, b, c] = three.map(|j| normal[j]);
            let alone = DMat3::from_cols(a, b, c).inverse() * wanted;
            share[least] = 0.0;
            for i in 0..3 {
                share[three[i]] = alone[i];
            }
        }
        let mut p = [DVec3::ZERO; 4];
        let (mut v, mut omega) = (DVec3::ZERO, DVec3::ZERO);
        for j in 0..n {
            p[j] = s[j] * share[j];
            v += twist[j].0 * share[j];
            omega += twist[j].1 * share[j];
        }
        let w = [0, 1].map(|i| b[i] + self.alpha * (v + omega.cross(operator.lever[i])));
        (p, self.planar(w))
    }
}
