//! The largest stable step of each integrator, found by trying, beside what theory says.

use std::ops::ControlFlow;

use box_physics::integrators::{Integrator, Limit};
use box_physics::state::BodyState;
use box_scenarios::{Driver, Family, ForceSet, Model, Setup};
use glam::DVec3;

/// A dimensionless step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Number {
    /// |ω|·dt of a free tumbling box.
    Spin,
    /// c·dt/m of linear drag.
    Drag,
    /// √(k/m)·dt of an undamped spring.
    Spring,
}

impl Number {
    pub(crate) const ALL: [Self; 3] = [Self::Spin, Self::Drag, Self::Spring];

    /// As a heading.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Spin => "|ω|·dt",
            Self::Drag => "c·dt/m",
            Self::Spring => "√(k/m)·dt",
        }
    }

    /// What the integrator claims.
    pub(crate) fn theory(self, integrator: Integrator) -> Limit {
        let s = &integrator.info().stability;
        match self {
            Self::Spin => s.rotation,
            Self::Drag => s.drag,
            Self::Spring => s.oscillator,
        }
    }
}

/// The smallest step tried, and the largest: nobody takes a larger one.
const TRIED: (f64, f64) = (0.1, 1e3);
/// Ratio between the steps tried before bisecting: narrow, as instability may begin in a narrow band.
const RATIO: f64 = 1.02;
/// Steps of a trial, and of the trial for slow growth at the smallest step.
const TRIAL: u64 = 1000;
const LONG_TRIAL: u64 = 100_000;

/// The bodies whose tumbling is tried: box, plate and needle of the families.
const BODIES: [usize; 3] = [0, 2, 3];

/// The largest stable step, as a [`Limit`]: `None` if even the largest tried is stable. For the spin, that
/// of the worst of three bodies.
pub(crate) fn measured(integrator: Integrator, number: Number) -> Limit {
    let trials: &[usize] = if number == Number::Spin {
        &BODIES
    } else {
        &BODIES[..1]
    };
    let limits = trials.iter().map(|&b| of_body(integrator, number, b));
    limits.fold(Limit::None, |worst, l| match (worst, l) {
        (Limit::AlwaysGrows, _) | (_, Limit::AlwaysGrows) => Limit::AlwaysGrows,
        (Limit::Below(a), Limit::Below(b)) => Limit::Below(a.min(b)),
        (Limit::None, other) | (other, Limit::None) => other,
    })
}

fn of_body(integrator: Integrator, number: Number, of: usize) -> Limit {
    let stable = |integrator, number, x, n| stable(integrator, number, of, x, n);
    if !stable(integrator, number, TRIED.0, LONG_TRIAL) {
        return Limit::AlwaysGrows;
    }
    let mut good = TRIED.0;
    let steps = (TRIED.1 / TRIED.0).log(RATIO).ceil() as u32;
    let first_bad = (1..=steps)
        .map(|k| TRIED.0 * RATIO.powi(k as i32))
        .try_for_each(|x| {
            if stable(integrator, number, x, TRIAL) {
                good = x;
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(x)
            }
        });
    let ControlFlow::Break(mut bad) = first_bad else {
        return Limit::None;
    };
    while bad / good > 1.0 + 1e-4 {
        let middle = (good * bad).sqrt();
        if stable(integrator, number, middle, TRIAL) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    Limit::Below(good)
}

/// Whether measurement and theory agree, to 3 %. For the spin, theory promises a range for every body;
/// the bodies tried may bear more.
pub(crate) fn agree(number: Number, measured: Limit, theory: Limit) -> bool {
    let promise = number == Number::Spin;
    match (measured, theory) {
        (Limit::Below(a), Limit::Below(b)) => a / b > 0.97 && (promise || a / b < 1.03),
        (Limit::None, Limit::Below(_)) => promise,
        (a, b) => a == b,
    }
}

/// Whether `n` steps of the dimensionless length `x` stay bounded.
fn stable(integrator: Integrator, number: Number, of: usize, x: f64, n: u64) -> bool {
    // A free-tumbling body of the families; for the others the same body without spin.
    let tumbling = &Family::all()[of].setup;
    let body = &tumbling.body;
    let rest = BodyState::at(DVec3::ZERO);
    let m = body.mass();
    let (setup, h) = match number {
        Number::Spin => {
            let spin = tumbling.initial.body_angular_velocity(body).length();
            (tumbling.clone(), x / spin)
        }
        Number::Drag => {
            let drag = ForceSet {
                linear_drag: x * m,
                ..ForceSet::none()
            };
            let moving = rest.with_velocity(DVec3::X);
            (Setup::new(*body, moving, drag, 1.0), 1.0)
        }
        Number::Spring => {
            let spring = ForceSet::none().with_spring(DVec3::ZERO, DVec3::ZERO, x * x * m, 0.0);
            let mut out = rest;
            out.position = DVec3::X;
            (Setup::new(*body, out, spring, 1.0), 1.0)
        }
    };
    let mut driver = Driver::new(setup.initial, integrator);
    let valid = driver.run(&Model::of(&setup), h, n, u64::MAX);
    let state = driver.state;
    let long = n >= LONG_TRIAL;
    valid
        && match number {
            // Growth of |L|: by 1 % over the long trial, to double in a short one.
            Number::Spin => {
                let l0 = setup.initial.angular_momentum.length();
                state.angular_momentum.length() <= if long { 1.01 } else { 2.0 } * l0
            }
            Number::Drag => state.velocity.length() <= 1.0 + 1e-9,
            // A stable oscillation's energy swings by up to 1/(1 − x²/4) near the limit.
            Number::Spring => {
                let energy = setup.energy(&state) / setup.energy(&setup.initial);
                energy <= if long { 1.5 } else { 1e4 }
            }
        }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_those_of_theory() {
        for (integrator, number, theory) in [
            (Integrator::ExplicitEuler, Number::Drag, Limit::Below(2.0)),
            (Integrator::Heun2012, Number::Drag, Limit::Below(2.0)),
            (Integrator::Rk4, Number::Drag, Limit::Below(2.785)),
            (Integrator::Rk4, Number::Spring, Limit::Below(2.828)),
            (Integrator::Split, Number::Spring, Limit::Below(2.0)),
            (Integrator::BackwardEuler, Number::Drag, Limit::None),
            (Integrator::Midpoint, Number::Spring, Limit::AlwaysGrows),
            (Integrator::Split, Number::Spin, Limit::None),
        ] {
            let found = measured(integrator, number);
            assert!(
                agree(number, found, theory),
                "{integrator} {}: {found} instead of {theory}",
                number.name()
            );
        }
    }
}
