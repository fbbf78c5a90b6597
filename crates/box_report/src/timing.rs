//! How long a step takes.

use std::time::{Duration, Instant};

use box_physics::schemes::Integrator;
use box_scenarios::oracle::Case;
use box_scenarios::run_plan;

/// A sample of the clock shorter than this is mostly clock.
const SHORTEST_SAMPLE: Duration = Duration::from_micros(100);
/// Samples, of which the shortest counts: what disturbs a measurement only ever lengthens it.
const SAMPLES: u32 = 20;

/// Nanoseconds per step of `case` under `integrator` with steps of at most `dt` \[s\]: whole runs, from
/// start to last sample, repeated until a sample is long enough; the minimum of twenty.
pub(crate) fn nanoseconds_per_step(case: &Case, integrator: Integrator, dt: f64) -> f64 {
    let plan = case.plan(dt);
    let run = || {
        let mut end = glam::DVec3::ZERO;
        let totals = run_plan(&case.setup, integrator, &plan, |_, state| {
            end = state.position;
            state.is_finite()
        });
        std::hint::black_box(end);
        totals.steps
    };
    let mut best = f64::INFINITY;
    for _ in 0..SAMPLES {
        let (start, mut steps) = (Instant::now(), 0);
        let elapsed = loop {
            steps += run();
            let elapsed = start.elapsed();
            if elapsed >= SHORTEST_SAMPLE {
                break elapsed;
            }
        };
        if steps > 0 {
            best = best.min(elapsed.as_nanos() as f64 / steps as f64);
        }
    }
    best
}
