//! A log10 axis for `egui_plot`, which has none (0.37): plot [`to_axis`] of the value, give the plot
//! [`marks`] and [`tick`], and print [`from_axis`] in labels.

use egui_plot::{GridInput, GridMark};

use super::format::number;

/// Zero and less stand here, below anything a step can cost or miss.
pub(super) const FLOOR: f64 = 1e-17;

/// Place of a value on the axis; NaN for a value that is not finite, so that the line breaks.
pub(super) fn to_axis(value: f64) -> f64 {
    if value.is_finite() {
        value.max(FLOOR).log10()
    } else {
        f64::NAN
    }
}

/// The value at a place on the axis.
pub(super) fn from_axis(place: f64) -> f64 {
    10_f64.powf(place)
}

/// Most decades with marks between them, and most decades marked one by one: more labels than that find
/// no room in a low drawer.
const FINE: f64 = 6.0;
const COARSE: f64 = 6.0;

/// Grid marks: every decade (every second, fifth, … where there are many) and, where there are few, the
/// 2 to 9 between them.
#[expect(
    clippy::needless_pass_by_value,
    reason = "the signature egui_plot asks for"
)]
pub(super) fn marks(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let span = high - low;
    // Nothing to mark before the first point; a value in f64 has at most 633 decades.
    if !(low.is_finite() && high.is_finite() && span > 0.0 && span < 2000.0) {
        return Vec::new();
    }
    let stride = (span / COARSE).ceil().max(1.0);
    let mut out = Vec::new();
    let mut decade = (low / stride).floor() * stride;
    while decade <= high {
        out.push(GridMark {
            value: decade,
            step_size: stride,
        });
        if span <= FINE {
            for digit in 2..=9 {
                let value = decade + f64::from(digit).log10();
                // Room to the next labeled mark (1, 2, 5, 10), which decides whether a label fits.
                let step_size = if span <= LABELLED && (digit == 2 || digit == 5) {
                    0.3
                } else {
                    0.05
                };
                out.push(GridMark { value, step_size });
            }
        }
        decade += stride;
    }
    out.retain(|mark| (low..=high).contains(&mark.value));
    out
}

/// Fewer decades than this also label 2 and 5.
const LABELLED: f64 = 1.7;

/// The label of a mark: `1000`, `1e-6`; and 2, 5 between decades where few decades are in sight.
pub(super) fn tick(mark: GridMark, low: f64, high: f64) -> String {
    let decade = (mark.value - mark.value.round()).abs() < 1e-9;
    let digit = from_axis(mark.value - mark.value.floor()).round() as u8;
    if decade {
        let exponent = mark.value.round();
        if exponent <= FLOOR.log10().round() {
            "≤1e-17".to_owned()
        } else if (-3.0..=5.0).contains(&exponent) {
            number_of_decade(exponent)
        } else {
            format!("1e{exponent}")
        }
    } else if high - low <= LABELLED && (digit == 2 || digit == 5) {
        number(from_axis(mark.value))
    } else {
        String::new()
    }
}

/// 10ⁿ in full, −3 ≤ n ≤ 5.
fn number_of_decade(exponent: f64) -> String {
    if exponent >= 0.0 {
        format!("{:.0}", from_axis(exponent))
    } else {
        format!("{:.*}", -exponent as usize, from_axis(exponent))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(low: f64, high: f64) -> Vec<GridMark> {
        marks(GridInput {
            bounds: (low, high),
            base_step_size: 0.1,
        })
    }

    fn labels(low: f64, high: f64) -> Vec<String> {
        grid(low, high)
            .into_iter()
            .map(|m| tick(m, low, high))
            .filter(|t| !t.is_empty())
            .collect()
    }

    #[test]
    fn there_and_back() {
        for value in [1e-12, 0.3, 1.0, 250.0, 1e9] {
            assert!((from_axis(to_axis(value)) / value - 1.0).abs() < 1e-12);
        }
        assert_eq!(to_axis(0.0), -17.0);
        assert_eq!(to_axis(-5.0), -17.0);
        assert!(to_axis(f64::NAN).is_nan() && to_axis(f64::INFINITY).is_nan());
    }

    #[test]
    fn decades_in_words_of_one_size() {
        assert_eq!(labels(0.5, 3.5), ["10", "100", "1000"]);
        assert_eq!(
            labels(-6.5, -1.5),
            ["1e-6", "1e-5", "1e-4", "0.001", "0.01"]
        );
        assert_eq!(labels(4.5, 7.2), ["100000", "1e6", "1e7"]);
    }

    #[test]
    fn less_than_two_decades_label_two_and_five() {
        assert_eq!(labels(1.9, 3.1), ["100", "200", "500", "1000"]);
        assert_eq!(labels(2.1, 2.9), ["200", "500"]);
    }

    #[test]
    fn marks_are_few_sane_and_inside() {
        for (low, high) in [(1.9, 3.1), (-17.0, 3.0), (-300.0, 300.0), (0.0, 6.0)] {
            let marks = grid(low, high);
            assert!(
                (1..=60).contains(&marks.len()),
                "{low} {high}: {}",
                marks.len()
            );
            assert!(
                marks
                    .iter()
                    .all(|m| m.value >= low && m.value <= high && m.step_size > 0.0)
            );
        }
        assert_eq!(grid(0.0, 6.0).len(), 7 + 6 * 8);
        assert!(grid(f64::NEG_INFINITY, f64::INFINITY).is_empty());
        assert!(grid(f64::NAN, 1.0).is_empty() && grid(1.0, 1.0).is_empty());
    }
}
