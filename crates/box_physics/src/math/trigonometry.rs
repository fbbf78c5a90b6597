//! Sine and cosine: a polynomial on |x| ≤ π/4, the usual range of a step, and `libm` beyond.

use core::f64::consts::FRAC_PI_4;

// sin x = x + x³ S(x²), cos x = 1 − x²/2 + x⁴ C(x²). Coefficients: Chebyshev interpolation of S and C on 0 ≤
// x² ≤ (π/4)² at 40 digits (mpmath `chebyfit`). Interpolation errors: 2.0e-17 in S, 1.3e-18 in C; that is
// below 1e-17 in sin and 5e-19 in cos, a tenth of a rounding unit.
const S: [f64; 6] = [
    -0.16666666666666666,
    0.008333333333330948,
    -0.00019841269836756774,
    2.7557316101617874e-06,
    -2.505113165023518e-08,
    1.5918115263265974e-10,
];
const C: [f64; 6] = [
    0.041666666666666664,
    -0.0013888888888887398,
    2.480158729876456e-05,
    -2.7557317271145144e-07,
    2.087614614655861e-09,
    -1.1382623647474604e-11,
];

/// S(z) and C(z) for z = x², by Estrin's method: three independent pairs, which the processor can evaluate at
/// the same time.
#[inline(always)]
fn polynomials(z: f64) -> (f64, f64) {
    let z2 = z * z;
    let z4 = z2 * z2;
    let s = (S[0] + z * S[1]) + z2 * (S[2] + z * S[3]) + z4 * (S[4] + z * S[5]);
    let c = (C[0] + z * C[1]) + z2 * (C[2] + z * C[3]) + z4 * (C[4] + z * C[5]);
    (s, c)
}

/// (sin x, cos x) for any finite `x` \[rad\]; absolute error below 1.5e-16. NaN for a non-finite `x`.
///
/// ```
/// let (s, c) = box_physics::math::sin_cos(0.5);
/// assert!((s - 0.479_425_538_604_203).abs() < 1e-15 && (c - 0.877_582_561_890_372_8).abs() < 1e-15);
/// ```
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    if x.abs() <= FRAC_PI_4 {
        small_sin_cos(x)
    } else {
        large_sin_cos(x)
    }
}

/// Returns (sin(√z)/√z, cos(√z)) for z = x² ≥ 0, for the exponential map of a rotation vector. For x ≤ π/4 it needs no
/// square root and no division, so x = 0 is not a special case.
#[inline(always)]
pub fn sinc_cos(z: f64) -> (f64, f64) {
    if z <= FRAC_PI_4 * FRAC_PI_4 {
        small_sinc_cos(z)
    } else {
        let x = z.sqrt();
        let (s, c) = large_sin_cos(x);
        (s / x, c)
    }
}

/// Sine and cosine for code that serves both one body and many bodies in SIMD lanes.
pub trait Trigonometry {
    /// Sine and cosine, as [`sin_cos`].
    fn sin_cos(&mut self, x: f64) -> (f64, f64);
    /// sin(√z)/√z and cos(√z), as [`sinc_cos`].
    fn sinc_cos(&mut self, z: f64) -> (f64, f64);
    /// Returns `true` if the caller may continue with a formula that holds only under `condition`. For one
    /// body it returns the condition. For many bodies it always returns `true`; bodies with a false condition
    /// are stepped again one by one.
    fn holds(&mut self, condition: bool) -> bool;
}

/// Sine and cosine of any argument, for one body.
pub struct AnyArgument;

impl Trigonometry for AnyArgument {
    #[inline(always)]
    fn sin_cos(&mut self, x: f64) -> (f64, f64) {
        sin_cos(x)
    }

    #[inline(always)]
    fn sinc_cos(&mut self, z: f64) -> (f64, f64) {
        sinc_cos(z)
    }

    #[inline(always)]
    fn holds(&mut self, condition: bool) -> bool {
        condition
    }
}

/// The polynomials alone, without a branch. Gives the same bits as [`AnyArgument`] while every argument is
/// within |x| ≤ π/4, and records whether that was so.
#[derive(Default)]
pub(crate) struct SmallArguments {
    /// Sum that is nonzero if an argument was larger or not a number. (Not a flag: the compiler vectorizes
    /// additions but not a chain of conditions.)
    others: f64,
}

impl SmallArguments {
    /// Returns `true` if every argument was small.
    #[inline(always)]
    pub(crate) fn all_small(&self) -> bool {
        self.others == 0.0
    }
}

impl Trigonometry for SmallArguments {
    #[inline(always)]
    fn sin_cos(&mut self, x: f64) -> (f64, f64) {
        self.others += if x.abs() <= FRAC_PI_4 { 0.0 } else { 1.0 };
        small_sin_cos(x)
    }

    #[inline(always)]
    fn sinc_cos(&mut self, z: f64) -> (f64, f64) {
        let small = z <= FRAC_PI_4 * FRAC_PI_4;
        self.others += if small { 0.0 } else { 1.0 };
        small_sinc_cos(z)
    }

    #[inline(always)]
    fn holds(&mut self, condition: bool) -> bool {
        self.others += if condition { 0.0 } else { 1.0 };
        true
    }
}

#[inline(always)]
fn small_sin_cos(x: f64) -> (f64, f64) {
    let z = x * x;
    let (s, c) = polynomials(z);
    (x + x * z * s, (1.0 - 0.5 * z) + z * z * c)
}

#[inline(always)]
fn small_sinc_cos(z: f64) -> (f64, f64) {
    let (s, c) = polynomials(z);
    (1.0 + z * s, (1.0 - 0.5 * z) + z * z * c)
}

/// The general case, in a separate function to keep the common case small.
#[cold]
#[inline(never)]
fn large_sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// libm is correct to 1 ulp, which suffices for a bound of 1.5e-16.
    #[test]
    fn within_bound_of_libm_over_the_polynomial_range() {
        let n = 200_000;
        for i in -n..=n {
            let x = FRAC_PI_4 * f64::from(i) / f64::from(n);
            let (s, c) = sin_cos(x);
            assert!((s - libm::sin(x)).abs() <= 1.5e-16, "sin {x:e}");
            assert!((c - libm::cos(x)).abs() <= 2.3e-16, "cos {x:e}");
            let (sinc, c2) = sinc_cos(x * x);
            assert!((sinc * x - libm::sin(x)).abs() <= 2.3e-16, "sinc {x:e}");
            assert!((c2 - c).abs() <= 1.2e-16);
        }
    }

    #[test]
    fn large_arguments_and_the_unit_circle() {
        let mut x = 0.7;
        while x < 1e15 {
            let (s, c) = sin_cos(x);
            assert!((s * s + c * c - 1.0).abs() < 5e-16, "{x:e}");
            assert!((s - libm::sin(x)).abs() <= 1.2e-16);
            x *= 1.37;
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert_eq!(sinc_cos(0.0), (1.0, 1.0));
        assert!(sin_cos(f64::INFINITY).0.is_nan());
    }

    #[test]
    fn odd_and_even_to_the_bit() {
        for x in [1e-300, 1e-8, 0.3, 0.785, 0.786, 5.0, 1e6] {
            let ((s, c), (t, d)) = (sin_cos(x), sin_cos(-x));
            assert_eq!((s, c), (-t, d));
        }
    }
}
