//! The one runner of a setup against a reference.

use box_physics::integrators::Integrator;
use box_physics::state::BodyState;

use crate::driver::Totals;
use crate::metrics::{Errors, SpeedLimits, StateError};
use crate::reference::ReferenceSolution;
use crate::run::{End, Plan, run_plan, steps_in};
use crate::setup::Setup;
use crate::status::{Divergence, Reason};

/// What a run should have reached at a sample, as far as it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    /// The state.
    pub state: Option<BodyState>,
    /// The energy \[J\], in the zero of [`Setup::energy`].
    pub energy: Option<f64>,
}

/// A sample of a run with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared<'a> {
    /// Time \[s\].
    pub t: f64,
    /// The state computed.
    pub state: &'a BodyState,
    /// Its error, where the reference is known.
    pub error: Option<StateError>,
}

/// The result of a run against a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// The largest errors over the samples; 0 in what the reference does not know.
    pub errors: Errors,
    /// Cost.
    pub totals: Totals,
    /// How it ended.
    pub end: End,
    /// When and why it diverged, if it did; nothing after that counts.
    pub diverged: Option<Divergence>,
    /// The last state that did not diverge.
    pub last: BodyState,
}

/// Runs `setup` by `integrator` along `plan`. `expected` gives the
/// reference at each sample, in order of time; `look` sees each sample and returns whether to go on.
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
        reference.iter().for_each(|r| limits.see(r));
        diverged = limits.broken(state).map(|reason| Divergence { t, reason });
        if diverged.is_some() {
            return false;
        }
        let error = reference.map(|r| StateError::between(state, &r));
        error.iter().for_each(|e| errors.see(e));
        if let Some(energy) = energy {
            errors.see_energy(setup.energy(state), energy);
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

/// Runs `setup` to its end in steps of `dt` \[s\] and compares every step with `reference`. Impulses between
/// two steps split that step at their time.
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
