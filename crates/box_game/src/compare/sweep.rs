//! Work–precision: every integrator at every step size over the whole scene, error against cost, in a thread
//! of its own.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use bevy::platform::time::Instant;
use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::runner::DUE;
use box_scenarios::{LiveReference, Model, Plan, Runner, Setup, StateError, run_plan};

/// Rates of the steps [1/s], coarsest first; every step fits a whole number of times into the first.
pub const RATES: [u32; 8] = [15, 30, 60, 120, 240, 480, 960, 1920];
/// How much of a scene is run at most \[s\].
const LONGEST: f64 = 10.0;
/// A timing is the least of this many, or of as many as fit into the time allowed.
const REPEATS: u32 = 5;
/// A point is not timed for longer than this.
const PATIENCE: Duration = Duration::from_millis(40);
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
    thread: Option<JoinHandle<()>>,
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
    pub fn start(&mut self, setup: Setup, integrators: Vec<Integrator>) -> std::io::Result<()> {
        self.cancel();
        self.shared = Arc::default();
        self.total = (integrators.len() * RATES.len()) as u32;
        let shared = self.shared.clone();
        self.thread = Some(
            std::thread::Builder::new()
                .name("sweep".to_owned())
                .spawn(move || run(&setup, &integrators, &shared))?,
        );
        Ok(())
    }

    /// Stops it; what is done stays. Takes as long as one point.
    pub fn cancel(&mut self) {
        self.shared.cancel.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic in there was printed there.
            let _ = thread.join();
        }
    }

    /// Whether it runs.
    pub fn is_running(&self) -> bool {
        self.thread.as_ref().is_some_and(|t| !t.is_finished())
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

fn run(setup: &Setup, integrators: &[Integrator], shared: &Shared) {
    let model = Arc::new(Model::of(setup));
    // Fine enough for the finest step: 1/30720 s.
    let mut reference = LiveReference::of(setup, 1.0 / 480.0);
    let seconds = setup.duration.min(LONGEST);
    let samples = (seconds * f64::from(RATES[0])).floor().max(1.0) as u32;
    let mut trusted = Vec::new();
    for k in 0..=samples {
        if shared.cancel.load(Ordering::Relaxed) {
            return;
        }
        match reference.at(f64::from(k) / f64::from(RATES[0])) {
            Some(state) => trusted.push(state),
            None => break,
        }
    }
    let times: Vec<f64> = (0..trusted.len())
        .map(|k| k as f64 / f64::from(RATES[0]))
        .collect();
    let radius = setup.body.radius();
    for &integrator in integrators {
        let mut points = Vec::new();
        for rate in RATES {
            if shared.cancel.load(Ordering::Relaxed) {
                break;
            }
            let (dt, parts) = (1.0 / f64::from(rate), rate / RATES[0]);
            let errors = errors(setup, &model, integrator, dt, parts, &trusted);
            let cost =
                errors.map(|_| cost(setup, integrator, &Plan::new(&times, &setup.impulses, dt)));
            let simulated = times.last().copied().unwrap_or(0.0);
            points.push(SweepPoint {
                dt,
                position: errors.map_or(f64::NAN, |e| e.0),
                attitude: errors.map_or(f64::NAN, |e| e.1.to_degrees()),
                cost: cost.map_or(f64::NAN, |c| c.as_nanos() as f64 / simulated),
            });
            shared.done.fetch_add(1, Ordering::Relaxed);
        }
        let fit = |error: fn(&SweepPoint) -> f64, unit: f64| {
            order(points.iter().map(|p| (p.dt, error(p) / unit)))
        };
        let line = SweepLine {
            integrator,
            order_position: fit(|p| p.position, radius),
            order_attitude: fit(|p| p.attitude, 1.0_f64.to_degrees()),
            points,
        };
        shared
            .lines
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(line);
    }
}

/// Largest distance \[m\] and angle \[rad\] from the `trusted` states; `None` if it diverged.
fn errors(
    setup: &Setup,
    model: &Arc<Model>,
    integrator: Integrator,
    dt: f64,
    parts: u32,
    trusted: &[BodyState],
) -> Option<(f64, f64)> {
    let mut runner = Runner::new(integrator, model, setup.initial, 0.0, &setup.impulses);
    let mut worst = (0.0_f64, 0.0_f64);
    for (k, expected) in trusted.iter().enumerate() {
        for part in 0..if k > 0 { parts } else { 0 } {
            let t = (k - 1) as f64 / f64::from(RATES[0]) + f64::from(part) * dt;
            runner.take_impulses(&setup.impulses, t + DUE * dt);
            runner.driver.time = t;
            if !runner.step(dt) {
                return None;
            }
        }
        let error = StateError::between(&runner.driver.state, expected);
        worst = (worst.0.max(error.position), worst.1.max(error.attitude));
    }
    Some(worst)
}

/// The shortest time of a few runs.
fn cost(setup: &Setup, integrator: Integrator, plan: &Plan) -> Duration {
    let began = Instant::now();
    let mut best = Duration::MAX;
    for n in 0..REPEATS {
        // Three at least: one may fall into another process's turn.
        if n >= 3 && began.elapsed() > PATIENCE {
            break;
        }
        let start = Instant::now();
        run_plan(setup, integrator, plan, |_, _| true);
        best = best.min(start.elapsed());
    }
    best
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

    fn wait(sweep: &Sweep) {
        for _ in 0..6000 {
            if !sweep.is_running() {
                return;
            }
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
        sweep.start(setup, integrators.to_vec()).expect("a thread");
        wait(&sweep);
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
        sweep
            .start(setup, vec![Integrator::Split])
            .expect("a thread");
        wait(&sweep);
        assert!(sweep.lines()[0].points.iter().all(|p| p.position < 1.0));
        let setup = Scenario::find("needle").expect("a scene").setup;
        sweep
            .start(setup, vec![Integrator::SemiImplicitEuler])
            .expect("a thread");
        wait(&sweep);
        let points = &sweep.lines()[0].points;
        assert!(points[0].attitude.is_nan() && points[0].cost.is_nan());
    }

    #[test]
    fn it_can_be_canceled_and_dropped() {
        let setup = Scenario::find("heavy-top").expect("a scene").setup;
        let mut sweep = Sweep::default();
        sweep
            .start(setup.clone(), Integrator::ALL.to_vec())
            .expect("a thread");
        sweep.cancel();
        assert!(!sweep.is_running());
        let (done, total) = sweep.progress();
        assert!(done < total);
        sweep.start(setup, vec![Integrator::Rk4]).expect("a thread");
        drop(sweep);
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
