//! Live timing, two figures: what a step of this scene costs in the plugin, by its own clock, and what it would cost
//! under **every** integrator, on one snapshot of the scene's bodies in turns ([`Snapshot`]). Both begin again where
//! scene, step or load change. Neither is older than two seconds, unless the clock is so coarse that a round of all
//! integrators takes longer. The mean over the run, for the work–precision plot, covers what its sweep covers.
//!
//! A sample lasts at least [`GRAINS`] grains of the clock. In a browser, where a grain may be 100 µs, it is made of
//! parts in several frames; [`IntegratorSamples::uncertainty`] says what the grain leaves of it.

use std::collections::VecDeque;
use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::prelude::*;
use box_bench::measure::{Cost, Stopwatch, wall_clock};
use box_bench::snapshot::{LONGEST_SCENE, Sample, Snapshot};
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
/// And at least this many grains of the clock.
pub const GRAINS: u32 = 50;
/// Time for samples in a frame.
const BUDGET: Duration = Duration::from_micros(300);
/// Share of a frame's time for samples, where that is more and the clock is coarse.
const SHARE: f64 = 0.1;
/// The most time for samples in a frame.
const MOST: Duration = Duration::from_millis(8);
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
    /// Sum and number of the samples of this run.
    run: Vec<(f64, u32)>,
    /// Steps of the plugin at this round's snapshot, and whether the round belongs to the run's mean.
    round: (u64, bool),
    /// Medians over time: (time since start \[s\], ns), per integrator.
    history: Vec<VecDeque<(f64, f64)>>,
    /// Time since start \[s\], and each stage of one step \[µs\].
    plugin: VecDeque<(f64, [f64; Stage::ALL.len()])>,
    /// Steps of the plugin at its last sample.
    steps: u64,
    turn: Turn,
    snapshot: Option<Snapshot>,
    load: Option<Load>,
    /// Of the clock.
    grain: Duration,
    /// Standard deviation that the grain leaves in the last sample, relative.
    uncertainty: f64,
    /// What tells the time of a sample.
    pub stopwatch: Stopwatch,
    /// Time for samples in a frame: at least one part of a sample is taken, at most each integrator has its turn.
    pub budget: Duration,
}

/// A sample in the making.
#[derive(Clone, Debug, Default)]
pub struct Turn {
    /// Number of the integrator.
    pub integrator: usize,
    /// Calls timed so far, in this number of parts.
    calls: u32,
    parts: u32,
    elapsed: Duration,
    /// Force evaluations of a call; none before the first.
    evaluations: Option<u64>,
}

impl Turn {
    /// One part of at least `part`, for a sample of at least `shortest`; returns that once it is complete.
    pub fn take(
        &mut self,
        snapshot: &mut Snapshot,
        (part, shortest): (Duration, Duration),
        stopwatch: Stopwatch,
    ) -> Option<Sample> {
        let integrator = Integrator::ALL[self.integrator];
        let evaluations = match self.evaluations {
            Some(evaluations) => evaluations,
            // Not timed: it pays for what the one before it has left in the caches.
            None => snapshot.call(integrator).evaluations,
        };
        self.evaluations = Some(evaluations);
        let part = part.min(shortest.saturating_sub(self.elapsed));
        let mut calls = 1;
        if self.calls > 0 {
            let each = self.elapsed.as_secs_f64() / f64::from(self.calls);
            calls = (part.as_secs_f64() / each.max(1e-9)).clamp(1.0, 1e6) as u32;
        }
        // The last stretch alone counts, so that the clock is read twice for a part.
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

    /// The next integrator's.
    fn next(&self) -> Self {
        Self {
            integrator: (self.integrator + 1) % Integrator::ALL.len(),
            ..Self::default()
        }
    }

    /// Standard deviation, relative, that a clock of this grain leaves. Both ends of a part are rounded down by up to a
    /// grain: their difference has a variance of a sixth of the grain's square.
    fn uncertainty(&self, grain: Duration) -> f64 {
        let sigma = grain.as_secs_f64() * (f64::from(self.parts) / 6.0).sqrt();
        sigma / self.elapsed.as_secs_f64().max(1e-12)
    }
}

/// The shortest sample with a clock of this grain.
pub fn shortest_sample(grain: Duration) -> Duration {
    SHORTEST.max(grain * GRAINS)
}

/// The smallest difference that the clock shows: the median of a few.
pub fn measure_grain() -> Duration {
    let mut last = Instant::now();
    let mut steps: Vec<Duration> = (0..9)
        .map(|_| {
            loop {
                let now = Instant::now();
                let step = now - last;
                if step > Duration::ZERO {
                    last = now;
                    return step;
                }
            }
        })
        .collect();
    steps.sort();
    steps[steps.len() / 2]
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
            run: vec![(0.0, 0); n],
            round: (0, false),
            history: vec![VecDeque::new(); n],
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
    /// Minimum, median and 95th percentile [ns per body-step] of the last two seconds.
    pub fn statistics(&self, integrator: Integrator) -> Option<(f64, f64, f64)> {
        let recent = &self.recent[integrator.index()];
        let recent: Vec<f64> = recent.iter().map(|s| s.1).collect();
        let cost = (!recent.is_empty()).then(|| Cost::of(&recent))?;
        Some((cost.min, cost.median, cost.p95))
    }

    /// Mean of this run's samples [ns per body-step], each of another moment of the scene: what the sweep measures.
    pub fn mean_of_run(&self, integrator: Integrator) -> Option<f64> {
        let (sum, count) = self.run[integrator.index()];
        (count > 0).then(|| sum / f64::from(count))
    }

    /// The smallest difference that the clock shows.
    pub fn grain(&self) -> Duration {
        self.grain
    }

    /// Standard deviation of a sample, relative, that comes from the grain of the clock.
    pub fn uncertainty(&self) -> f64 {
        self.uncertainty
    }

    /// A grain so long that a sample does not fit into a frame's budget.
    pub fn is_coarse(&self) -> bool {
        self.grain * GRAINS > BUDGET
    }

    /// Force evaluations per body-step, measured.
    pub fn evaluations(&self, integrator: Integrator) -> f64 {
        self.evaluations[integrator.index()]
    }

    /// (time \[s\], median ns per body-step), oldest first.
    pub fn history(&self, integrator: Integrator) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.history[integrator.index()].iter().copied()
    }

    /// What each stage of a step took in the plugin \[µs\], the median of the last two seconds; with a coarse clock,
    /// which shows 0 or a grain, the mean.
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
            self.run.fill((0.0, 0));
            self.plugin.clear();
            self.snapshot = None;
            self.turn = Turn {
                integrator: self.turn.integrator,
                ..Turn::default()
            };
            self.load = Some(load);
        }
        let old = |t: f64| time - t > WINDOW;
        let least = usize::from(self.is_coarse());
        for recent in &mut self.recent {
            while recent.len() > least && recent.front().is_some_and(|s| old(s.0)) {
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
        if self.round.1 {
            self.run[k].0 += sample.nanoseconds;
            self.run[k].1 += 1;
        }
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
    (clock, fixed): (Res<PhysicsClock>, Res<Time<Fixed>>),
    (floor, settings): (Option<Res<Floor>>, Res<ContactSettings>),
    (timings, session): (Option<Res<PhysicsTimings>>, Option<Res<Session>>),
    time: Res<Time<Real>>,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let samples = &mut *samples;
    let now = time.elapsed_secs_f64();
    let h = fixed.timestep().as_secs_f64() / f64::from(clock.substeps.max(1));
    let duration = session
        .as_ref()
        .map_or(LONGEST_SCENE, |s| s.scenario.setup.duration);
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
    let shortest = shortest_sample(samples.grain);
    let budget = if samples.is_coarse() {
        time.delta().mul_f64(SHARE).clamp(BUDGET, MOST)
    } else {
        BUDGET
    };
    let started = Instant::now();
    loop {
        let first = samples.turn.integrator == 0 && samples.turn.calls == 0;
        if first || samples.snapshot.is_none() {
            let within = run.clock < duration.min(LONGEST_SCENE);
            samples.round = (clock.steps(), within && clock.steps() != samples.round.0);
            let floor = floor.as_deref().map(|f| (*f, *settings));
            let boxes = boxes.iter();
            let boxes = boxes
                .map(|(body, state, contact)| (body, state, contact.cloned().unwrap_or_default()));
            samples.snapshot = Snapshot::new(boxes, &run.law.forces, floor, h);
        }
        let Some(snapshot) = &mut samples.snapshot else {
            return;
        };
        let part = budget.min(shortest);
        let sample = samples
            .turn
            .take(snapshot, (part, shortest), samples.stopwatch);
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

    /// A sample of fifty grains of 100 µs, taken over several frames, agrees with one taken in one go.
    #[test]
    fn a_sample_in_parts_measures_the_same() {
        let bodies = [(RigidBox::default(), BodyState::default())];
        let forces = box_scenarios::ForceSet::none();
        let all = || bodies.iter().map(|(b, s)| (b, s, ContactState::default()));
        let mut snapshot = Snapshot::new(all(), &forces, None, 1.0 / 60.0).expect("a body");
        let grain = Duration::from_micros(100);
        let mut measure = |part: Duration| {
            let mut best = f64::INFINITY;
            let mut parts = 0;
            for _ in 0..5 {
                let mut turn = Turn::default();
                let sample = loop {
                    if let Some(sample) =
                        turn.take(&mut snapshot, (part, GRAINS * grain), wall_clock)
                    {
                        break sample;
                    }
                };
                assert!(turn.elapsed >= GRAINS * grain);
                best = best.min(sample.nanoseconds);
                parts = turn.parts.max(parts);
            }
            (best, parts)
        };
        let (whole, parts) = measure(GRAINS * grain);
        assert_eq!(parts, 1);
        let (pieces, parts) = measure(10 * grain);
        assert!((2..=6).contains(&parts), "{parts} parts");
        assert!(
            (0.6..1.6).contains(&(pieces / whole)),
            "{pieces} ns, {whole} ns"
        );
        // A grain over √6 in fifty; of six parts √6 times as much.
        for (parts, expected) in [(1, 0.02 / 6.0_f64.sqrt()), (6, 0.02)] {
            let turn = Turn {
                parts,
                elapsed: GRAINS * grain,
                ..Turn::default()
            };
            assert!((turn.uncertainty(grain) - expected).abs() < 1e-12);
        }
        assert!(measure_grain() < Duration::from_millis(1));
    }

    /// With a coarse clock, the last sample stays until there is another.
    #[test]
    fn a_coarse_clock_keeps_its_last_sample() {
        let mut samples = IntegratorSamples {
            grain: Duration::from_micros(100),
            ..IntegratorSamples::default()
        };
        samples.begin(0.0, load(0.1));
        samples.record(Integrator::Split, 0.0, sample(9.0));
        samples.begin(10.0, load(0.1));
        assert_eq!(samples.statistics(Integrator::Split), Some((9.0, 9.0, 9.0)));
        samples.record(Integrator::Split, 10.0, sample(5.0));
        samples.begin(10.1, load(0.1));
        assert_eq!(samples.statistics(Integrator::Split), Some((5.0, 5.0, 5.0)));
    }

    /// A clock made of force evaluations tells sweep and panel the same costs, so that the dots of the work–precision
    /// plot lie on the lines of the sweep.
    #[test]
    fn dots_lie_on_the_lines_of_the_sweep() {
        use crate::app::GamePlugin;
        use crate::cli::Cli;
        use crate::compare::sweep::{Sweep, SweepTask};
        use bevy::input::InputPlugin;
        use bevy::time::TimeUpdateStrategy;
        use clap::Parser;

        const SECONDS: f64 = 3.0;
        // In free flight alike but for the first step of a memory. Where an integrator iterates or meets the floor, its
        // own motion, which the sweep follows, differs from the main box's.
        let mut wrong = Vec::new();
        for (scene, boxes, within) in [
            ("dzhanibekov", 1, 0.05),
            ("heavy-top", 1, 0.1),
            ("throw", 20, 0.05),
            ("contact", 1, 0.3),
        ] {
            let arguments = ["box_game", scene, "--boxes", &boxes.to_string()];
            let cli = Cli::try_parse_from(arguments).expect("valid");
            let mut app = App::new();
            app.add_plugins((MinimalPlugins, InputPlugin, GamePlugin { cli }))
                .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
            app.update();
            // Every integrator in every frame, on a clock of 30 ns a body-step or evaluation.
            let stopwatch: Stopwatch = |work| Duration::from_nanos(30 * work());
            let mut samples = app.world_mut().resource_mut::<IntegratorSamples>();
            (samples.stopwatch, samples.budget) = (stopwatch, Duration::from_secs(10));
            app.world_mut()
                .resource_mut::<Session>()
                .scenario
                .setup
                .duration = SECONDS;
            let setup = app.world().resource::<Session>().setup();
            for _ in 0..(60.0 * SECONDS) as u32 {
                app.update();
            }
            let samples = app.world().resource::<IntegratorSamples>();
            let mut sweep = Sweep::default();
            let task = SweepTask {
                stopwatch,
                ..SweepTask::new(setup, boxes, Integrator::ALL.to_vec())
            };
            sweep.start(task).expect("a thread");
            sweep.wait();
            for line in sweep.lines() {
                let at_60_hz = line
                    .points
                    .iter()
                    .find(|p| (p.dt * 60.0 - 1.0).abs() < 1e-9);
                let swept = at_60_hz.expect("a rate of the sweep").cost;
                let live = samples.mean_of_run(line.integrator).expect("sampled") * 60.0;
                let ratio = live / swept;
                if (ratio - 1.0).abs() > within {
                    let integrator = line.integrator;
                    wrong.push(format!(
                        "{scene}, {integrator}: {live:.0} live, {swept:.0} swept"
                    ));
                }
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
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
