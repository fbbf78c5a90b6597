//! Work–precision: every integrator at every step size over the whole scene, error against cost, beside the frames:
//! `Work` is done in slices, by a thread or, where there are none, by the frames.

mod work;

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use box_bench::measure::{Stopwatch, wall_clock};
use box_physics::prelude::Integrator;
use box_scenarios::statistics::{self, Fitted};
use box_scenarios::{ReferenceSolution, Setup};

use crate::platform::Worker;
use work::Work;

/// Rates of the steps [1/s], coarsest first; every step fits a whole number of times into the first.
pub const RATES: [u32; 8] = [15, 30, 60, 120, 240, 480, 960, 1920];

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
#[derive(Default)]
pub struct Sweep {
    shared: Arc<Shared>,
    worker: Option<Worker>,
    total: u32,
}

#[derive(Default)]
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
        let mut work = Work::new(task, &self.shared);
        self.worker = Some(Worker::spawn(move || work.slice())?);
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
        let lines = self.shared.lines.lock();
        lines.unwrap_or_else(PoisonError::into_inner).clone()
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

#[cfg(test)]
mod tests;
