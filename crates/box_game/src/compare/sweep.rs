//! Work–precision: every integrator at every step size over the whole scene, error against cost, beside the frames:
//! [`Work`] is done in slices, by a thread or, where there are none, by the frames.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use bevy::platform::time::Instant;
use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::run::PlanRun;
use box_scenarios::runner::DUE;
use box_scenarios::{LiveReference, Model, Plan, ReferenceSolution, Runner, Setup, StateError};

use crate::platform::Worker;

/// Rates of the steps [1/s], coarsest first; every step fits a whole number of times into the first.
pub const RATES: [u32; 8] = [15, 30, 60, 120, 240, 480, 960, 1920];
/// How much of a scene is run at most \[s\].
const LONGEST: f64 = 10.0;
/// A timing is the least of this many samples, or of as many as fit into the time allowed.
const REPEATS: u32 = 5;
/// A point is not timed for longer than this, after three samples.
const PATIENCE: Duration = Duration::from_millis(40);
/// A slice ends with the first stretch of steps after this time. Half of what a frame may be held.
const SLICE: Duration = Duration::from_millis(4);
/// Steps between two looks at the clock.
const STRETCH: u32 = 128;
/// The reference is found in parts of this of a step of the first rate.
const PARTS: u32 = 32;
/// Errors below are rounding, above (attitude \[rad\], position in radii of the box) lost: neither shows
/// an order.
const ROUNDING: f64 = 1e-11;
const LOST: f64 = 0.3;

/// One step size of one integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepPoint {
    /// dt \[s\].
    pub dt: f64,
    /// Largest distance from the reference \[m\]; NaN if it diverged.
    pub position: f64,
    /// Largest angle to the reference \[°\]; NaN if it diverged.
    pub attitude: f64,
    /// Shortest time [ns per simulated second].
    pub cost: f64,
}

/// All step sizes of one integrator.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepLine {
    /// The integrator.
    pub integrator: Integrator,
    /// Coarsest first.
    pub points: Vec<SweepPoint>,
    /// Order fitted to the position, where it can be.
    pub order_position: Option<f64>,
    /// Order fitted to the attitude, where it can be.
    pub order_attitude: Option<f64>,
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
    /// Begins; a sweep that runs is canceled first. `truth` is the setup's reference, if it is known, and `grain` that
    /// of the clock.
    ///
    /// # Errors
    /// Where the system gives no thread.
    pub fn start(
        &mut self,
        setup: Setup,
        truth: Option<ReferenceSolution>,
        integrators: Vec<Integrator>,
        grain: Duration,
    ) -> std::io::Result<()> {
        self.cancel();
        self.shared = Arc::default();
        self.total = (integrators.len() * RATES.len()) as u32;
        let shared = self.shared.clone();
        let mut work = Work::new(setup, truth, integrators, grain);
        self.worker = Some(Worker::spawn(move || work.slice(&shared))?);
        Ok(())
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

/// A sweep in the middle.
struct Work {
    setup: Setup,
    model: Arc<Model>,
    integrators: Vec<Integrator>,
    /// A timing lasts at least this long.
    shortest: Duration,
    /// The reference at every step of the first rate.
    trusted: Vec<BodyState>,
    stage: Stage,
    /// Of the integrator whose turn it is.
    points: Vec<SweepPoint>,
    integrator: usize,
}

/// What is being found out.
enum Stage {
    /// The reference; parts done.
    Reference(Box<LiveReference>, u32),
    /// The errors of the next point.
    Errors(Box<Errors>),
    /// Its cost.
    Cost(Box<Cost>),
}

struct Errors {
    runner: Runner,
    /// Samples compared.
    compared: usize,
    worst: (f64, f64),
}

struct Cost {
    errors: (f64, f64),
    plan: Plan,
    run: PlanRun,
    /// Of the sample: runs completed, and time spent on them and on the one in progress.
    runs: u32,
    spent: Duration,
    /// Samples taken, their least per run, and their time.
    samples: u32,
    best: Duration,
    total: Duration,
}

impl Work {
    fn new(
        setup: Setup,
        truth: Option<ReferenceSolution>,
        integrators: Vec<Integrator>,
        grain: Duration,
    ) -> Self {
        let model = Arc::new(Model::of(&setup));
        let truth = truth.or_else(|| ReferenceSolution::closed_form(&setup));
        // Fine enough for the finest step: 1/30720 s.
        let reference =
            LiveReference::new(&model, setup.initial, &setup.impulses, truth, 1.0 / 480.0);
        Self {
            setup,
            model,
            integrators,
            shortest: grain * super::sampling::GRAINS,
            trusted: Vec::new(),
            stage: Stage::Reference(Box::new(reference), 0),
            points: Vec::new(),
            integrator: 0,
        }
    }

    /// Works for a while; returns whether anything is left to do.
    fn slice(&mut self, shared: &Shared) -> bool {
        let end = Instant::now() + SLICE;
        loop {
            let goes_on = !shared.cancel.load(Ordering::Relaxed) && self.next(shared, end);
            if !goes_on || Instant::now() >= end {
                return goes_on;
            }
        }
    }

    /// A stretch of steps; returns whether anything is left to do.
    fn next(&mut self, shared: &Shared, end: Instant) -> bool {
        match &mut self.stage {
            Stage::Reference(reference, parts) => {
                let seconds = self.setup.duration.min(LONGEST);
                let samples = (seconds * f64::from(RATES[0])).floor().max(1.0) as u32;
                let state = reference.at(f64::from(*parts) / f64::from(PARTS * RATES[0]));
                let known = state.is_some() && *parts <= samples * PARTS;
                if let Some(state) = state.filter(|_| known && parts.is_multiple_of(PARTS)) {
                    self.trusted.push(state);
                }
                *parts += 1;
                return known || self.begin_point();
            }
            Stage::Errors(errors) => {
                let rate = RATES[self.points.len()];
                if errors.runner.diverged.is_some() {
                    self.end_point(shared, None, Duration::ZERO);
                    return self.begin_point();
                }
                if errors.compared < self.trusted.len() {
                    errors.compare_next(&self.setup, rate, &self.trusted);
                } else {
                    self.begin_timing();
                }
            }
            Stage::Cost(cost) => {
                let stretch = (STRETCH * RATES[0] / RATES[self.points.len()]).max(1);
                if cost.run(&self.setup, stretch, self.shortest, end) {
                    let (errors, best) = (cost.errors, cost.best);
                    self.end_point(shared, Some(errors), best);
                    return self.begin_point();
                }
            }
        }
        true
    }

    /// Begins the next point; returns whether there is one.
    fn begin_point(&mut self) -> bool {
        let Some(&integrator) = self.integrators.get(self.integrator) else {
            return false;
        };
        let (setup, model) = (&self.setup, &self.model);
        self.stage = Stage::Errors(Box::new(Errors {
            runner: Runner::new(integrator, model, setup.initial, 0.0, &setup.impulses),
            compared: 0,
            worst: (0.0, 0.0),
        }));
        true
    }

    /// Times the point whose errors are known.
    fn begin_timing(&mut self) {
        let Stage::Errors(errors) = &self.stage else {
            return;
        };
        let times: Vec<f64> = (0..self.trusted.len())
            .map(|k| k as f64 / f64::from(RATES[0]))
            .collect();
        let dt = 1.0 / f64::from(RATES[self.points.len()]);
        self.stage = Stage::Cost(Box::new(Cost {
            errors: errors.worst,
            plan: Plan::new(&times, &self.setup.impulses, dt),
            run: PlanRun::new(&self.setup, self.integrators[self.integrator]),
            runs: 0,
            spent: Duration::ZERO,
            samples: 0,
            best: Duration::MAX,
            total: Duration::ZERO,
        }));
    }

    /// Keeps a point: `errors` \[m\] and \[rad\] unless it diverged, and the time of a run.
    fn end_point(&mut self, shared: &Shared, errors: Option<(f64, f64)>, time: Duration) {
        let simulated = self.trusted.len().saturating_sub(1) as f64 / f64::from(RATES[0]);
        self.points.push(SweepPoint {
            dt: 1.0 / f64::from(RATES[self.points.len()]),
            position: errors.map_or(f64::NAN, |e| e.0),
            attitude: errors.map_or(f64::NAN, |e| e.1.to_degrees()),
            cost: errors.map_or(f64::NAN, |_| time.as_nanos() as f64 / simulated),
        });
        shared.done.fetch_add(1, Ordering::Relaxed);
        if self.points.len() < RATES.len() {
            return;
        }
        let points = core::mem::take(&mut self.points);
        let fit = |error: fn(&SweepPoint) -> f64, unit: f64| {
            order(points.iter().map(|p| (p.dt, error(p) / unit)))
        };
        let line = SweepLine {
            integrator: self.integrators[self.integrator],
            order_position: fit(|p| p.position, self.setup.body.radius()),
            order_attitude: fit(|p| p.attitude, 1.0_f64.to_degrees()),
            points,
        };
        self.integrator += 1;
        shared
            .lines
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(line);
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

impl Cost {
    /// Runs the scene until `end`, with a look at the clock after every `stretch` samples; returns whether it has been
    /// timed often enough.
    fn run(&mut self, setup: &Setup, stretch: u32, shortest: Duration, end: Instant) -> bool {
        let start = Instant::now();
        for n in 1_u32.. {
            if self.run.advance(&self.plan, |_, _| true).is_some() {
                self.runs += 1;
                break;
            }
            if n.is_multiple_of(stretch) && Instant::now() >= end {
                self.spent += start.elapsed();
                return false;
            }
        }
        self.spent += start.elapsed();
        self.run.restart(setup);
        if self.spent < shortest {
            return false;
        }
        self.best = self.best.min(self.spent / self.runs);
        self.total += self.spent;
        self.samples += 1;
        (self.runs, self.spent) = (0, Duration::ZERO);
        // Three at least: one may fall into another process's turn.
        self.samples >= REPEATS || self.samples >= 3 && self.total > PATIENCE
    }
}

/// The slope of log error over log dt, by least squares along the finest stretch of four neighboring
/// steps (three, if there is none of four) over which it is steady: neither lost, nor rounding, nor on the
/// way from one to the other. `None` where there is no such stretch. `points` are (dt, error), coarsest
/// first.
pub fn order(points: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let points: Vec<(f64, f64)> = points.collect();
    [4, 3].into_iter().find_map(|length| {
        let mut finest_first = points.windows(length).rev();
        finest_first.find_map(steady_slope)
    })
}

/// By how much the slopes between neighbors may differ, of their mean.
const STEADY: f64 = 0.15;

fn steady_slope(points: &[(f64, f64)]) -> Option<f64> {
    if !points.iter().all(|(_, e)| (ROUNDING..LOST).contains(e)) {
        return None;
    }
    let logs: Vec<(f64, f64)> = points.iter().map(|(dt, e)| (dt.ln(), e.ln())).collect();
    let slopes = || {
        logs.windows(2)
            .map(|p| (p[0].1 - p[1].1) / (p[0].0 - p[1].0))
    };
    let (low, high) = slopes().fold((f64::MAX, f64::MIN), |(l, h), s| (l.min(s), h.max(s)));
    let n = logs.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / n;
    let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
    let sxy: f64 = logs.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    let sxx: f64 = logs.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let slope = sxy / sxx;
    (low > 0.25 && high - low <= STEADY * slope).then_some(slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_scenarios::Scenario;

    fn start(sweep: &mut Sweep, setup: Setup, integrators: &[Integrator]) {
        let truth = Some(setup.reference());
        let grain = Duration::from_nanos(50);
        let started = sweep.start(setup, truth, integrators.to_vec(), grain);
        started.expect("a thread");
    }

    fn wait(sweep: &mut Sweep) {
        for _ in 0..6000 {
            if !sweep.is_running() {
                return;
            }
            sweep.tick();
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("the sweep does not end");
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
        let mut sweep = Sweep::default();
        start(&mut sweep, setup, &integrators);
        wait(&mut sweep);
        assert_eq!(sweep.progress(), (32, 32));
        let lines = sweep.lines();
        for (line, order) in lines.iter().zip([Some(2.0), Some(4.0), Some(1.0), None]) {
            assert_eq!(line.points.len(), RATES.len());
            match (line.order_attitude, order) {
                (Some(found), Some(order)) => {
                    assert!((found - order).abs() < 0.2, "{}: {found}", line.integrator);
                }
                (found, order) => assert_eq!(found, order, "{}", line.integrator),
            }
            assert!(line.points.iter().all(|p| p.cost > 0.0));
        }
    }

    /// Without a formula there is the fine simulation; a diverged point is a gap.
    #[test]
    fn scenes_without_a_formula_and_divergence() {
        let mut setup = Scenario::find("contact").expect("a scene").setup;
        setup.duration = 0.5;
        let mut sweep = Sweep::default();
        start(&mut sweep, setup, &[Integrator::Split]);
        wait(&mut sweep);
        assert!(sweep.lines()[0].points.iter().all(|p| p.position < 1.0));
        let setup = Scenario::find("needle").expect("a scene").setup;
        start(&mut sweep, setup, &[Integrator::SemiImplicitEuler]);
        wait(&mut sweep);
        let points = &sweep.lines()[0].points;
        assert!(points[0].attitude.is_nan() && points[0].cost.is_nan());
    }

    #[test]
    fn it_can_be_canceled_and_dropped() {
        let setup = Scenario::find("heavy-top").expect("a scene").setup;
        let mut sweep = Sweep::default();
        start(&mut sweep, setup.clone(), Integrator::ALL);
        sweep.cancel();
        assert!(!sweep.is_running());
        let (done, total) = sweep.progress();
        assert!(done < total);
        start(&mut sweep, setup, &[Integrator::Rk4]);
        drop(sweep);
    }

    /// As a browser does it: no slice holds a frame for long, and a coarse clock is no hindrance. A frame may be held
    /// for 8 ms; a busy machine interrupts slices, so those count that it did not.
    #[test]
    fn slices_are_short_and_samples_long() {
        for scene in ["throw", "contact", "heavy-top"] {
            let mut setup = Scenario::find(scene).expect("a scene").setup;
            setup.duration = 0.5;
            // After a push the reference is not known.
            let grain = Duration::from_micros(100);
            let mut work = Work::new(setup, None, vec![Integrator::Split, Integrator::Rk4], grain);
            let (shared, mut slices) = (Shared::default(), Vec::new());
            loop {
                let start = Instant::now();
                let goes_on = work.slice(&shared);
                slices.push(start.elapsed());
                if !goes_on {
                    break;
                }
            }
            slices.sort();
            let quick = slices[slices.len() / 10];
            assert!(quick < Duration::from_millis(8), "{scene}: {quick:?}");
            // 16 points of 3 samples of 50 grains are 240 ms.
            assert!(slices.len() >= 20, "{scene}: {} slices", slices.len());
            let lines = shared.lines.into_inner().expect("not poisoned");
            assert_eq!(lines.len(), 2);
            let points = lines.iter().flat_map(|l| &l.points);
            assert!(points.clone().all(|p| p.cost > 0.0), "{scene}");
            assert!(points.clone().all(|p| p.attitude < 180.0), "{scene}");
        }
    }

    #[test]
    fn an_order_needs_a_steady_slope_between_rounding_and_lost() {
        let line = |c: f64, p: i32| {
            RATES.map(move |r| {
                let dt = 1.0 / f64::from(r);
                (dt, c * dt.powi(p))
            })
        };
        let found = order(line(0.5, 3).into_iter()).expect("a slope");
        assert!((found - 3.0).abs() < 1e-9);
        assert!(order(line(1e-13, 0).into_iter()).is_none());
        assert!(order(line(100.0, 0).into_iter()).is_none());
        // A floor of rounding under a fourth order: the slope is that above the floor.
        let floored = line(1.0, 4).map(|(dt, e)| (dt, e + 3e-10));
        let found = order(floored.into_iter()).expect("a slope");
        assert!((found - 4.0).abs() < 0.3, "{found}");
    }
}
