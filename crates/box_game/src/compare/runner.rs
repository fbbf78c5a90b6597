//! One trajectory (main box or comparison): its simulation, clock and balance.

use std::sync::Arc;

use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::runner::DUE;
use box_scenarios::{LiveReference, Model, TimedImpulse, local_error};

use super::input::Inputs;
use super::track::Track;

/// Times closer than this fraction of a step count as equal.
pub(crate) const SAME: f64 = 1e-6;

/// Data that all runners of a run share while they are stepped.
pub(crate) struct Shared<'a> {
    pub(crate) inputs: &'a Inputs,
    pub(crate) impulses: &'a [TimedImpulse],
    pub(crate) reference: &'a mut LiveReference,
    /// Time of the clock \[s\]. A comparison that arrives there within rounding is set to exactly this time.
    pub(crate) clock: f64,
}

/// A trajectory with its measurements.
#[derive(Clone, Debug)]
pub struct Runner {
    /// The simulation and its balance.
    pub simulation: box_scenarios::Runner,
    /// Past and current measurements.
    pub track: Track,
    /// Step relative to that of the clock.
    pub factor: f64,
    /// Delay of the last input \[s\]: the steps of the runner end at other times.
    pub skew: f64,
    pub(crate) next_input: u64,
    /// The reference at the runner's time, after inputs.
    pub(crate) reference: Option<BodyState>,
    /// Number of steps written to the CSV log.
    pub(crate) logged: u64,
}

impl Runner {
    /// Creates a runner in `state` at `t` \[s\] under `law`; `next_input` is the number of its first input.
    pub(crate) fn new(
        integrator: Integrator,
        law: &Arc<Model>,
        state: BodyState,
        t: f64,
        next_input: u64,
        impulses: &[TimedImpulse],
    ) -> Self {
        let simulation = box_scenarios::Runner::new(integrator, law, state, t, impulses);
        Self {
            track: Track::new(law, &simulation.balance, &state, t),
            simulation,
            factor: 1.0,
            skew: 0.0,
            next_input,
            reference: Some(state),
            logged: 0,
        }
    }

    /// The integrator.
    pub fn integrator(&self) -> Integrator {
        self.simulation.driver.integrator
    }

    /// The state now.
    pub fn state(&self) -> &BodyState {
        &self.simulation.driver.state
    }

    /// Takes one step of `h` \[s\]. The runner must not have diverged.
    pub(crate) fn step(&mut self, h: f64, shared: &mut Shared<'_>) {
        let t = self.simulation.driver.time;
        let scene = self.simulation.take_impulses(shared.impulses, t + DUE * h);
        if self.take_inputs(shared.inputs, t, h) {
            self.reference = shared.reference.at(t);
        }
        let goes_on = self.simulation.step(h);
        let driver = &mut self.simulation.driver;
        if (driver.time - shared.clock).abs() <= SAME * h {
            driver.time = shared.clock;
        }
        if !goes_on {
            return;
        }
        let now = driver.time;
        let to = shared.reference.at(now);
        let smooth = !scene && !shared.inputs.any_within(t, now, DUE * h);
        let model = self.simulation.model.clone();
        self.observe(&model, to, smooth, h);
    }

    /// Measures the state after a step of `h` \[s\] under `model`; `to` is the reference there. The step is `smooth` if
    /// no input acted within it.
    pub(crate) fn observe(&mut self, model: &Model, to: Option<BodyState>, smooth: bool, h: f64) {
        let driver = &self.simulation.driver;
        let ends = self.reference.zip(to).filter(|_| smooth);
        let local = ends.map(|(from, to)| local_error(driver.integrator, model, from, &to, h));
        let books = (model, &self.simulation.balance);
        let (state, t) = (&driver.state, driver.time);
        self.track.observe(books, state, t, to.as_ref(), local);
        self.reference = to;
    }

    fn take_inputs(&mut self, inputs: &Inputs, t: f64, h: f64) -> bool {
        let (first, due) = (self.next_input, t + DUE * h);
        while let Some(input) = inputs.get(self.next_input).filter(|i| i.t <= due) {
            self.simulation.change(&input.change);
            self.skew = (t - input.t).max(0.0);
            self.next_input += 1;
        }
        self.next_input > first
    }

    /// Sets the comparison to `state` at `t` \[s\] with a new balance.
    pub(crate) fn resync(&mut self, law: &Arc<Model>, state: BodyState, t: f64, next_input: u64) {
        self.simulation.restart(law, state, t);
        self.next_input = next_input;
        self.reference = Some(state);
        self.track.reopen(law, &self.simulation.balance, &state, t);
    }

    /// Returns a copy without the past, for `restore`.
    pub(crate) fn save(&self) -> Self {
        let now = self.track.now;
        Self {
            simulation: self.simulation.clone(),
            track: Track {
                now,
                ..Track::default()
            },
            ..*self
        }
    }

    /// Restores a saved copy and removes the past after it.
    pub(crate) fn restore(&mut self, saved: &Self) {
        self.simulation = saved.simulation.clone();
        self.track.now.worst = saved.track.now.worst;
        self.track.rewind(saved.simulation.driver.time);
        self.next_input = saved.next_input;
        self.reference = saved.reference;
        self.logged = self.simulation.driver.totals.steps;
    }
}
