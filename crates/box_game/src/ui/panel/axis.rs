//! Axes of the plots. A linear axis is marked at 1, 2 or 5 times a power of ten, with enough labels for a low plot: by
//! default, `egui_plot` (0.37) marks only powers of ten, of which a plot may contain one. For a log axis, plot
//! [`to_axis`] of the value and print [`from_axis`] in labels.

use std::ops::RangeInclusive;

use egui_plot::{GridInput, GridMark, uniform_grid_spacer};

use super::format::number;

/// Distance of labels on a linear axis, in units of the finest grid spacing: 24 points vertically, 64 horizontally,
/// where labels are wider than high.
pub(super) const UPRIGHT: f64 = 3.0;
pub(super) const ALONG: f64 = 8.0;
/// Maximum number of marks; more mean that the plot is not laid out yet.
const MAX_GRID_MARKS: f64 = 200.0;

/// Position of values ≤ 0, below any cost or error of a step.
const FLOOR: f64 = 1e-17;
/// Maximum number of decades with marks between them, and of decades that are all marked. More labels do not fit in a
/// low drawer.
const FEW: f64 = 6.0;
/// Number of decades below which 2 and 5 are also labeled.
const LABELED: f64 = 1.7;

/// Marks of an axis. On a linear one, `apart` is their distance.
pub(super) fn marks(log: bool, apart: f64) -> Box<dyn Fn(GridInput) -> Vec<GridMark>> {
    if log {
        Box::new(|input| log_marks(input.bounds))
    } else {
        uniform_grid_spacer(move |input| steps(&input, apart))
    }
}

pub(super) fn label(log: bool, mark: GridMark, range: &RangeInclusive<f64>) -> String {
    if log {
        tick(mark.value, range.end() - range.start())
    } else {
        number(mark.value)
    }
}

/// Distances of the marks without and with a label. None if the distance is infinite.
fn steps(input: &GridInput, apart: f64) -> [f64; 3] {
    let (low, high) = input.bounds;
    let (step, parts) = round_up(input.base_step_size * apart);
    let count = (high - low) / step;
    if (0.0..MAX_GRID_MARKS).contains(&count) {
        [step / parts, step, step]
    } else {
        [f64::INFINITY; 3]
    }
}

/// The next of 1, 2, 5 times a power of ten, and the number of its divisions.
fn round_up(value: f64) -> (f64, f64) {
    let decade = 10_f64.powf(value.log10().floor());
    let parts = [(1.0, 5.0), (2.0, 4.0), (5.0, 5.0), (10.0, 5.0)];
    let parts = parts.map(|(digit, parts)| (digit * decade, parts));
    let next = parts.into_iter().find(|p| p.0 >= value * (1.0 - 1e-9));
    next.unwrap_or((f64::NAN, 1.0))
}

/// Position of a value on a log axis; NaN for a value that is not finite, so that the line breaks.
pub(super) fn to_axis(value: f64) -> f64 {
    if value.is_finite() {
        value.max(FLOOR).log10()
    } else {
        f64::NAN
    }
}

/// The value at a position on a log axis.
pub(super) fn from_axis(place: f64) -> f64 {
    10_f64.powf(place)
}

/// Every decade (every second, fifth, … of many) and, between few decades, the digits 2 to 9.
fn log_marks((low, high): (f64, f64)) -> Vec<GridMark> {
    let span = high - low;
    // No marks before the first point; a value in f64 has at most 633 decades.
    if !(span > 0.0 && span < 2000.0) {
        return Vec::new();
    }
    let stride = (span / FEW).ceil();
    let digits = if span <= FEW { 1..=9 } else { 1..=1 };
    let mark = |decade: f64, digit: u8| GridMark {
        value: decade + f64::from(digit).log10(),
        // Distance to the next labeled mark, which decides whether a label fits.
        step_size: match digit {
            1 => stride,
            2 | 5 if span <= LABELED => 0.3,
            _ => 0.05,
        },
    };
    ((low / stride).floor() as i32..=(high / stride).floor() as i32)
        .flat_map(|k| digits.clone().map(move |digit| (f64::from(k), digit)))
        .map(|(k, digit)| mark(k * stride, digit))
        .filter(|mark| (low..=high).contains(&mark.value))
        .collect()
}

/// Label of a mark: `1000`, `1e-6`; between few decades also 2 and 5.
fn tick(place: f64, span: f64) -> String {
    let exponent = place.round();
    let digit = from_axis(place - place.floor()).round();
    if (place - exponent).abs() < 1e-9 {
        match exponent as i32 {
            ..=-17 => "≤1e-17".to_owned(),
            n @ -3..=5 => number(10_f64.powi(n)),
            n => format!("1e{n}"),
        }
    } else if span <= LABELED && (digit == 2.0 || digit == 5.0) {
        number(from_axis(place))
    } else {
        String::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(log: bool, bounds: (f64, f64), base_step_size: f64) -> Vec<GridMark> {
        let input = GridInput {
            bounds,
            base_step_size,
        };
        marks(log, UPRIGHT)(input)
    }

    /// Any range gives a plot of 170 points height two to eight labels, at least 24 points apart, at round numbers
    /// including zero.
    #[test]
    fn every_linear_range_has_a_few_round_labels() {
        for exponent in -9..4 {
            for top in [1.0, 1.4, 2.1, 3.3, 4.8, 7.6, 9.9] {
                let high = top * 10_f64.powi(exponent);
                let low = -0.3 * high;
                let spacing = 8.0 * (high - low) / 170.0;
                let all = grid(false, (low, high), spacing);
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
        for (high, step) in [
            (0.0, 1.0),
            (f64::INFINITY, 1.0),
            (1.0, 0.0),
            (1.0, f64::NAN),
            (1e9, 1e-3),
        ] {
            assert_eq!(grid(false, (0.0, high), step), [], "{high} {step}");
        }
        for (low, high) in [
            (f64::NEG_INFINITY, f64::INFINITY),
            (f64::NAN, 1.0),
            (1.0, 1.0),
        ] {
            assert_eq!(grid(true, (low, high), 0.1), [], "{low} {high}");
        }
    }

    #[test]
    fn decades_in_words_of_one_size_and_two_and_five_where_they_are_few() {
        for (low, high, labels) in [
            (0.5, 3.5, "10 100 1000"),
            (-6.5, -1.5, "1e-6 1e-5 1e-4 0.001 0.01"),
            (3.5, 6.2, "10\u{a0}000 1e5 1e6"),
            (1.9, 3.1, "100 200 500 1000"),
            (2.1, 2.9, "200 500"),
        ] {
            let marks = grid(true, (low, high), 0.1);
            let found: Vec<_> = marks
                .iter()
                .map(|&m| label(true, m, &(low..=high)))
                .collect();
            let found: Vec<_> = found.iter().filter(|t| !t.is_empty()).collect();
            assert_eq!(found, labels.split(' ').collect::<Vec<_>>());
        }
    }

    #[test]
    fn log_marks_are_few_sane_and_inside() {
        for (low, high) in [(1.9, 3.1), (-17.0, 3.0), (-300.0, 300.0), (0.0, 6.0)] {
            let marks = grid(true, (low, high), 0.1);
            let sane = |m: &GridMark| (low..=high).contains(&m.value) && m.step_size > 0.0;
            assert!((1..=60).contains(&marks.len()) && marks.iter().all(sane));
        }
        assert_eq!(grid(true, (0.0, 6.0), 0.1).len(), 7 + 6 * 8);
    }
}
