//! Interleaved timing.
//!
//! A shared machine drifts: its clock changes, a neighbor wakes. So contenders take turns, one sample
//! each, round after round, and what is compared are figures of the same run. What disturbs a sample
//! only ever lengthens it: the **minimum** is the intrinsic cost, median and 95th percentile tell how
//! quiet the machine was. Before each sample the contender is called once untimed: it would else pay for what
//! the one before it has left in the caches, and for threads that fell asleep meanwhile.

use std::time::Duration;

use bevy::platform::time::Instant;
use box_scenarios::statistics::Quantiles;
use serde::Serialize;

/// Something to be timed.
pub struct Contender<'a> {
    run: Box<dyn FnMut() + 'a>,
    /// What one call amounts to (say, bodies times steps); a cost is per unit.
    units: f64,
}

impl<'a> Contender<'a> {
    /// `run` does `units` units of work (> 0) at each call.
    pub fn new(units: f64, run: impl FnMut() + 'a) -> Self {
        Self {
            run: Box::new(run),
            units,
        }
    }
}

/// How to measure.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// A sample lasts at least this long: a call that is shorter is repeated.
    pub shortest_sample: Duration,
    /// Samples per contender (≥ 1).
    pub samples: usize,
}

impl Default for Settings {
    /// Twenty samples of at least 100 µs.
    fn default() -> Self {
        Self {
            shortest_sample: Duration::from_micros(100),
            samples: 20,
        }
    }
}

/// What a unit of work costs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// Shortest sample \[ns per unit\]: the cost without what else the machine did.
    pub min: f64,
    /// Median sample \[ns per unit\].
    pub median: f64,
    /// 95th percentile \[ns per unit\].
    pub p95: f64,
}

impl Cost {
    /// Of samples [ns per unit], which must not be empty.
    pub fn of(samples: &[f64]) -> Self {
        let quantiles = Quantiles::of(samples.iter().copied());
        Self {
            min: quantiles.min(),
            median: quantiles.median(),
            p95: quantiles.at(0.95),
        }
    }

    /// How far the median lies above the minimum, relative: 0.05 is a quiet machine.
    pub fn spread(&self) -> f64 {
        self.median / self.min - 1.0
    }
}

/// A call that takes longer than this is not made untimed: what the one before it left is a small part of it.
const LONG: Duration = Duration::from_millis(200);

/// Times all `contenders` in turns and returns their costs in their order. Each is called once before
/// the first sample, to warm caches, and is repeated within a sample as often as that first call asks.
pub fn interleaved(contenders: &mut [Contender<'_>], settings: &Settings) -> Vec<Cost> {
    let repeats: Vec<(u32, bool)> = contenders
        .iter_mut()
        .map(|c| {
            let (repeats, elapsed) = fill(c, settings.shortest_sample);
            (repeats, elapsed > LONG * repeats)
        })
        .collect();
    let mut samples = vec![Vec::with_capacity(settings.samples); contenders.len()];
    for _ in 0..settings.samples.max(1) {
        for ((contender, &(repeats, long)), samples) in
            contenders.iter_mut().zip(&repeats).zip(&mut samples)
        {
            if !long {
                (contender.run)();
            }
            let nanoseconds = time(contender, repeats).as_nanos() as f64;
            samples.push(nanoseconds / (f64::from(repeats) * contender.units));
        }
    }
    samples.iter().map(|s| Cost::of(s)).collect()
}

/// One sample of a contender that has no opponents [ns per unit]: its calls until they last at least `shortest`, after
/// as many as that takes to find out.
pub fn sample(contender: &mut Contender<'_>, shortest: Duration) -> f64 {
    let (repeats, elapsed) = fill(contender, shortest);
    elapsed.as_nanos() as f64 / (f64::from(repeats) * contender.units)
}

/// Calls that fill a sample, and how long they lasted.
fn fill(contender: &mut Contender<'_>, shortest: Duration) -> (u32, Duration) {
    let mut repeats = 1;
    loop {
        let elapsed = time(contender, repeats);
        if elapsed >= shortest {
            return (repeats, elapsed);
        }
        // A fifth more than needed, at most ten times as many as were tried.
        let wanted = 1.2 * shortest.as_secs_f64() / elapsed.as_secs_f64().max(1e-9);
        repeats = (f64::from(repeats) * wanted.min(10.0)).ceil() as u32;
    }
}

fn time(contender: &mut Contender<'_>, repeats: u32) -> Duration {
    let clock = Instant::now();
    for _ in 0..repeats {
        (contender.run)();
    }
    clock.elapsed()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contenders_take_turns_and_short_calls_are_repeated() {
        let turns = std::cell::RefCell::new(Vec::new());
        let settings = Settings {
            shortest_sample: Duration::from_nanos(1),
            samples: 3,
        };
        let costs = interleaved(
            &mut [
                Contender::new(1.0, || turns.borrow_mut().push('a')),
                Contender::new(1.0, || turns.borrow_mut().push('b')),
            ],
            &settings,
        );
        assert_eq!(costs.len(), 2);
        // The warm-up of each, then a sample of each in turn, untimed and timed.
        let turns = turns.into_inner();
        assert_eq!(turns.iter().collect::<String>(), "abaabbaabbaabb");
        let mut calls = 0_u32;
        let settings = Settings {
            shortest_sample: Duration::from_micros(50),
            samples: 2,
        };
        interleaved(&mut [Contender::new(1.0, || calls += 1)], &settings);
        assert!(calls > 3, "an empty call must be repeated to fill a sample");
    }

    #[test]
    fn cost_is_per_unit_and_ordered() {
        let cost = Cost::of(&[3.0, 1.0, 2.0]);
        assert_eq!((cost.min, cost.median, cost.p95), (1.0, 2.0, 3.0));
        assert_eq!(cost.spread(), 1.0);
    }
}
