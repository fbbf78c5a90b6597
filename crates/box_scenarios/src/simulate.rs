//! A setup against its truth: the errors of every step.

use box_physics::integrators::Integrator;
use box_physics::state::BodyState;
use glam::DVec3;

use crate::metrics::{Errors, Sanity, StateError};
use crate::run::{Plan, Totals, run_plan, steps_in};
use crate::setup::Setup;
use crate::truth::Truth;

/// The result of [`simulate`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulationResult {
    /// The largest errors against the truth over all steps; 0 in what the truth does not know.
    pub errors: Errors,
    /// Cost.
    pub totals: Totals,
    /// When the run diverged \[s\], if it did; nothing after that counts.
    pub diverged_at: Option<f64>,
    /// The last state.
    pub last: BodyState,
}

/// Runs `setup` to its end in steps of `dt` \[s\] and compares every step with `truth`. Impulses between
/// two steps split that step at their time.
pub fn simulate(setup: &Setup, truth: &Truth, integrator: Integrator, dt: f64) -> SimulationResult {
    let n = steps_in(setup.duration, dt);
    let times: Vec<f64> = (0..=n).map(|k| k as f64 * dt).collect();
    let references: Vec<_> = times.iter().map(|&t| truth.at(t)).collect();
    let sanity = sanity(setup, references.iter().flatten());
    let conserves = setup.conserves_energy();
    let energy = setup.energy(&setup.initial);
    let (mut errors, mut diverged_at) = (Errors::default(), None);
    let mut last = setup.initial;
    let mut expected = references.iter();
    let plan = Plan::new(&times, &setup.impulses, dt);
    let totals = run_plan(setup, integrator, &plan, |t, state| {
        let reference = expected.next().copied().flatten();
        if sanity.is_diverged(state) {
            diverged_at = Some(t);
            return false;
        }
        if let Some(reference) = reference {
            errors.see(&StateError::between(state, &reference));
        }
        if conserves {
            errors.see_energy(setup.energy(state), energy);
        }
        last = *state;
        true
    });
    SimulationResult {
        errors,
        totals,
        diverged_at,
        last,
    }
}

/// The limits of sanity for `setup` with these trusted states. Where nothing moves, what gravity and
/// the box's size make of a second sets the scale.
pub fn sanity<'a>(setup: &Setup, reference: impl IntoIterator<Item = &'a BodyState>) -> Sanity {
    let body = &setup.body;
    let speed =
        setup.forces.acceleration(body).length() + body.radius() + setup.initial.velocity.length();
    let momentum = body.inertia().dot(DVec3::ONE) + setup.initial.angular_momentum.length();
    Sanity::new(reference, speed, momentum)
}
