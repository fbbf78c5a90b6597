//! Steps a setup with several integrators at once and compares them with one reference, for the headless table. Memory
//! use does not grow with the duration.

use std::sync::Arc;

use box_physics::prelude::{BodyState, Integrator};

use crate::balance::Residual;
use crate::driver::Totals;
use crate::live_reference::{LiveReference, Uncertainty};
use crate::metrics::StateError;
use crate::model::Model;
use crate::runner::{DUE, Runner, local_error};
use crate::setup::Setup;
use crate::status::Status;

/// A comparison to run.
#[derive(Clone, Debug)]
pub struct IntegratorComparison {
    /// The scene.
    pub setup: Setup,
    /// The integrators, in this order.
    pub integrators: Vec<Integrator>,
    /// Step \[s\].
    pub dt: f64,
    /// Substeps per step, ≥ 1.
    pub substeps: u32,
}

/// One integrator at the end of one step.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Number of steps so far.
    pub step: u64,
    /// Simulated time \[s\].
    pub t: f64,
    /// Index in the list of integrators.
    pub number: usize,
    /// The integrator.
    pub integrator: Integrator,
    /// The state.
    pub state: &'a BodyState,
    /// Error against the reference, up to its horizon.
    pub error: Option<StateError>,
    /// Error of this step alone; unknown if an impulse acts during the step, and with substeps.
    pub local: Option<StateError>,
    /// Kinetic and potential energy \[J\].
    pub energy: f64,
    /// Residual of energy and angular momentum.
    pub residual: Residual,
    /// Force evaluations in this step.
    pub evaluations: u64,
    /// Number of corners at the floor.
    pub contacts: u32,
    /// Status of the trajectory.
    pub status: Status,
}

/// One line of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratorResult {
    /// The integrator.
    pub integrator: Integrator,
    /// Largest distance from the reference \[m\], up to its horizon; `None` if it diverged.
    pub position: Option<f64>,
    /// Largest angle to the reference \[rad\], up to its horizon; `None` if it diverged.
    pub attitude: Option<f64>,
    /// Largest energy residual, divided by its scale; `None` if it diverged.
    pub energy: Option<f64>,
    /// Largest residual of the angular momentum (vector), divided by its scale; `None` if it diverged.
    pub momentum: Option<f64>,
    /// Steps and cost.
    pub totals: Totals,
    /// Status at the end.
    pub status: Status,
}

/// The table.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparisonResult {
    /// The results, in the order of the integrators.
    pub integrators: Vec<IntegratorResult>,
    /// Source of the reference, in words.
    pub reference: String,
    /// Time up to which errors are known \[s\], if the reference ended before the scene.
    pub horizon: Option<f64>,
    /// Uncertainty of the reference; smaller errors are not significant.
    pub uncertainty: Uncertainty,
}

impl IntegratorComparison {
    /// Number of steps in the setup's duration, at least one.
    pub fn steps(&self) -> u64 {
        (self.setup.duration / self.dt).round().max(1.0) as u64
    }

    /// Runs to the end of the setup and passes every integrator to `look` at the start and after each of its steps.
    ///
    /// # Errors
    /// The first error of `look`, which ends the run.
    pub fn run<E>(
        &self,
        mut look: impl FnMut(&Moment<'_>) -> Result<(), E>,
    ) -> Result<ComparisonResult, E> {
        let setup = &self.setup;
        let model = Arc::new(Model::of(setup));
        let substeps = self.substeps.max(1);
        let h = self.dt / f64::from(substeps);
        let mut reference = LiveReference::of(setup, self.dt);
        let mut before = Some(setup.initial);
        let mut trials: Vec<Trial> = self
            .integrators
            .iter()
            .map(|&i| Trial {
                runner: Runner::new(i, &model, setup.initial, 0.0, &setup.impulses),
                worst: None,
                residual: Residual::default(),
            })
            .collect();
        for n in 0..=self.steps() {
            // Computed as n·dt, not as a sum.
            let t = n as f64 * self.dt;
            let now = reference.at(t);
            let alone = n > 0 && substeps == 1 && setup.impulses.is_empty();
            let ends = before.zip(now).filter(|_| alone);
            for (number, trial) in trials.iter_mut().enumerate() {
                if trial.runner.diverged.is_some() {
                    continue;
                }
                let evaluations = trial.runner.driver.totals.evaluations;
                if n > 0 {
                    let start = (n - 1) as f64 * self.dt;
                    for part in 0..substeps {
                        let from = start + f64::from(part) * h;
                        trial.runner.take_impulses(&setup.impulses, from + DUE * h);
                        trial.runner.driver.time = from;
                        if !trial.runner.step(h) {
                            break;
                        }
                    }
                }
                let runner = &trial.runner;
                let (integrator, state) = (runner.driver.integrator, &runner.driver.state);
                let residual = runner.balance.residual(&model, state);
                let error = now.map(|r| StateError::between(state, &r));
                let moment = Moment {
                    step: n,
                    t,
                    number,
                    integrator,
                    state,
                    error,
                    local: ends.map(|(from, to)| local_error(integrator, &model, from, &to, h)),
                    energy: model.energy(state),
                    residual,
                    evaluations: runner.driver.totals.evaluations - evaluations,
                    contacts: runner.driver.contacts(),
                    status: runner.status(),
                };
                look(&moment)?;
                trial.include(n, error.as_ref(), &residual);
            }
            before = now;
        }
        Ok(ComparisonResult {
            integrators: trials.iter().map(Trial::result).collect(),
            reference: reference.description(),
            horizon: reference.horizon(),
            uncertainty: reference.uncertainty(),
        })
    }
}

struct Trial {
    runner: Runner,
    /// Largest errors of position \[m\] and attitude \[rad\]; known after the first step with a reference.
    worst: Option<(f64, f64)>,
    residual: Residual,
}

impl Trial {
    fn include(&mut self, step: u64, error: Option<&StateError>, residual: &Residual) {
        if let (Some(e), true) = (error, step > 0) {
            let (x, a) = self.worst.unwrap_or_default();
            self.worst = Some((x.max(e.position), a.max(e.attitude)));
        }
        let worst = &mut self.residual;
        worst.energy = worst.energy.max(residual.energy.abs());
        worst.vector = worst.vector.max(residual.vector);
    }

    /// The result; errors of a diverged run are meaningless and omitted.
    fn result(&self) -> IntegratorResult {
        let alive = self.runner.diverged.is_none();
        let worst = self.worst.filter(|_| alive);
        IntegratorResult {
            integrator: self.runner.driver.integrator,
            position: worst.map(|w| w.0),
            attitude: worst.map(|w| w.1),
            energy: alive.then_some(self.residual.energy),
            momentum: alive.then_some(self.residual.vector),
            totals: self.runner.driver.totals,
            status: self.runner.status(),
        }
    }
}

#[cfg(test)]
mod tests;
