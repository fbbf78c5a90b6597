//! The work of a sweep, in slices.

use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
use std::time::Duration;

use bevy::platform::time::Instant;
use box_bench::measure::Cost;
use box_bench::snapshot::{LONGEST_SCENE, Snapshot};
use box_physics::prelude::BodyState;
use box_scenarios::runner::DUE;
use box_scenarios::{LiveReference, Model, ReferenceSolution, Runner, Setup, StateError};

use super::{RATES, Shared, SweepPoint, SweepTask};
use crate::compare::sampling::{Turn, shortest_sample};

/// Rounds of samples at a rate, at least and at most: between these no round begins after [`PATIENCE`].
const ROUNDS: (u32, u32) = (3, 10);
const PATIENCE: Duration = Duration::from_millis(200);
/// A slice ends with the first stretch of steps after this time. Half of what a frame may be held.
const SLICE: Duration = Duration::from_millis(4);
/// The reference is found in parts of this of a step of the first rate.
const PARTS: u32 = 32;

/// A sweep in the middle: rate by rate the errors of every integrator, then their costs in turns.
pub(super) struct Work {
    task: SweepTask,
    model: Arc<Model>,
    /// The reference at every step of the first rate.
    trusted: Vec<BodyState>,
    stage: Stage,
    /// Number of the rate.
    rate: usize,
    /// Errors at this rate \[m\] and \[rad\], unless it diverged.
    found: Vec<Option<(f64, f64)>>,
}

/// What is being found out.
enum Stage {
    /// The reference; parts done.
    Reference(Box<LiveReference>, u32),
    /// The errors of the next integrator.
    Errors(Box<Errors>),
    /// The costs of all.
    Costs(Box<Costs>),
}

struct Errors {
    runner: Runner,
    /// Samples compared.
    compared: usize,
    worst: (f64, f64),
}

struct Costs {
    snapshot: Snapshot,
    started: Instant,
    /// Integrators that did not diverge, by their places in the task, and their samples [ns per body-step].
    samples: Vec<(usize, Vec<f64>)>,
    /// Whose turn it is, and the sample in the making.
    next: usize,
    turn: Turn,
    round: u32,
}

impl Work {
    pub(super) fn new(mut task: SweepTask) -> Self {
        let model = Arc::new(Model::of(&task.setup));
        let truth = task.truth.take();
        let truth = truth.or_else(|| ReferenceSolution::closed_form(&task.setup));
        let (start, impulses) = (task.setup.initial, &task.setup.impulses);
        // Fine enough for the finest step: 1/30720 s.
        let reference = LiveReference::new(&model, start, impulses, truth, 1.0 / 480.0);
        Self {
            task,
            model,
            trusted: Vec::new(),
            stage: Stage::Reference(Box::new(reference), 0),
            rate: 0,
            found: Vec::new(),
        }
    }

    /// Works for a while; returns whether anything is left to do.
    pub(super) fn slice(&mut self, shared: &Shared) -> bool {
        let end = Instant::now() + SLICE;
        loop {
            let goes_on = !shared.cancel.load(Ordering::Relaxed) && self.next(shared);
            if !goes_on || Instant::now() >= end {
                return goes_on;
            }
        }
    }

    /// A stretch of steps or a part of a sample; returns whether anything is left to do.
    fn next(&mut self, shared: &Shared) -> bool {
        match &mut self.stage {
            Stage::Reference(reference, parts) => {
                let seconds = self.task.setup.duration.min(LONGEST_SCENE);
                let samples = (seconds * f64::from(RATES[0])).floor().max(1.0) as u32;
                let state = reference.at(f64::from(*parts) / f64::from(PARTS * RATES[0]));
                let known = state.is_some() && *parts <= samples * PARTS;
                if let Some(state) = state.filter(|_| known && parts.is_multiple_of(PARTS)) {
                    self.trusted.push(state);
                }
                *parts += 1;
                known || self.begin_errors()
            }
            Stage::Errors(errors) => {
                let diverged = errors.runner.diverged.is_some();
                if !diverged && errors.compared < self.trusted.len() {
                    errors.compare_next(&self.task.setup, RATES[self.rate], &self.trusted);
                    return true;
                }
                self.found.push((!diverged).then_some(errors.worst));
                shared.done.fetch_add(1, Ordering::Relaxed);
                self.begin_errors() || self.begin_costs()
            }
            Stage::Costs(costs) => {
                if costs.go_on(&self.task) {
                    return true;
                }
                let samples = core::mem::take(&mut costs.samples);
                self.end_rate(shared, &samples);
                self.begin_errors()
            }
        }
    }

    /// Begins the errors of the next integrator; returns whether there is one.
    fn begin_errors(&mut self) -> bool {
        let next = self.task.integrators.get(self.found.len());
        let Some(&integrator) = next.filter(|_| self.rate < RATES.len()) else {
            return false;
        };
        let (setup, model) = (&self.task.setup, &self.model);
        self.stage = Stage::Errors(Box::new(Errors {
            runner: Runner::new(integrator, model, setup.initial, 0.0, &setup.impulses),
            compared: 0,
            worst: (0.0, 0.0),
        }));
        true
    }

    /// Begins the costs of those that did not diverge.
    fn begin_costs(&mut self) -> bool {
        let (task, rate) = (&self.task, RATES[self.rate]);
        let snapshot = Snapshot::of_scene(&task.setup, task.boxes, 1.0 / f64::from(rate));
        let Some(snapshot) = snapshot else {
            return false;
        };
        let valid = self.found.iter().enumerate().filter(|(_, e)| e.is_some());
        self.stage = Stage::Costs(Box::new(Costs {
            snapshot,
            started: Instant::now(),
            samples: valid.map(|(k, _)| (k, Vec::new())).collect(),
            next: 0,
            turn: Turn::default(),
            round: 0,
        }));
        true
    }

    /// Adds the points of a rate to the lines.
    fn end_rate(&mut self, shared: &Shared, samples: &[(usize, Vec<f64>)]) {
        let dt = 1.0 / f64::from(RATES[self.rate]);
        let mut lines = shared.lines.lock().unwrap_or_else(PoisonError::into_inner);
        for (k, (line, errors)) in lines.iter_mut().zip(self.found.drain(..)).enumerate() {
            let cost = samples.iter().find(|s| s.0 == k).map(|s| Cost::of(&s.1));
            line.points.push(SweepPoint {
                dt,
                position: errors.map_or(f64::NAN, |e| e.0),
                attitude: errors.map_or(f64::NAN, |e| e.1.to_degrees()),
                cost: cost.map_or(f64::NAN, |c| c.min / dt),
            });
        }
        self.rate += 1;
    }
}

impl Costs {
    /// A part of a sample of the integrator whose turn it is; returns whether any sample is missing.
    fn go_on(&mut self, task: &SweepTask) -> bool {
        let late = self.round >= ROUNDS.0 && self.started.elapsed() > PATIENCE;
        if self.samples.is_empty() || self.round >= ROUNDS.1 || late && self.next == 0 {
            return false;
        }
        let (k, samples) = &mut self.samples[self.next];
        self.turn.integrator = task.integrators[*k].index();
        let shortest = shortest_sample(task.grain);
        let length = (SLICE, shortest);
        if let Some(sample) = self.turn.take(&mut self.snapshot, length, task.stopwatch) {
            samples.push(sample.nanoseconds);
            self.turn = Turn::default();
            self.next = (self.next + 1) % self.samples.len();
            self.round += u32::from(self.next == 0);
        }
        true
    }
}

impl Errors {
    /// Goes on to the next sample and compares with it.
    fn compare_next(&mut self, setup: &Setup, rate: u32, trusted: &[BodyState]) {
        let (dt, parts) = (1.0 / f64::from(rate), rate / RATES[0]);
        let (k, runner) = (self.compared, &mut self.runner);
        for part in 0..if k > 0 { parts } else { 0 } {
            let t = (k - 1) as f64 / f64::from(RATES[0]) + f64::from(part) * dt;
            runner.take_impulses(&setup.impulses, t + DUE * dt);
            runner.driver.time = t;
            if !runner.step(dt) {
                return;
            }
        }
        let error = StateError::between(&runner.driver.state, &trusted[k]);
        self.worst.0 = self.worst.0.max(error.position);
        self.worst.1 = self.worst.1.max(error.attitude);
        self.compared += 1;
    }
}
