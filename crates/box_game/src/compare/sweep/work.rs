//! The work of a sweep: functions that pause after every stretch of steps, so that it can be done in slices.

use std::pin::Pin;
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
use std::task::{Context, Waker};
use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::tasks::futures_lite::future::yield_now as pause;
use box_bench::measure::Stopwatch;
use box_bench::snapshot::{LONGEST_SCENE, Snapshot};
use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::runner::DUE;
use box_scenarios::{LiveReference, Model, ReferenceSolution, Runner, Setup, StateError};

use super::{RATES, Shared, SweepPoint, SweepTask};
use crate::compare::sampling::shortest_sample;

/// Minimum and maximum number of sampling rounds per rate. After the minimum, no round begins after [`PATIENCE`].
const ROUNDS: (u32, u32) = (3, 10);
const PATIENCE: Duration = Duration::from_millis(200);
/// Time after which a slice ends at the next pause. With a part of a sample after it, it stays below the allowed 8 ms
/// per frame.
const SLICE: Duration = Duration::from_millis(3);
/// Time after which a part of a sample ends at the next stretch.
const PART: Duration = Duration::from_millis(2);
/// Steps of a box in a stretch: short relative to a part, long relative to reading the clock.
const STRETCH: usize = 128;
/// Steps between two pauses while errors are computed.
const STEPS: u32 = 16;
/// Number of reference states computed per step of the first rate.
const PARTS: u32 = 32;

/// A sweep in progress.
pub(super) struct Work {
    shared: Arc<Shared>,
    rest: Pin<Box<dyn Future<Output = ()> + Send>>,
}

impl Work {
    pub(super) fn new(task: SweepTask, shared: &Arc<Shared>) -> Self {
        Self {
            shared: shared.clone(),
            rest: Box::pin(sweep(task, shared.clone())),
        }
    }

    /// Works for one slice. Returns `false` when done.
    pub(super) fn slice(&mut self) -> bool {
        let end = Instant::now() + SLICE;
        let mut context = Context::from_waker(Waker::noop());
        loop {
            let canceled = self.shared.cancel.load(Ordering::Relaxed);
            let goes_on = !canceled && self.rest.as_mut().poll(&mut context).is_pending();
            if !goes_on || Instant::now() >= end {
                return goes_on;
            }
        }
    }
}

/// Computes the errors of every integrator rate by rate, then their costs in turns.
async fn sweep(mut task: SweepTask, shared: Arc<Shared>) {
    let truth = task.truth.take();
    let truth = truth.or_else(|| ReferenceSolution::closed_form(&task.setup));
    let trusted = reference(&task.setup, truth).await;
    for rate in RATES {
        let mut found = Vec::new();
        for &integrator in &task.integrators {
            found.push(errors(&task.setup, integrator, rate, &trusted).await);
            shared.done.fetch_add(1, Ordering::Relaxed);
        }
        let Some(costs) = costs(&task, rate, &found).await else {
            return;
        };
        let dt = 1.0 / f64::from(rate);
        let mut lines = shared.lines.lock().unwrap_or_else(PoisonError::into_inner);
        for ((line, errors), cost) in lines.iter_mut().zip(found).zip(costs) {
            line.points.push(SweepPoint {
                dt,
                position: errors.map_or(f64::NAN, |e| e.0),
                attitude: errors.map_or(f64::NAN, |e| e.1.to_degrees()),
                cost: cost.map_or(f64::NAN, |ns| ns / dt),
            });
        }
    }
}

/// Computes the reference at every step of the first rate.
async fn reference(setup: &Setup, truth: Option<ReferenceSolution>) -> Vec<BodyState> {
    let (model, start) = (Arc::new(Model::of(setup)), setup.initial);
    // Fine enough for the finest step: 1/30720 s.
    let mut reference = LiveReference::new(&model, start, &setup.impulses, truth, 1.0 / 480.0);
    let seconds = setup.duration.min(LONGEST_SCENE);
    let samples = (seconds * f64::from(RATES[0])).floor().max(1.0) as u32;
    let mut trusted = Vec::new();
    for part in 0..=samples * PARTS {
        let Some(state) = reference.at(f64::from(part) / f64::from(PARTS * RATES[0])) else {
            break;
        };
        if part.is_multiple_of(PARTS) {
            trusted.push(state);
        }
        pause().await;
    }
    trusted
}

/// Computes the largest errors at a rate \[m\] and \[rad\]; `None` if it diverges.
async fn errors(
    setup: &Setup,
    integrator: Integrator,
    rate: u32,
    trusted: &[BodyState],
) -> Option<(f64, f64)> {
    let (dt, parts) = (1.0 / f64::from(rate), rate / RATES[0]);
    let model = Arc::new(Model::of(setup));
    let mut runner = Runner::new(integrator, &model, setup.initial, 0.0, &setup.impulses);
    let mut worst = (0.0_f64, 0.0_f64);
    for (k, trusted) in trusted.iter().enumerate() {
        for part in 0..if k > 0 { parts } else { 0 } {
            let t = (k - 1) as f64 / f64::from(RATES[0]) + f64::from(part) * dt;
            runner.take_impulses(&setup.impulses, t + DUE * dt);
            runner.driver.time = t;
            if !runner.step(dt) {
                return None;
            }
            if part % STEPS == STEPS - 1 {
                pause().await;
            }
        }
        let error = StateError::between(&runner.driver.state, trusted);
        worst = (worst.0.max(error.position), worst.1.max(error.attitude));
        pause().await;
    }
    Some(worst)
}

/// Measures the costs of integrators that did not diverge [ns per body-step]: the minimum of their samples.
async fn costs(
    task: &SweepTask,
    rate: u32,
    found: &[Option<(f64, f64)>],
) -> Option<Vec<Option<f64>>> {
    let mut snapshot = Snapshot::of_scene(&task.setup, task.boxes, 1.0 / f64::from(rate))?;
    let shortest = shortest_sample(task.grain);
    let started = Instant::now();
    let mut costs = vec![None; found.len()];
    for round in 0..ROUNDS.1 {
        if round >= ROUNDS.0 && started.elapsed() > PATIENCE {
            break;
        }
        for (k, &integrator) in task.integrators.iter().enumerate() {
            if found[k].is_some() {
                let cost = sample(&mut snapshot, integrator, shortest, task.stopwatch).await;
                costs[k] = Some(costs[k].unwrap_or(f64::INFINITY).min(cost));
            }
        }
    }
    Some(costs)
}

/// Measures the cost [ns per body-step] of whole runs of the scene that take at least `shortest`, timed in parts.
async fn sample(
    snapshot: &mut Snapshot,
    integrator: Integrator,
    shortest: Duration,
    stopwatch: Stopwatch,
) -> f64 {
    let stretch = (STRETCH / snapshot.bodies()).max(1);
    // Not timed, because it loads the caches.
    snapshot.advance(integrator, stretch);
    snapshot.restart();
    let (mut elapsed, mut courses) = (Duration::ZERO, 0);
    while !(snapshot.is_at_start() && elapsed >= shortest) {
        let part = stopwatch(&mut || {
            let (begin, mut work) = (Instant::now(), 0);
            loop {
                work += snapshot.advance(integrator, stretch);
                let time = begin.elapsed();
                courses += u32::from(snapshot.is_at_start());
                if time >= PART || (snapshot.is_at_start() && elapsed + time >= shortest) {
                    return work;
                }
            }
        });
        elapsed += part;
        pause().await;
    }
    elapsed.as_nanos() as f64 / (f64::from(courses) * snapshot.units())
}
