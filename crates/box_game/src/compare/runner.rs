//! One integrator beside the hero: its simulation, its clock, its books.

use std::sync::Arc;

use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::TimedImpulse;
use box_scenarios::metrics::Sanity;

use super::input::{Change, Inputs};
use super::ledger::Ledger;
use super::reference::Reference;
use super::track::{ReferenceStep, Track, local_error};
use crate::compare::lane::{Lane, Law};

/// Two times closer than this part of a step are one.
pub(crate) const SAME: f64 = 1e-6;
/// An input this part of a step after a boundary still belongs to it.
const DUE: f64 = 1e-9;

/// What all runners of a run share while they are stepped.
pub(crate) struct Shared<'a> {
    pub(crate) inputs: &'a Inputs,
    pub(crate) impulses: &'a [TimedImpulse],
    pub(crate) reference: &'a mut Reference,
    pub(crate) limits: &'a Sanity,
    /// The clock's time \[s\]: where a lane arrives there, it is there exactly.
    pub(crate) clock: f64,
}

/// A lane with what is measured of it.
#[derive(Clone, Debug)]
pub struct Runner {
    /// The simulation.
    pub lane: Lane,
    /// Books and past.
    pub track: Track,
    /// Its step over the clock's.
    pub factor: f64,
    /// By how much it took the last input late, because it has boundaries of its own \[s\].
    pub skew: f64,
    pub(crate) law: Arc<Law>,
    pub(crate) next_input: u64,
    pub(crate) next_impulse: usize,
    /// The reference at its time, after inputs.
    pub(crate) reference: Option<BodyState>,
    /// Steps of which the log has a row.
    pub(crate) logged: u64,
}

/// A runner without its past.
#[derive(Clone, Debug)]
pub(crate) struct Saved {
    lane: Lane,
    law: Arc<Law>,
    ledger: Ledger,
    worst: (f64, f64),
    diverged: Option<f64>,
    next_input: u64,
    next_impulse: usize,
    reference: Option<BodyState>,
}

impl Runner {
    /// In `state` at `t` \[s\] under `law`; `next_input` is the number of the first input to come.
    pub(crate) fn new(
        integrator: Integrator,
        law: &Arc<Law>,
        state: BodyState,
        t: f64,
        next_input: u64,
        impulses: &[TimedImpulse],
    ) -> Self {
        Self {
            lane: Lane::new(state, integrator).at_time(t),
            track: Track::new(law, &state, t),
            factor: 1.0,
            skew: 0.0,
            law: law.clone(),
            next_input,
            next_impulse: impulses.partition_point(|i| i.t < t - DUE),
            reference: Some(state),
            logged: 0,
        }
    }

    /// One step of `h` \[s\], unless it has diverged.
    pub(crate) fn step(&mut self, h: f64, shared: &mut Shared<'_>) {
        if self.track.diverged.is_some() {
            return;
        }
        let t = self.lane.time;
        let scene = self.take_impulses(shared.impulses, t + DUE * h);
        if self.take_inputs(shared.inputs, t, h) {
            self.reference = shared.reference.at(t);
        }
        self.track.ledger.step(&self.law, &self.lane.state, h);
        let before = self.lane.state;
        let stepped = self.lane.step(&self.law, h);
        if (self.lane.time - shared.clock).abs() <= SAME * h {
            self.lane.time = shared.clock;
        }
        let now = self.lane.time;
        if !stepped.sound || shared.limits.is_diverged(&self.lane.state) {
            self.lane.state = before;
            self.track.diverged = Some(now);
            return;
        }
        let to = shared.reference.at(now);
        let smooth = !scene && !shared.inputs.any_within(t, now, DUE * h);
        let local = match (self.reference, to) {
            (Some(from), Some(to)) if smooth => Some(local_error(
                self.lane.integrator,
                &self.law,
                &ReferenceStep { from, to },
                h,
            )),
            _ => None,
        };
        self.track
            .observe(&self.law, &self.lane.state, now, to.as_ref(), local);
        self.reference = to;
    }

    /// The scene's own impulses up to `until` \[s\]; whether there were any.
    fn take_impulses(&mut self, impulses: &[TimedImpulse], until: f64) -> bool {
        let mut any = false;
        while let Some(i) = impulses.get(self.next_impulse).filter(|i| i.t <= until) {
            let change = Change::Impulse {
                impulse: i.impulse,
                body_point: i.body_point,
            };
            self.change(&change);
            self.next_impulse += 1;
            any = true;
        }
        any
    }

    fn take_inputs(&mut self, inputs: &Inputs, t: f64, h: f64) -> bool {
        let mut any = false;
        while let Some(input) = inputs
            .get(self.next_input)
            .filter(|input| input.t <= t + DUE * h)
        {
            self.change(&input.change);
            self.skew = (t - input.t).max(0.0);
            self.next_input += 1;
            any = true;
        }
        any
    }

    fn change(&mut self, change: &Change) {
        let (law, before) = (self.law.clone(), self.lane.state);
        match change {
            Change::Impulse {
                impulse,
                body_point,
            } => self
                .lane
                .state
                .apply_impulse_at_body_point(&law.body, *impulse, *body_point),
            Change::Law(law) => self.law = law.clone(),
            Change::Place(state) => self.lane.state = *state,
        }
        self.track
            .ledger
            .input((&law, &before), (&self.law, &self.lane.state));
    }

    /// Puts the lane into `state` at `t` \[s\] and opens new books.
    pub(crate) fn resync(&mut self, law: &Arc<Law>, state: BodyState, t: f64, next_input: u64) {
        self.lane.state = state;
        self.lane.time = t;
        self.lane.memory = Default::default();
        self.lane.contact = Default::default();
        self.law = law.clone();
        self.next_input = next_input;
        self.reference = Some(state);
        self.track.reopen(law, &state, t);
    }

    pub(crate) fn save(&self) -> Saved {
        Saved {
            lane: self.lane.clone(),
            law: self.law.clone(),
            ledger: self.track.ledger,
            worst: self.track.now.worst,
            diverged: self.track.diverged,
            next_input: self.next_input,
            next_impulse: self.next_impulse,
            reference: self.reference,
        }
    }

    /// Back to what was saved; the past after that is forgotten.
    pub(crate) fn restore(&mut self, saved: &Saved) {
        self.lane = saved.lane.clone();
        self.law = saved.law.clone();
        self.track.ledger = saved.ledger;
        self.track.now.worst = saved.worst;
        self.track.diverged = saved.diverged;
        self.track.series.rewind(saved.lane.time);
        self.next_input = saved.next_input;
        self.next_impulse = saved.next_impulse;
        self.reference = saved.reference;
        self.logged = self.lane.steps;
    }
}

impl Saved {
    pub(crate) fn integrator(&self) -> Integrator {
        self.lane.integrator
    }
}
