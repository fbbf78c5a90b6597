//! Large angles.

use core::f64::consts::FRAC_2_PI;

use crate::math::sin_cos;

/// π/2 in three parts: 33 bits, 33 bits and the remainder (fdlibm, Sun Microsystems 1993). A multiple below
/// 2²⁰ of the first two is exact.
const FIRST: f64 = 1.5707963267341256;
const SECOND: f64 = 6.077100506303966e-11;
const THIRD: f64 = 2.0222662487959506e-21;
const EXACT_MULTIPLES: f64 = 1_048_576.0;

/// The nearest whole number, ties to even, by adding and subtracting 1.5·2⁵², where the spacing of f64 is 1.
/// Returns `x` itself beyond 2⁵¹.
#[inline(always)]
pub(super) fn nearest(x: f64) -> f64 {
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    if x.abs() < 2_251_799_813_685_248.0 {
        (x + SHIFT) - SHIFT
    } else {
        x
    }
}

/// (sin x, cos x) like [`sin_cos`], and as fast for an `x` \[rad\] of thousands of turns as for a small one.
/// Quarter turns are subtracted in three parts (Cody, Waite 1980); the remainder is in the range of the
/// polynomials.
#[inline(always)]
pub(super) fn sin_cos_of_phase(x: f64) -> (f64, f64) {
    let quarters = nearest(x * FRAC_2_PI);
    if quarters.abs() >= EXACT_MULTIPLES || quarters.is_nan() {
        return sin_cos(x);
    }
    let rest = ((x - quarters * FIRST) - quarters * SECOND) - quarters * THIRD;
    let (s, c) = sin_cos(rest);
    match (quarters as i32) & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_libm() {
        let mut x = 1e-9;
        while x < 1e18 {
            for x in [x, -x] {
                let (s, c) = sin_cos_of_phase(x);
                assert!((s - libm::sin(x)).abs() < 2.3e-16, "{x:e}");
                assert!((c - libm::cos(x)).abs() < 2.3e-16, "{x:e}");
            }
            x *= 1.0037;
        }
        assert!(sin_cos_of_phase(f64::NAN).0.is_nan());
    }

    #[test]
    fn nearest_is_round_half_even() {
        for (x, n) in [
            (0.5, 0.0),
            (1.5, 2.0),
            (-2.6, -3.0),
            (1e300, 1e300),
            (3.49, 3.0),
        ] {
            assert_eq!(nearest(x), n);
        }
    }
}
