//! One run of a scene: the main box, the comparisons and the reference, all with the same start and the same inputs.

mod past;
mod ranking;

use std::collections::VecDeque;
use std::iter;
use std::mem::{replace, swap, take};
use std::sync::Arc;

use bevy::platform::time::Instant;
use box_physics::floor::ContactState;
use box_physics::prelude::{BodyState, Integrator, IntegratorMemory};
use box_scenarios::{
    Change, Divergence, LiveReference, Model, Reason, ReferenceSolution, Setup, TimedImpulse,
};

use super::flips::{Flips, lateness};
use super::input::{Input, Inputs};
use super::runner::{Runner, SAME, Shared};
use super::track::Track;
use past::Checkpoint;
use ranking::Ranking;

/// Maximum number of marks kept.
const MAX_MARKS: usize = 512;
/// Marks of one kind that are closer than this are merged \[s\].
const MARK_SPACING: f64 = 0.02;
/// Number of steps between two checks of the deadline.
const BATCH: u32 = 16;

/// Kind of a mark in the plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkKind {
    /// The main box touched the floor.
    Contact,
    /// The reference flipped.
    Flip,
    /// A push, a changed parameter or a moved box.
    Input,
    /// The step size changed.
    Step,
    /// The integrator of the main box changed.
    Integrator,
    /// All trajectories were set to the state of the reference.
    Resync,
}

/// A mark in the plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Simulated time \[s\].
    pub t: f64,
    /// Kind of the mark.
    pub kind: MarkKind,
}

/// A run of a scene; see the module.
#[derive(Clone, Debug)]
pub struct Run {
    /// Time of the clock \[s\].
    pub clock: f64,
    /// Step of the clock \[s\].
    pub step: f64,
    /// The current model: body, forces and floor.
    pub law: Arc<Model>,
    /// The main box: a body stepped by the plugin and observed here before and after each step.
    pub main_box: Runner,
    /// The comparisons.
    pub comparisons: Vec<Runner>,
    /// The reference for all trajectories.
    pub reference: LiveReference,
    /// Flips of the reference.
    pub reference_flips: Flips,
    /// Marks in the plots, oldest first.
    pub marks: VecDeque<Mark>,
    start: (Arc<Model>, BodyState),
    /// The main box at the start of its last step; `true` if one of the scene's impulses acted there.
    before: (BodyState, bool),
    impulses: Arc<[TimedImpulse]>,
    inputs: Inputs,
    checkpoints: VecDeque<Checkpoint>,
    ranking: Ranking,
}

impl Run {
    /// Creates a run from the start of `setup`. `truth` is its reference, if known.
    pub fn new(
        setup: &Setup,
        truth: Option<ReferenceSolution>,
        main_box: Integrator,
        step: f64,
    ) -> Self {
        let law = Arc::new(Model::of(setup));
        let state = setup.initial;
        let impulses: Arc<[TimedImpulse]> = setup.impulses.as_slice().into();
        let mut run = Self {
            clock: 0.0,
            step,
            main_box: Runner::new(main_box, &law, state, 0.0, 0, &impulses),
            comparisons: Vec::new(),
            reference: LiveReference::new(&law, state, &impulses, truth, step),
            reference_flips: Flips::new(&law, &state, 0.0),
            marks: VecDeque::new(),
            start: (law.clone(), state),
            before: (state, false),
            impulses,
            inputs: Inputs::default(),
            checkpoints: VecDeque::new(),
            ranking: Ranking::default(),
            law,
        };
        run.save();
        run
    }

    /// The state that the run began with.
    pub fn start(&self) -> &BodyState {
        &self.start.1
    }

    /// Compares with exactly these integrators, in this order. A new comparison catches up from the start, or begins at
    /// the reference if early inputs were dropped.
    pub fn choose(&mut self, integrators: impl IntoIterator<Item = Integrator>) {
        let mut old = take(&mut self.comparisons);
        for integrator in integrators {
            let kept = old.iter().position(|r| r.integrator() == integrator);
            let impulses = &self.impulses;
            let runner = match kept {
                Some(k) => old.swap_remove(k),
                None if self.inputs.is_whole() => {
                    let (law, state) = &self.start;
                    Runner::new(integrator, law, *state, 0.0, 0, impulses)
                }
                // The beginning is forgotten: begin at the reference.
                None => {
                    let known = self.reference.follow(self.clock);
                    let state = known.unwrap_or(*self.main_box.state());
                    let (t, next) = (self.clock, self.inputs.end());
                    Runner::new(integrator, &self.law, state, t, next, impulses)
                }
            };
            self.comparisons.push(runner);
        }
    }

    /// The integrators of the comparisons.
    pub fn integrators(&self) -> impl Iterator<Item = Integrator> + '_ {
        self.comparisons.iter().map(Runner::integrator)
    }

    /// Every trajectory, the main box's first.
    pub fn trajectories(&self) -> impl Iterator<Item = &Runner> {
        iter::once(&self.main_box).chain(&self.comparisons)
    }

    /// The reference at the clock's time, if it is known.
    pub fn trusted(&self) -> Option<&BodyState> {
        self.main_box.reference.as_ref()
    }

    /// Returns `true` if the largest attitude error \[rad\] is at least the largest position error in radii of the box.
    pub fn attitude_says_more(&self) -> bool {
        let worst = self.trajectories().map(|r| r.track.now.worst);
        let (x, a) = worst.fold((0.0_f64, 0.0_f64), |(x, a), w| (x.max(w.0), a.max(w.1)));
        a.to_radians() >= x / self.law.body.radius()
    }

    /// Number of the trajectory's flip with the largest lateness, and that lateness \[s\]; see [`lateness`].
    pub fn late(&self, track: &Track) -> Option<(usize, f64)> {
        let now = track.now.sample.t;
        let known = self.reference_flips.times();
        let due = known.partition_point(|&t| t <= now);
        lateness(track.flips.times(), &known[..due], now)
    }

    /// Returns `true` if the main box or a comparison diverged.
    pub fn any_diverged(&self) -> bool {
        let mut all = self.trajectories();
        all.any(|r| r.simulation.diverged.is_some())
    }

    /// Marks an event in the plots.
    pub fn mark(&mut self, t: f64, kind: MarkKind) {
        let repeats = |last: &Mark| last.kind == kind && t - last.t < MARK_SPACING;
        if !self.marks.back().is_some_and(repeats) {
            self.marks.push_back(Mark { t, kind });
        }
        if self.marks.len() > MAX_MARKS {
            self.marks.pop_front();
        }
    }

    /// Sets the step of the clock \[s\].
    pub fn set_step(&mut self, step: f64) {
        if step != self.step {
            self.step = step;
            self.reference.set_clock_step(step);
            if self.clock > 0.0 {
                self.mark(self.clock, MarkKind::Step);
            }
        }
    }

    /// Records a change of the box at `t` \[s\], the start of the next step.
    fn push(&mut self, t: f64, change: Change) {
        self.reference.push(t, &change);
        self.inputs.push(Input { t, change });
        self.mark(t, MarkKind::Input);
    }

    /// Records the main box before its step: `state` at `t` \[s\], under the force model `law`. `pushes` applies the
    /// pushes since its last step and returns them. If the result differs from `state`, the box was moved, and every
    /// comparison is moved there too.
    pub fn before_step(
        &mut self,
        t: f64,
        law: Model,
        state: &BodyState,
        pushes: impl FnOnce(&mut BodyState) -> Vec<Change>,
    ) {
        let margin = 1e-9 * self.step;
        let before = *self.main_box.state();
        let (mut expected, mut kicked) = (before, false);
        let next = |k: usize| self.impulses.get(k).filter(|i| i.t <= t + margin);
        let next_impulse = &mut self.main_box.simulation.next_impulse;
        while let Some(i) = next(*next_impulse) {
            expected.apply_impulse_at_body_point(&self.law.body, i.impulse, i.body_point);
            *next_impulse += 1;
            kicked = true;
        }
        let changes = pushes(&mut expected);
        let inputs = self.inputs.end();
        if expected == *state {
            changes.into_iter().for_each(|change| self.push(t, change));
        } else {
            self.push(t, Change::Place(*state));
        }
        let old = self.law.clone();
        if *self.law != law {
            self.law = Arc::new(law);
            self.push(t, Change::Model(self.law.clone()));
        }
        if self.inputs.end() != inputs || kicked {
            let balance = &mut self.main_box.simulation.balance;
            balance.input((&old, &before), (&self.law, state));
            self.main_box.reference = self.reference.at(t);
        }
        self.before = (*state, kicked);
    }

    /// Records the main box after a step of `h` \[s\]: `state` at `t` \[s\].
    pub fn after_step(
        &mut self,
        t: f64,
        h: f64,
        (state, contact): (&BodyState, &ContactState),
        integrator: Integrator,
    ) {
        if integrator != self.main_box.integrator() {
            self.main_box.simulation.driver.integrator = integrator;
            self.mark(self.clock, MarkKind::Integrator);
        }
        self.set_step(h);
        self.clock = t;
        let own = &mut self.main_box.simulation;
        own.balance.step(&self.law, &self.before.0, h);
        if own.diverged.is_none() && own.balance.is_exceeded(&self.law, state) {
            let reason = Reason::Energy;
            own.diverged = Some(Divergence { t, reason });
        }
        (own.driver.state, own.driver.time) = (*state, t);
        own.driver.contact.clone_from(contact);
        let to = self.reference.at(t);
        self.main_box.observe(&self.law, to, !self.before.1, h);
        if let Some(to) = &to {
            let flips = self.reference_flips.times().len();
            self.reference_flips.observe(to, t);
            if let Some(&flip) = self.reference_flips.times().get(flips) {
                self.mark(flip, MarkKind::Flip);
            }
        }
    }

    /// Simulates the comparisons up to the clock's time, the one farthest behind first, until `deadline`. Returns
    /// `true` if all have arrived.
    pub fn advance(&mut self, deadline: Option<Instant>) -> bool {
        let Self {
            comparisons,
            inputs,
            impulses,
            reference,
            clock,
            step,
            ..
        } = self;
        let mut shared = Shared {
            inputs,
            impulses,
            reference,
            clock: *clock,
        };
        for n in 1_u32.. {
            let end = |r: &&mut Runner| r.simulation.driver.time + r.factor * *step;
            let due = |r: &&mut Runner| {
                r.simulation.diverged.is_none() && end(r) <= *clock + SAME * *step
            };
            let next = comparisons
                .iter_mut()
                .filter(due)
                .min_by(|a, b| end(a).total_cmp(&end(b)));
            let Some(runner) = next else {
                break;
            };
            runner.step(runner.factor * *step, &mut shared);
            if n.is_multiple_of(BATCH) && deadline.is_some_and(|d| Instant::now() >= d) {
                return false;
            }
        }
        self.save();
        true
    }

    /// Sets every trajectory to the reference's state, with a new balance. Returns that state for the body.
    pub fn resync(&mut self) -> Option<BodyState> {
        let state = self.reference.follow(self.clock)?;
        self.reference.push(self.clock, &Change::Place(state));
        let (t, next) = (self.clock, self.inputs.end());
        for runner in iter::once(&mut self.main_box).chain(&mut self.comparisons) {
            runner.resync(&self.law, state, t, next);
        }
        self.before = (state, false);
        self.reference_flips = Flips::new(&self.law, &state, t);
        self.mark(t, MarkKind::Resync);
        Some(state)
    }

    /// Swaps the main box with the comparison under `integrator`, if that has reached the clock's time. Updates the
    /// state, memory and contact that the plugin keeps for the main box. Returns `true` if swapped.
    pub fn swap(
        &mut self,
        integrator: Integrator,
        (state, memory, contact): (&mut BodyState, &mut IntegratorMemory, &mut ContactState),
    ) -> bool {
        let here = |r: &&mut Runner| {
            r.integrator() == integrator
                && r.simulation.diverged.is_none()
                && (r.simulation.driver.time - self.clock).abs() <= SAME * self.step
        };
        let Some(runner) = self.comparisons.iter_mut().find(here) else {
            return false;
        };
        // Pushes that wait for the next step stay with the body.
        if state != self.main_box.state() {
            return false;
        }
        swap(runner, &mut self.main_box);
        // The step stays with the place, and both stand at the same input.
        swap(&mut runner.factor, &mut self.main_box.factor);
        runner.next_input = self.inputs.end();
        runner.simulation.model = self.law.clone();
        // What the plugin steps is with the plugin.
        let (new, old) = (&mut self.main_box.simulation, &mut runner.simulation);
        *state = new.driver.state;
        old.driver.contact = replace(contact, new.driver.contact.clone());
        old.driver.memory = replace(memory, take(&mut new.driver.memory));
        self.main_box.skew = 0.0;
        self.before = (*state, false);
        self.checkpoints.truncate(1);
        true
    }

    /// Number of samples, stretches, marks and checkpoints in memory; bounded for runs of any length.
    pub fn kept(&self) -> usize {
        let samples: usize = self.trajectories().map(|r| r.track.series.kept()).sum();
        samples + self.marks.len() + self.checkpoints.len()
    }
}
