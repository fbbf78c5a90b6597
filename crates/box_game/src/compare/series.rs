//! Time series of a trajectory in memory of fixed size. The last minute is kept in full, and the whole run as minima
//! and maxima over stretches. Their length doubles when there are too many.

use std::collections::VecDeque;

/// Smallest visible angle to the reference \[°\].
pub const VISIBLE_ANGLE: f64 = 1.0;
/// Smallest visible distance from the reference \[m\].
pub const VISIBLE_DISTANCE: f64 = 0.01;
/// Minimum time between two kept samples \[s\]; plots do not resolve more.
const SPACING: f64 = 1.0 / 60.0;
/// Number of recent samples: slightly more than a minute.
const RECENT: usize = 3700;
/// Maximum number of stretches of the whole run, even.
const STRETCHES: usize = 1024;

/// A quantity recorded for each trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Distance from the reference \[m\].
    Position,
    /// Angle to the reference \[°\].
    Attitude,
    /// Distance after one step from the reference's state \[m\].
    LocalPosition,
    /// Angle after one step from the reference's state \[°\].
    LocalAttitude,
    /// Residual of the energy balance, relative to its scale.
    Energy,
    /// Residual of the balance of |L|, relative to its scale.
    Momentum,
    /// Angle between L and its expected direction \[°\].
    Direction,
}

impl Quantity {
    /// All quantities.
    pub const ALL: [Self; 7] = [
        Self::Position,
        Self::Attitude,
        Self::LocalPosition,
        Self::LocalAttitude,
        Self::Energy,
        Self::Momentum,
        Self::Direction,
    ];

    /// Label of the axis, name of the column, factor from a value to the unit of the label, and smallest visible
    /// magnitude in that unit.
    const fn info(self) -> (&'static str, &'static str, f64, Option<f64>) {
        const DISTANCE: Option<f64> = Some(VISIBLE_DISTANCE);
        const ANGLE: Option<f64> = Some(VISIBLE_ANGLE);
        match self {
            Self::Position => ("position error [m]", "pos_err_m", 1.0, DISTANCE),
            Self::Attitude => ("attitude error [°]", "rot_err_deg", 1.0, ANGLE),
            Self::LocalPosition => ("local position error [m]", "local_pos_err_m", 1.0, DISTANCE),
            Self::LocalAttitude => ("local attitude error [°]", "local_rot_err_deg", 1.0, ANGLE),
            Self::Energy => ("energy drift [%]", "energy_rel", 100.0, None),
            Self::Momentum => ("|L| drift [%]", "angmom_rel", 100.0, None),
            Self::Direction => ("direction of L [°]", "angmom_dir_deg", 1.0, ANGLE),
        }
    }

    /// Label of the axis.
    pub const fn label(self) -> &'static str {
        self.info().0
    }

    /// Name of the CSV column.
    pub const fn column(self) -> &'static str {
        self.info().1
    }

    /// Factor from a value to the unit of the label.
    pub const fn scale(self) -> f64 {
        self.info().2
    }

    /// Smallest visible magnitude in the unit of the label, if known.
    pub const fn visible(self) -> Option<f64> {
        self.info().3
    }
}

/// Values of a trajectory at one time; NaN where unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Simulated time \[s\].
    pub t: f64,
    /// Values in the order of [`Quantity::ALL`].
    pub values: [f64; Quantity::ALL.len()],
}

impl Sample {
    /// Returns the value of `quantity`.
    pub fn get(&self, quantity: Quantity) -> f64 {
        self.values[quantity as usize]
    }
}

/// Smallest values, with the time of the first sample, and largest, with that of the last.
type Stretch = (Sample, Sample);

/// Extends a stretch by the next one.
fn extend((low, high): &mut Stretch, next: &Stretch) {
    high.t = next.1.t;
    for k in 0..Quantity::ALL.len() {
        // `min` and `max` pass over NaN.
        low.values[k] = low.values[k].min(next.0.values[k]);
        high.values[k] = high.values[k].max(next.1.values[k]);
    }
}

/// A time series; see the module.
#[derive(Clone, Debug, Default)]
pub struct Series {
    recent: VecDeque<Sample>,
    whole: Vec<Stretch>,
    /// Samples per full stretch: a power of two.
    length: usize,
    /// Number of samples in the newest stretch.
    filled: usize,
}

impl Series {
    /// Adds a sample, unless it is too soon after the last one.
    pub fn push(&mut self, sample: Sample) {
        let due = |last: &Sample| sample.t - last.t >= SPACING * (1.0 - 1e-6);
        if !self.recent.back().is_none_or(due) {
            return;
        }
        self.recent.push_back(sample);
        if self.recent.len() > RECENT {
            self.recent.pop_front();
        }
        self.length = self.length.max(1);
        match self.whole.last_mut() {
            Some(last) if self.filled < self.length => {
                extend(last, &(sample, sample));
                self.filled += 1;
            }
            _ => {
                self.whole.push((sample, sample));
                self.filled = 1;
            }
        }
        if self.whole.len() > STRETCHES {
            let pairs = self.whole.chunks(2).map(|pair| {
                let mut first = pair[0];
                pair[1..].iter().for_each(|s| extend(&mut first, s));
                first
            });
            self.whole = pairs.collect();
            // There was an odd number: the last stands alone and is half full.
            self.filled = self.length;
            self.length *= 2;
        }
    }

    /// Removes the samples after `t` \[s\].
    pub fn rewind(&mut self, t: f64) {
        self.recent.retain(|s| s.t <= t);
        while self.whole.last().is_some_and(|s| s.1.t > t) {
            self.whole.pop();
            self.filled = self.length;
        }
    }

    /// Points of one quantity over the last `window` \[s\], or over the whole run.
    pub fn points(&self, quantity: Quantity, window: Option<f64>) -> Vec<[f64; 2]> {
        let k = quantity as usize;
        let recent_is_all = self.whole.first().map(|s| s.0.t) == self.recent.front().map(|s| s.t);
        if window.is_none() && !recent_is_all {
            let ends = |s: &Stretch| [&s.0, &s.1].map(|end| [end.t, end.values[k]]);
            return self.whole.iter().flat_map(ends).collect();
        }
        let recent = self.recent(window);
        recent.map(|s| [s.t, s.values[k]]).collect()
    }

    /// Samples of the last `window` \[s\], or of the last minute.
    pub fn recent(&self, window: Option<f64>) -> impl Iterator<Item = &Sample> {
        let end = self.recent.back().map_or(0.0, |s| s.t);
        let from = window.map_or(f64::NEG_INFINITY, |w| end - w);
        let first = self.recent.partition_point(|s| s.t < from);
        self.recent.range(first..)
    }

    /// The newest sample.
    pub fn last(&self) -> Option<&Sample> {
        self.recent.back()
    }

    /// Number of samples and stretches in memory.
    pub fn kept(&self) -> usize {
        self.recent.len() + self.whole.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(t: f64, v: f64) -> Sample {
        Sample {
            t,
            values: [v; Quantity::ALL.len()],
        }
    }

    /// Ten minutes at 60 Hz, then half a second at 1920 Hz, of which 60 samples per second are kept.
    #[test]
    fn memory_is_flat_and_extremes_survive() {
        let mut series = Series::default();
        let mut largest = 0;
        for n in 0..36_000 {
            let v = if n == 5000 { 100.0 } else { f64::from(n % 7) };
            series.push(at(f64::from(n) / 60.0, v));
            largest = largest.max(series.kept());
        }
        assert!(largest <= RECENT + STRETCHES, "{largest}");
        let whole = series.points(Quantity::Energy, None);
        assert!(whole.len() <= 2 * STRETCHES);
        assert!(whole.is_sorted_by(|a, b| a[0] <= b[0]));
        assert!(whole.iter().any(|p| p[1] == 100.0), "the peak is kept");
        let end = 35_999.0 / 60.0;
        assert_eq!(whole.last().map(|p| p[0]), Some(end));
        let ten = series.points(Quantity::Position, Some(10.0));
        assert!((599..=601).contains(&ten.len()), "{}", ten.len());
        for n in 1..1000 {
            series.push(at(end + f64::from(n) / 1920.0, 0.0));
        }
        let kept = series.points(Quantity::Energy, Some(0.5)).len();
        assert!((29..=32).contains(&kept), "{kept}");
    }

    #[test]
    fn short_runs_are_shown_as_they_were_and_can_be_taken_back() {
        let mut series = Series::default();
        (0..600).for_each(|n| series.push(at(f64::from(n) / 60.0, f64::from(n))));
        assert_eq!(series.points(Quantity::Energy, None).len(), 600);
        series.rewind(5.0);
        assert_eq!(series.last().map(|s| s.t), Some(5.0));
        series.push(at(5.5, 1.0));
        assert_eq!(series.points(Quantity::Energy, None).len(), 302);
    }
}
