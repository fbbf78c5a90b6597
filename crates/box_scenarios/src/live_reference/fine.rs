//! The fine simulation, used where there is no closed form.

use std::collections::VecDeque;
use std::sync::Arc;

use box_physics::prelude::{BodyState, Integrator};

use crate::driver::Driver;
use crate::model::Model;
use crate::setup::TimedImpulse;

/// The most accurate integrator for `model` in fine steps.
pub fn best_integrator(model: &Model) -> Integrator {
    let d = model.forces.dissipation();
    if d.quadratic_drag != 0.0 || d.angular_drag != 0.0 {
        Integrator::Rk4
    } else if model.forces.has_wrench() {
        Integrator::Split4
    } else {
        Integrator::Exact
    }
}

/// A simulation that can only advance.
#[derive(Clone, Debug)]
pub(super) struct Fine {
    pub(super) driver: Driver,
    model: Arc<Model>,
    /// Impulses of the scene that have not acted yet.
    waiting: VecDeque<TimedImpulse>,
    lost: bool,
}

impl Fine {
    pub(super) fn new(
        state: BodyState,
        from: f64,
        model: &Arc<Model>,
        waiting: VecDeque<TimedImpulse>,
    ) -> Self {
        Self {
            driver: Driver::new(state, best_integrator(model)).at_time(from),
            model: model.clone(),
            waiting,
            lost: false,
        }
    }

    pub(super) fn at(&mut self, t: f64, h: f64) -> Option<BodyState> {
        while let Some(i) = self.waiting.front().filter(|i| i.t < t) {
            let i = *i;
            self.run(i.t, h);
            self.waiting.pop_front();
            self.driver.apply(&self.model, &i);
        }
        self.run(t, h);
        let here = (self.driver.time - t).abs() <= 1e-9 * h;
        (here && !self.lost).then_some(self.driver.state)
    }

    /// Advances to exactly `t` in equal steps of at most `h`.
    fn run(&mut self, t: f64, h: f64) {
        let way = t - self.driver.time;
        if way <= 1e-9 * h || self.lost {
            return;
        }
        let n = (way / h - 1e-6).ceil().max(1.0);
        for _ in 0..n as u64 {
            self.lost |= self.driver.step(&self.model, way / n).is_none();
        }
        self.driver.time = t;
    }
}
