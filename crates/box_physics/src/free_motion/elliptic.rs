//! Elliptic integrals of the first kind, by the arithmetic–geometric mean.
//!
//! All functions take the *complementary modulus* k' = √(1−m) instead of the parameter m. Near the separatrix
//! m rounds to 1, but 1−m, computed without cancellation, keeps every digit.

use core::f64::consts::{FRAC_PI_2, PI};

/// Relative difference at which the mean has converged: the square root of the rounding unit, because the
/// next step squares the difference.
const AGREEMENT: f64 = 1e-8;

/// Maximum number of steps. k' = 1e-160 needs 12; the cap only stops a NaN.
const MAX_STEPS: usize = 24;

/// The complete integral K = ∫₀^{π/2} dθ/√(1 − m sin²θ) = π/(2 agm(1, k')), k' = √(1−m) in (0, 1].
/// Infinite for k' = 0. Relative error below 4e-16 (Gauss 1799; Abramowitz, Stegun 17.6).
///
/// ```
/// let k = box_physics::free_motion::complete_integral(0.5_f64.sqrt()); // m = ½
/// assert!((k - 1.854_074_677_301_372).abs() < 1e-15);
/// ```
pub fn complete_integral(complementary_modulus: f64) -> f64 {
    let (mut a, mut b) = (1.0, complementary_modulus);
    if b == 0.0 {
        return f64::INFINITY;
    }
    for _ in 0..MAX_STEPS {
        let mean = 0.5 * (a + b);
        if (a - b).abs() <= AGREEMENT * a {
            return FRAC_PI_2 / mean;
        }
        (a, b) = (mean, (a * b).sqrt());
    }
    FRAC_PI_2 / a
}

/// The incomplete integral F(φ|m) = ∫₀^φ dθ/√(1 − m sin²θ) for |φ| ≤ π/2. φ is given by two numbers
/// proportional to its `sine` and `cosine` (≥ 0), so that amplitudes near 0 and near π/2 are equally
/// accurate. k' = √(1−m) in [0, 1]. For other amplitudes, F(φ+π) = F(φ) + 2K.
///
/// Landen's transformation on the tangent, tan(φ₁−φ) = (b/a) tan φ, runs along with the mean of a = 1 and b =
/// k'. The branch of the growing amplitude is counted, and a final arctangent gives the result (Bulirsch,
/// Numer. Math. 7 (1965) 78, procedure `el1`). At k' = 0 the result is asinh tan φ.
///
/// ```
/// use box_physics::free_motion::incomplete_integral;
/// let (m, phi) = (0.75_f64, 0.6_f64);
/// let f = incomplete_integral(phi.sin(), phi.cos(), (1.0 - m).sqrt());
/// assert!((f - 0.628_362_071_230_700_7).abs() < 1e-14);
/// ```
pub fn incomplete_integral(sine: f64, cosine: f64, complementary_modulus: f64) -> f64 {
    if sine == 0.0 {
        return 0.0;
    }
    if complementary_modulus == 0.0 {
        return libm::asinh(sine / cosine);
    }
    let mut cotangent = (cosine / sine).abs();
    // m and b are twice the means of Bulirsch's procedure, which avoids halving in the loop. A cotangent of 0
    // (φ = π/2) becomes −∞ (φ₁ = π) and remains −∞.
    let (mut m, mut b) = (1.0, complementary_modulus);
    let mut half_turns = 0_u64;
    for _ in 0..MAX_STEPS {
        let (product, before) = (m * b, m);
        m += b;
        cotangent -= product / cotangent;
        if cotangent == 0.0 {
            cotangent = product.sqrt() * f64::EPSILON;
        }
        if (before - b).abs() <= AGREEMENT * before {
            break;
        }
        b = 2.0 * product.sqrt();
        half_turns = 2 * half_turns + u64::from(cotangent < 0.0);
    }
    half_turns += u64::from(cotangent < 0.0);
    let f = (libm::atan(m / cotangent) + PI * half_turns as f64) / m;
    if sine < 0.0 { -f } else { f }
}

/// The nome p = exp(−πK'/K) from the parameter m ≤ ½ (so p ≤ e^{−π}): with
/// ε = ½(1−√k')/(1+√k') = ½m/((1+k')(1+√k')²), p = ε + 2ε⁵ + 15ε⁹ + 150ε¹³ + … (Weierstrass;
/// Abramowitz, Stegun 17.3.21). The first omitted term is 1707 ε¹⁷ < 1e-19 relative to p.
pub(crate) fn nome(m: f64) -> f64 {
    let k = (1.0 - m).sqrt();
    let root = 1.0 + k.sqrt();
    let e = 0.5 * m / ((1.0 + k) * root * root);
    let e4 = (e * e) * (e * e);
    e * (1.0 + e4 * (2.0 + e4 * (15.0 + e4 * 150.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4};

    /// Compared with mpmath (40 digits), k' as the f64 shown.
    #[test]
    fn complete_integral_to_the_last_digits() {
        for (k, expected) in [
            (1.0, FRAC_PI_2),
            (0.9486832980505138, 1.6124413487202194),
            (FRAC_1_SQRT_2, 1.8540746773013719),
            (0.5, 2.1565156474996434),
            (0.03162277660168379, 4.841132560550297),
            (3.1622776601683795e-05, 11.747927282280077),
            (1e-10, 24.412145291060348),
            (1e-50, 116.51554901082217),
            (1e-150, 346.77405831022674),
        ] {
            let error = complete_integral(k) / expected - 1.0;
            assert!(error.abs() < 4e-16, "{k}: {error:e}");
        }
        assert_eq!(complete_integral(0.0), f64::INFINITY);
    }

    /// Compared with mpmath (Carlson's form, 60 digits): sine and cosine parts, k', F.
    #[test]
    fn incomplete_integral_to_the_last_digits() {
        for (sine, cosine, k, expected) in [
            (1e-30, 1.0, 1.0, 1e-30),
            (1.0, 1.0, 1.0, FRAC_PI_4),
            (1.0, 1e-9, 1.0, 1.5707963257948967),
            (0.3, 0.8, 0.9486832980505138, 0.359524982970402),
            (0.9, 0.1, 0.9486832980505138, 1.495824765028807),
            (1.0, 1e-9, 0.9486832980505138, 1.6124413476661268),
            (-1.0, 0.0, 0.9486832980505138, -1.6124413487202194),
            (0.3, 0.8, FRAC_1_SQRT_2, 0.3626299679202477),
            (1.0, 1.0, FRAC_1_SQRT_2, 0.8260178762492452),
            (0.9, 0.1, 0.43588989435406733, 2.0288373482688034),
            (1e-30, 1.0, 3.1622776601683795e-05, 1e-30),
            (1.0, 1.0, 3.1622776601683795e-05, 0.881373586886333),
            (1.0, 1e-9, 3.1622776601683795e-05, 11.747895659503481),
            (1.0, 1e-60, 3.1622776601683795e-05, 11.747927282280077),
            (0.9, 0.1, 1e-50, 2.893443985885871),
            (1.0, 1e-60, 1e-50, 116.51554901072217),
            (-1.0, 0.0, 1e-50, -116.51554901082217),
            (0.3, 0.8, 0.0, 0.36672460423013675),
            (1.0, 1e-60, 0.0, 138.84825276020268),
        ] {
            let error = incomplete_integral(sine, cosine, k) / expected - 1.0;
            assert!(error.abs() < 1e-15, "{sine} {cosine} {k}: {error:e}");
        }
    }

    #[test]
    fn nome_against_its_definition() {
        for (m, expected) in [
            (0.5, 0.04321391826377225),
            (0.3, 0.022277436157153507),
            (1e-5, 6.25003125020508e-07),
            (1e-200, 6.25e-202),
        ] {
            assert!((nome(m) / expected - 1.0).abs() < 4e-16, "{m}");
        }
        assert_eq!(nome(0.0), 0.0);
    }
}
