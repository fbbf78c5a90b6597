//! Free rotation with three different moments: Jacobi's elliptic functions as ratios of theta series.

use glam::{DQuat, DVec3};

use super::elliptic::incomplete_integral;
use super::jacobi::{Jacobi, Series};
use super::phase::sin_cos_of_phase;
use crate::rotation::compose;

/// # The motion
///
/// Let c be the axis that the momentum circulates about (its component never changes sign), a the other
/// extreme axis and b the middle one. The signs are chosen so that the components of L along a and c are not
/// negative and (a, b, c) is right-handed. With `D = |L|² − 2T I_b`, c is the axis of the largest moment if
/// D > 0 (σ = 1), otherwise of the smallest (σ = −1), and
///
/// ```text
/// L_a = A_a cn(u|m),  L_b = σ A_b sn(u|m),  L_c = A_c dn(u|m),   u = λt + u₀
/// ```
///
/// # The attitude
///
/// In axes whose third is L, the body's c axis has colatitude θ and the body precesses by φ:
/// `φ' = |L| (L_a²/I_a + L_b²/I_b)/(L_a² + L_b²)` (Landau, Lifshitz §37), whose integral is
///
/// ```text
/// φ(t) = A₂t − σ arg Z,   Z = Σ (−1)^k p^{k(k+1)} [cosh (2k+1)y sin (2k+1)x + i sinh (2k+1)y cos (2k+1)x]
///      = θ₁(x + iy|p)/2p^{1/4},   x = πu/2K,   y = (π/2K) F(atan2(A_a, A_c √m) | 1−m)
/// A₂ = |L|/I_a − σ(πλ/2K) Σ(−1)^k p^{k(k+1)}(2k+1)cosh (2k+1)y / Σ(−1)^k p^{k(k+1)}sinh (2k+1)y
/// ```
///
/// The turn from the body to those axes is `R_z(φ − α′) B`. B is the least turn that takes l = L/|L| to c,
/// `B ∝ (1 + l_c; l_b, −l_a, 0)`. α is the azimuth of L in the (a, b) plane, α′ = α + π/2. So
/// `e^{i(φ−α′)} ∝ e^{iA₂t} Z^{∓1} (l_a − i l_b)`. This needs no arctangent, only one square root for the half
/// angle of the quaternion. Then q(t) = q₀ ∘ b(0)* ∘ b(t).
///
/// # The series
///
/// For m ≤ ½ the nome is p ≤ e^{−π}, and four terms of each series reach 1e-17. For m > ½ Jacobi's imaginary
/// transformation gives the same sums in the complementary nome p′ ≤ e^{−π}, with hyperbolic functions of
/// x′ = πu/2K′ (θ₁(z|τ) = i(−iτ)^{−½} e^{z²/πiτ} θ₁(z/τ|−1/τ), and so on; Whittaker, Watson 21.51). Again four
/// terms suffice. No digits are lost at the separatrix, where the series in p loses four at 1−m = 1e-16; p′ = 0
/// is the separatrix itself. See [`Series`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tumbling {
    /// q₀ ∘ b(0)*
    left: DQuat,
    /// |L| [kg m²/s]
    momentum: f64,
    /// Body axis of each of a, b, c, and its sign.
    axes: [usize; 3],
    signs: [f64; 3],
    /// λ [1/s] and u₀.
    frequency: f64,
    offset: f64,
    /// ½A₂, or for m > ½ half of A′ [rad/s].
    half_precession: f64,
    series: Series,
}

impl Tumbling {
    /// `inertia` and `l` are scaled to the order of 1. `rate` [rad/s] times l/I is the angular velocity;
    /// `momentum_scale` times l is the momentum. The three moments differ, and at most one component of `l`
    /// is negligible.
    pub(super) fn new(
        inertia: DVec3,
        rate: f64,
        rotation: DQuat,
        l: DVec3,
        momentum_scale: f64,
    ) -> Self {
        let axes = Axes::new(inertia, l);
        let [ia, ib, ic] = axes.inertia;
        let [la, lb, lc] = axes.momentum;
        let sigma = axes.sigma;
        let length = l.length();
        // Ratios of gaps of moments, every one positive.
        let (gap_ab, gap_bc, gap_ac) = ((ia - ib).abs(), (ib - ic).abs(), (ia - ic).abs());
        // Amplitudes, as sums of squares: no cancellation.
        let to_a = (ia * gap_bc) / (ib * gap_ac);
        let aa = (la * la + lb * lb * to_a).sqrt();
        let ab = (lb * lb + la * la / to_a).sqrt();
        let ac2 = lc * lc + lb * lb * (ic * gap_ab) / (ib * gap_ac);
        let ac = ac2.sqrt();
        // The parameter and its complement, each without cancellation; the smaller one decides.
        let m = ab * ab * (ic * gap_ab) / (ib * gap_ac * ac2);
        let complement = axes.discriminant.abs() * ic / (gap_bc * ac2);
        let lambda = rate * (ac / ic) * (gap_bc * gap_ac / (ia * ib)).sqrt();
        // The amplitude of y: tan² = A_a²/(A_c² m), a ratio of moments alone.
        let (y_sine, y_cosine) = ((ia * gap_bc).sqrt(), (ic * gap_ab).sqrt());
        let amplitudes = [aa / length, sigma * ab / length, ac / length];
        let free = rate * length / ia;
        let circular = m <= 0.5;
        let (modulus, complementary) = if circular {
            (m.sqrt(), (1.0 - m).sqrt())
        } else {
            ((1.0 - complement).sqrt(), complement.sqrt())
        };
        let offset = incomplete_integral(sigma * lb / ab, la / aa, complementary);
        let y = incomplete_integral(y_sine, y_cosine, modulus);
        let (series, precession) = if circular {
            Series::circular(m, complementary, y, amplitudes, sigma)
        } else {
            Series::hyperbolic(complement, modulus, y, amplitudes, sigma)
        };
        let mut motion = Self {
            left: rotation,
            momentum: length * momentum_scale,
            axes: axes.index,
            signs: axes.sign,
            frequency: lambda,
            offset,
            half_precession: 0.5 * (free - sigma * lambda * precession),
            series,
        };
        // With `left` = q₀ the motion starts from q₀ ∘ b(0).
        let (first, _) = motion.frame(0.0);
        motion.left = compose(rotation, first.conjugate());
        motion
    }

    /// Attitude and body momentum at time `t`.
    #[inline]
    pub(super) fn at(&self, t: f64) -> (DQuat, DVec3) {
        let (b, l) = self.frame(t);
        (compose(self.left, b), self.momentum * l)
    }

    /// b(t), the turn from body axes to axes fixed in the world, and L/|L|, both in body axes.
    #[inline(always)]
    fn frame(&self, t: f64) -> (DQuat, DVec3) {
        let u = self.frequency * t + self.offset;
        let Jacobi {
            l: [la, lb, lc],
            re,
            im,
            half_jumps,
            flip,
        } = self.series.at(u);
        // W = Z^∓ (l_a − i l_b). A half turn u → u + 2K changes the sign of both factors, so both omit it.
        let (w_re, w_im) = (re * la + im * lb, im * la - re * lb);
        // √W up to a positive factor, without cancellation in either half plane.
        let w = (w_re * w_re + w_im * w_im).sqrt();
        let (root_re, root_im) = if w_re >= 0.0 {
            (w + w_re, w_im)
        } else {
            (w_im, w - w_re)
        };
        let (sin, cos) = sin_cos_of_phase(self.half_precession * t + half_jumps);
        let z_re = root_re * cos - root_im * sin;
        let z_im = root_re * sin + root_im * cos;
        // Rounding changes |l| from 1 by a few units; one Newton step corrects it.
        let unit = 1.5 - 0.5 * (la * la + lb * lb + lc * lc);
        let (la, lb, lc) = (flip * unit * la, flip * unit * lb, unit * lc);
        // (0, 0, z_im; z_re) ∘ (l_b, −l_a, 0; 1 + l_c)
        let turn = [
            z_re * lb + z_im * la,
            z_im * lb - z_re * la,
            z_im * (1.0 + lc),
        ];
        let real = z_re * (1.0 + lc);
        let squares = turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2];
        let norm = 1.0 / (squares + real * real).sqrt();
        let vector = self.in_body(turn) * norm;
        let q = DQuat::from_xyzw(vector.x, vector.y, vector.z, real * norm);
        (q, self.in_body([la, lb, lc]))
    }

    /// From (a, b, c) to body axes.
    #[inline(always)]
    fn in_body(&self, v: [f64; 3]) -> DVec3 {
        let mut out = [0.0; 3];
        for k in 0..3 {
            out[self.axes[k]] = self.signs[k] * v[k];
        }
        DVec3::from_array(out)
    }
}

/// Body axes of a, b, c, and the signs that make (a, b, c) right-handed and the components of L along a and c
/// positive.
struct Axes {
    index: [usize; 3],
    sign: [f64; 3],
    inertia: [f64; 3],
    momentum: [f64; 3],
    discriminant: f64,
    sigma: f64,
}

impl Axes {
    fn new(inertia: DVec3, l: DVec3) -> Self {
        let (i, l) = (inertia.to_array(), l.to_array());
        let mut order = [0_usize, 1, 2];
        order.sort_by(|&a, &b| i[a].total_cmp(&i[b]));
        let [low, middle, high] = order;
        // D = |L|² − 2T I_b, summed so that its sign is correct next to the separatrix.
        let part = |k: usize| l[k] * l[k] * ((i[k] - i[middle]) / i[k]);
        let discriminant = part(low) + part(high);
        let (a, c, sigma) = if discriminant > 0.0 {
            (low, high, 1.0)
        } else {
            (high, low, -1.0)
        };
        let b = middle;
        let parity = if b == (a + 1) % 3 { 1.0 } else { -1.0 };
        let sign_of = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
        let (sign_a, sign_c) = (sign_of(l[a]), sign_of(l[c]));
        let sign = [sign_a, sign_a * sign_c * parity, sign_c];
        Self {
            index: [a, b, c],
            sign,
            inertia: [i[a], i[b], i[c]],
            momentum: [l[a].abs(), sign[1] * l[b], l[c].abs()],
            discriminant,
            sigma,
        }
    }
}
