//! Carlson's symmetric elliptic integrals, by duplication (B. C. Carlson, Numer. Algorithms 10, 1995; DLMF 19.36).
//!
//! Implemented here because available libraries use the platform's power and arc tangent functions; `libm` has the same
//! bits on every machine.

/// Spread of the arguments below which the series after the duplications have a negligible relative error: (ε/4)^(1/6)
/// with ε = 2⁻⁵³.
const SPREAD: f64 = 1.7e-3;

/// R_F(x, y, z) for arguments ≥ 0, at most one of them 0. Relative error 1e-15.
pub(super) fn rf(mut x: f64, mut y: f64, mut z: f64) -> f64 {
    let mut mean = (x + y + z) / 3.0;
    let (dx, dy) = (mean - x, mean - y);
    let widest = dx.abs().max(dy.abs()).max((dx + dy).abs());
    let mut shrunk = 1.0;
    while shrunk * widest > SPREAD * mean {
        let (a, b, c) = (x.sqrt(), y.sqrt(), z.sqrt());
        let lambda = a * b + b * c + c * a;
        [x, y, z, mean] = [x, y, z, mean].map(|v| 0.25 * (v + lambda));
        shrunk *= 0.25;
    }
    let (x, y) = (shrunk * dx / mean, shrunk * dy / mean);
    let z = -(x + y);
    let (e2, e3) = (x * y - z * z, x * y * z);
    (1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 / 44.0 * e2 * e3) / mean.sqrt()
}

/// R_J(x, y, z, p) for arguments ≥ 0, at most one of x, y, z equal to 0, p > 0. The relative error is 1e-15, except for
/// a cancellation of at most two digits.
pub(super) fn rj(mut x: f64, mut y: f64, mut z: f64, mut p: f64) -> f64 {
    let mut mean = (x + y + z + 2.0 * p) / 5.0;
    let (dx, dy, dz) = (mean - x, mean - y, mean - z);
    let delta = (p - x) * (p - y) * (p - z);
    let widest = dx.abs().max(dy.abs()).max(dz.abs()).max((mean - p).abs());
    let (mut shrunk, mut sum) = (1.0, 0.0);
    while shrunk * widest > SPREAD * mean {
        let (a, b, c, r) = (x.sqrt(), y.sqrt(), z.sqrt(), p.sqrt());
        let lambda = a * b + b * c + c * a;
        let d = (r + a) * (r + b) * (r + c);
        sum += shrunk / d * rc_beside_1(shrunk * shrunk * shrunk * delta / (d * d));
        [x, y, z, p, mean] = [x, y, z, p, mean].map(|v| 0.25 * (v + lambda));
        shrunk *= 0.25;
    }
    let [x, y, z] = [dx, dy, dz].map(|d| shrunk * d / mean);
    let p = -0.5 * (x + y + z);
    let e2 = x * y + y * z + z * x - 3.0 * p * p;
    let e3 = x * y * z + 2.0 * e2 * p + 4.0 * p * p * p;
    let e4 = (2.0 * x * y * z + e2 * p + 3.0 * p * p * p) * p;
    let e5 = x * y * z * p * p;
    let series = 1.0 - 3.0 / 14.0 * e2 + e3 / 6.0 + 9.0 / 88.0 * e2 * e2
        - 3.0 / 22.0 * e4
        - 9.0 / 52.0 * e2 * e3
        + 3.0 / 26.0 * e5;
    shrunk * series / (mean * mean.sqrt()) + 6.0 * sum
}

/// R_C(1, 1 + e) for e > −1.
fn rc_beside_1(e: f64) -> f64 {
    let s = e.abs().sqrt();
    match e {
        _ if s == 0.0 => 1.0,
        _ if e > 0.0 => libm::atan(s) / s,
        _ => libm::atanh(s) / s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (x, y, z, p, R_J(x, y, z, p), R_F(x, y, z)) by mpmath.
    #[test]
    fn against_high_precision() {
        for (x, y, z, p, exact_j, exact_f) in [
            (0.0, 0.001, 1.0, 0.001, 2994.983958780465, 4.841132560550297),
            (0.0, 0.001, 1.0, 0.5, 21.586690420974442, 4.841132560550297),
            (0.0, 0.001, 1.0, 40.0, 0.346131035384295, 4.841132560550297),
            (
                0.0,
                1e-9,
                1.0,
                0.001,
                22797.243485615913,
                11.747927282280077,
            ),
            (0.0, 1e-9, 1.0, 0.5, 63.008860872006565, 11.747927282280077),
            (0.0, 1e-9, 1.0, 40.0, 0.864136781192727, 11.747927282280077),
            (
                0.0,
                1e-15,
                1.0,
                0.001,
                43520.498665898085,
                18.655682558575236,
            ),
            (0.0, 1e-15, 1.0, 0.5, 104.45539246976875, 18.655682558575236),
            (0.0, 1e-15, 1.0, 40.0, 1.382218426904532, 18.655682558575236),
            (0.3, 0.7, 1.0, 0.2, 3.828949013438806, 1.2650802817015436),
            (0.9, 0.99, 1.0, 1.5, 0.8032950157136229, 1.0191919540680562),
            (0.5, 0.5, 1.0, 0.5, 2.260648559158617, 1.246450480280461),
            (
                1e-4,
                0.3,
                1.0,
                90.0,
                0.06348111159044209,
                2.0573100602960635,
            ),
        ] {
            for (what, computed, exact) in [
                ("R_J", rj(x, y, z, p), exact_j),
                ("R_F", rf(x, y, z), exact_f),
            ] {
                let error = (computed / exact - 1.0).abs();
                assert!(error < 1e-14, "{what} at {x} {y} {z} {p}: {error:e}");
            }
        }
    }
}
