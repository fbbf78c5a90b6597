//! Marks of a linear axis at 1, 2 or 5 times a power of ten, close enough together that a low plot has a
//! few with labels: `egui_plot` marks powers of ten alone, of which a plot may hold one.

use egui_plot::{GridInput, GridMark};

/// Labeled marks stand this many times the finest spacing of the plot's grid apart: 24 points above each other, 64 side
/// by side, where a label is wider than high.
const APART: f64 = 3.0;
const ALONG: f64 = 8.0;
/// More marks than this are a plot that is not laid out yet.
const MOST: f64 = 200.0;

/// [`marks`] of a horizontal axis.
pub(super) fn along(input: GridInput) -> Vec<GridMark> {
    marks(GridInput {
        base_step_size: input.base_step_size * ALONG / APART,
        ..input
    })
}

/// Grid marks: those that get labels, and the plain ones between them.
#[expect(
    clippy::needless_pass_by_value,
    reason = "the signature egui_plot asks for"
)]
pub(super) fn marks(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let finest = input.base_step_size * APART;
    if !(low.is_finite() && high > low && high.is_finite() && finest > 0.0 && finest.is_finite()) {
        return Vec::new();
    }
    let (step, parts) = round_up(finest);
    let count = (high - low) / step;
    if count.is_nan() || count > MOST {
        return Vec::new();
    }
    let minor = step / f64::from(parts);
    let first = (low / minor).ceil() as i64;
    let last = (high / minor).floor() as i64;
    (first..=last)
        .map(|k| GridMark {
            // Of an integer, so that zero is zero.
            value: k as f64 * minor,
            step_size: if k.rem_euclid(i64::from(parts)) == 0 {
                step
            } else {
                minor
            },
        })
        .collect()
}

/// The next of 1, 2, 5 times a power of ten, and into how many parts it is divided.
fn round_up(value: f64) -> (f64, u8) {
    let decade = 10_f64.powf(value.log10().floor());
    for (digit, parts) in [(1.0, 5), (2.0, 4), (5.0, 5)] {
        if digit * decade >= value * (1.0 - 1e-9) {
            return (digit * decade, parts);
        }
    }
    (10.0 * decade, 5)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In a plot 170 points high, whatever its range: two to eight labels, at least 24 points apart, at
    /// round numbers, zero among them.
    #[test]
    fn every_range_has_a_few_round_labels() {
        for exponent in -9..4 {
            for top in [1.0, 1.4, 2.1, 3.3, 4.8, 7.6, 9.9] {
                let high = top * 10_f64.powi(exponent);
                let low = -0.3 * high;
                let spacing = 8.0 * (high - low) / 170.0;
                let all = marks(GridInput {
                    bounds: (low, high),
                    base_step_size: spacing,
                });
                let step = all.iter().map(|m| m.step_size).fold(0.0, f64::max);
                let labeled: Vec<_> = all.iter().filter(|m| m.step_size == step).collect();
                assert!((2..=8).contains(&labeled.len()), "{high}: {labeled:?}");
                assert!(step >= 3.0 * spacing * (1.0 - 1e-9));
                assert!(labeled.iter().any(|m| m.value == 0.0));
                let digit = step / 10_f64.powf(step.log10().floor() + 1e-9);
                assert!(digit > 0.99 && digit < 5.01, "{step}");
            }
        }
    }

    #[test]
    fn a_plot_without_a_size_has_no_marks() {
        for (low, high, step) in [
            (0.0, 0.0, 1.0),
            (0.0, f64::INFINITY, 1.0),
            (0.0, 1.0, 0.0),
            (0.0, 1.0, f64::NAN),
            (0.0, 1e9, 1e-3),
        ] {
            assert!(
                marks(GridInput {
                    bounds: (low, high),
                    base_step_size: step,
                })
                .is_empty()
            );
        }
    }
}
