//! Work–precision sweep: error and cost of every integrator at every step size over the whole scene. `Work` is done in
//! slices in the background: by a thread or, without threads, by the frames.

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

/// Step rates [1/s], coarsest first. The first step is an integer multiple of every other one.
pub const RATES: [u32; 8] = [15, 30, 60, 120, 240, 480, 960, 1920];

/// Result of one integrator at one step size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepPoint {
    /// Step size \[s\].
    pub dt: f64,
    /// Largest distance from the reference \[m\]; NaN if the run diverged.
    pub position: f64,
    /// Largest angle to the reference \[°\]; NaN if the run diverged.
    pub attitude: f64,
    /// Cost of a box over the scene [ns per simulated second], the minimum of the samples.
    pub cost: f64,
}

/// Results of one integrator at all step sizes.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepLine {
    /// The integrator.
    pub integrator: Integrator,
    /// Points, coarsest step first.
    pub points: Vec<SweepPoint>,
}

impl SweepLine {
    /// Order of convergence fitted to the position error, or else to the attitude error.
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

/// Input of a sweep.
#[derive(Clone, Debug)]
pub struct SweepTask {
    /// The scene.
    pub setup: Setup,
    /// Reference of the scene, if known.
    pub truth: Option<ReferenceSolution>,
    /// Number of boxes.
    pub boxes: usize,
    /// The integrators.
    pub integrators: Vec<Integrator>,
    /// Grain of the clock.
    pub grain: Duration,
    /// The clock that times samples.
    pub stopwatch: Stopwatch,
}

impl SweepTask {
    /// Creates a task: `setup` with `boxes` boxes under `integrators`, timed by a clock without grain.
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

/// A sweep: not started, running or done.
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
    /// Starts a sweep. A running one is canceled first.
    ///
    /// # Errors
    /// The system cannot start a thread.
    pub fn start(&mut self, task: SweepTask) -> std::io::Result<()> {
        self.cancel();
        self.shared = Arc::new(Shared::of(&task.integrators));
        self.total = (task.integrators.len() * RATES.len()) as u32;
        let mut work = Work::new(task, &self.shared);
        self.worker = Some(Worker::spawn(move || work.slice())?);
        Ok(())
    }

    /// Waits for the end of the sweep.
    pub fn wait(&mut self) {
        while self.is_running() {
            self.tick();
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Advances the sweep by one frame, on platforms without threads.
    pub fn tick(&mut self) {
        if let Some(worker) = &mut self.worker {
            worker.tick();
        }
    }

    /// Cancels the sweep and keeps the finished points. Blocks for at most one slice.
    pub fn cancel(&mut self) {
        self.shared.cancel.store(true, Ordering::Relaxed);
        if let Some(worker) = self.worker.take() {
            worker.join();
        }
    }

    /// Returns `true` if the sweep is running.
    pub fn is_running(&self) -> bool {
        self.worker.as_ref().is_some_and(Worker::is_running)
    }

    /// Number of finished points, and of all points.
    pub fn progress(&self) -> (u32, u32) {
        (self.shared.done.load(Ordering::Relaxed), self.total)
    }

    /// The lines so far.
    pub fn lines(&self) -> Vec<SweepLine> {
        let lines = self.shared.lines.lock();
        lines.unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Cancels the sweep and removes its lines, for another scene.
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
