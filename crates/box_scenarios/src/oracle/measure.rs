//! Runs a case with one integrator and step size.

use box_physics::integrators::Integrator;

use super::Case;
use crate::driver::Totals;
use crate::metrics::error_scale;
use crate::run::{End, Plan};
use crate::simulate::{Expected, compare};

/// Outcome of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The run reached the last sample with errors within [`MAX_ERRORS`].
    Ok,
    /// The run reached the last sample, but with an error beyond [`MAX_ERRORS`] in this quantity.
    Lost(&'static str),
    /// The run left the sane range or became non-finite; its errors are infinite.
    Diverged,
    /// The case was not run, for this reason.
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
    /// |ΔL| in world axes, divided by the initial |L| or, if that is 0, the final one. Absolute [kg m²/s] if both are
    /// 0.
    pub angular_momentum: f64,
    /// |ΔE| divided by the initial energy or, if that is 0, the initial kinetic energy. `None` if the case neither
    /// conserves nor prescribes the energy.
    pub energy: Option<f64>,
    /// Steps, evaluations and fallbacks.
    pub totals: Totals,
    /// Outcome of the run.
    pub outcome: Outcome,
}

/// Errors beyond which a run is lost: its result has nothing to do with the motion.
pub const MAX_ERRORS: Limits = Limits {
    position: 0.5,
    attitude: 0.5,
    angular_momentum: 0.5,
    energy: 0.5,
};

/// Limits of errors; see [`MAX_ERRORS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Position error divided by the reference's largest distance from its start, or by the circumradius of the box if
    /// that is larger.
    pub position: f64,
    /// Attitude error \[rad\].
    pub attitude: f64,
    /// Angular momentum error divided by the largest |L| of the reference.
    pub angular_momentum: f64,
    /// Energy error, relative.
    pub energy: f64,
}

/// Maximum number of steps and of force evaluations in a run, about ten seconds. (A step at the floor may need
/// thousands of evaluations.)
const MAX_STEPS: u64 = 100_000_000;
const MAX_EVALUATIONS: u64 = 4 * MAX_STEPS;

impl Case {
    /// Plans a run with steps of at most `dt` \[s\]. Every interval between samples and impulses is divided into equal
    /// steps.
    pub fn plan(&self, dt: f64) -> Plan {
        let times: Vec<f64> = self.samples.iter().map(|s| s.t).collect();
        Plan::new(&times, &self.setup.impulses, dt)
    }

    /// The reason why this case cannot be run at `dt` \[s\], or `None`. The only reason is too many steps.
    pub fn unsupported(&self, dt: f64) -> Option<&'static str> {
        (self.plan(dt).steps() > MAX_STEPS).then_some("more than 1e8 steps")
    }

    /// Runs the case with `integrator` in steps of at most `dt` \[s\].
    pub fn measure(&self, integrator: Integrator, dt: f64) -> Measurement {
        if let Some(reason) = self.unsupported(dt) {
            return Measurement::without_run(Outcome::Unsupported(reason), f64::NAN, None);
        }
        let setup = &self.setup;
        let mut samples = self.samples.iter();
        let expected = |_| {
            let sample = samples.next();
            Expected {
                state: sample.map(|s| s.state),
                energy: sample.and_then(|s| self.expected_energy(s)),
            }
        };
        let run = compare(
            setup,
            integrator,
            &self.plan(dt).within(MAX_EVALUATIONS),
            expected,
            |_| true,
        );
        let (errors, totals) = (run.errors, run.totals);
        if run.end == End::OutOfBudget {
            let reason = "more than 4e8 force evaluations";
            let unfinished = Measurement::without_run(Outcome::Unsupported(reason), f64::NAN, None);
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
        if run.diverged.is_some() || all.iter().any(|e| !e.is_finite()) {
            let energy = self.has_expected_energy().then_some(f64::INFINITY);
            let failed = Measurement::without_run(Outcome::Diverged, f64::INFINITY, energy);
            return Measurement { totals, ..failed };
        }
        let last = self
            .samples
            .last()
            .map_or(0.0, |s| s.state.angular_momentum.length());
        let momentum = error_scale(setup.initial.angular_momentum.length(), last);
        let kinetic = setup.initial.kinetic_energy(&setup.body);
        let energy = error_scale(self.initial_energy(), kinetic);
        let energy = self.has_expected_energy().then_some(errors.energy / energy);
        let lost = [
            (
                "position",
                errors.position > MAX_ERRORS.position * self.reach(),
            ),
            ("attitude", errors.attitude > MAX_ERRORS.attitude),
            (
                "angular momentum",
                errors.angular_momentum > MAX_ERRORS.angular_momentum * self.largest_momentum(),
            ),
            ("energy", energy.is_some_and(|e| e > MAX_ERRORS.energy)),
        ];
        Measurement {
            position: errors.position,
            velocity: errors.velocity,
            attitude: errors.attitude,
            angular_momentum: errors.angular_momentum / momentum,
            energy,
            totals,
            outcome: (lost.iter().find(|(_, beyond)| *beyond))
                .map_or(Outcome::Ok, |(what, _)| Outcome::Lost(what)),
        }
    }

    /// The reference's largest distance from its start, or the circumradius of the box if that is larger \[m\].
    fn reach(&self) -> f64 {
        let start = self.setup.initial.position;
        let far = self
            .samples
            .iter()
            .map(|s| (s.state.position - start).length());
        far.fold(self.setup.body.radius(), f64::max)
    }

    /// The reference's largest |L|, or that of the box at 1 rad/s if that is larger [kg m²/s].
    fn largest_momentum(&self) -> f64 {
        let own = self.setup.body.inertia().max_element();
        let all = self
            .samples
            .iter()
            .map(|s| s.state.angular_momentum.length());
        all.fold(own, f64::max)
    }

    fn has_expected_energy(&self) -> bool {
        self.samples
            .iter()
            .any(|s| self.expected_energy(s).is_some())
    }

    /// Initial energy, with the zero level of the file if it prescribes one.
    fn initial_energy(&self) -> f64 {
        let own = || self.setup.energy(&self.setup.initial);
        let first = self.samples.first().filter(|s| s.t == 0.0);
        first.and_then(|s| s.energy).unwrap_or_else(own)
    }
}

impl Measurement {
    fn without_run(outcome: Outcome, errors: f64, energy: Option<f64>) -> Self {
        Self {
            position: errors,
            velocity: errors,
            attitude: errors,
            angular_momentum: errors,
            energy,
            totals: Totals::default(),
            outcome,
        }
    }
}
