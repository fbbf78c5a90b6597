//! Axes: range, grid lines and labels.

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};

/// Mapping of values to an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    /// Linear.
    Linear,
    /// Logarithmic, with decades.
    Log,
}

/// An axis with its title, which includes the unit.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub(crate) title: String,
    pub(crate) scale: Scale,
    /// Smallest and largest value shown. On a logarithmic axis, smaller values are drawn at the lower end.
    pub(crate) limits: (f64, f64),
}

impl Axis {
    pub(crate) fn log(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            scale: Scale::Log,
            limits: (1e-16, 1e12),
        }
    }

    pub(crate) fn linear(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            scale: Scale::Linear,
            limits: (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// Returns this axis limited to values from `low` to `high`.
    #[must_use]
    pub(crate) fn within(mut self, low: f64, high: f64) -> Self {
        self.limits = (low, high);
        self
    }

    /// The range that shows `values`.
    pub(super) fn range(&self, values: &[f64]) -> Range {
        match self.scale {
            Scale::Log => self.decades(values),
            Scale::Linear => self.even(values),
        }
    }

    fn decades(&self, values: &[f64]) -> Range {
        let (low, high) = self.limits;
        let logs = values
            .iter()
            .filter(|v| v.is_finite() && **v <= high)
            .map(|v| v.max(low).log10());
        let (mut from, mut to) = extent(logs).unwrap_or((0.0, 1.0));
        // A margin of 5 %, and at least one whole decade.
        let margin = 0.05 * (to - from).max(0.5);
        (from, to) = (from - margin, to + margin);
        if from.ceil() >= to.floor() {
            (from, to) = (from.floor(), to.ceil().max(from.floor() + 1.0));
        }
        let every = ((to - from) / 9.0).ceil().max(1.0);
        let decades = || (from.ceil() as i32..=to.floor() as i32).map(f64::from);
        let labeled: Vec<f64> = decades().filter(|d| d.rem_euclid(every) == 0.0).collect();
        let minor = if every > 1.0 {
            decades().collect()
        } else {
            (from.floor() as i32..=to.floor() as i32)
                .flat_map(|d| (2..10).map(move |n| f64::from(d) + f64::from(n).log10()))
                .filter(|v| (from..=to).contains(v))
                .collect()
        };
        Range {
            low: from,
            high: to,
            labeled,
            minor,
            scale: Scale::Log,
            limits: self.limits,
            digits: 0,
        }
    }

    fn even(&self, values: &[f64]) -> Range {
        let (low, high) = self.limits;
        let inside = values
            .iter()
            .copied()
            .filter(|v| v.is_finite() && (low..=high).contains(v));
        let (from, to) = extent(inside).unwrap_or((0.0, 1.0));
        let span = (to - from).max(1e-12);
        let (from, to) = (from - 0.03 * span, to + 0.03 * span);
        // A step of 1, 2 or 5 times a power of ten that gives five to ten grid lines.
        let rough = (to - from) / 8.0;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0]
            .into_iter()
            .map(|m| m * power)
            .find(|s| *s >= rough)
            .unwrap_or(10.0 * power);
        let first = (from / step).ceil() as i64;
        let last = (to / step).floor() as i64;
        Range {
            low: from,
            high: to,
            labeled: (first..=last).map(|k| k as f64 * step).collect(),
            minor: Vec::new(),
            scale: Scale::Linear,
            limits: self.limits,
            digits: (-step.log10().floor()).max(0.0) as usize,
        }
    }
}

/// The range of an axis in drawing coordinates: logarithms on a logarithmic axis.
#[derive(Clone)]
pub(super) struct Range {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) labeled: Vec<f64>,
    pub(super) minor: Vec<f64>,
    scale: Scale,
    limits: (f64, f64),
    digits: usize,
}

impl Range {
    /// The drawing coordinate of `value`; `None` if the axis cannot show it.
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        let (low, high) = self.limits;
        match self.scale {
            Scale::Linear => (value.is_finite() && (low..=high).contains(&value)).then_some(value),
            Scale::Log => (value.is_finite() && value >= 0.0 && value <= high)
                .then(|| value.max(low).log10().clamp(self.low, self.high)),
        }
    }

    /// The label of a grid line.
    pub(super) fn label(&self, at: f64) -> String {
        match self.scale {
            Scale::Log => match at.round() as i32 {
                0 => "1".to_owned(),
                1 => "10".to_owned(),
                n => format!("10{}", superscript(n)),
            },
            Scale::Linear => {
                // Label −0 as 0.
                let at = if at.abs() < 1e-12 { 0.0 } else { at };
                format!("{at:.*}", self.digits)
            }
        }
    }
}

impl Ranged for Range {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let part = (value - self.low) / (self.high - self.low);
        from + (part * f64::from(to - from)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, hint: H) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            self.minor.clone()
        } else {
            self.labeled.clone()
        }
    }

    fn range(&self) -> core::ops::Range<f64> {
        self.low..self.high
    }
}

fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |e, v| {
        let (low, high) = e.unwrap_or((v, v));
        Some((low.min(v), high.max(v)))
    })
}

/// An integer in superscript digits.
pub(crate) fn superscript(n: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let sign = if n < 0 { "⁻" } else { "" };
    let digits = n.unsigned_abs().to_string();
    let raised = digits.bytes().map(|b| DIGITS[usize::from(b - b'0')]);
    sign.chars().chain(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_and_even_steps() {
        let r = Axis::log("x").range(&[3e-7, 0.2, f64::INFINITY, 0.0]);
        assert_eq!(r.place(0.0), r.place(1e-16));
        assert!(r.place(f64::INFINITY).is_none() && r.place(f64::NAN).is_none());
        assert!(r.labeled.iter().all(|v| v.fract() == 0.0) && r.labeled.len() > 4);
        assert_eq!(r.label(-6.0), "10⁻⁶");
        assert_eq!(r.label(0.0), "1");
        let r = Axis::linear("t").range(&[0.0, 10.0]);
        assert_eq!(r.label(r.labeled[1]), "2");
        let narrow = Axis::log("x").range(&[2.0, 3.0]);
        assert!(narrow.high - narrow.low >= 1.0 && !narrow.labeled.is_empty());
    }
}
