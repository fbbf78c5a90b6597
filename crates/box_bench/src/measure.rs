//! Interleaved timing.
//!
//! The speed of a shared machine varies: its clock changes, and other processes run. The contenders therefore take
//! turns, one sample each per round, and only results of the same run are compared. A disturbance can only lengthen a
//! sample. The **minimum** is therefore the intrinsic cost; median and 95th percentile show how quiet the machine was.
//! Before each sample the contender runs once untimed. Otherwise the sample would include reloading the caches after
//! the previous contender and waking threads that fell asleep.

use std::time::Duration;

use bevy::platform::time::Instant;
use box_scenarios::statistics::Quantiles;
use serde::Serialize;

/// Measures the duration of a call that returns its work (force evaluations and body-steps). This is the wall clock, or
/// in tests a clock computed from the work.
pub type Stopwatch = fn(&mut dyn FnMut() -> u64) -> Duration;

/// The wall clock.
pub fn wall_clock(work: &mut dyn FnMut() -> u64) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}

/// Work to be timed.
pub struct Contender<'a> {
    run: Box<dyn FnMut() -> u64 + 'a>,
    /// Number of units of work per call (for example, bodies times steps); costs are per unit.
    units: f64,
    /// Number of calls per sample; 0 before the first sample.
    repeats: u32,
    /// `true` if a call takes too long for an untimed call.
    long: bool,
}

impl<'a> Contender<'a> {
    /// Creates a contender whose `run` does `units` units of work (> 0) per call.
    pub fn new(units: f64, mut run: impl FnMut() + 'a) -> Self {
        Self::counted(units, move || {
            run();
            0
        })
    }

    /// Creates a contender whose `run` returns its work, at least 1.
    pub fn counted(units: f64, run: impl FnMut() -> u64 + 'a) -> Self {
        Self {
            run: Box::new(run),
            units,
            repeats: 0,
            long: false,
        }
    }

    /// Takes one sample [ns per unit]: an untimed call, then enough calls to reach the minimum duration. The first
    /// sample determines the number of calls and is its own warm-up.
    pub fn sample(&mut self, settings: &Settings) -> f64 {
        if self.repeats > 0 && !self.long {
            (self.run)();
        }
        self.repeats = self.repeats.max(1);
        loop {
            let elapsed = self.time(settings.stopwatch);
            if elapsed >= settings.shortest_sample {
                self.long = elapsed > LONG_CALL * self.repeats;
                return elapsed.as_nanos() as f64 / (f64::from(self.repeats) * self.units);
            }
            // 20 % more than needed, at most ten times the last number.
            let wanted =
                1.2 * settings.shortest_sample.as_secs_f64() / elapsed.as_secs_f64().max(1e-9);
            self.repeats = (f64::from(self.repeats) * wanted.clamp(1.2, 10.0)).ceil() as u32;
        }
    }

    fn time(&mut self, stopwatch: Stopwatch) -> Duration {
        let (run, repeats) = (&mut self.run, self.repeats);
        stopwatch(&mut || (0..repeats).map(|_| run()).sum())
    }
}

/// Settings of a measurement.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Minimum duration of a sample; shorter calls are repeated.
    pub shortest_sample: Duration,
    /// Minimum (≥ 1) and maximum number of samples per contender. Between these, no round starts after the `budget` is
    /// used up.
    pub samples: (usize, usize),
    /// Time after which no further round starts.
    pub budget: Duration,
    /// The clock.
    pub stopwatch: Stopwatch,
}

impl Default for Settings {
    /// Twenty samples of at least 100 µs by the wall clock, fewer if they would take more than ten seconds.
    fn default() -> Self {
        Self {
            shortest_sample: Duration::from_micros(100),
            samples: (3, 20),
            budget: Duration::from_secs(10),
            stopwatch: wall_clock,
        }
    }
}

/// Cost of a unit of work.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// Shortest sample \[ns per unit\], the cost without disturbances.
    pub min: f64,
    /// Median sample \[ns per unit\].
    pub median: f64,
    /// 95th percentile \[ns per unit\].
    pub p95: f64,
}

impl Cost {
    /// The cost from samples [ns per unit], which must not be empty.
    pub fn of(samples: &[f64]) -> Self {
        let quantiles = Quantiles::of(samples.iter().copied());
        Self {
            min: quantiles.min(),
            median: quantiles.median(),
            p95: quantiles.at(0.95),
        }
    }

    /// Relative difference between median and minimum; 0.05 indicates a quiet machine.
    pub fn spread(&self) -> f64 {
        self.median / self.min - 1.0
    }
}

/// Duration of a call above which no untimed call is made, because caches and threads hardly affect it.
const LONG_CALL: Duration = Duration::from_millis(200);

/// Times all `contenders` in turns and returns their costs in the same order. The first sample of each is discarded: it
/// determines the number of calls and warms the caches.
pub fn interleaved(contenders: &mut [Contender<'_>], settings: &Settings) -> Vec<Cost> {
    interleaved_until(contenders, settings, || false).unwrap_or_default()
}

/// Like [`interleaved`], but returns `None` as soon as `stop`, called before each sample, returns `true`.
pub fn interleaved_until(
    contenders: &mut [Contender<'_>],
    settings: &Settings,
    mut stop: impl FnMut() -> bool,
) -> Option<Vec<Cost>> {
    let start = Instant::now();
    let (least, most) = settings.samples;
    let mut samples = vec![Vec::with_capacity(most); contenders.len()];
    for round in 0..=most.max(1) {
        if round > least.max(1) && start.elapsed() > settings.budget {
            break;
        }
        for (contender, samples) in contenders.iter_mut().zip(&mut samples) {
            if stop() {
                return None;
            }
            let sample = contender.sample(settings);
            if round > 0 {
                samples.push(sample);
            }
        }
    }
    Some(samples.iter().map(|s| Cost::of(s)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contenders_take_turns_and_short_calls_are_repeated() {
        let turns = std::cell::RefCell::new(Vec::new());
        let settings = Settings {
            shortest_sample: Duration::from_nanos(1),
            samples: (3, 3),
            ..Settings::default()
        };
        let costs = interleaved(
            &mut [
                Contender::new(1.0, || turns.borrow_mut().push('a')),
                Contender::new(1.0, || turns.borrow_mut().push('b')),
            ],
            &settings,
        );
        assert_eq!(costs.len(), 2);
        // The first sample of each, then alternating samples, each after an untimed call.
        let turns = turns.into_inner();
        assert_eq!(turns.iter().collect::<String>(), "abaabbaabbaabb");
        let mut calls = 0_u32;
        let settings = Settings {
            shortest_sample: Duration::from_micros(50),
            samples: (2, 2),
            ..Settings::default()
        };
        interleaved(&mut [Contender::new(1.0, || calls += 1)], &settings);
        assert!(calls > 3, "an empty call must be repeated to fill a sample");
    }

    #[test]
    fn a_budget_ends_the_rounds_and_a_stop_the_whole() {
        let settings = Settings {
            shortest_sample: Duration::from_nanos(1),
            samples: (2, 1000),
            budget: Duration::ZERO,
            ..Settings::default()
        };
        let mut calls = 0;
        interleaved(&mut [Contender::new(1.0, || calls += 1)], &settings);
        assert_eq!(calls, 1 + 2 * 2, "the first, and two samples");
        let contenders = &mut [Contender::new(1.0, || ())];
        assert_eq!(interleaved_until(contenders, &settings, || true), None);
    }

    /// A clock computed from the work: ten nanoseconds per unit.
    #[test]
    fn a_stopwatch_can_be_another() {
        let settings = Settings {
            stopwatch: |work| Duration::from_nanos(10 * work()),
            ..Settings::default()
        };
        let cost = interleaved(&mut [Contender::counted(5.0, || 35)], &settings)[0];
        assert_eq!((cost.min, cost.p95), (70.0, 70.0));
    }

    #[test]
    fn cost_is_per_unit_and_ordered() {
        let cost = Cost::of(&[3.0, 1.0, 2.0]);
        assert_eq!((cost.min, cost.median, cost.p95), (1.0, 2.0, 3.0));
        assert_eq!(cost.spread(), 1.0);
    }
}
