//! Going back: checkpoints, from which the lanes are simulated again.

use std::sync::Arc;

use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::{Balance, Change, LiveReference, Model, ReferenceSolution};

use super::Run;
use crate::compare::Quantity;
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
    hero: (Balance, (f64, f64)),
    lanes: Vec<Saved>,
}

impl Run {
    /// Keeps a checkpoint where the last is old enough.
    pub(super) fn save(&mut self) {
        let due = self
            .checkpoints
            .back()
            .is_none_or(|last| self.clock >= last.t + CHECKPOINT);
        if due {
            let hero = &self.hero;
            self.checkpoints.push_back(Checkpoint {
                t: self.clock,
                reference: self.reference.clone(),
                law: self.law.clone(),
                hero: (hero.balance, hero.track.now.worst),
                lanes: self.lanes.iter().map(Runner::save).collect(),
            });
            if self.checkpoints.len() > CHECKPOINTS {
                self.checkpoints.pop_front();
            }
        }
    }

    /// Back to `t` \[s\], where the hero was in `state`: the lanes return to the checkpoint before it
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
        let integrators: Vec<Integrator> = self
            .lanes
            .iter()
            .map(|r| r.lane.driver.integrator)
            .collect();
        let Some(c) = self.checkpoints.back().cloned() else {
            // Before the first: anew from the start.
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
            self.lanes.clear();
            self.choose(integrators);
            self.hero.balance = Balance::new(&self.law, &self.start.1);
            self.hero.track = Track::new(&self.law, &self.hero.balance, &self.start.1, 0.0);
            self.arrive(t, state);
            return;
        };
        self.reference = c.reference.clone();
        self.law = c.law.clone();
        let mut lanes = core::mem::take(&mut self.lanes);
        lanes.retain_mut(|r| {
            let saved = c
                .lanes
                .iter()
                .find(|s| s.integrator() == r.lane.driver.integrator);
            saved.map(|s| r.restore(s)).is_some()
        });
        self.lanes = lanes;
        self.choose(integrators);
        let hero = &mut self.hero;
        (hero.balance, hero.track.now.worst) = c.hero;
        self.arrive(t, state);
    }

    /// The hero is in `state` at `t` \[s\], a time between a checkpoint and the next.
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
        self.hero.track.series.rewind(t);
        // Its own steps since then are not known: what they left over stays as the last sample had it.
        let left = self.hero.track.series.last().map_or(0.0, |s| {
            let energy = s.get(Quantity::Energy);
            if energy.is_finite() { energy } else { 0.0 }
        });
        self.hero.balance.rebase(&self.law, state, left);
        self.hero.diverged = self.hero.diverged.filter(|d| d.t <= t);
        self.hero.state = *state;
        self.hero.before = *state;
        self.hero.reference = self.reference.at(t);
        self.hero.next_impulse = self.impulses.partition_point(|i| i.t < t - 1e-9);
    }
}
