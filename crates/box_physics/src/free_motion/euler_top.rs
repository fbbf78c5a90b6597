//! The torque-free rotation over one step as an explicit algebraic map: no iteration, no branch, no memory.
//!
//! The rotation with the middle moment I_r, `exp(h J_r L)`, commutes with the rest and is applied exactly
//! (Fassò, J. Comput. Phys. 189 (2003) 527). The remaining top has J = 1/I − 1/I_r, with one component 0:
//!
//! ```text
//! L_i' = g_i L_j L_k,    g_i = J_k − J_j,    2C = |L|²,   2H = Σ J_i L_i²        i, j, k cyclic
//! ε_i − ε_j = 2 g_k (J_k C − H),  Σ ε = 0:   ξ = g_j g_k L_i² + ε_i is the same for all i
//! ```
//!
//! and ξ' ² = 4 Π (ξ − ε_i), so ξ is Weierstrass' ℘ of the time. The addition theorem of ℘ gives the motion.
//! With P_i² = W − z² ε_i, W = z² ℘(z), z = h/2, and M the momentum at half time,
//!
//! ```text
//! M_i ∝ P_j P_k L_i + z P_i g_i L_j L_k,     L_i(h) = L_i + 2 z P_i g_i M_j M_k / (P_i² − z² g_j g_k M_i²)
//! attitude: Cayley's vector                  c_i = z (J_i + δ) M_i / P_i
//! ```
//!
//! In terms of P_i M_i only the square root P_1 P_2 P_3 remains.
//!
//! δ depends on J, C, H and h alone. W and δ are power series in h²; with one J zero, δ has few terms.
//! Truncating W causes an error in the step length; truncating δ causes an error in the angle about L. The
//! world momentum, |L| and the energy are exact for any truncation, and a step back is the inverse.
//! `docs/free-rotation.md` has the derivation.
//!
//! Sources: Moser, Veselov, Commun. Math. Phys. 139 (1991) 217; McLachlan, Zanna, Found. Comput. Math. 5 (2005) 87;
//! Hairer, Vilmart, J. Phys. A 39 (2006) 13225 and Vilmart, J. Comput. Phys. 227 (2008) 7083: a discrete top with
//! exactly modified moments is the same map in implicit form.

use glam::{DQuat, DVec3};

use super::FreeRotation;
use crate::body::RigidBox;
use crate::math::{AnyArgument, Trigonometry};
use crate::rotation::{compose, exponential_map_by};
use crate::state::BodyState;

/// Largest z² (|J L|² + λ²), where λ² = −p₂|L|² is the square of the growth rate about the middle axis. At
/// this limit 2 × the root is 0.3, which means |ω|h = 0.3 to 1.1 depending on the body. The truncation of δ
/// is then at most 1.1e-14 rad (40 000 bodies; median 4e-16), and decreases as h¹³.
const LARGEST: f64 = 0.15 * 0.15;

/// η: the change of L follows from the denominator for |ΔL|² ≪ 4η|L|², and from |L| = const. beyond. Between
/// 2⁻¹² and 2⁻¹⁶ both rounding errors are small.
const REFLECTED: f64 = 1.0 / 16384.0;

/// Maximum number of parts of a larger step. Beyond it, the closed form is cheaper.
const MAX_PARTS: f64 = 8.0;

/// Free rotation over `h` \[s\] of either sign, accurate to rounding at any step. Compared with
/// [`FreeRotation`] it needs no memory and is several times cheaper. World momentum, |L| and energy are
/// conserved to rounding; −`h` is the inverse.
///
/// ```
/// use box_physics::free_motion::{FreeRotation, free_rotation};
/// use box_physics::prelude::*;
/// let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0)?;
/// let start = BodyState::default().with_body_angular_velocity(&body, DVec3::new(0.01, 8.0, 0.0));
/// let motion = FreeRotation::new(body.inertia(), start.rotation, start.angular_momentum);
/// let mut state = start;
/// free_rotation(&body, &mut state, 1.0 / 60.0);
/// let (_, momentum) = motion.at(1.0 / 60.0);
/// assert!((state.angular_momentum - momentum).length() < 1e-15);
/// # Ok::<(), InvalidValue>(())
/// ```
#[inline(always)]
pub fn free_rotation(body: &RigidBox, state: &mut BodyState, h: f64) {
    free_rotation_by(body, state, h, &mut AnyArgument);
}

/// [`free_rotation`] with a given sine and cosine.
#[inline(always)]
pub(crate) fn free_rotation_by(
    body: &RigidBox,
    state: &mut BodyState,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) {
    let l = state.angular_momentum;
    let middle = body.splitting().reference;
    let top = Map::new(body.inverse_inertia() - DVec3::splat(middle), l, h);
    if !trigonometry.holds(top.size <= LARGEST) {
        return large_step(body, state, h, top.size);
    }
    let spin = exponential_map_by((h * middle) * l, trigonometry);
    (state.rotation, state.angular_momentum) = top.apply(compose(state.rotation, spin), l);
}

/// A step beyond [`LARGEST`]: in parts or by the closed form. Non-finite numbers also take this path and stay
/// non-finite.
#[cold]
#[inline(never)]
fn large_step(body: &RigidBox, state: &mut BodyState, h: f64, size: f64) {
    let (mut q, mut l) = (state.rotation, state.angular_momentum);
    let parts = (size / LARGEST).sqrt().ceil();
    if parts <= MAX_PARTS {
        let middle = body.splitting().reference;
        let j = body.inverse_inertia() - DVec3::splat(middle);
        q = compose(q, exponential_map_by((h * middle) * l, &mut AnyArgument));
        for _ in 0..parts as u32 {
            (q, l) = Map::new(j, l, h / parts).apply(q, l);
        }
        (state.rotation, state.angular_momentum) = (q, l);
    } else {
        (state.rotation, state.angular_momentum) = FreeRotation::new(body.inertia(), q, l).at(h);
        // Restarted in every step, the closed form loses 1e-17 of |L| per step.
        let (square, m) = (l.length_squared(), state.angular_momentum);
        state.angular_momentum += m * (0.5 * (square - m.length_squared()) / square);
    }
}

/// One step of the top that remains after the rotation with the middle moment.
struct Map {
    /// Turn of the body axes, not normalized.
    turn: [f64; 4],
    /// D, the change of L times N/2.
    change: [f64; 3],
    /// N P_1²
    denominator: f64,
    /// P_1²
    factor: f64,
    /// η|L|², and more than 0 at rest.
    small: f64,
    /// z² (|J L|² + λ²)
    size: f64,
}

impl Map {
    /// `j` = 1/I − 1/I_r [1/(kg m²)], one of them 0.
    #[inline(always)]
    fn new(j: DVec3, l: DVec3, h: f64) -> Self {
        let l = l.to_array();
        // z J_i, z g_i
        let z = 0.5 * h;
        let j = [z * j.x, z * j.y, z * j.z];
        let g = [j[2] - j[1], j[0] - j[2], j[1] - j[0]];
        let w = [j[0] * l[0], j[1] * l[1], j[2] * l[2]];
        let squares = (w[0] * w[0] + w[1] * w[1]) + w[2] * w[2];
        // 2C; 2H z
        let ll = l[0] * l[0];
        let c = (ll + l[1] * l[1]) + l[2] * l[2];
        let e = (w[0] * l[0] + w[1] * l[1]) + w[2] * l[2];
        // ⅓ z² (ε_j − ε_k), and from their differences y_i = z² ε_i
        let (c_third, e_third) = (c * (1.0 / 3.0), e * (1.0 / 3.0));
        let d = [
            g[0] * (j[0] * c_third - e_third),
            g[1] * (j[1] * c_third - e_third),
            g[2] * (j[2] * c_third - e_third),
        ];
        let y = [d[2] - d[1], d[0] - d[2], d[1] - d[0]];
        let w = weierstrass(y);
        // P_i² and their products
        let p = [w - y[0], w - y[1], w - y[2]];
        let pp = [p[1] * p[2], p[2] * p[0], p[0] * p[1]];
        let product = p[0] * pp[0];
        let root = product.sqrt();
        let b = [p[0] * g[0], p[1] * g[1], p[2] * g[2]];
        // P_i M_i times `common`
        let m = [
            root * l[0] + (b[0] * l[1]) * l[2],
            root * l[1] + (b[1] * l[2]) * l[0],
            root * l[2] + (b[2] * l[0]) * l[1],
        ];
        let gg = g[1] * g[2];
        let common = p[0] - gg * ll;
        let pc = p[0] * common;
        let denominator = root * (pc * pc - gg * (m[0] * m[0]));
        // z δ
        let p1 = (j[0] + j[1]) + j[2];
        let p2 = 2.0 * (j[0] * j[1] + (j[0] + j[1]) * j[2]);
        let pe = p2 * e;
        let b2 = p2 * c;
        let delta = pe * precession(p1 * e, b2, pe * e);
        Self {
            turn: [
                ((j[0] + delta) * pp[0]) * m[0],
                ((j[1] + delta) * pp[1]) * m[1],
                ((j[2] + delta) * pp[2]) * m[2],
                product * common,
            ],
            change: [
                (b[0] * m[1]) * m[2],
                (b[1] * m[2]) * m[0],
                (b[2] * m[0]) * m[1],
            ],
            denominator,
            factor: p[0],
            small: c * REFLECTED + f64::MIN_POSITIVE,
            size: squares - 0.5 * b2,
        }
    }

    /// Attitude and momentum after the step. The quaternion is normalized here. The momentum changes by an
    /// increment, so its rounding error is that of the increment:
    ///
    /// ```text
    /// ΔL = 2 D/N;   N (L·D) = −|D|² because |L + ΔL| = |L|, so
    /// 2/N = 2 (η|L|² − N (L·D)) / (N (η|L|² + |D|²))
    /// ```
    ///
    /// In a fast spin N has the same rounding in every step. A relative error δ of N changes |L|² by δ|ΔL|² per step,
    /// always with the same sign. The last line does not have this error: for |D|² ≫ η|L|² it is −2 (L·D)/|D|², and the
    /// new L is the reflection of L in the plane normal to D. In a slow spin L·D cancels, and the line is 2/N again.
    #[inline(always)]
    fn apply(&self, q: DQuat, l: DVec3) -> (DQuat, DVec3) {
        let q = compose(q, DQuat::from_array(self.turn));
        let norm = q.length();
        let d = DVec3::from_array(self.change);
        // One division for both results.
        let divisor = self.denominator * (d.dot(d) + self.small);
        let r = 1.0 / (divisor * norm);
        let scale = self.factor * self.small - self.denominator * l.dot(d);
        (q * (r * divisor), l + d * (scale * (r * (2.0 * norm))))
    }
}

/// z² ℘(z) for y_i = z² ε_i: 1 + Σ c_k with c₂ = Σy²/10, c₃ = y₁y₂y₃/7,
/// c_k = 3/((2k+1)(k−3)) Σ c_m c_{k−m}, to k = 7 (Abramowitz, Stegun 18.5.2).
#[inline(always)]
fn weierstrass(y: [f64; 3]) -> f64 {
    let c2 = ((y[0] * y[0] + y[1] * y[1]) + y[2] * y[2]) * 0.1;
    let c3 = (y[0] * y[1]) * (y[2] * (1.0 / 7.0));
    let c22 = c2 * c2;
    let c4 = c22 * (1.0 / 3.0);
    let c5 = (c2 * c3) * (3.0 / 11.0);
    let c6 = (c22 * c2) * (2.0 / 39.0) + (c3 * c3) * (1.0 / 13.0);
    let c7 = (c22 * c3) * (2.0 / 33.0);
    1.0 + ((c2 + c3) + (c4 + c5) + (c6 + c7))
}

/// z δ/(2 p₂ H) as a series in a = p₁ H, b = p₂ C, q = p₂ H² to the fourth degree, q counting twice: order 12
/// in h. The caller includes the powers of z and the factors 2. p₁ = Σ J, p₂ = Σ J_j J_k; p₃ is 0.
///
/// The rational coefficients come from the power series of the Riccati equation in `docs/free-rotation.md`.
#[inline(always)]
fn precession(a: f64, b: f64, q: f64) -> f64 {
    let s0 = 1.0 / 6.0
        + b * (-2.0 / 45.0 + b * (1.0 / 378.0 + b * (-1.0 / 9450.0 + b * (1.0 / 534600.0))))
        + q * (-19.0 / 1260.0
            + b * (59.0 / 14175.0 - b * (1019.0 / 1871100.0))
            + q * (151.0 / 207900.0));
    let s1 = 7.0 / 90.0
        + b * (-4.0 / 189.0 + b * (1.0 / 315.0 - b * (131.0 / 467775.0)))
        + q * (-19.0 / 2100.0 + b * (1676.0 / 467775.0));
    let s2 = 31.0 / 945.0 + b * (-4.0 / 315.0 + b * (379.0 / 155925.0)) - q * (1063.0 / 207900.0);
    let s3 = 127.0 / 9450.0 - b * (3032.0 / 467775.0);
    s0 + a * (s1 + a * (s2 + a * (s3 + a * (73.0 / 13365.0))))
}

#[cfg(test)]
mod tests;
