//! Live timing. The plugin's own clock gives the cost of a step of this scene. A [`Snapshot`] of the scene's bodies
//! gives the cost under **every** integrator, measured in turns. Both restart when scene, step or load change. Neither
//! is older than two seconds, unless the clock is so coarse that a round of all integrators takes longer. The mean over
//! the run, for the work–precision plot, covers the same part of the scene as its sweep.
//!
//! A sample lasts at least `GRAINS` grains of the clock. In a browser, where a grain may be 100 µs, a sample is split
//! over several frames; [`IntegratorSamples::uncertainty`] is the remaining error. The first sample of each integrator
//! in a run of the program is dropped, because a browser compiles and optimizes code while it runs.

mod turn;

use turn::GRAINS;
pub(crate) use turn::{Turn, measure_grain, shortest_sample};

use std::collections::VecDeque;
use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::prelude::*;
use box_bench::measure::{Cost, Stopwatch, wall_clock};
use box_bench::snapshot::{LONGEST_SCENE, Sample, Snapshot};
use box_physics::floor::ContactState;
use box_physics::plugin::Stage;
use box_physics::prelude::{BodyState, Integrator, PhysicsClock, PhysicsTimings, RigidBox};

use crate::compare::Comparison;
use crate::scene::session::Session;

/// Duration of the time window of the figures \[s\].
const WINDOW: f64 = 2.0;
/// Maximum number of plugin steps kept: the last step of each frame, at 120 frames per second.
const STEPS: usize = 240;
/// Time for samples in a frame.
const BUDGET: Duration = Duration::from_micros(300);
/// Fraction of the frame time for samples, if the clock is coarse and this is more.
const SHARE: f64 = 0.1;
/// Maximum time for samples in a frame.
const MAX_BUDGET: Duration = Duration::from_millis(8);
/// Maximum number of plotted points per integrator: at least five minutes.
const HISTORY: usize = 3600;

/// Times every integrator live.
pub fn plugin(app: &mut App) {
    app.init_resource::<IntegratorSamples>()
        .add_systems(Update, sample_integrators);
}

/// The recent samples of every integrator and of the plugin.
#[derive(Resource)]
pub struct IntegratorSamples {
    /// In the order of [`Integrator::ALL`].
    each: Vec<Samples>,
    /// Steps of the plugin at this round's snapshot; `true` if the round counts in the run's mean.
    round: (u64, bool),
    /// Time since start \[s\], and each stage of one step \[µs\].
    plugin: VecDeque<(f64, [f64; Stage::ALL.len()])>,
    /// Steps of the plugin at its last sample.
    steps: u64,
    turn: Turn,
    snapshot: Option<Snapshot>,
    load: Option<Load>,
    /// Smallest time difference that the clock resolves.
    pub grain: Duration,
    /// Relative standard deviation of the last sample due to the grain of the clock.
    pub uncertainty: f64,
    /// The clock that times samples.
    pub stopwatch: Stopwatch,
    /// Time for samples in a frame. At least one part of a sample is taken, and at most one sample per integrator.
    pub budget: Duration,
}

/// The samples of one integrator: (time since start \[s\], ns).
#[derive(Clone, Default)]
struct Samples {
    recent: VecDeque<(f64, f64)>,
    /// Minima over time.
    history: VecDeque<(f64, f64)>,
    evaluations: f64,
    /// `true` once the first sample has been taken and dropped.
    warm: bool,
    /// Sum and number in this run.
    run: (f64, u32),
}

/// Conditions for which the samples are valid.
#[derive(Clone, Debug, PartialEq)]
struct Load {
    scene: String,
    h: f64,
    boxes: usize,
    floor: bool,
    /// `true` if forces other than gravity act.
    forced: bool,
}

impl Default for IntegratorSamples {
    fn default() -> Self {
        Self {
            each: vec![Samples::default(); Integrator::ALL.len()],
            round: (0, false),
            plugin: VecDeque::new(),
            steps: 0,
            turn: Turn::default(),
            snapshot: None,
            load: None,
            grain: measure_grain(),
            uncertainty: 0.0,
            stopwatch: wall_clock,
            budget: BUDGET,
        }
    }
}

impl IntegratorSamples {
    /// Cost of a body-step \[ns\], from the samples of the last two seconds.
    pub fn cost(&self, integrator: Integrator) -> Option<Cost> {
        let recent = self.each[integrator.index()].recent.iter();
        let recent: Vec<f64> = recent.map(|s| s.1).collect();
        (!recent.is_empty()).then(|| Cost::of(&recent))
    }

    /// Mean of this run's samples [ns per body-step], each at another time of the scene, as in the sweep.
    pub fn mean_of_run(&self, integrator: Integrator) -> Option<f64> {
        let (sum, count) = self.each[integrator.index()].run;
        (count > 0).then(|| sum / f64::from(count))
    }

    /// Returns `true` if the grain is so long that a sample does not fit into a frame's budget.
    pub fn is_coarse(&self) -> bool {
        self.grain * GRAINS > BUDGET
    }

    /// Force evaluations per body-step, measured.
    pub fn evaluations(&self, integrator: Integrator) -> f64 {
        self.each[integrator.index()].evaluations
    }

    /// (time \[s\], minimum ns per body-step), oldest first.
    pub fn history(&self, integrator: Integrator) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.each[integrator.index()].history.iter().copied()
    }

    /// Time of each stage of a step in the plugin \[µs\]: the median of the last two seconds. A coarse clock shows 0 or
    /// one grain; then it is the mean.
    pub fn plugin(&self) -> Option<[f64; Stage::ALL.len()]> {
        let stage = |k: usize| {
            let recent: Vec<f64> = self.plugin.iter().map(|s| s.1[k]).collect();
            if self.is_coarse() {
                recent.iter().sum::<f64>() / recent.len() as f64
            } else {
                Cost::of(&recent).median
            }
        };
        (!self.plugin.is_empty()).then(|| core::array::from_fn(stage))
    }

    /// The stages of each step of the last two seconds \[µs\], oldest first.
    pub fn plugin_steps(&self) -> impl Iterator<Item = [f64; Stage::ALL.len()]> + '_ {
        self.plugin.iter().map(|step| step.1)
    }

    /// Drops samples that are too old, or all samples if the load changed.
    fn begin(&mut self, time: f64, load: Load) {
        if self.load.as_ref() != Some(&load) {
            for samples in &mut self.each {
                samples.recent.clear();
                samples.run = (0.0, 0);
            }
            self.plugin.clear();
            self.snapshot = None;
            self.turn = Turn::of(self.turn.integrator);
            self.load = Some(load);
        }
        let old = |t: f64| time - t > WINDOW;
        let least = usize::from(self.is_coarse());
        for Samples { recent, .. } in &mut self.each {
            while recent.len() > least && recent.front().is_some_and(|s| old(s.0)) {
                recent.pop_front();
            }
        }
        while self.plugin.front().is_some_and(|s| old(s.0)) || self.plugin.len() >= STEPS {
            self.plugin.pop_front();
        }
    }

    fn record(&mut self, integrator: Integrator, time: f64, sample: Sample) {
        let samples = &mut self.each[integrator.index()];
        samples.evaluations = sample.evaluations;
        if !std::mem::replace(&mut samples.warm, true) {
            return;
        }
        samples.recent.push_back((time, sample.nanoseconds));
        if self.round.1 {
            samples.run.0 += sample.nanoseconds;
            samples.run.1 += 1;
        }
        let times = samples.recent.iter().map(|s| s.1);
        let min = times.fold(f64::INFINITY, f64::min);
        samples.history.push_back((time, min));
        if samples.history.len() > HISTORY {
            samples.history.pop_front();
        }
    }

    fn record_plugin(&mut self, time: f64, steps: u64, timings: &PhysicsTimings) {
        // A paused clock takes no step that could be measured.
        if steps != self.steps {
            self.steps = steps;
            let stages = Stage::ALL.map(|s| timings.stage(s) as f64 * 1e-3);
            self.plugin.push_back((time, stages));
        }
    }
}

/// Times the next integrators. A snapshot is taken before the first of them.
pub fn sample_integrators(
    mut samples: ResMut<IntegratorSamples>,
    boxes: Query<(&RigidBox, &BodyState, Option<&ContactState>)>,
    comparison: Res<Comparison>,
    clock: Res<PhysicsClock>,
    (timings, session): (Res<PhysicsTimings>, Res<Session>),
    time: Res<Time<Real>>,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let samples = &mut *samples;
    let now = time.elapsed_secs_f64();
    let load = Load {
        scene: session.run_id(),
        h: run.step,
        boxes: boxes.iter().len(),
        floor: run.law.floor().is_some(),
        forced: !run.law.forces.is_gravity_alone(),
    };
    samples.begin(now, load);
    samples.record_plugin(now, clock.steps(), &timings);
    let shortest = shortest_sample(samples.grain);
    let budget = if samples.is_coarse() {
        time.delta().mul_f64(SHARE).clamp(BUDGET, MAX_BUDGET)
    } else {
        BUDGET
    };
    let started = Instant::now();
    loop {
        let first = samples.turn.integrator == 0 && samples.turn.calls == 0;
        if first || samples.snapshot.is_none() {
            let end = session.scenario.setup.duration.min(LONGEST_SCENE);
            let within = run.clock < end;
            samples.round = (clock.steps(), within && clock.steps() != samples.round.0);
            let floor = run.law.floor().map(|floor| (floor, run.law.settings));
            let boxes = boxes
                .iter()
                .map(|b| (b.0, b.1, b.2.cloned().unwrap_or_default()));
            samples.snapshot = Snapshot::new(boxes, &run.law.forces, floor, run.step);
        }
        let Some(snapshot) = &mut samples.snapshot else {
            return;
        };
        let (length, stopwatch) = ((budget.min(shortest), shortest), samples.stopwatch);
        let sample = samples.turn.take(snapshot, length, stopwatch);
        let complete = sample.is_some();
        if let Some(sample) = sample {
            samples.uncertainty = samples.turn.uncertainty(samples.grain);
            samples.record(Integrator::ALL[samples.turn.integrator], now, sample);
            samples.turn = samples.turn.next();
        }
        let round_is_over = complete && samples.turn.integrator == 0;
        if round_is_over || started.elapsed() >= samples.budget {
            return;
        }
    }
}

#[cfg(test)]
mod tests;
