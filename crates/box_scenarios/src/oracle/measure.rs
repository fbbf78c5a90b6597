//! A case under one integrator and step.

use box_physics::integrators::Integrator;

use super::Case;
use crate::metrics::{Errors, StateError, energy_scale, momentum_scale};
use crate::run::{Plan, Totals, run_plan_within};
use crate::simulate::sanity;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It reached the last sample.
    Ok,
    /// It left every sane range, or became non-finite; its errors are infinite.
    Diverged,
    /// It was not run, and why.
    Unsupported(&'static str),
}

/// The largest errors over the samples of a case, and the cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// |Δx| \[m\].
    pub position: f64,
    /// |Δv| [m/s].
    pub velocity: f64,
    /// Attitude \[rad\].
    pub attitude: f64,
    /// |ΔL| in world axes over the initial |L|, or the final one where the initial is 0 (absolute
    /// [kg m²/s] where both are).
    pub angular_momentum: f64,
    /// |ΔE| over the initial energy, or the initial kinetic energy where that is 0; `None` where the
    /// case neither conserves nor prescribes the energy.
    pub energy: Option<f64>,
    /// Steps, evaluations, fallbacks.
    pub totals: Totals,
    /// How it ended.
    pub status: Status,
}

/// Longest run [steps], and its force evaluations: some ten seconds. (A step at the floor may take thousands.)
const MAX_STEPS: u64 = 100_000_000;
const MAX_EVALUATIONS: u64 = 4 * MAX_STEPS;

impl Case {
    /// The steps of a run with at most `dt` \[s\]: every interval between samples and impulses in equal
    /// steps.
    pub fn plan(&self, dt: f64) -> Plan {
        let times: Vec<f64> = self.samples.iter().map(|s| s.t).collect();
        Plan::new(&times, &self.setup.impulses, dt)
    }

    /// Why this case cannot be run at `dt` \[s\], if it cannot: it would take for ever.
    pub fn unsupported(&self, dt: f64) -> Option<&'static str> {
        (self.plan(dt).steps() > MAX_STEPS).then_some("more than 1e8 steps")
    }

    /// Runs the case by `integrator` in steps of at most `dt` \[s\].
    pub fn measure(&self, integrator: Integrator, dt: f64) -> Measurement {
        if let Some(reason) = self.unsupported(dt) {
            return Measurement::without_run(Status::Unsupported(reason), f64::NAN, None);
        }
        let setup = &self.setup;
        let sanity = sanity(setup, self.samples.iter().map(|s| &s.state));
        let mut errors = Errors::default();
        let mut has_energy = false;
        let mut diverged = false;
        let mut samples = self.samples.iter();
        let plan = self.plan(dt);
        let totals = run_plan_within(setup, integrator, &plan, MAX_EVALUATIONS, |_, state| {
            diverged = sanity.is_diverged(state);
            if let Some(sample) = samples.next().filter(|_| !diverged) {
                errors.see(&StateError::between(state, &sample.state));
                if let Some(expected) = self.expected_energy(sample) {
                    errors.see_energy(setup.energy(state), expected);
                    has_energy = true;
                }
            }
            !diverged
        });
        if totals.evaluations > MAX_EVALUATIONS {
            let reason = "more than 4e8 force evaluations";
            let unfinished = Measurement::without_run(Status::Unsupported(reason), f64::NAN, None);
            return Measurement {
                totals,
                ..unfinished
            };
        }
        let all = [
            errors.position,
            errors.velocity,
            errors.attitude,
            errors.angular_momentum,
            errors.energy,
        ];
        diverged |= all.iter().any(|e| !e.is_finite());
        if diverged {
            let energy = self.knows_energy().then_some(f64::INFINITY);
            let failed = Measurement::without_run(Status::Diverged, f64::INFINITY, energy);
            return Measurement { totals, ..failed };
        }
        let last = self
            .samples
            .last()
            .map_or(0.0, |s| s.state.angular_momentum.length());
        let momentum = momentum_scale(setup.initial.angular_momentum.length(), last);
        let kinetic = setup.initial.kinetic_energy(&setup.body);
        let energy = energy_scale(self.initial_energy(), kinetic);
        Measurement {
            position: errors.position,
            velocity: errors.velocity,
            attitude: errors.attitude,
            angular_momentum: errors.angular_momentum / momentum,
            energy: has_energy.then_some(errors.energy / energy),
            totals,
            status: Status::Ok,
        }
    }

    fn knows_energy(&self) -> bool {
        self.samples
            .iter()
            .any(|s| self.expected_energy(s).is_some())
    }

    /// As the file counts it, where it gives it.
    fn initial_energy(&self) -> f64 {
        let own = || self.setup.energy(&self.setup.initial);
        let first = self.samples.first().filter(|s| s.t == 0.0);
        first.and_then(|s| s.energy).unwrap_or_else(own)
    }
}

impl Measurement {
    fn without_run(status: Status, errors: f64, energy: Option<f64>) -> Self {
        Self {
            position: errors,
            velocity: errors,
            attitude: errors,
            angular_momentum: errors,
            energy,
            totals: Totals::default(),
            status,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::run_plan;
    use crate::scenario::Scenario;

    /// A run is ended soon after its budget, and what it did until then is what the whole run does.
    #[test]
    fn a_budget_ends_a_run() {
        let setup = Scenario::default().setup;
        let plan = Plan::new(&[100.0], &[], 1e-3);
        let whole = run_plan(&setup, Integrator::Split, &plan, |_, _| true);
        assert_eq!(whole.steps, 100_000);
        let mut looks = 0;
        let part = run_plan_within(&setup, Integrator::Split, &plan, 10_000, |_, _| {
            looks += 1;
            true
        });
        assert!(
            (10_000..20_000).contains(&part.evaluations) && looks == 0,
            "{part:?}"
        );
    }
}
