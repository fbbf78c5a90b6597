//! Jacobi's elliptic functions, and the theta function of the precession, for one motion.

use core::f64::consts::{FRAC_PI_2, PI};

use super::elliptic::{complete_integral, nome};
use super::phase::{nearest, sin_cos_of_phase};
use super::theta::{SERIES, TERMS, alternating_sum, base_series, constants, finish, odd, powers};

/// Elliptic functions and Z of one motion (see [`Tumbling`](super::tumbling::Tumbling)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Series {
    /// π/2K (turns u into x), or π/2K′ (turns u into x′).
    scale: f64,
    branch: Branch,
    /// The six series by powers of v, including constant factors.
    coefficients: [[f64; SERIES]; 4],
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Branch {
    /// m ≤ ½; v = cos 2x.
    Circular,
    /// m > ½; v = p′ cosh 2x′, at most about ½ over the half period |u| ≤ K.
    Hyperbolic {
        /// p′
        nome: f64,
        /// 2K and its reciprocal; both 0 on the separatrix, which has no period.
        period: f64,
        frequency: f64,
        /// Half of the increase of the precession at every half turn u → u + 2K: −σy′.
        half_jump: f64,
    },
}

/// The values at one u.
pub(super) struct Jacobi {
    /// `A_a cn u`, `σA_b sn u`, `A_c dn u`; the first two without their sign change at half turns.
    pub(super) l: [f64; 3],
    /// Z for σ = −1, its conjugate for σ = 1, both up to the same positive factor and the same sign.
    pub(super) re: f64,
    pub(super) im: f64,
    /// Half of the precession due to half turns \[rad\].
    pub(super) half_jumps: f64,
    /// −1 after an odd number of subtracted half turns.
    pub(super) flip: f64,
}

impl Series {
    /// Series for m ≤ ½. `complementary` is √(1−m), `f` the integral in y, `amplitudes` `A_a`, `σA_b`, `A_c`.
    /// Also returns A₂'s quotient of sums times π/2K.
    pub(super) fn circular(
        m: f64,
        complementary: f64,
        f: f64,
        amplitudes: [f64; 3],
        sigma: f64,
    ) -> (Self, f64) {
        let powers = powers(nome(m));
        let scale = FRAC_PI_2 / complete_integral(complementary);
        let y = scale * f;
        // cosh (2k+1)y and sinh (2k+1)y over ½e^y; 1 − e^{−…} by expm1 because y may be tiny.
        let growth = libm::exp(2.0 * y);
        let (mut cosh, mut sinh, mut e) = ([0.0; TERMS], [0.0; TERMS], 1.0);
        for k in 0..TERMS {
            let less = -libm::expm1(-2.0 * odd(k) * y);
            (cosh[k], sinh[k]) = (e * (2.0 - less), e * less);
            e *= growth;
        }
        let slope = alternating_sum(&powers, |k| odd(k) * cosh[k]);
        let value = alternating_sum(&powers, |k| sinh[k]);
        let base = base_series(&powers, 0, &cosh, &sinh);
        // sn = (θ₃/θ₂) θ₁(x)/θ₄(x), cn = (θ₄/θ₂) θ₂(x)/θ₄(x), dn = (θ₄/θ₃) θ₃(x)/θ₄(x)
        let [theta2, theta3, theta4] = constants(&powers);
        let factors = [theta4 / theta2, theta3 / theta2, theta4 / theta3];
        let coefficients = finish(base, amplitudes, factors, sigma);
        let series = Self {
            scale,
            branch: Branch::Circular,
            coefficients,
        };
        (series, scale * slope / value)
    }

    /// Series for m > ½. `complement` is 1−m (0 on the separatrix), `modulus` √m; the rest is as above.
    ///
    /// The transformed phase is θ₁(x+iy|p) ∝ e^{−2ixy/πκ} Ẑ with κ = K′/K, x′ = x/κ, y′ = y/κ and Ẑ = Σ(−1)^k
    /// p′^{k(k+1)} [cos (2k+1)y′ sinh (2k+1)x′ + i sin (2k+1)y′ cosh (2k+1)x′]. With n half turns subtracted
    /// from x, the linear parts of A₂t and of this phase leave
    ///
    /// ```text
    /// φ = A′t − 2σny′ − σ arg Ẑ
    /// A′ = |L|/I_a − σ(πλ/2K′) Σ(−1)^k p′^{k(k+1)}(2k+1)cos (2k+1)y′ / Σ(−1)^k p′^{k(k+1)} sin (2k+1)y′
    /// ```
    ///
    /// For p′ = 0: Ẑ ∝ cos y′ tanh u + i sin y′, the separatrix.
    pub(super) fn hyperbolic(
        complement: f64,
        modulus: f64,
        f: f64,
        amplitudes: [f64; 3],
        sigma: f64,
    ) -> (Self, f64) {
        let nome = nome(complement);
        let powers = powers(nome);
        let quarter = complete_integral(modulus);
        let scale = FRAC_PI_2 / quarter;
        let y = scale * f;
        let (mut cos, mut sin) = ([0.0; TERMS], [0.0; TERMS]);
        for k in 0..TERMS {
            (sin[k], cos[k]) = sin_cos_of_phase(odd(k) * y);
        }
        let slope = alternating_sum(&powers, |k| odd(k) * cos[k]);
        let value = alternating_sum(&powers, |k| sin[k]);
        let mut base = base_series(&powers, 1, &cos, &sin);
        // The same ratios with θ₂(x) and θ₄(x) exchanged: cn ∝ Θ₄/Θ₂, dn ∝ Θ₃/Θ₂, sn ∝ Θ₁/Θ₂.
        let [theta2, theta3, theta4] = constants(&powers);
        let factors = [theta2 / theta4, theta3 / theta4, theta2 / theta3];
        for row in &mut base {
            row.swap(0, 3);
        }
        let coefficients = finish(base, amplitudes, factors, sigma);
        // p′ = exp(−πK/K′)
        let period = if nome > 0.0 {
            -2.0 * quarter / PI * libm::log(nome)
        } else {
            0.0
        };
        let series = Self {
            scale,
            branch: Branch::Hyperbolic {
                nome,
                period,
                frequency: if period > 0.0 { 1.0 / period } else { 0.0 },
                half_jump: -sigma * y,
            },
            coefficients,
        };
        (series, scale * slope / value)
    }

    #[inline(always)]
    pub(super) fn at(&self, u: f64) -> Jacobi {
        match self.branch {
            Branch::Circular => {
                let (sin, cos) = sin_cos_of_phase(self.scale * u);
                let sums = self.sums(1.0 - 2.0 * sin * sin);
                let scale = 1.0 / sums[3];
                Jacobi {
                    l: [
                        cos * sums[0] * scale,
                        sin * sums[1] * scale,
                        sums[2] * scale,
                    ],
                    re: sin * sums[4],
                    im: cos * sums[5],
                    half_jumps: 0.0,
                    flip: 1.0,
                }
            }
            Branch::Hyperbolic {
                nome,
                period,
                frequency,
                half_jump,
            } => {
                let mut half_turns = nearest(u * frequency);
                let mut rest = u - half_turns * period;
                // After about 1e15 half turns their product is rounded by more than one. The position within
                // a turn is then lost, but it must be within one turn, or the series does not converge.
                while (rest * frequency).abs() > 0.51 {
                    let more = nearest(rest * frequency);
                    rest -= more * period;
                    half_turns += more;
                }
                let x = self.scale * rest;
                // tanh and sech from e^{−|x|}, which may underflow on the separatrix.
                let decay = libm::exp(-x.abs());
                let square = decay * decay;
                let scale = 1.0 / (1.0 + square);
                let tanh = ((1.0 - square) * scale).copysign(x);
                let sech = 2.0 * decay * scale;
                let sums = self.sums(0.5 * nome * (square + 1.0 / square.max(f64::MIN_POSITIVE)));
                let scale = 1.0 / sums[3];
                Jacobi {
                    l: [
                        sech * sums[0] * scale,
                        tanh * sums[1] * scale,
                        sech * sums[2] * scale,
                    ],
                    re: tanh * sums[4],
                    im: sums[5],
                    half_jumps: half_turns * half_jump,
                    flip: if (half_turns as i64) & 1 == 0 {
                        1.0
                    } else {
                        -1.0
                    },
                }
            }
        }
    }

    /// The six cubics at `v`.
    #[inline(always)]
    fn sums(&self, v: f64) -> [f64; SERIES] {
        let c = &self.coefficients;
        let mut sums = [0.0; SERIES];
        for s in 0..SERIES {
            sums[s] = c[0][s] + v * (c[1][s] + v * (c[2][s] + v * c[3][s]));
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::free_motion::incomplete_integral;

    /// The series for 1−m = `mc` with unit amplitudes, by the chosen branch.
    fn series(mc: f64, circular: bool, sigma: f64) -> (Series, f64) {
        let (k, kc) = ((1.0 - mc).sqrt(), mc.sqrt());
        let f = incomplete_integral(0.6, 0.8, k);
        if circular {
            Series::circular(1.0 - mc, kc, f, [1.0; 3], sigma)
        } else {
            Series::hyperbolic(mc, k, f, [1.0; 3], sigma)
        }
    }

    /// 1−m, u, cn, sn, dn by mpmath (150 digits).
    #[test]
    fn jacobi_functions() {
        #[rustfmt::skip]
        let cases = [
            (0.9, 0.3, [0.9554669523495009, 0.2950981243043688, 0.9956363340613903]),
            (0.9, 7.5, [0.5107126296511229, 0.8597514814845247, 0.9623319276676403]),
            (0.6, -2.0, [-0.17203845259419676, -0.9850902348663265, 0.7822013114719268]),
            (0.5, 30.0, [0.9454722525288123, 0.3257026553439408, 0.9731181275420538]),
            (0.4, 0.3, [0.956114855739238, 0.29299212043114076, 0.9739062431359388]),
            (0.4, 30.0, [0.48377203644652994, -0.875194045199336, 0.7351334776410157]),
            (0.05, -2.0, [0.22840248090492582, -0.9735667962273955, 0.31553020238853324]),
            (1e-06, 7.5, [0.000880165652850525, 0.9999996126541367, 0.001332175214364167]),
            (1e-06, 30.0, [0.08333933364626821, -0.9965212268022172, 0.0833452913316612]),
            (1e-18, 30.0, [-1.3358091355375025e-06, 0.9999999999991078, 1.3358095098424213e-06]),
            (1e-60, 7.5, [0.0011061684019161861, 0.9999993881955461, 0.0011061684019161861]),
            (0.0, 30.0, [1.871524593768035e-13, 1.0, 1.871524593768035e-13]),
        ];
        for (mc, u, expected) in cases {
            let value = series(mc, mc >= 0.5, 1.0).0.at(u);
            let [cn, sn, dn] = value.l;
            for (a, b) in [cn * value.flip, sn * value.flip, dn].iter().zip(expected) {
                assert!((a - b).abs() < 2e-15, "{mc} {u}: {a} {b}");
            }
        }
    }

    /// Both expansions give the same functions where they converge. Z is compared as the precession that it
    /// and the linear part give over a time.
    #[test]
    fn both_expansions_agree() {
        for (mc, sigma) in [(0.5, 1.0), (0.5, -1.0), (0.48, 1.0), (0.52, -1.0)] {
            let (circular, a) = series(mc, true, sigma);
            let (hyperbolic, b) = series(mc, false, sigma);
            // Half the precession, as a unit vector squared: e^{iφ}, times l_a − i l_b, from u = 0.
            let turn = |s: &Series, rate: f64, u: f64| {
                let t = s.at(u);
                let arg = |t: &Jacobi| libm::atan2(t.im, t.re) - libm::atan2(t.l[1], t.l[0]);
                -sigma * rate * u + 2.0 * t.half_jumps + arg(&t) - arg(&s.at(0.0))
            };
            for k in -400..400 {
                let u = 0.07 * f64::from(k) + 0.01;
                let ([x, y, z], [p, q, r]) = (circular.at(u).l, hyperbolic.at(u).l);
                let flip = hyperbolic.at(u).flip;
                let worst = (x - flip * p).abs().max((y - flip * q).abs());
                assert!(worst < 1e-14, "{mc} {u} {worst:e}");
                assert!((z - r).abs() < 2e-15);
                let difference = turn(&circular, a, u) - turn(&hyperbolic, b, u);
                let turns = difference / (2.0 * PI);
                assert!((turns - nearest(turns)).abs() < 1e-14, "{mc} {u}: {turns}");
            }
        }
    }
}
