//! One corner with Coulomb's friction, solved directly.

use core::f64::consts::TAU;
use std::sync::LazyLock;

use glam::{DMat3, DVec3};

use crate::math::sin_cos;

/// Directions tried for the slip: the function whose root it is has degree two in them, so between
/// neighbours there is hardly ever more than one of its at most four roots. If none is found, two lie
/// close together: more directions.
const DIRECTIONS: [usize; 2] = [24, 120];

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

/// The impulse p with w = b + Wp that obeys the law of one corner, and whether it was found; `w` is
/// positive definite.
///
/// Sticking, p = −W⁻¹b, if that lies in the cone. Otherwise it slips along an unknown unit t̂:
/// p = p_n(n − µt̂), and w_n = 0 gives p_n = −b_n/D with D(t̂) = W_nn − µ W_nt·t̂. What remains is
/// w_t ∥ t̂: with a(t̂) = D b_t − b_n (W_tn − µ W_tt t̂) = D w_t a root of t̂ × a = 0 with t̂·a > 0, D > 0. (The slip
/// turns during the impulse: −b_t for its direction is up to 74 % wrong.)
pub(super) fn solve(w: &DMat3, b: DVec3, friction: f64) -> (DVec3, bool) {
    if b.y >= 0.0 {
        return (DVec3::ZERO, true);
    }
    let smooth = DVec3::Y * (-b.y / w.y_axis.y);
    if friction == 0.0 {
        return (smooth, true);
    }
    let stick = -(w.inverse() * b);
    let tangential = stick.x * stick.x + stick.z * stick.z;
    if stick.y > 0.0 && tangential <= (friction * stick.y) * (friction * stick.y) {
        return (stick, true);
    }
    // For a unit t = (c, s): (D, a_x, a_z).
    let along = |c: f64, s: f64| {
        let q = w.y_axis - friction * (c * w.x_axis + s * w.z_axis);
        (q.y, q.y * b.x - b.y * q.x, q.y * b.z - b.y * q.z)
    };
    let turn = |c: f64, s: f64| {
        let (_, x, z) = along(c, s);
        c * z - s * x
    };
    for directions in CIRCLES.iter() {
        if let Some(p) = slide(b, friction, directions, &along, &turn) {
            return (p, true);
        }
    }
    (smooth, false)
}

/// The sliding solution among so many directions.
fn slide(
    b: DVec3,
    friction: f64,
    directions: &[(f64, f64)],
    along: &impl Fn(f64, f64) -> (f64, f64, f64),
    turn: &impl Fn(f64, f64) -> f64,
) -> Option<DVec3> {
    let (mut c0, mut s0) = (1.0, 0.0);
    let mut f0 = turn(c0, s0);
    let mut best: Option<(f64, DVec3)> = None;
    for &(c1, s1) in &directions[1..] {
        let f1 = turn(c1, s1);
        if f0 == 0.0 || (f0 < 0.0) != (f1 < 0.0) {
            let (c, s) = root((c0, s0, f0), (c1, s1, f1), turn);
            let (d, x, z) = along(c, s);
            let forward = c * x + s * z;
            // Of several the one that turns the slip least.
            let likeness = c * b.x + s * b.z;
            if d > 0.0 && forward >= 0.0 && best.is_none_or(|(l, _)| likeness > l) {
                let normal = -b.y / d;
                let p = DVec3::new(-friction * c * normal, normal, -friction * s * normal);
                best = Some((likeness, p));
            }
        }
        (c0, s0, f0) = (c1, s1, f1);
    }
    best.map(|(_, p)| p)
}

/// A root between two neighbouring directions: false position (Illinois) on the chord, every point put
/// back on the circle.
fn root(
    (mut c0, mut s0, mut f0): (f64, f64, f64),
    (mut c1, mut s1, mut f1): (f64, f64, f64),
    f: &impl Fn(f64, f64) -> f64,
) -> (f64, f64) {
    for _ in 0..60 {
        let share = if f0 == f1 { 0.5 } else { f0 / (f0 - f1) };
        let (c, s) = (c0 + share * (c1 - c0), s0 + share * (s1 - s0));
        let length = (c * c + s * s).sqrt();
        let (c, s) = (c / length, s / length);
        let value = f(c, s);
        let width = (c1 - c0).abs() + (s1 - s0).abs();
        if value == 0.0 || width <= 4.0 * f64::EPSILON {
            return (c, s);
        }
        let at_edge = (c == c0 && s == s0) || (c == c1 && s == s1);
        if (value < 0.0) == (f1 < 0.0) {
            (c1, s1, f1) = (c, s, value);
            f0 *= 0.5;
        } else {
            (c0, s0, f0) = (c, s, value);
            f1 *= 0.5;
        }
        if at_edge {
            return (c, s);
        }
    }
    let (c, s) = (c0 + c1, s0 + s1);
    let length = (c * c + s * s).sqrt();
    (c / length, s / length)
}
