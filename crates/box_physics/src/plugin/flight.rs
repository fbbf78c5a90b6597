//! Bodies in free flight: those that stay clear of the floor in this step.

use core::ops::Range;

use glam::DVec3;

use super::columns::ForceColumnsContiguousItem;
use super::components::NearFloor;
use super::step::{Setting, Tally, runs_of};
use crate::body::RigidBox;
use crate::floor::{self, Floor};
use crate::force::{ForceLaw, Gravity};
use crate::schemes::{GravityField, Group, Scheme, SchemeMemory, SchemeVisitor};
use crate::state::BodyState;

/// Steps a chunk of bodies in free flight; those that may meet the floor are marked and left alone.
pub(crate) struct FreeFlight<'a, 'w, 's> {
    pub(crate) setting: Setting<'a>,
    /// Index in the table of the first body of the chunk.
    pub(crate) first: usize,
    pub(crate) bodies: &'a [RigidBox],
    /// Of the whole table.
    pub(crate) forces: &'a ForceColumnsContiguousItem<'w, 's>,
    pub(crate) states: &'a mut [BodyState],
    pub(crate) memories: &'a mut [SchemeMemory],
    pub(crate) near: &'a mut [NearFloor],
}

impl NearFloor {
    /// Whether the body is left to *Contact* in this step; noted.
    #[inline(always)]
    fn meets<F: ForceLaw>(
        &mut self,
        floor: &Floor,
        body: &RigidBox,
        state: &BodyState,
        law: &F,
        h: f64,
    ) -> bool {
        self.still = false;
        self.pending = self.touched || floor::may_touch(floor, body, state, law, h);
        self.pending
    }
}

impl SchemeVisitor for FreeFlight<'_, '_, '_> {
    type Output = Tally;

    fn visit<S: Scheme>(mut self) -> Tally {
        let (forces, bodies, first) = (self.forces, self.bodies, self.first);
        let world = self.setting.gravity;
        if !forces.only_gravity() {
            return self.each::<S, _>(|i| forces.forces(first + i, &bodies[i], world));
        }
        let mut tally = Tally::default();
        match self
            .setting
            .floor
            .map_or(0, |floor| self.leave_to_contact(floor))
        {
            0 => self.run::<S>(0..bodies.len(), &mut tally),
            left if left < bodies.len() => self.runs::<S>(&mut tally),
            _ => {}
        }
        tally
    }
}

/// Bodies that are copied together into one group, where the floor parts a chunk into short runs.
const GATHERED: usize = 64;

/// A run shorter than this is copied together with others: that costs a body less than a step of its own.
const SHORT: usize = 16;

impl FreeFlight<'_, '_, '_> {
    /// Marks the bodies that may meet the floor. How many there are.
    fn leave_to_contact(&mut self, floor: &Floor) -> usize {
        let mut left = 0;
        for i in 0..self.bodies.len() {
            let law = Gravity(self.gravity(i));
            let (body, state) = (&self.bodies[i], &self.states[i]);
            left += usize::from(self.near[i].meets(floor, body, state, &law, self.setting.h));
        }
        left
    }

    #[inline(always)]
    fn gravity(&self, i: usize) -> DVec3 {
        self.forces.gravity(self.first + i, self.setting.gravity)
    }

    /// The bodies between those that are left to *Contact*: long runs of them where they are, short ones
    /// copied together.
    fn runs<S: Scheme>(&mut self, tally: &mut Tally) {
        let (mut chosen, mut count) = ([0; GATHERED], 0);
        let mut next = 0;
        while let Some(range) = self.next_run(next) {
            next = range.end;
            if range.len() >= SHORT {
                self.run::<S>(range, tally);
                continue;
            }
            if count + range.len() > GATHERED {
                self.gathered::<S>(&chosen[..count], tally);
                count = 0;
            }
            for i in range {
                chosen[count] = i;
                count += 1;
            }
        }
        if count > 0 {
            self.gathered::<S>(&chosen[..count], tally);
        }
    }

    /// The next bodies in a row that are not left to *Contact*.
    fn next_run(&self, from: usize) -> Option<Range<usize>> {
        let range = runs_of(self.near.len() - from, |i| !self.near[from + i].pending).next()?;
        Some(from + range.start..from + range.end)
    }

    /// Neighbours, where they are.
    fn run<S: Scheme>(&mut self, range: Range<usize>, tally: &mut Tally) {
        if !self.forces.scales_gravity() {
            let gravity = GravityField::Uniform(self.setting.gravity);
            return self.group::<S>(range, gravity, tally);
        }
        for start in range.clone().step_by(GATHERED) {
            let part = start..range.end.min(start + GATHERED);
            let gravity: [DVec3; GATHERED] =
                core::array::from_fn(|k| self.gravity(part.end.min(start + k + 1) - 1));
            self.group::<S>(part, GravityField::Each(&gravity), tally);
        }
    }

    fn group<S: Scheme>(
        &mut self,
        range: Range<usize>,
        gravity: GravityField<'_>,
        tally: &mut Tally,
    ) {
        let known = tally.faults.len();
        let mut group = Group {
            bodies: &self.bodies[range.clone()],
            states: &mut self.states[range.clone()],
            memories: &mut self.memories[range.clone()],
            gravity,
            faults: &mut tally.faults,
        };
        tally.outcome += S::step_group(&mut group, self.setting.h);
        tally.bodies += range.len() as u64;
        for i in &mut tally.faults[known..] {
            *i += self.first + range.start;
        }
    }

    /// Scattered bodies: at least one, at most [`GATHERED`].
    #[inline(never)]
    fn gathered<S: Scheme>(&mut self, chosen: &[usize], tally: &mut Tally) {
        let known = tally.faults.len();
        // What is beyond the last is not looked at.
        let place = |k: usize| chosen[k.min(chosen.len() - 1)];
        let bodies: [RigidBox; GATHERED] = core::array::from_fn(|k| self.bodies[place(k)]);
        let mut states: [BodyState; GATHERED] = core::array::from_fn(|k| self.states[place(k)]);
        let mut memories: [SchemeMemory; GATHERED] =
            core::array::from_fn(|k| match chosen.get(k) {
                Some(&i) => core::mem::take(&mut self.memories[i]),
                None => SchemeMemory::default(),
            });
        let gravity: [DVec3; GATHERED] = core::array::from_fn(|k| self.gravity(place(k)));
        let mut group = Group {
            bodies: &bodies[..chosen.len()],
            states: &mut states,
            memories: &mut memories,
            gravity: GravityField::Each(&gravity),
            faults: &mut tally.faults,
        };
        tally.outcome += S::step_group(&mut group, self.setting.h);
        tally.bodies += chosen.len() as u64;
        for ((&i, state), memory) in chosen.iter().zip(states).zip(memories) {
            self.states[i] = state;
            self.memories[i] = memory;
        }
        for i in &mut tally.faults[known..] {
            *i = self.first + chosen[*i];
        }
    }

    fn each<S: Scheme, F: ForceLaw>(&mut self, law: impl Fn(usize) -> F) -> Tally {
        let mut tally = Tally::default();
        for i in 0..self.bodies.len() {
            let (body, state) = (&self.bodies[i], &mut self.states[i]);
            let law = law(i);
            if let Some(floor) = self.setting.floor
                && self.near[i].meets(floor, body, state, &law, self.setting.h)
            {
                continue;
            }
            let before = *state;
            let memory = &mut self.memories[i];
            tally.outcome += S::step(body, state, &law, self.setting.h, memory);
            tally.bodies += 1;
            if !state.is_sound() {
                *state = before;
                tally.faults.push(self.first + i);
            }
        }
        tally
    }
}
