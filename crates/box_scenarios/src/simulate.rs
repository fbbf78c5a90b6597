//! Runs a setup and compares it with a reference.

use box_physics::integrators::Integrator;
use box_physics::state::BodyState;

use crate::driver::Totals;
use crate::metrics::{Errors, SpeedLimits, StateError};
use crate::reference::ReferenceSolution;
use crate::run::{End, Plan, run_plan, steps_in};
use crate::setup::Setup;
use crate::status::{Divergence, Reason};

/// Expected values at a sample, as far as they are known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    /// The state.
    pub state: Option<BodyState>,
    /// The energy \[J\], with the zero level of [`Setup::energy`].
    pub energy: Option<f64>,
}

/// A sample of a run with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared<'a> {
    /// Time \[s\].
    pub t: f64,
    /// The computed state.
    pub state: &'a BodyState,
    /// The error, if the reference is known.
    pub error: Option<StateError>,
}

/// The result of a run against a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Largest errors over the samples; 0 for quantities without a reference.
    pub errors: Errors,
    /// Cost.
    pub totals: Totals,
    /// Outcome of the run.
    pub end: End,
    /// When and why the run diverged, if it did. Later samples do not count.
    pub diverged: Option<Divergence>,
    /// The last state before a divergence.
    pub last: BodyState,
}

/// Runs `setup` with `integrator` along `plan`. `expected` returns the reference at each sample, in order of time.
/// `look` receives each sample and returns whether to continue.
pub fn compare(
    setup: &Setup,
    integrator: Integrator,
    plan: &Plan,
    mut expected: impl FnMut(f64) -> Expected,
    mut look: impl FnMut(&Compared) -> bool,
) -> Comparison {
    let mut limits = SpeedLimits::of(setup);
    let (mut errors, mut diverged, mut last) = (Errors::default(), None, setup.initial);
    let (totals, end) = run_plan(setup, integrator, plan, |t, state| {
        let Expected {
            state: reference,
            energy,
        } = expected(t);
        reference.iter().for_each(|r| limits.include(r));
        let reason = limits.exceeded(state);
        diverged = reason.map(|reason| Divergence { t, reason });
        if diverged.is_some() {
            return false;
        }
        let error = reference.map(|r| StateError::between(state, &r));
        error.iter().for_each(|e| errors.include(e));
        if let Some(energy) = energy {
            errors.include_energy(setup.energy(state), energy);
        }
        last = *state;
        look(&Compared { t, state, error })
    });
    if let End::Failed { at: t } = end {
        let reason = Reason::Invalid;
        diverged = Some(Divergence { t, reason });
    }
    Comparison {
        errors,
        totals,
        end,
        diverged,
        last,
    }
}

/// Runs `setup` to its end in steps of `dt` \[s\] and compares every step with `reference`. An impulse within a step
/// splits the step.
pub fn simulate(
    setup: &Setup,
    reference: &ReferenceSolution,
    integrator: Integrator,
    dt: f64,
) -> Comparison {
    let n = steps_in(setup.duration, dt);
    let times: Vec<f64> = (0..=n).map(|k| k as f64 * dt).collect();
    let plan = Plan::new(&times, &setup.impulses, dt);
    let energy = setup.conserved_energy();
    let expected = |t| Expected {
        state: reference.at(t),
        energy,
    };
    compare(setup, integrator, &plan, expected, |_| true)
}
