//! One corner with Coulomb's friction, solved directly.

use glam::{DMat3, DVec3};

use super::answered;

/// Number of directions around the circle that are tried if no likely direction leads to a root, and cosine and sine of
/// the angle between two of them.
const DIRECTIONS: u32 = 16;
const TURN: (f64, f64) = (0.923_879_532_511_286_7, 0.382_683_432_365_089_8);

/// Maximum number of Newton steps from an estimated slip, and the largest turn in one of them \[rad\].
const NEAR_STEPS: u32 = 8;
const LARGEST_TURN: f64 = 0.5;

/// The impulse p with w = b + Wp that obeys Coulomb's law at one corner, or `None` if it is not found. `w` is positive
/// definite. `near` is the impulse of a similar problem, or zero.
///
/// The corner sticks, p = −W⁻¹b, if that is in the cone. Otherwise it slips along an unknown unit vector t̂: p = p_n(n
/// − µt̂), and w_n = 0 gives p_n = −b_n/D with D(t̂) = W_nn − µ W_nt·t̂. The condition w_t ∥ t̂ remains. With a(t̂) = D
/// b_t − b_n (W_tn − µ W_tt t̂) = D w_t, it is a root of t̂ × a = 0 with t̂·a > 0, D > 0. (The slip turns during the
/// impulse, so −b_t as its direction has an error of up to 74 %.)
pub(super) fn solve(w: &DMat3, b: DVec3, friction: f64, near: DVec3) -> Option<DVec3> {
    if b.y >= 0.0 {
        return Some(DVec3::ZERO);
    }
    let stick = -(w.inverse() * b);
    let tangential = stick.x * stick.x + stick.z * stick.z;
    if stick.y > 0.0 && tangential <= (friction * stick.y) * (friction * stick.y) {
        answered("corner: sticks");
        return Some(stick);
    }
    slide(w, b, friction, near)
}

/// The impulse if the corner slides; `w` may be singular.
pub(super) fn slide(w: &DMat3, b: DVec3, friction: f64, near: DVec3) -> Option<DVec3> {
    if b.y >= 0.0 {
        return None;
    }
    let slip = Slip { w, b, friction };
    let found = slip.near_to(-near).or_else(|| slip.near());
    found.inspect(|_| answered("corner: slides"))
}

/// Quantities of a slipping corner as functions of the unit direction t = (c, s).
struct Slip<'a> {
    w: &'a DMat3,
    b: DVec3,
    friction: f64,
}

impl Slip<'_> {
    /// D and a.
    #[inline(always)]
    fn along(&self, (c, s): (f64, f64)) -> (f64, f64, f64) {
        let (w, b) = (self.w, self.b);
        let q = w.y_axis - self.friction * (c * w.x_axis + s * w.z_axis);
        (q.y, q.y * b.x - b.y * q.x, q.y * b.z - b.y * q.z)
    }

    /// t̂ × a and its derivative by the angle.
    #[inline(always)]
    fn turn(&self, (c, s): (f64, f64)) -> (f64, f64) {
        let (w, b) = (self.w, self.b);
        let (_, x, z) = self.along((c, s));
        let dq = self.friction * (s * w.x_axis - c * w.z_axis);
        let (dx, dz) = (dq.y * b.x - b.y * dq.x, dq.y * b.z - b.y * dq.z);
        (c * z - s * x, (c * dz - s * z) - (s * dx + c * x))
    }

    /// The sliding solution by Newton's method from likely directions: the slip before the impact, the slip after the
    /// normal impulse alone, and the direction against the friction that would stop it.
    fn near(&self) -> Option<DVec3> {
        let (w, b) = (self.w, self.b);
        let starts = [
            |_: &DMat3, b: DVec3| b,
            |w: &DMat3, b: DVec3| b - w.y_axis * (b.y / w.y_axis.y),
            |w: &DMat3, b: DVec3| w.inverse() * b,
        ];
        let near = starts.iter().find_map(|start| self.near_to(start(w, b)));
        // In one of a hundred cases the slip has another direction.
        near.or_else(|| {
            let mut slip = DVec3::X;
            (0..DIRECTIONS).find_map(|_| {
                slip = DVec3::new(
                    TURN.0 * slip.x - TURN.1 * slip.z,
                    0.0,
                    TURN.1 * slip.x + TURN.0 * slip.z,
                );
                self.near_to(slip)
            })
        })
    }

    fn near_to(&self, slip: DVec3) -> Option<DVec3> {
        let speed = (slip.x * slip.x + slip.z * slip.z).sqrt();
        if speed == 0.0 {
            return None;
        }
        let mut t = (slip.x / speed, slip.z / speed);
        for _ in 0..NEAR_STEPS {
            let (value, slope) = self.turn(t);
            let step = -value / slope;
            if step.is_nan() || step.abs() > LARGEST_TURN {
                return None;
            }
            t = on_circle(t.0 - step * t.1, t.1 + step * t.0);
            // Quadratic convergence: the next step would be negligible.
            if step.abs() <= 1e-8 {
                return self.impulse(t);
            }
        }
        None
    }

    /// The impulse against the slip along t, or `None` if the corner would slip the other way.
    fn impulse(&self, t: (f64, f64)) -> Option<DVec3> {
        let (d, x, z) = self.along(t);
        (d > 0.0 && t.0 * x + t.1 * z >= 0.0).then(|| {
            let normal = -self.b.y / d;
            let along = -self.friction * normal;
            DVec3::new(along * t.0, normal, along * t.1)
        })
    }
}

#[inline(always)]
pub(super) fn on_circle(c: f64, s: f64) -> (f64, f64) {
    let scale = 1.0 / (c * c + s * s).sqrt();
    (c * scale, s * scale)
}
