//! Stepping back: checkpoints, from which the comparisons are simulated again.

use std::sync::Arc;

use box_physics::prelude::BodyState;
use box_scenarios::{Balance, Change, LiveReference, Model};

use super::Run;
use crate::compare::Quantity;
use crate::compare::runner::{Runner, SAME};

/// Interval of the checkpoints for stepping back \[s\], and their maximum number: four minutes.
const CHECKPOINT: f64 = 1.0;
const CHECKPOINTS: usize = 240;

#[derive(Clone, Debug)]
pub(super) struct Checkpoint {
    t: f64,
    reference: LiveReference,
    law: Arc<Model>,
    main_box: (Balance, (f64, f64)),
    comparisons: Vec<Runner>,
}

impl Run {
    /// Saves a checkpoint if the last is old enough. The first, at the start, is always kept.
    pub(super) fn save(&mut self) {
        let last = self.checkpoints.back();
        if last.is_some_and(|last| self.clock < last.t + CHECKPOINT) {
            return;
        }
        let main_box = &self.main_box;
        self.checkpoints.push_back(Checkpoint {
            t: self.clock,
            reference: self.reference.clone(),
            law: self.law.clone(),
            main_box: (main_box.simulation.balance, main_box.track.now.worst),
            comparisons: self.comparisons.iter().map(Runner::save).collect(),
        });
        if self.checkpoints.len() > CHECKPOINTS {
            self.checkpoints.remove(1);
        }
    }

    /// Steps back to `t` \[s\], where the main box was in `state`. The comparisons return to the checkpoint before it
    /// and are simulated up to that time.
    pub fn rewind(&mut self, t: f64, state: &BodyState) {
        let end = t + SAME * self.step;
        self.inputs.rewind(t - SAME * self.step);
        self.marks.retain(|m| m.t <= end);
        self.checkpoints.retain(|c| c.t == 0.0 || c.t <= end);
        let Some(c) = self.checkpoints.back().cloned() else {
            return;
        };
        self.reference = c.reference;
        self.reference.set_clock_step(self.step);
        self.law = c.law;
        let kept = self.comparisons.iter().map(|r| (r.integrator(), r.factor));
        let (integrators, factors): (Vec<_>, Vec<_>) = kept.unzip();
        self.comparisons.retain_mut(|r| {
            let mut saved = c.comparisons.iter();
            let saved = saved.find(|s| s.integrator() == r.integrator());
            saved.map(|s| r.restore(s)).is_some()
        });
        self.choose(integrators);
        for (runner, factor) in self.comparisons.iter_mut().zip(factors) {
            runner.factor = factor;
        }
        let main_box = &mut self.main_box;
        (main_box.simulation.balance, main_box.track.now.worst) = c.main_box;
        self.arrive(t, state);
    }

    /// Sets the main box to `state` at `t` \[s\], a time between a checkpoint and the next.
    fn arrive(&mut self, t: f64, state: &BodyState) {
        // Inputs since the checkpoint also apply to the reference.
        let from = self.checkpoints.back().map_or(0.0, |c| c.t);
        for input in self.inputs.since(from - 1e-12) {
            self.reference.push(input.t, &input.change);
            if let Change::Model(law) = &input.change {
                self.law = law.clone();
            }
        }
        self.clock = t;
        self.main_box.track.rewind(t);
        self.reference_flips.rewind(t);
        // The main box's steps since then are unknown, so the energy residual is that of the last sample.
        let last = self.main_box.track.series.last();
        let left = last.map(|s| s.get(Quantity::Energy));
        let left = left.filter(|energy| energy.is_finite()).unwrap_or(0.0);
        let own = &mut self.main_box.simulation;
        own.balance.rebase(&self.law, state, left);
        own.diverged = own.diverged.filter(|d| d.t <= t);
        (own.driver.state, own.driver.time) = (*state, t);
        own.next_impulse = self.impulses.partition_point(|i| i.t < t - 1e-9);
        self.main_box.reference = self.reference.at(t);
        self.before = (*state, false);
    }
}
