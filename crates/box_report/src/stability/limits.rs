//! The largest stable step of each integrator, measured and compared with theory. Linear problems are measured with the
//! matrix of a step, spinning bodies with runs.

use std::ops::ControlFlow;

use box_physics::body::RigidBox;
use box_physics::integrators::{Integrator, Limit};
use box_physics::state::BodyState;
use box_scenarios::random::Random;
use box_scenarios::{Driver, Family, ForceSet, Model};
use glam::DVec3;

/// A dimensionless step size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Number {
    /// |ω|·dt of a free tumbling box.
    Spin,
    /// c·dt/m of linear drag.
    Drag,
    /// d·dt/m of a damper at the center of mass.
    Damper,
    /// √(k/m)·dt of an undamped spring.
    Spring,
}

impl Number {
    pub(crate) const ALL: [Self; 4] = [Self::Spin, Self::Drag, Self::Damper, Self::Spring];

    /// The heading of a table column.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Spin => "|ω|·dt",
            Self::Drag => "c·dt/m",
            Self::Damper => "d·dt/m",
            Self::Spring => "√(k/m)·dt",
        }
    }

    /// The limit that the integrator claims.
    pub(crate) fn theory(self, integrator: Integrator) -> Limit {
        let s = &integrator.info().stability;
        match self {
            Self::Spin => s.rotation,
            Self::Drag => s.drag,
            Self::Damper => s.damper,
            Self::Spring => s.oscillator,
        }
    }
}

/// The smallest and the largest step tried; no application uses larger ones.
const TRIED: (f64, f64) = (0.1, 1e3);
/// Ratio between successive steps tried: for a spinning body, where each is a run, and for a linear problem, where each
/// is a matrix. The second must be fine because instability may begin in a narrow band (0.16 % wide for `split4` on a
/// spring).
const RATIO: f64 = 1.02;
const FINE_RATIO: f64 = 1.0005;
/// Number of steps of a run, and of the run that detects slow growth at the smallest step.
const TRIAL: u64 = 1000;
const LONG_TRIAL: u64 = 100_000;
/// Relative growth per step that may be due to rounding in the matrix of a stable step.
const GROWTH_TOLERANCE: f64 = 1e-10;

/// The largest stable step, as a [`Limit`]; `None` if even the largest step tried is stable. For spin, the limit of the
/// worst body tried.
pub(crate) fn measured(integrator: Integrator, number: Number) -> Limit {
    if number == Number::Spin {
        let spinning = spinning();
        return search(RATIO, |x, smallest| {
            spinning.iter().all(|s| s.stable(integrator, x, smallest))
        });
    }
    search(FINE_RATIO, |x, smallest| {
        match spectral_radius(integrator, number, x) {
            Some(radius) => radius <= 1.0 + GROWTH_TOLERANCE,
            None => bounded(integrator, number, x, smallest),
        }
    })
}

/// The largest step for which it and all smaller steps tried are `stable`. The second argument of `stable` says whether
/// the step is the smallest one.
fn search(ratio: f64, stable: impl Fn(f64, bool) -> bool) -> Limit {
    if !stable(TRIED.0, true) {
        return Limit::AlwaysGrows;
    }
    let mut good = TRIED.0;
    let steps = (TRIED.1 / TRIED.0).log(ratio).ceil() as u32;
    let first_bad = (1..=steps)
        .map(|k| TRIED.0 * ratio.powi(k as i32))
        .try_for_each(|x| {
            if stable(x, false) {
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
        if stable(middle, false) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    Limit::Below(good)
}

/// A body whose spin must stay bounded, with several initial spins.
struct Spinning {
    body: RigidBox,
    starts: Vec<BodyState>,
    /// Number of steps of a run.
    steps: u64,
}

/// Box, plate and needle of the families, and a blade that spins near its middle axis. For the blade, a single Newton
/// step is singular from |ω|·dt = 1.004 on, for some directions of the spin.
fn spinning() -> Vec<Spinning> {
    let tumbling = ["free-tumble", "thin-plate", "needle"];
    let of_family = |f: &Family| Spinning {
        body: f.setup.body,
        starts: vec![f.setup.initial],
        steps: TRIAL,
    };
    let mut all: Vec<Spinning> = Family::all()
        .iter()
        .filter(|f| tumbling.contains(&f.id))
        .map(of_family)
        .collect();
    let blade = RigidBox::new(DVec3::new(1.0, 0.0012, 0.055), 1.0)
        .expect("the numbers of the blade are valid");
    let mut random = Random::new(11);
    let start = |_| {
        let spin = (DVec3::Z + random.vector(0.1)).normalize();
        BodyState::default().with_body_angular_velocity(&blade, spin)
    };
    let starts = (0..32).map(start).collect();
    all.push(Spinning {
        body: blade,
        starts,
        steps: 20,
    });
    all
}

impl Spinning {
    /// Returns `true` if |L| stays bounded at |ω|·dt = `x`: it grows by less than 1 % in a long run, and less than
    /// doubles in a short one.
    fn stable(&self, integrator: Integrator, x: f64, long: bool) -> bool {
        let model = Model::without_floor(self.body, ForceSet::none());
        let (steps, growth) = match (long, self.starts.len()) {
            (true, 1) => (LONG_TRIAL, 1.01),
            _ => (self.steps, 2.0),
        };
        self.starts.iter().all(|start| {
            let h = x / start.body_angular_velocity(&self.body).length();
            let mut driver = Driver::new(*start, integrator);
            let most = growth * start.angular_momentum.length();
            driver.run(&model, h, steps, u64::MAX) && driver.state.angular_momentum.length() <= most
        })
    }
}

/// The linear problem of `number` with the dimensionless step `x`; its time step is 1 s.
fn linear(number: Number, x: f64) -> Model {
    let body = RigidBox::default();
    let m = body.mass();
    let spring = |stiffness, damping| {
        ForceSet::none().with_spring(DVec3::ZERO, DVec3::ZERO, stiffness, damping)
    };
    let forces = match number {
        Number::Damper => spring(0.0, x * m),
        Number::Spring => spring(x * x * m, 0.0),
        Number::Spin | Number::Drag => ForceSet {
            linear_drag: x * m,
            ..ForceSet::none()
        },
    };
    Model::without_floor(body, forces)
}

/// Position and velocity along x.
fn pair(state: &BodyState) -> [f64; 2] {
    [state.position.x, state.velocity.x]
}

fn at([x, v]: [f64; 2]) -> BodyState {
    BodyState::at(DVec3::X * x).with_velocity(DVec3::X * v)
}

/// The asymptotic growth factor per step: the largest eigenvalue magnitude of the step's matrix, from its trace and
/// determinant. `None` for an integrator whose step depends on the previous step.
fn spectral_radius(integrator: Integrator, number: Number, x: f64) -> Option<f64> {
    let model = linear(number, x);
    let step = |start| {
        let mut driver = Driver::new(start, integrator);
        driver.step(&model, 1.0);
        driver.state
    };
    if number != Number::Spring {
        // If a step depends on the previous one, the second step shows it.
        let mut driver = Driver::new(at([0.0, 1.0]), integrator);
        driver.run(&model, 1.0, 2, u64::MAX);
        let once = step(at([0.0, 1.0]));
        let twice = step(at([0.0, once.velocity.x]));
        return (driver.state.velocity == twice.velocity).then_some(once.velocity.x.abs());
    }
    let columns = [[1.0, 0.0], [0.0, 1.0]].map(|start| pair(&step(at(start))));
    let mut driver = Driver::new(at([1.0, 0.0]), integrator);
    driver.run(&model, 1.0, 2, u64::MAX);
    if driver.state.velocity != step(at(columns[0])).velocity {
        return None;
    }
    let [[a, c], [b, d]] = columns;
    let (half_trace, determinant) = (0.5 * (a + d), a * d - b * c);
    let discriminant = half_trace * half_trace - determinant;
    Some(if discriminant < 0.0 {
        determinant.sqrt()
    } else {
        half_trace.abs() + discriminant.sqrt()
    })
}

/// Returns `true` if a run of the linear problem stays bounded. For integrators whose step has no matrix.
fn bounded(integrator: Integrator, number: Number, x: f64, long: bool) -> bool {
    let model = linear(number, x);
    let start = at(if number == Number::Spring {
        [1.0, 0.0]
    } else {
        [0.0, 1.0]
    });
    let mut driver = Driver::new(start, integrator);
    // Detects growth by 1e-4 per step, or by 1e-5 in the long run.
    let steps = if long { LONG_TRIAL } else { 10_000 };
    let size = |s: &BodyState| match number {
        Number::Spring => s.velocity.length().hypot(x * s.position.length()),
        _ => s.velocity.length(),
    };
    // Ignore growth in the first steps of a multistep method.
    let settled = driver.run(&model, 1.0, 100, u64::MAX);
    let before = size(&driver.state);
    settled && driver.run(&model, 1.0, steps, u64::MAX) && size(&driver.state) <= 2.7 * before
}

/// Returns `true` if measurement and theory agree to 3 %. For spin, the theoretical limit holds for every body; the
/// bodies tried may remain stable beyond it.
pub(crate) fn agree(number: Number, measured: Limit, theory: Limit) -> bool {
    let promise = number == Number::Spin;
    match (measured, theory) {
        (Limit::Below(a), Limit::Below(b)) => a / b > 0.97 && (promise || a / b < 1.03),
        (Limit::None, Limit::Below(_)) => promise,
        (a, b) => a == b,
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
            (Integrator::Rk4, Number::Damper, Limit::Below(2.785)),
            (Integrator::Split, Number::Damper, Limit::None),
            (Integrator::Rk4, Number::Spring, Limit::Below(2.828)),
            // Chin's 4A: 2√3.
            (Integrator::Split, Number::Spring, Limit::Below(3.464)),
            (Integrator::SymmetricTop, Number::Spring, Limit::Below(2.0)),
            (Integrator::BackwardEuler, Number::Drag, Limit::None),
            (Integrator::Midpoint, Number::Spring, Limit::AlwaysGrows),
            (Integrator::Split, Number::Spin, Limit::None),
            // |tr|/2 > 1 between 3.16346 and 3.16853, by at most 3e-6, and again from 5.027 on.
            (Integrator::Split4, Number::Spring, Limit::Below(3.163)),
            (
                Integrator::SemiImplicitEuler,
                Number::Spring,
                Limit::Below(2.0),
            ),
        ] {
            let found = measured(integrator, number);
            assert!(
                agree(number, found, theory),
                "{integrator} {}: {found} instead of {theory}",
                number.name()
            );
        }
    }

    /// The measured limit is that of the worst body, not of three ordinary ones.
    #[test]
    fn a_single_newton_step_fails_where_its_matrix_is_singular() {
        let Limit::Below(found) = measured(Integrator::EngineNewton, Number::Spin) else {
            panic!("engine-newton has a limit");
        };
        assert!((1.0..1.1).contains(&found), "{found}");
    }

    /// For leapfrog, half the trace of the step's matrix is 1 − x²/2 and the determinant is 1.
    #[test]
    fn the_matrix_of_a_step_is_that_of_the_formula() {
        let radius = |x| spectral_radius(Integrator::SemiImplicitEuler, Number::Spring, x);
        let beyond = 1.0_f64 - 2.1 * 2.1 / 2.0;
        let expected = beyond.abs() + (beyond * beyond - 1.0).sqrt();
        assert!((radius(2.1).expect("a matrix") - expected).abs() < 1e-12);
        assert!((radius(1.9).expect("a matrix") - 1.0).abs() < 1e-12);
    }
}
