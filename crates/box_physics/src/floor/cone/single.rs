//! One corner with Coulomb's friction, solved directly.

use core::f64::consts::TAU;
use std::sync::LazyLock;

use glam::{DMat3, DVec3};

use crate::math::sin_cos;

/// Directions tried for the slip: the function whose root it is has degree two in them, so between
/// neighbors there is hardly ever more than one of its at most four roots. If none is found, two lie
/// close together: more directions.
const DIRECTIONS: [usize; 2] = [24, 120];

/// Newton steps from the slip before, and the largest turn in one of them \[rad\].
const NEAR_STEPS: u32 = 8;
const LARGEST_TURN: f64 = 0.5;

/// (cos, sin) of these directions, the first one again at the end.
static CIRCLES: LazyLock<[Vec<(f64, f64)>; 2]> = LazyLock::new(|| {
    DIRECTIONS.map(|n| {
        let direction = |i: usize| {
            let (s, c) = sin_cos(TAU * i as f64 / n as f64);
            (c, s)
        };
        (0..=n).map(direction).collect()
    })
});

/// The impulse p with w = b + Wp that obeys the law of one corner, if it is found; `w` is positive definite.
///
/// Sticking, p = −W⁻¹b, if that lies in the cone. Otherwise it slips along an unknown unit t̂:
/// p = p_n(n − µt̂), and w_n = 0 gives p_n = −b_n/D with D(t̂) = W_nn − µ W_nt·t̂. What remains is
/// w_t ∥ t̂: with a(t̂) = D b_t − b_n (W_tn − µ W_tt t̂) = D w_t a root of t̂ × a = 0 with t̂·a > 0, D > 0. (The slip
/// turns during the impulse: −b_t for its direction is up to 74 % wrong.)
pub(super) fn solve(w: &DMat3, b: DVec3, friction: f64) -> Option<DVec3> {
    if b.y >= 0.0 {
        return Some(DVec3::ZERO);
    }
    let stick = -(w.inverse() * b);
    let tangential = stick.x * stick.x + stick.z * stick.z;
    if stick.y > 0.0 && tangential <= (friction * stick.y) * (friction * stick.y) {
        return Some(stick);
    }
    slide(w, b, friction)
}

/// The impulse if the corner slides; `w` may be singular.
pub(super) fn slide(w: &DMat3, b: DVec3, friction: f64) -> Option<DVec3> {
    if b.y >= 0.0 {
        return None;
    }
    let slip = Slip { w, b, friction };
    slip.near()
        .or_else(|| CIRCLES.iter().find_map(|directions| slip.among(directions)))
}

/// The corner slips: everything as a function of the unit direction t = (c, s).
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

    /// t̂ × a and t̂·a.
    #[inline(always)]
    fn parts(&self, (c, s): (f64, f64)) -> (f64, f64) {
        let (_, x, z) = self.along((c, s));
        (c * z - s * x, c * x + s * z)
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

    /// The sliding solution by Newton's method from a direction that is likely: the slip before, as most turn
    /// little; after the normal impulse alone; against the friction that would stop it.
    fn near(&self) -> Option<DVec3> {
        let (w, b) = (self.w, self.b);
        let starts = [
            |_: &DMat3, b: DVec3| b,
            |w: &DMat3, b: DVec3| b - w.y_axis * (b.y / w.y_axis.y),
            |w: &DMat3, b: DVec3| w.inverse() * b,
        ];
        starts.iter().find_map(|start| self.near_to(start(w, b)))
    }

    fn near_to(&self, slip: DVec3) -> Option<DVec3> {
        let speed = (slip.x * slip.x + slip.z * slip.z).sqrt();
        let mut t = (slip.x / speed, slip.z / speed);
        for _ in 0..NEAR_STEPS {
            let (value, slope) = self.turn(t);
            let step = -value / slope;
            if step.is_nan() || step.abs() > LARGEST_TURN {
                return None;
            }
            t = on_circle(t.0 - step * t.1, t.1 + step * t.0);
            // The next would be the square of this.
            if step.abs() <= 1e-8 {
                return self.impulse(t);
            }
        }
        None
    }

    /// The impulse against the slip along t, if that is where it goes.
    fn impulse(&self, t: (f64, f64)) -> Option<DVec3> {
        let (d, x, z) = self.along(t);
        (d > 0.0 && t.0 * x + t.1 * z >= 0.0).then(|| {
            let normal = -self.b.y / d;
            let along = -self.friction * normal;
            DVec3::new(along * t.0, normal, along * t.1)
        })
    }

    /// The sliding solution, its root looked for between neighbors of these directions.
    fn among(&self, directions: &[(f64, f64)]) -> Option<DVec3> {
        let mut last = directions[0];
        let (mut turn, mut forward) = self.parts(last);
        let mut best: Option<(f64, DVec3)> = None;
        for &next in &directions[1..] {
            let (next_turn, next_forward) = self.parts(next);
            // At a root t̂·a is |a| or −|a|, and only the former will do: where it is negative on both
            // sides there is nothing to find.
            let crosses = turn == 0.0 || (turn < 0.0) != (next_turn < 0.0);
            if crosses && (forward >= 0.0 || next_forward >= 0.0) {
                let t = self.root((last, turn), next);
                // Of several the one that turns the slip least.
                let likeness = t.0 * self.b.x + t.1 * self.b.z;
                if let Some(p) = self.impulse(t)
                    && best.is_none_or(|(l, _)| likeness > l)
                {
                    best = Some((likeness, p));
                }
            }
            (last, turn, forward) = (next, next_turn, next_forward);
        }
        best.map(|(_, p)| p)
    }

    /// A root of t̂ × a between two neighboring directions: Newton's method from the middle, kept between
    /// the two by halving where it would leave them. Every point is put back on the circle.
    fn root(&self, (mut low, low_value): ((f64, f64), f64), mut high: (f64, f64)) -> (f64, f64) {
        if low_value == 0.0 {
            return low;
        }
        let mut t = on_circle(low.0 + high.0, low.1 + high.1);
        for _ in 0..60 {
            let (value, slope) = self.turn(t);
            if value == 0.0 {
                return t;
            }
            if (value < 0.0) == (low_value < 0.0) {
                low = t;
            } else {
                high = t;
            }
            let step = -value / slope;
            let newton = on_circle(t.0 - step * t.1, t.1 + step * t.0);
            if step.abs() <= 2.0 * f64::EPSILON {
                return newton;
            }
            let between = cross(low, newton) > 0.0 && cross(newton, high) > 0.0;
            t = if between {
                newton
            } else {
                on_circle(low.0 + high.0, low.1 + high.1)
            };
            if t == low || t == high {
                return t;
            }
        }
        t
    }
}

/// Sine of the angle from `a` to `b`.
#[inline(always)]
fn cross(a: (f64, f64), b: (f64, f64)) -> f64 {
    a.0 * b.1 - a.1 * b.0
}

#[inline(always)]
pub(super) fn on_circle(c: f64, s: f64) -> (f64, f64) {
    let scale = 1.0 / (c * c + s * s).sqrt();
    (c * scale, s * scale)
}
