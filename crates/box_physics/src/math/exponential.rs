//! e^{−ζ} and the φ functions of exponential integrators (Hochbruck, Ostermann, Acta Numerica 2010, §2).

/// e^x, with the same bits on every machine.
#[inline]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Coefficients of the exact solution of v' = −(ζ/h) v + a over one step: x += h φ₁ v + h² φ₂ a, v ← e^{−ζ} v + h φ₁ a.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponential {
    /// e^{−ζ}
    pub decay: f64,
    /// φ₁ = (1 − e^{−ζ})/ζ
    pub phi1: f64,
    /// φ₂ = (1 − φ₁)/ζ
    pub phi2: f64,
}

impl Exponential {
    /// No decay: the step is a parabola.
    pub const IDENTITY: Self = Self {
        decay: 1.0,
        phi1: 1.0,
        phi2: 0.5,
    };

    /// Evaluates the functions at ζ = rate × step, any finite value. The relative error is below 4e-16 for |ζ| ≤ 700,
    /// without cancellation at small ζ.
    ///
    /// For |ζ| < ½, φ₂ is summed as Σ (−ζ)ⁿ/(n+2)!, and φ₁ = 1 − ζφ₂ and e^{−ζ} = 1 − ζφ₁ follow. For larger |ζ|, φ₁
    /// comes from `expm1`.
    #[inline]
    pub fn new(zeta: f64) -> Self {
        if zeta == 0.0 {
            return Self::IDENTITY;
        }
        if zeta.abs() < 0.5 {
            // 1/2!, 1/3!, … 1/15!: the first omitted term is below 0.5^14/16! = 3e-18.
            const TERMS: usize = 14;
            let mut phi2 = 0.0;
            let mut factorial = 1.307_674_368e12; // 15!
            for n in (0..TERMS).rev() {
                phi2 = 1.0 / factorial - zeta * phi2;
                factorial /= (n + 2) as f64;
            }
            let phi1 = 1.0 - zeta * phi2;
            Self {
                decay: 1.0 - zeta * phi1,
                phi1,
                phi2,
            }
        } else {
            let growth = libm::expm1(-zeta);
            let phi1 = -growth / zeta;
            Self {
                decay: libm::exp(-zeta),
                phi1,
                phi2: (1.0 - phi1) / zeta,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_expm1_where_both_are_good() {
        for zeta in [0.3, 0.49, 0.499_999, 0.5, 0.500_001, 0.7, -0.3, -0.49] {
            let e = Exponential::new(zeta);
            let phi1 = -libm::expm1(-zeta) / zeta;
            assert!((e.decay - libm::exp(-zeta)).abs() < 3e-16, "{zeta}");
            assert!((e.phi1 - phi1).abs() < 3e-16, "{zeta}");
            assert!((e.phi2 - (1.0 - phi1) / zeta).abs() < 2e-15, "{zeta}");
        }
    }

    #[test]
    fn tiny_and_huge_rates() {
        // φ₂ = 1/2 − ζ/6 to first order.
        let e = Exponential::new(1e-9);
        assert!((e.phi2 - (0.5 - 1e-9 / 6.0)).abs() < 1e-16);
        assert!((e.phi1 - (1.0 - 0.5e-9)).abs() < 2e-16);
        let e = Exponential::new(1e6);
        assert_eq!(e.decay, 0.0);
        assert!((e.phi1 - 1e-6).abs() < 1e-21 && (e.phi2 - (1e-6 - 1e-12)).abs() < 1e-21);
        assert_eq!(Exponential::new(0.0), Exponential::IDENTITY);
    }
}
