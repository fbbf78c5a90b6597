//! Quantiles of samples, and the order of convergence of errors.

use core::fmt;

/// Samples in ascending order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Quantiles(Vec<f64>);

impl Quantiles {
    /// Sorts `samples`.
    pub fn of(samples: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = samples.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        Self(sorted)
    }

    /// The sample nearest to the quantile `q`, 0 to 1; NaN if there are no samples.
    pub fn at(&self, q: f64) -> f64 {
        let last = self.0.len().saturating_sub(1);
        let place = (last as f64 * q).round() as usize;
        self.0.get(place).copied().unwrap_or(f64::NAN)
    }

    /// The smallest sample.
    pub fn min(&self) -> f64 {
        self.at(0.0)
    }

    /// The median sample.
    pub fn median(&self) -> f64 {
        self.at(0.5)
    }

    /// The mean of the middle half of the samples. It has a finer resolution than the median if a coarse clock rounds
    /// the samples.
    pub fn middle(&self) -> f64 {
        let n = self.0.len();
        let half = &self.0[n / 4..(3 * n).div_ceil(4)];
        half.iter().sum::<f64>() / half.len() as f64
    }
}

/// Result of fitting an order to errors at several steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fitted {
    /// Error ∝ dtᵖ.
    Order(f64),
    /// Only rounding errors at every step.
    Rounding,
    /// Too few points between lost runs and rounding.
    Unknown,
}

impl fmt::Display for Fitted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Order(p) => write!(f, "dt^p, p = {p:.1}"),
            Self::Rounding => f.write_str("rounding"),
            Self::Unknown => f.write_str("no order"),
        }
    }
}

/// Errors above this are no longer proportional to a power of the step: a tenth of a radian, of a meter, or of the
/// energy.
const MAX_FITTED_ERROR: f64 = 0.1;
/// Errors below this \[m, rad or relative\] are rounding errors, summed over tens of thousands of steps and amplified
/// by the motion.
const MAX_ROUNDING_ERROR: f64 = 1e-10;
/// Factor by which a point must exceed the smallest error, which may be rounding.
const ABOVE_FLOOR: f64 = 20.0;

/// Fits the order to pairs (dt, error) in any order; failed runs are ignored.
///
/// The line is a least-squares fit of the logarithms over the errors that are neither lost nor near the smallest. If
/// there are many, only the smaller half of the steps is used, because the order is defined for small steps.
pub fn order(points: &[(f64, f64)]) -> Fitted {
    let mut points: Vec<_> = points
        .iter()
        .copied()
        .filter(|(_, e)| e.is_finite())
        .collect();
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    if points.len() < 3 {
        return Fitted::Unknown;
    }
    if points.iter().all(|p| p.1 < MAX_ROUNDING_ERROR) {
        return Fitted::Rounding;
    }
    // Uses the points from the largest step to the smallest error. Beyond, rounding errors grow.
    let smallest = points
        .iter()
        .enumerate()
        .min_by(|a, b| a.1.1.total_cmp(&b.1.1))
        .map_or(0, |(k, _)| k);
    let floor = if points[smallest].1 < 100.0 * MAX_ROUNDING_ERROR {
        ABOVE_FLOOR * points[smallest].1.max(1e-13)
    } else {
        0.0
    };
    let usable: Vec<_> = points[..=smallest]
        .iter()
        .filter(|p| p.1 < MAX_FITTED_ERROR && p.1 > floor)
        .map(|(h, e)| (libm::log(*h), libm::log(*e)))
        .collect();
    if usable.len() < 2 {
        return Fitted::Unknown;
    }
    let keep = usable.len().div_ceil(2).max(3).min(usable.len());
    let tail = &usable[usable.len() - keep..];
    let n = tail.len() as f64;
    let (mx, my) = tail
        .iter()
        .fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
    let (sxy, sxx) = tail.iter().fold((0.0, 0.0), |s, p| {
        (s.0 + (p.0 - mx) * (p.1 - my), s.1 + (p.0 - mx).powi(2))
    });
    Fitted::Order(sxy / sxx)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(f: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..8)
            .map(|k| 1.0 / 15.0 / f64::from(1 << k))
            .map(|h| (h, f(h)))
            .collect()
    }

    fn fitted(f: impl Fn(f64) -> f64) -> f64 {
        match order(&errors(f)) {
            Fitted::Order(p) => p,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn quantiles_are_samples() {
        let q = Quantiles::of([5.0, 1.0, 4.0, 2.0, 3.0]);
        assert_eq!(
            (q.min(), q.median(), q.at(0.95), q.at(0.7)),
            (1.0, 3.0, 5.0, 4.0)
        );
        assert_eq!(q.middle(), 3.0);
        assert!(Quantiles::default().median().is_nan() && Quantiles::default().middle().is_nan());
    }

    #[test]
    fn orders_are_found_between_lost_and_rounding() {
        assert!((fitted(|h| 3.0 * h * h) - 2.0).abs() < 1e-9);
        // Lost for large steps, rounding for small ones.
        let fourth = |h: f64| (1e4 * h.powi(4)).min(3.0) + 1e-14 / h;
        assert!((fitted(fourth) - 4.0).abs() < 0.1);
        let sixth = |h: f64| h.powi(6) + 1e-14;
        assert!((fitted(sixth) - 6.0).abs() < 0.2);
        assert_eq!(order(&errors(|h| 1e-15 / h)), Fitted::Rounding);
        assert_eq!(order(&errors(|_| 2.5)), Fitted::Unknown);
        assert_eq!(order(&errors(|_| f64::INFINITY)), Fitted::Unknown);
    }
}
