//! Going back: checkpoints, from which the comparisons are simulated again.

use std::sync::Arc;

use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::{Balance, Change, LiveReference, Model, ReferenceSolution};

use super::Run;
use crate::compare::Quantity;
use crate::compare::flips::Flips;
use crate::compare::runner::{Runner, SAME, Saved};
use crate::compare::track::Track;

/// Distance of the states to which stepping back returns \[s\], and how many there are: four minutes.
const CHECKPOINT: f64 = 1.0;
const CHECKPOINTS: usize = 240;

#[derive(Clone, Debug)]
pub(super) struct Checkpoint {
    t: f64,
    reference: LiveReference,
    law: Arc<Model>,
    main_box: (Balance, (f64, f64)),
    comparisons: Vec<Saved>,
}

impl Run {
    /// Keeps a checkpoint where the last is old enough.
    pub(super) fn save(&mut self) {
        let due = self
            .checkpoints
            .back()
            .is_none_or(|last| self.clock >= last.t + CHECKPOINT);
        if due {
            let main_box = &self.main_box;
            self.checkpoints.push_back(Checkpoint {
                t: self.clock,
                reference: self.reference.clone(),
                law: self.law.clone(),
                main_box: (main_box.balance, main_box.track.now.worst),
                comparisons: self.comparisons.iter().map(Runner::save).collect(),
            });
            if self.checkpoints.len() > CHECKPOINTS {
                self.checkpoints.pop_front();
            }
        }
    }

    /// Back to `t` \[s\], where the main box was in `state`: the comparisons return to the checkpoint before it
    /// (or to the start) and are simulated again up to there.
    pub fn rewind(&mut self, t: f64, state: &BodyState) {
        let margin = SAME * self.step;
        self.inputs.rewind(t - margin);
        while self.checkpoints.back().is_some_and(|c| c.t > t + margin) {
            self.checkpoints.pop_back();
        }
        while self.rules.back().is_some_and(|r| r.t > t + margin) {
            self.rules.pop_back();
        }
        let integrators: Vec<Integrator> = self.integrators().collect();
        let Some(c) = self.checkpoints.back().cloned() else {
            // Before the first: again from the start.
            self.reference = LiveReference::new(
                &self.start.0,
                self.start.1,
                &self.impulses,
                ReferenceSolution::closed_form(&{
                    let mut setup = self.start.0.setup(self.start.1, 3600.0);
                    setup.impulses = self.impulses.to_vec();
                    setup
                }),
                self.step,
            );
            self.law = self.start.0.clone();
            self.comparisons.clear();
            self.choose(integrators);
            self.main_box.balance = Balance::new(&self.law, &self.start.1);
            self.main_box.track = Track::new(&self.law, &self.main_box.balance, &self.start.1, 0.0);
            self.reference_flips = Flips::new(&self.law, &self.start.1, 0.0);
            self.arrive(t, state);
            return;
        };
        self.reference = c.reference.clone();
        self.law = c.law.clone();
        let mut comparisons = core::mem::take(&mut self.comparisons);
        comparisons.retain_mut(|r| {
            let mut saved = c.comparisons.iter();
            let saved = saved.find(|s| s.integrator() == r.integrator());
            saved.map(|s| r.restore(s)).is_some()
        });
        self.comparisons = comparisons;
        self.choose(integrators);
        let main_box = &mut self.main_box;
        (main_box.balance, main_box.track.now.worst) = c.main_box;
        self.arrive(t, state);
    }

    /// The main box is in `state` at `t` \[s\], a time between a checkpoint and the next.
    fn arrive(&mut self, t: f64, state: &BodyState) {
        // Inputs since the checkpoint belong to the reference as well.
        let from = self.checkpoints.back().map_or(0.0, |c| c.t);
        for n in 0..self.inputs.end() {
            if let Some(input) = self.inputs.get(n).filter(|i| i.t >= from - 1e-12).cloned() {
                self.reference.push(input.t, &input.change);
                if let Change::Model(law) = input.change {
                    self.law = law;
                }
            }
        }
        self.clock = t;
        self.main_box.track.rewind(t);
        self.reference_flips.rewind(t);
        // Its own steps since then are not known: what they left over stays as the last sample had it.
        let left = self.main_box.track.series.last().map_or(0.0, |s| {
            let energy = s.get(Quantity::Energy);
            if energy.is_finite() { energy } else { 0.0 }
        });
        self.main_box.balance.rebase(&self.law, state, left);
        self.main_box.diverged = self.main_box.diverged.filter(|d| d.t <= t);
        self.main_box.state = *state;
        self.main_box.before = *state;
        self.main_box.reference = self.reference.at(t);
        self.main_box.next_impulse = self.impulses.partition_point(|i| i.t < t - 1e-9);
    }
}
