//! Live timing, two figures: what a step of this scene costs in the plugin, by its own clock, and what it would cost
//! under **every** integrator, on one snapshot of the scene's bodies in turns ([`Snapshot`]). Neither is older than two
//! seconds, and both begin again where scene, step or load change.

use std::collections::VecDeque;
use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::prelude::*;
use box_bench::measure::Cost;
use box_bench::snapshot::{Sample, Snapshot};
use box_physics::floor::{ContactSettings, ContactState, Floor};
use box_physics::plugin::Stage;
use box_physics::prelude::{BodyState, Integrator, PhysicsClock, PhysicsTimings, RigidBox};

use crate::compare::Comparison;
use crate::scene::session::Session;

/// Figures come from the last two seconds \[s\].
const WINDOW: f64 = 2.0;
/// Steps of the plugin that are kept: a step in each of 120 frames a second, or the last of many in a frame.
const STEPS: usize = 240;
/// A sample lasts at least this long.
const SHORTEST: Duration = Duration::from_micros(100);
/// Time for samples in a frame; at least one integrator has its turn.
const BUDGET: Duration = Duration::from_micros(300);
/// Points of the plotted past per integrator: five minutes at least.
const HISTORY: usize = 3600;

/// Times every integrator live.
pub struct SamplingPlugin;

impl Plugin for SamplingPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<IntegratorSamples>()
            .add_systems(Update, sample_integrators);
    }
}

/// The recent samples of every integrator and of the plugin.
#[derive(Resource)]
pub struct IntegratorSamples {
    recent: Vec<VecDeque<(f64, f64)>>,
    evaluations: Vec<f64>,
    /// Medians over time: (time since start \[s\], ns), per integrator.
    history: Vec<VecDeque<(f64, f64)>>,
    /// Time since start \[s\], and each stage of one step \[µs\].
    plugin: VecDeque<(f64, [f64; Stage::ALL.len()])>,
    /// Steps of the plugin at its last sample.
    steps: u64,
    next: usize,
    snapshot: Option<Snapshot>,
    load: Option<Load>,
}

/// What the samples belong to.
#[derive(Clone, Debug, PartialEq)]
struct Load {
    scene: Option<String>,
    h: f64,
    boxes: usize,
    floor: bool,
    /// Whether the forces are more than gravity.
    forced: bool,
}

impl Default for IntegratorSamples {
    fn default() -> Self {
        let n = Integrator::ALL.len();
        Self {
            recent: vec![VecDeque::new(); n],
            evaluations: vec![0.0; n],
            history: vec![VecDeque::new(); n],
            plugin: VecDeque::new(),
            steps: 0,
            next: 0,
            snapshot: None,
            load: None,
        }
    }
}

impl IntegratorSamples {
    /// Minimum, median and 95th percentile [ns per body-step] of the last two seconds.
    pub fn statistics(&self, integrator: Integrator) -> Option<(f64, f64, f64)> {
        let recent = &self.recent[integrator.index()];
        let recent: Vec<f64> = recent.iter().map(|s| s.1).collect();
        let cost = (!recent.is_empty()).then(|| Cost::of(&recent))?;
        Some((cost.min, cost.median, cost.p95))
    }

    /// Force evaluations per body-step, measured.
    pub fn evaluations(&self, integrator: Integrator) -> f64 {
        self.evaluations[integrator.index()]
    }

    /// (time \[s\], median ns per body-step), oldest first.
    pub fn history(&self, integrator: Integrator) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.history[integrator.index()].iter().copied()
    }

    /// What each stage of a step took in the plugin \[µs\], the median of the last two seconds.
    pub fn plugin(&self) -> Option<[f64; Stage::ALL.len()]> {
        let stage = |k: usize| {
            let recent: Vec<f64> = self.plugin.iter().map(|s| s.1[k]).collect();
            Cost::of(&recent).median
        };
        (!self.plugin.is_empty()).then(|| core::array::from_fn(stage))
    }

    /// Age \[s\] at `time` \[s\] of the oldest sample that a figure is made from.
    pub fn oldest(&self, time: f64) -> f64 {
        let first = self.recent.iter().filter_map(|r| r.front().map(|s| s.0));
        first
            .chain(self.plugin.front().map(|s| s.0))
            .fold(0.0, |age: f64, t| age.max(time - t))
    }

    /// Drops what is too old, or everything if the load is another.
    fn begin(&mut self, time: f64, load: Load) {
        if self.load.as_ref() != Some(&load) {
            self.recent.iter_mut().for_each(VecDeque::clear);
            self.plugin.clear();
            self.snapshot = None;
            self.load = Some(load);
        }
        let old = |t: f64| time - t > WINDOW;
        for recent in &mut self.recent {
            while recent.front().is_some_and(|s| old(s.0)) {
                recent.pop_front();
            }
        }
        while self.plugin.front().is_some_and(|s| old(s.0)) || self.plugin.len() >= STEPS {
            self.plugin.pop_front();
        }
    }

    fn record(&mut self, integrator: Integrator, time: f64, sample: Sample) {
        let k = integrator.index();
        self.recent[k].push_back((time, sample.nanoseconds));
        self.evaluations[k] = sample.evaluations;
        if let Some((_, median, _)) = self.statistics(integrator) {
            let history = &mut self.history[k];
            history.push_back((time, median));
            if history.len() > HISTORY {
                history.pop_front();
            }
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

/// The next integrators' turns; a snapshot is taken before the first of them.
pub fn sample_integrators(
    mut samples: ResMut<IntegratorSamples>,
    boxes: Query<(&RigidBox, &BodyState, Option<&ContactState>)>,
    comparison: Res<Comparison>,
    clock: Res<PhysicsClock>,
    fixed: Res<Time<Fixed>>,
    floor: Option<Res<Floor>>,
    settings: Res<ContactSettings>,
    (timings, session): (Option<Res<PhysicsTimings>>, Option<Res<Session>>),
    time: Res<Time<Real>>,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let samples = &mut *samples;
    let now = time.elapsed_secs_f64();
    let h = fixed.timestep().as_secs_f64() / f64::from(clock.substeps.max(1));
    samples.begin(
        now,
        Load {
            scene: session.map(|s| s.run_id()),
            h,
            boxes: boxes.iter().len(),
            floor: floor.is_some(),
            forced: !run.law.forces.is_gravity_alone(),
        },
    );
    if let Some(timings) = &timings {
        samples.record_plugin(now, clock.steps(), timings);
    }
    let started = Instant::now();
    loop {
        if samples.next == 0 || samples.snapshot.is_none() {
            let floor = floor.as_deref().map(|f| (*f, *settings));
            let boxes = boxes.iter();
            let boxes = boxes
                .map(|(body, state, contact)| (body, state, contact.cloned().unwrap_or_default()));
            samples.snapshot = Snapshot::new(boxes, &run.law.forces, floor, h);
        }
        let Some(snapshot) = &mut samples.snapshot else {
            return;
        };
        let integrator = Integrator::ALL[samples.next];
        let sample = snapshot.time(integrator, SHORTEST);
        samples.record(integrator, now, sample);
        samples.next = (samples.next + 1) % Integrator::ALL.len();
        if started.elapsed() >= BUDGET {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(h: f64) -> Load {
        Load {
            scene: None,
            h,
            boxes: 1,
            floor: false,
            forced: false,
        }
    }

    fn sample(nanoseconds: f64) -> Sample {
        Sample {
            nanoseconds,
            evaluations: 1.0,
        }
    }

    /// A second after a change nothing of before is in the figures, and at no time anything older than two seconds.
    #[test]
    fn nothing_is_older_than_two_seconds_or_of_another_load() {
        let mut samples = IntegratorSamples::default();
        let split = Integrator::Split;
        for n in 0_u32..600 {
            let time = f64::from(n) / 60.0;
            samples.begin(time, load(0.1));
            samples.record(split, time, sample(if n < 300 { 900.0 } else { 20.0 }));
            samples.record_plugin(time, n.into(), &PhysicsTimings::default());
            assert!(samples.oldest(time) <= WINDOW);
        }
        assert_eq!(samples.statistics(split), Some((20.0, 20.0, 20.0)));
        assert!(samples.plugin().is_some());
        samples.begin(10.0, load(0.2));
        assert_eq!(samples.statistics(split), None);
        assert_eq!(samples.plugin(), None);
        samples.record(split, 10.0, sample(5.0));
        assert_eq!(samples.statistics(split), Some((5.0, 5.0, 5.0)));
    }

    #[test]
    fn memory_stays_flat() {
        let mut samples = IntegratorSamples::default();
        for n in 0_u32..10_000 {
            samples.begin(f64::from(n) * 1e-3, load(0.1));
            samples.record(Integrator::Split, f64::from(n) * 1e-3, sample(50.0));
            samples.record_plugin(f64::from(n) * 1e-3, n.into(), &PhysicsTimings::default());
        }
        assert_eq!(samples.history(Integrator::Split).count(), HISTORY);
        assert!(samples.recent[0].len() <= 2001);
        assert!(samples.plugin.len() <= STEPS);
    }
}
