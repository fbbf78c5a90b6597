//! Runs one integrator through the impulses of a setup, with the balance of its energy and angular momentum.

use std::sync::Arc;

use box_physics::prelude::{BodyState, Integrator};

use crate::balance::Balance;
use crate::driver::Driver;
use crate::live_reference::Change;
use crate::metrics::StateError;
use crate::model::Model;
use crate::setup::TimedImpulse;
use crate::status::{Divergence, Reason, Status};

/// An impulse or input belongs to a step boundary if it is less than this fraction of a step later.
pub const DUE: f64 = 1e-9;

/// One integrator with its balance; see the [module](self).
#[derive(Clone, Debug)]
pub struct Runner {
    /// The simulation.
    pub driver: Driver,
    /// The current model.
    pub model: Arc<Model>,
    /// Expected energy and angular momentum.
    pub balance: Balance,
    /// Time and cause of the divergence, if any.
    pub diverged: Option<Divergence>,
    /// Index of the next impulse of the setup.
    pub next_impulse: usize,
}

impl Runner {
    /// Creates a runner in `state` at `t` \[s\]. Impulses of the setup before `t` are skipped.
    pub fn new(
        integrator: Integrator,
        model: &Arc<Model>,
        state: BodyState,
        t: f64,
        impulses: &[TimedImpulse],
    ) -> Self {
        Self {
            driver: Driver::new(state, integrator).at_time(t),
            model: model.clone(),
            balance: Balance::new(model, &state),
            diverged: None,
            next_impulse: impulses.partition_point(|i| i.t < t - DUE),
        }
    }

    /// Restarts the same integrator in `state` at `t` \[s\] under `model`.
    pub fn restart(&mut self, model: &Arc<Model>, state: BodyState, t: f64) {
        let (integrator, totals) = (self.driver.integrator, self.driver.totals);
        self.driver = Driver::new(state, integrator).at_time(t);
        self.driver.totals = totals;
        self.model = model.clone();
        self.balance = Balance::new(model, &state);
        self.diverged = None;
    }

    /// Applies the setup's impulses up to `until` \[s\]. Returns `true` if there were any.
    pub fn take_impulses(&mut self, impulses: &[TimedImpulse], until: f64) -> bool {
        let first = self.next_impulse;
        while let Some(i) = impulses.get(self.next_impulse).filter(|i| i.t <= until) {
            self.change(&Change::Impulse {
                impulse: i.impulse,
                body_point: i.body_point,
            });
            self.next_impulse += 1;
        }
        self.next_impulse > first
    }

    /// Applies a change to the box or its model.
    pub fn change(&mut self, change: &Change) {
        let (model, before) = (self.model.clone(), self.driver.state);
        match change {
            Change::Impulse {
                impulse,
                body_point,
            } => self
                .driver
                .state
                .apply_impulse_at_body_point(&model.body, *impulse, *body_point),
            Change::Model(model) => self.model = model.clone(),
            Change::Place(state) => self.driver.state = *state,
        }
        self.balance
            .input((&model, &before), (&self.model, &self.driver.state));
    }

    /// Takes one step of `h` \[s\], unless the run has diverged. Returns `true` if the run continues. A diverged run
    /// keeps its last state before the divergence.
    pub fn step(&mut self, h: f64) -> bool {
        if self.diverged.is_some() {
            return false;
        }
        let before = self.driver.state;
        self.balance.step(&self.model, &before, h);
        let stepped = self.driver.step(&self.model, h);
        let reason = if stepped.is_none() {
            Some(Reason::Invalid)
        } else if self.balance.is_exceeded(&self.model, &self.driver.state) {
            Some(Reason::Energy)
        } else {
            None
        };
        if let Some(reason) = reason {
            let t = self.driver.time;
            self.driver.state = before;
            self.diverged = Some(Divergence { t, reason });
        }
        self.diverged.is_none()
    }

    /// The current status.
    pub fn status(&self) -> Status {
        Status::of(&self.driver.state, self.driver.contacts(), self.diverged)
    }
}

/// The error of a single step of `h` \[s\] that starts in the reference's state, relative to the reference at its end.
pub fn local_error(
    integrator: Integrator,
    model: &Model,
    from: BodyState,
    to: &BodyState,
    h: f64,
) -> StateError {
    let mut one = Driver::new(from, integrator);
    one.step(model, h);
    StateError::between(&one.state, to)
}
