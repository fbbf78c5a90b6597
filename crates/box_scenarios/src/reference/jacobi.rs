//! Jacobi's elliptic functions and Legendre's integrals, in terms of the complementary parameter m₁ = 1 − m, so that no
//! accuracy is lost as m → 1.

use super::carlson;

/// sn, cn and dn at one argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jacobi {
    /// sn(u|m)
    pub sn: f64,
    /// cn(u|m)
    pub cn: f64,
    /// dn(u|m)
    pub dn: f64,
}

/// Jacobi's functions of a fixed parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elliptic {
    m1: f64,
    /// The quarter period K(m).
    pub quarter: f64,
}

/// Maximum number of Landen steps. The arithmetic–geometric mean converges quadratically; from m₁ = 1e-300 it takes 13.
const MAX_STEPS: usize = 16;

impl Elliptic {
    /// Creates the functions for the complementary parameter `m1` = 1 − m, 0 < m₁ ≤ 1.
    pub fn new(m1: f64) -> Self {
        let (mut a, mut b) = (1.0_f64, m1.sqrt());
        for _ in 0..MAX_STEPS {
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
        }
        Self {
            m1,
            quarter: core::f64::consts::FRAC_PI_2 / a,
        }
    }

    /// sn, cn, dn at any real `u`, and the number of half periods 2K that were subtracted.
    pub fn at(&self, u: f64) -> (Jacobi, f64) {
        let half_periods = (u / (2.0 * self.quarter)).round();
        let r = u - half_periods * (2.0 * self.quarter);
        let base = self.quarter_range(r);
        // sn and cn change sign with every half period, dn does not.
        let sign = if half_periods.rem_euclid(2.0) == 0.0 {
            1.0
        } else {
            -1.0
        };
        let j = Jacobi {
            sn: sign * base.sn,
            cn: sign * base.cn,
            dn: base.dn,
        };
        (j, half_periods)
    }

    /// The functions for |r| ≤ K. Above K/2 they are computed from the distance to K, because cn and dn would cancel
    /// there: sn(K−s) = cn s/dn s, cn(K−s) = k' sn s/dn s, dn(K−s) = k'/dn s.
    fn quarter_range(&self, r: f64) -> Jacobi {
        if r.abs() <= 0.5 * self.quarter {
            return self.landen(r);
        }
        let s = self.landen(self.quarter - r.abs());
        let k1 = self.m1.sqrt();
        Jacobi {
            sn: (s.cn / s.dn).copysign(r),
            cn: k1 * s.sn / s.dn,
            dn: k1 / s.dn,
        }
    }

    /// Descending Landen transformation (Abramowitz, Stegun 1964, 16.4): with aₙ, cₙ of the
    /// arithmetic–geometric mean, φ_N = 2ᴺ a_N u, sin(2φₙ₋₁ − φₙ) = (cₙ/aₙ) sin φₙ, sn = sin φ₀.
    fn landen(&self, u: f64) -> Jacobi {
        let (mut a, mut b) = (1.0_f64, self.m1.sqrt());
        let mut ratios = [0.0; MAX_STEPS];
        let mut n = 0;
        while n < MAX_STEPS {
            let c = 0.5 * (a - b);
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
            ratios[n] = c / a;
            n += 1;
            if c <= 1e-17 * a {
                break;
            }
        }
        let mut phi = a * u * (1u32 << n) as f64;
        for ratio in ratios[..n].iter().rev() {
            phi = 0.5 * (phi + libm::asin(ratio * libm::sin(phi)));
        }
        let (sn, cn) = libm::sincos(phi);
        // dn² = 1 − m sn² = cn² + m₁ sn²
        Jacobi {
            sn,
            cn,
            dn: (cn * cn + self.m1 * sn * sn).sqrt(),
        }
    }

    /// F(φ|m) for a point (cos φ, sin φ) ∝ (`x`, `y`) on the circle, −π < φ ≤ π: Carlson's
    /// F = sin φ R_F(cos²φ, 1 − m sin²φ, 1), reflected beyond ±π/2.
    pub fn first_integral(&self, y: f64, x: f64) -> f64 {
        let norm = libm::hypot(x, y);
        let (s, c) = (y / norm, x / norm);
        let delta = c * c + self.m1 * s * s;
        let f = s * carlson::rf(c * c, delta, 1.0);
        if x >= 0.0 {
            f
        } else {
            (2.0 * self.quarter).copysign(y) - f
        }
    }

    /// ∫₀ᵘ cn²/(cn² + p sn²) dw for p > 0, monotonic in u. With ν = 1 − p the integrand is
    /// 1 − p sn²/(1 − ν sn²), and ∫ sn²/(1 − ν sn²) = ⅓ sn³ R_J(cn², dn², 1, cn² + p sn²) on
    /// |u| ≤ K (DLMF 19.25.14): no cancellation at any p.
    pub fn third_integral(&self, u: f64, p: f64) -> f64 {
        let part = |sn: f64, cn2: f64, dn2: f64| {
            p * sn * sn * sn / 3.0 * carlson::rj(cn2, dn2, 1.0, cn2 + p * sn * sn)
        };
        let (j, half_periods) = self.at(u);
        let sign = if half_periods.rem_euclid(2.0) == 0.0 {
            1.0
        } else {
            -1.0
        };
        let within = part(sign * j.sn, j.cn * j.cn, j.dn * j.dn);
        let whole = if half_periods == 0.0 {
            0.0
        } else {
            2.0 * half_periods * part(1.0, 0.0, self.m1)
        };
        u - (within + whole)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values to 20 digits from the Taylor series of am(u) in 50-digit arithmetic (mpmath).
    #[test]
    fn against_high_precision() {
        // (m₁, u, sn, cn, dn, K)
        for (m1, u, sn, cn, dn, quarter) in TABLE {
            let e = Elliptic::new(m1);
            assert!(
                (e.quarter - quarter).abs() < 1e-15 * quarter,
                "K at m₁ = {m1}: {}",
                e.quarter
            );
            let (j, _) = e.at(u);
            let error = (j.sn - sn)
                .abs()
                .max((j.cn - cn).abs())
                .max((j.dn - dn).abs());
            assert!(error < 1e-14, "m₁ = {m1}, u = {u}: {error:e}");
            let back = e.first_integral(j.sn, j.cn);
            let turns = ((u - back) / (4.0 * quarter)).round();
            assert!(
                (back + 4.0 * quarter * turns - u).abs() < 1e-13 * u.abs().max(1.0) / dn.max(1e-3),
                "F at {m1}, {u}"
            );
        }
    }

    include!("jacobi_table.rs");

    #[test]
    fn third_integral_is_its_integrand() {
        for m1 in [0.9, 0.2, 1e-3, 1e-9] {
            let e = Elliptic::new(m1);
            for p in [1e-2, 0.3, 1.0, 7.0, 1e2] {
                for u in [-3.0, 0.4, 1.7, 11.0] {
                    let exact = simpson(0.0, u, |w| {
                        let (j, _) = e.at(w);
                        j.cn * j.cn / (j.cn * j.cn + p * j.sn * j.sn)
                    });
                    let error = (e.third_integral(u, p) - exact).abs();
                    assert!(error < 1e-8, "m₁ = {m1}, p = {p}, u = {u}: {error:e}");
                }
            }
        }
    }

    fn simpson(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
        let n = 20_000;
        let h = (b - a) / f64::from(n);
        let inner: f64 = (1..n)
            .map(|k| f(a + f64::from(k) * h) * if k % 2 == 1 { 4.0 } else { 2.0 })
            .sum();
        (f(a) + inner + f(b)) * h / 3.0
    }
}
