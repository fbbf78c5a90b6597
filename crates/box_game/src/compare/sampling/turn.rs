//! A sample of one integrator's cost, measured at once or, with a coarse clock, in parts.

use std::time::Duration;

use bevy::platform::time::Instant;
use box_bench::measure::Stopwatch;
use box_bench::snapshot::{Sample, Snapshot};
use box_physics::prelude::Integrator;

/// Minimum length of a sample.
const SHORTEST: Duration = Duration::from_micros(100);
/// Minimum length of a sample in grains of the clock.
pub(crate) const GRAINS: u32 = 50;

/// An incomplete sample.
#[derive(Clone, Debug, Default)]
pub(crate) struct Turn {
    pub integrator: usize,
    /// Number of calls timed so far, in `parts` parts.
    pub(super) calls: u32,
    parts: u32,
    elapsed: Duration,
    /// Force evaluations per call; `None` before the first.
    evaluations: Option<u64>,
}

impl Turn {
    /// Starts a sample of the integrator with this number.
    pub(crate) fn of(integrator: usize) -> Self {
        Self {
            integrator,
            ..Self::default()
        }
    }

    /// Measures a part of at least `part`. Returns the sample once it is complete, with at least `shortest`.
    pub(crate) fn take(
        &mut self,
        snapshot: &mut Snapshot,
        (part, shortest): (Duration, Duration),
        stopwatch: Stopwatch,
    ) -> Option<Sample> {
        let integrator = Integrator::ALL[self.integrator];
        let evaluations = match self.evaluations {
            Some(evaluations) => evaluations,
            // Not timed, because it loads the caches.
            None => snapshot.call(integrator).evaluations,
        };
        self.evaluations = Some(evaluations);
        let part = part.min(shortest.saturating_sub(self.elapsed));
        let mut calls = 1;
        if self.calls > 0 {
            let each = self.elapsed.as_secs_f64() / f64::from(self.calls);
            calls = (part.as_secs_f64() / each.max(1e-9)).clamp(1.0, 1e6) as u32;
        }
        // Only the last stretch counts, so the clock is read twice per part.
        let elapsed = loop {
            let elapsed = stopwatch(&mut || (0..calls).map(|_| snapshot.work(integrator)).sum());
            if elapsed >= part {
                break elapsed;
            }
            let wanted = 1.2 * part.as_secs_f64() / elapsed.as_secs_f64().max(1e-9);
            calls = (f64::from(calls) * wanted.clamp(1.2, 10.0)).ceil() as u32;
        };
        self.calls += calls;
        self.elapsed += elapsed;
        self.parts += 1;
        let units = f64::from(self.calls) * snapshot.units();
        (self.elapsed >= shortest).then(|| Sample {
            nanoseconds: self.elapsed.as_nanos() as f64 / units,
            evaluations: evaluations as f64 / snapshot.units(),
        })
    }

    pub(super) fn next(&self) -> Self {
        Self::of((self.integrator + 1) % Integrator::ALL.len())
    }

    /// Relative standard deviation due to a clock of this grain. Both ends of a part are rounded down by up to a grain,
    /// so their difference has a variance of a sixth of the grain's square.
    pub(super) fn uncertainty(&self, grain: Duration) -> f64 {
        let sigma = grain.as_secs_f64() * (f64::from(self.parts) / 6.0).sqrt();
        sigma / self.elapsed.as_secs_f64().max(1e-12)
    }
}

/// The shortest sample with a clock of this grain.
pub(crate) fn shortest_sample(grain: Duration) -> Duration {
    SHORTEST.max(grain * GRAINS)
}

/// The smallest difference that the clock resolves: the median of a few.
pub(crate) fn measure_grain() -> Duration {
    let mut steps = [Duration::ZERO; 9];
    for step in &mut steps {
        let last = Instant::now();
        while step.is_zero() {
            *step = last.elapsed();
        }
    }
    steps.sort();
    steps[steps.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::floor::ContactState;
    use box_physics::prelude::{BodyState, RigidBox};

    /// A clock for which every call costs the same.
    fn even_clock(work: &mut dyn FnMut() -> u64) -> Duration {
        Duration::from_nanos(100 * work())
    }

    /// A sample of fifty grains of 100 µs over several frames equals one measured at once.
    #[test]
    fn a_sample_in_parts_measures_the_same() {
        let bodies = [(RigidBox::default(), BodyState::default())];
        let forces = box_scenarios::ForceSet::none();
        let all = || bodies.iter().map(|(b, s)| (b, s, ContactState::default()));
        let mut snapshot = Snapshot::new(all(), &forces, None, 1.0 / 60.0).expect("a body");
        let grain = Duration::from_micros(100);
        let mut measure = |part: Duration| {
            let mut turn = Turn::default();
            let mut take = || turn.take(&mut snapshot, (part, GRAINS * grain), even_clock);
            let sample = core::iter::from_fn(|| Some(take())).flatten().next();
            assert!(turn.elapsed >= GRAINS * grain);
            (sample.expect("complete").nanoseconds, turn.parts)
        };
        let (whole, parts) = measure(GRAINS * grain);
        assert_eq!(parts, 1);
        let (pieces, parts) = measure(10 * grain);
        assert!((2..=6).contains(&parts), "{parts} parts");
        assert_eq!(pieces, whole);
        // A grain over √6 in fifty; with six parts, √6 times as much.
        for (parts, expected) in [(1, 0.02 / 6.0_f64.sqrt()), (6, 0.02)] {
            let turn = Turn {
                parts,
                elapsed: GRAINS * grain,
                ..Turn::default()
            };
            assert!((turn.uncertainty(grain) - expected).abs() < 1e-12);
        }
        assert!(!measure_grain().is_zero());
    }
}
