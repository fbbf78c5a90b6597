//! How each check measures.

use box_physics::integrators::{Integrator, IntegratorMemory};
use box_physics::state::BodyState;

use super::{Check, Finding, HardCase};
use crate::metrics::energy_scale;
use crate::run::advance;
use crate::setup::Setup;
use crate::simulate::{sanity, simulate};
use crate::trend::energy_trend;
use crate::truth::Truth;

pub(super) fn examine(case: &HardCase, truth: &Truth, integrator: Integrator, h: f64) -> Finding {
    let setup = &case.setup;
    let mut run = Run::new(setup, integrator);
    let (quantity, bound, value) = match case.check {
        Check::Position(bound) | Check::Attitude(bound) | Check::Energy(bound) => {
            let result = simulate(setup, truth, integrator, h);
            run.sane = result.diverged_at.is_none();
            let errors = result.errors;
            let (start, body) = (&setup.initial, &setup.body);
            match case.check {
                Check::Position(_) => ("position error [m]", bound, errors.position),
                Check::Attitude(_) => ("attitude error [rad]", bound, errors.attitude),
                _ => {
                    let scale = energy_scale(setup.energy(start), start.kinetic_energy(body));
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
            let trend = energy_trend(setup, integrator, h, steps).abs();
            ("energy trend, relative", bound, trend)
        }
        Check::Return { steps, bound } => {
            run.go(h, steps);
            run.go(-h, steps);
            (
                "distance from the start [rad]",
                bound,
                run.state.attitude_difference(&setup.initial),
            )
        }
        Check::UnitLength { steps, bound } => {
            run.go(h, steps);
            (
                "| |q|² − 1 |",
                bound,
                (run.state.rotation.length_squared() - 1.0).abs(),
            )
        }
        Check::NoReversal(bound) => ("reversed velocity, relative", bound, run.reversal(h)),
        Check::Unchanged => {
            run.go(h, 3);
            (
                "changed components",
                0.0,
                changed(&run.state, &setup.initial),
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

/// A run under way.
struct Run<'a> {
    setup: &'a Setup,
    integrator: Integrator,
    state: BodyState,
    memory: IntegratorMemory,
    sane: bool,
}

impl<'a> Run<'a> {
    fn new(setup: &'a Setup, integrator: Integrator) -> Self {
        Self {
            setup,
            integrator,
            state: setup.initial,
            memory: IntegratorMemory::default(),
            sane: true,
        }
    }

    /// `steps` steps of `h`, then a look at whether it is still sane.
    fn go(&mut self, h: f64, steps: u64) {
        let body = &self.setup.body;
        let forces = self.setup.forces.forces(body);
        let (state, memory) = (&mut self.state, &mut self.memory);
        advance(self.integrator, body, state, &forces, h, steps, memory);
        let reference = self.setup.initial;
        self.sane &= !sanity(self.setup, [&reference]).is_diverged(&self.state);
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
            let e = self.state.rotational_energy(body);
            let momentum = (self.state.angular_momentum.length() / l - 1.0).abs();
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
            worst = worst.max(-self.state.velocity.x / start);
        }
        worst
    }

    fn spikes(&mut self, h: f64) -> f64 {
        for _ in 0..10 {
            self.go(h, 99);
            self.go(0.5, 1);
        }
        let l = self.setup.initial.angular_momentum_world();
        (self.state.angular_momentum_world() - l).length() / l.length()
    }

    fn impulses(&mut self) -> f64 {
        let start = self.setup.initial;
        for i in &self.setup.impulses {
            self.state
                .apply_impulse_at_body_point(&self.setup.body, i.impulse, i.body_point);
        }
        let dv = (self.state.velocity - start.velocity).length() / start.velocity.length();
        let dl = (self.state.angular_momentum - start.angular_momentum).length();
        dv.max(dl / start.angular_momentum.length())
    }
}

fn changed(a: &BodyState, b: &BodyState) -> f64 {
    let numbers = |s: &BodyState| {
        let (x, v, l) = (s.position, s.velocity, s.angular_momentum);
        let q = s.rotation;
        [
            x.x, x.y, x.z, v.x, v.y, v.z, l.x, l.y, l.z, q.x, q.y, q.z, q.w,
        ]
    };
    let differ = |(a, b): &(f64, f64)| a.to_bits() != b.to_bits();
    numbers(a)
        .into_iter()
        .zip(numbers(b))
        .filter(differ)
        .count() as f64
}
