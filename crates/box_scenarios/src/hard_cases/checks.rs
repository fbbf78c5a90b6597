//! Measurements of the checks.

use box_physics::integrators::Integrator;

use super::{Check, Finding, HardCase};
use crate::driver::Driver;
use crate::metrics::{SpeedLimits, differing_numbers, error_scale};
use crate::model::Model;
use crate::reference::ReferenceSolution;
use crate::setup::Setup;
use crate::simulate::simulate;
use crate::trend::energy_trend;

pub(super) fn examine(
    case: &HardCase,
    reference: &ReferenceSolution,
    integrator: Integrator,
    h: f64,
) -> Finding {
    let setup = &case.setup;
    let mut run = Run::new(setup, integrator);
    let (quantity, bound, value) = match case.check {
        Check::Position(bound) | Check::Attitude(bound) | Check::Energy(bound) => {
            let result = simulate(setup, reference, integrator, h);
            run.sane = result.diverged.is_none();
            let errors = result.errors;
            let (start, body) = (&setup.initial, &setup.body);
            match case.check {
                Check::Position(_) => ("position error [m]", bound, errors.position),
                Check::Attitude(_) => ("attitude error [rad]", bound, errors.attitude),
                _ => {
                    let scale = error_scale(setup.energy(start), start.kinetic_energy(body));
                    ("energy error, relative", bound, errors.energy / scale)
                }
            }
        }
        Check::Bounded { steps, bound } => (
            "violation of |L| or of the energy's bounds, relative",
            bound,
            run.violation(h, steps),
        ),
        Check::Trend { steps, bound } => {
            let trend = energy_trend(setup, integrator, h, steps);
            run.sane = trend.is_some();
            (
                "energy trend, relative",
                bound,
                trend.map_or(f64::INFINITY, f64::abs),
            )
        }
        Check::Return { steps, bound } => {
            run.go(h, steps);
            run.go(-h, steps);
            (
                "distance from the start [rad]",
                bound,
                run.driver.state.attitude_difference(&setup.initial),
            )
        }
        Check::UnitLength { steps, bound } => {
            run.go(h, steps);
            (
                "| |q|² − 1 |",
                bound,
                (run.driver.state.rotation.length_squared() - 1.0).abs(),
            )
        }
        Check::NoReversal(bound) => ("reversed velocity, relative", bound, run.reversal(h)),
        Check::Unchanged => {
            run.go(h, 3);
            (
                "changed components",
                0.0,
                differing_numbers(&run.driver.state, &setup.initial) as f64,
            )
        }
        Check::Spikes(bound) => ("angular momentum error, relative", bound, run.spikes(h)),
        Check::Restored(bound) => (
            "change by opposite impulses, relative",
            bound,
            run.impulses(),
        ),
    };
    Finding {
        h,
        quantity,
        value,
        bound,
        sane: run.sane,
    }
}

/// A run in progress.
struct Run<'a> {
    setup: &'a Setup,
    model: Model,
    driver: Driver,
    limits: SpeedLimits,
    sane: bool,
}

impl<'a> Run<'a> {
    fn new(setup: &'a Setup, integrator: Integrator) -> Self {
        Self {
            setup,
            model: Model::of(setup),
            driver: Driver::new(setup.initial, integrator),
            limits: SpeedLimits::of(setup),
            sane: true,
        }
    }

    /// Takes `steps` steps of `h`, then checks whether the motion is still within the sane range.
    fn go(&mut self, h: f64, steps: u64) {
        let valid = self.driver.run(&self.model, h, steps, u64::MAX);
        self.sane &= valid && self.limits.exceeded(&self.driver.state).is_none();
    }

    fn violation(&mut self, h: f64, steps: u64) -> f64 {
        let body = &self.setup.body;
        let l = self.setup.initial.angular_momentum.length();
        let largest = body.inertia().max_element();
        let smallest = body.inertia().min_element();
        let (low, high) = (0.5 * l * l / largest, 0.5 * l * l / smallest);
        let mut worst = 0.0_f64;
        for _ in 0..steps {
            self.go(h, 1);
            if !self.sane {
                return f64::INFINITY;
            }
            let e = self.driver.state.rotational_energy(body);
            let momentum = (self.driver.state.angular_momentum.length() / l - 1.0).abs();
            worst = worst.max(momentum).max(low / e - 1.0).max(e / high - 1.0);
        }
        worst
    }

    fn reversal(&mut self, h: f64) -> f64 {
        let start = self.setup.initial.velocity.x;
        let mut worst = 0.0_f64;
        for _ in 0..50 {
            self.go(h, 1);
            if !self.sane {
                return f64::INFINITY;
            }
            worst = worst.max(-self.driver.state.velocity.x / start);
        }
        worst
    }

    fn spikes(&mut self, h: f64) -> f64 {
        for _ in 0..10 {
            self.go(h, 99);
            self.go(0.5, 1);
        }
        let l = self.setup.initial.angular_momentum_world();
        (self.driver.state.angular_momentum_world() - l).length() / l.length()
    }

    fn impulses(&mut self) -> f64 {
        let start = self.setup.initial;
        for i in &self.setup.impulses {
            self.driver.apply(&self.model, i);
        }
        let dv = (self.driver.state.velocity - start.velocity).length() / start.velocity.length();
        let dl = (self.driver.state.angular_momentum - start.angular_momentum).length();
        dv.max(dl / start.angular_momentum.length())
    }
}
