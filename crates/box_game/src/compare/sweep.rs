//! Work–precision: every integrator at every step size over the whole scene, error against cost, beside the frames:
//! `Work` is done in slices, by a thread or, where there are none, by the frames.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use bevy::platform::time::Instant;
use box_bench::measure::{Cost, Stopwatch, wall_clock};
use box_bench::snapshot::{LONGEST_SCENE, Snapshot};
use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::runner::DUE;
use box_scenarios::statistics::{self, Fitted};
use box_scenarios::{LiveReference, Model, ReferenceSolution, Runner, Setup, StateError};

use super::sampling::{Turn, shortest_sample};
use crate::platform::Worker;

/// Rates of the steps [1/s], coarsest first; every step fits a whole number of times into the first.
pub const RATES: [u32; 8] = [15, 30, 60, 120, 240, 480, 960, 1920];
/// Rounds of samples at a rate, at least and at most: between these no round begins after [`PATIENCE`].
const ROUNDS: (u32, u32) = (3, 10);
const PATIENCE: Duration = Duration::from_millis(200);
/// A slice ends with the first stretch of steps after this time. Half of what a frame may be held.
const SLICE: Duration = Duration::from_millis(4);
/// The reference is found in parts of this of a step of the first rate.
const PARTS: u32 = 32;

/// One step size of one integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepPoint {
    /// dt \[s\].
    pub dt: f64,
    /// Largest distance from the reference \[m\]; NaN if it diverged.
    pub position: f64,
    /// Largest angle to the reference \[°\]; NaN if it diverged.
    pub attitude: f64,
    /// Cost of a box over the scene [ns per simulated second], the minimum of the samples.
    pub cost: f64,
}

/// All step sizes of one integrator.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepLine {
    /// The integrator.
    pub integrator: Integrator,
    /// Coarsest first.
    pub points: Vec<SweepPoint>,
}

impl SweepLine {
    /// The order fitted to the position, or else the attitude.
    pub fn order(&self, position: bool) -> Fitted {
        let error = |p: &SweepPoint| {
            if position {
                p.position
            } else {
                p.attitude.to_radians()
            }
        };
        let points: Vec<_> = self.points.iter().map(|p| (p.dt, error(p))).collect();
        statistics::order(&points)
    }
}

/// What a sweep runs.
#[derive(Clone, Debug)]
pub struct SweepTask {
    /// The scene.
    pub setup: Setup,
    /// Its reference, if it is known.
    pub truth: Option<ReferenceSolution>,
    /// Its boxes.
    pub boxes: usize,
    /// The integrators.
    pub integrators: Vec<Integrator>,
    /// Grain of the clock.
    pub grain: Duration,
    /// What tells the time of a sample.
    pub stopwatch: Stopwatch,
}

impl SweepTask {
    /// `setup` with `boxes` boxes under `integrators`, on a clock without grain.
    pub fn new(setup: Setup, boxes: usize, integrators: Vec<Integrator>) -> Self {
        Self {
            setup,
            truth: None,
            boxes,
            integrators,
            grain: Duration::ZERO,
            stopwatch: wall_clock,
        }
    }
}

/// A sweep: none, running or done.
#[derive(Debug, Default)]
pub struct Sweep {
    shared: Arc<Shared>,
    worker: Option<Worker>,
    total: u32,
}

#[derive(Debug, Default)]
struct Shared {
    cancel: AtomicBool,
    done: AtomicU32,
    lines: Mutex<Vec<SweepLine>>,
}

impl Sweep {
    /// Begins; a sweep that runs is canceled first.
    ///
    /// # Errors
    /// Where the system gives no thread.
    pub fn start(&mut self, task: SweepTask) -> std::io::Result<()> {
        self.cancel();
        self.shared = Arc::new(Shared::of(&task.integrators));
        self.total = (task.integrators.len() * RATES.len()) as u32;
        let shared = self.shared.clone();
        let mut work = Work::new(task);
        self.worker = Some(Worker::spawn(move || work.slice(&shared))?);
        Ok(())
    }

    /// Waits for its end.
    pub fn wait(&mut self) {
        while self.is_running() {
            self.tick();
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// A frame has passed.
    pub fn tick(&mut self) {
        if let Some(worker) = &mut self.worker {
            worker.tick();
        }
    }

    /// Stops it; what is done stays. Takes as long as one slice.
    pub fn cancel(&mut self) {
        self.shared.cancel.store(true, Ordering::Relaxed);
        if let Some(worker) = self.worker.take() {
            worker.join();
        }
    }

    /// Whether it runs.
    pub fn is_running(&self) -> bool {
        self.worker.as_ref().is_some_and(Worker::is_running)
    }

    /// Points done of points to do.
    pub fn progress(&self) -> (u32, u32) {
        (self.shared.done.load(Ordering::Relaxed), self.total)
    }

    /// The lines so far.
    pub fn lines(&self) -> Vec<SweepLine> {
        self.shared
            .lines
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Forgets the lines: they are of another scene.
    pub fn clear(&mut self) {
        self.cancel();
        *self = Self::default();
    }
}

impl Drop for Sweep {
    fn drop(&mut self) {
        self.cancel();
    }
}

impl Shared {
    /// A line without points for each integrator.
    fn of(integrators: &[Integrator]) -> Self {
        let line = |&integrator| SweepLine {
            integrator,
            points: Vec::new(),
        };
        Self {
            lines: Mutex::new(integrators.iter().map(line).collect()),
            ..Self::default()
        }
    }
}

/// A sweep in the middle: rate by rate the errors of every integrator, then their costs in turns.
struct Work {
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
    fn new(mut task: SweepTask) -> Self {
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
    fn slice(&mut self, shared: &Shared) -> bool {
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
        let sample = self
            .turn
            .take(&mut self.snapshot, (SLICE, shortest), task.stopwatch);
        if let Some(sample) = sample {
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

#[cfg(test)]
mod tests {
    use super::*;
    use box_scenarios::Scenario;

    fn task(setup: &Setup, integrators: &[Integrator]) -> SweepTask {
        SweepTask::new(setup.clone(), 1, integrators.to_vec())
    }

    fn swept(setup: &Setup, integrators: &[Integrator]) -> Sweep {
        let mut sweep = Sweep::default();
        sweep.start(task(setup, integrators)).expect("a thread");
        sweep.wait();
        sweep
    }

    /// The fitted orders of the flip are those that the integrators claim for the rotation.
    #[test]
    fn orders_are_found() {
        let mut setup = Scenario::find("throw").expect("a scene").setup;
        setup.duration = 2.0;
        let integrators = [
            Integrator::SymmetricTop,
            Integrator::Rk4,
            Integrator::SemiImplicitEuler,
            Integrator::Exact,
        ];
        let sweep = swept(&setup, &integrators);
        assert_eq!(sweep.progress(), (32, 32));
        let lines = sweep.lines();
        for (line, order) in lines.iter().zip([Some(2.0), Some(4.0), Some(1.0), None]) {
            assert_eq!(line.points.len(), RATES.len());
            match (line.order(false), order) {
                (Fitted::Order(found), Some(order)) => {
                    assert!((found - order).abs() < 0.2, "{}: {found}", line.integrator);
                }
                (found, None) => assert_eq!(found, Fitted::Rounding, "{}", line.integrator),
                (found, _) => panic!("{}: {found}", line.integrator),
            }
            assert!(line.points.iter().all(|p| p.cost > 0.0));
        }
    }

    /// Without a formula there is the fine simulation; a diverged point is a gap.
    #[test]
    fn scenes_without_a_formula_and_divergence() {
        let mut setup = Scenario::find("contact").expect("a scene").setup;
        setup.duration = 0.5;
        let sweep = swept(&setup, &[Integrator::Split]);
        assert!(sweep.lines()[0].points.iter().all(|p| p.position < 1.0));
        let setup = Scenario::find("needle").expect("a scene").setup;
        let sweep = swept(&setup, &[Integrator::SemiImplicitEuler]);
        let points = &sweep.lines()[0].points;
        assert!(points[0].attitude.is_nan() && points[0].cost.is_nan());
    }

    #[test]
    fn it_can_be_canceled_and_dropped() {
        let setup = Scenario::find("heavy-top").expect("a scene").setup;
        let mut sweep = Sweep::default();
        let all = task(&setup, Integrator::ALL);
        sweep.start(all).expect("a thread");
        sweep.cancel();
        assert!(!sweep.is_running());
        let (done, total) = sweep.progress();
        assert!(done < total);
        let one = task(&setup, &[Integrator::Rk4]);
        sweep.start(one).expect("a thread");
        drop(sweep);
    }

    /// As a browser does it: the work is cut into slices, and a coarse clock is no hindrance.
    #[test]
    fn a_sweep_in_slices_under_a_coarse_clock() {
        for scene in ["throw", "contact", "heavy-top"] {
            let mut setup = Scenario::find(scene).expect("a scene").setup;
            setup.duration = 0.5;
            // After a push the reference is not known.
            let task = SweepTask {
                grain: Duration::from_micros(100),
                ..task(&setup, &[Integrator::Split, Integrator::Rk4])
            };
            let (shared, mut slices) = (Shared::of(&task.integrators), 1);
            let mut work = Work::new(task);
            while work.slice(&shared) {
                slices += 1;
            }
            // 16 points of 3 samples of 50 grains are 240 ms: 30 slices of 8 ms.
            assert!(slices >= 20, "{scene}: {slices} slices");
            let lines = shared.lines.into_inner().expect("not poisoned");
            assert_eq!(lines.len(), 2);
            let points = lines.iter().flat_map(|l| &l.points);
            assert!(points.clone().all(|p| p.cost > 0.0), "{scene}");
            assert!(points.clone().all(|p| p.attitude < 180.0), "{scene}");
        }
    }
}
