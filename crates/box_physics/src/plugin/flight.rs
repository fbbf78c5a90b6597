//! Bodies in free flight: those that cannot touch the floor in this step.

use core::ops::Range;

use glam::DVec3;

use super::chunks::runs_of;
use super::components::NearFloor;
use super::forces::{ForceColumnsContiguousItem, Step};
use super::integrate::Tally;
use super::parallel::CHUNK;
use crate::body::RigidBox;
use crate::floor::FloorBelow;
use crate::force::{ForceModel, Gravity};
use crate::integrators::{
    ForcedGroup, GravityField, Group, Integrate, IntegratorMemory, IntegratorVisitor,
};
use crate::state::BodyState;

/// Steps a chunk of bodies in free flight. Bodies that may touch the floor are marked and skipped.
pub(crate) struct FreeFlight<'a, 'w, 's> {
    pub(crate) step: &'a Step,
    /// Forces of the whole table.
    pub(crate) forces: &'a ForceColumnsContiguousItem<'w, 's>,
    /// Row of the first body.
    pub(crate) first: usize,
    pub(crate) bodies: &'a [RigidBox],
    pub(crate) states: &'a mut [BodyState],
    pub(crate) memories: &'a mut [IntegratorMemory],
    pub(crate) near: &'a mut [NearFloor],
    /// The floor, if the loop over many bodies also tests whether they may touch it.
    pub(crate) below: Option<FloorBelow>,
}

impl IntegratorVisitor for FreeFlight<'_, '_, '_> {
    type Output = Tally;

    fn visit<S: Integrate>(mut self) -> Tally {
        let (forces, bodies, first) = (self.forces, self.bodies, self.first);
        let step = self.step;
        if !forces.only_gravity() {
            return self.each::<S, _>(|i| forces.forces(first + i, &bodies[i], step));
        }
        let mut tally = Tally::default();
        // An integrator without branches tests for the floor in the same loop that steps the bodies.
        let floor = step.floor.as_ref();
        let floor = floor.filter(|_| !S::BRANCHES && step.planes.is_empty());
        self.below = floor.map(|floor| FloorBelow::new(floor, &step.settings, step.h));
        let gravity = |i| Gravity(forces.gravity(first + i, step.gravity));
        let left = match self.below {
            _ if !step.has_contact() => 0,
            Some(_) => self.leave_to_contact(gravity, |_, _, _| false),
            None => self.leave_to_contact(gravity, |body, state, model| {
                step.may_touch(body, state, model)
            }),
        };
        match left {
            0 => self.run::<S>(0..bodies.len(), &mut tally),
            left if left < bodies.len() => self.runs::<S>(&mut tally),
            _ => {}
        }
        tally
    }
}

/// Maximum number of bodies copied into one group when bodies at the floor split a chunk into short runs.
const GATHERED: usize = 64;

/// A run shorter than this is copied together with others, which costs less per body than stepping it alone.
const SHORT: usize = 16;

impl FreeFlight<'_, '_, '_> {
    /// Marks the bodies that touched the floor or a plane, or may touch one. Returns their number.
    fn leave_to_contact<F: ForceModel>(
        &mut self,
        model: impl Fn(usize) -> F,
        may_touch: impl Fn(&RigidBox, &BodyState, &F) -> bool,
    ) -> usize {
        let mut left = 0;
        for (i, near) in self.near.iter_mut().enumerate() {
            let (body, state) = (&self.bodies[i], &self.states[i]);
            near.pending = near.touched || may_touch(body, state, &model(i));
            left += usize::from(near.pending);
        }
        left
    }

    #[inline(always)]
    fn gravity(&self, i: usize) -> DVec3 {
        self.forces.gravity(self.first + i, self.step.gravity)
    }

    /// Steps the runs of bodies between those left to *Contact*: long runs in place, short runs copied together.
    fn runs<S: Integrate>(&mut self, tally: &mut Tally) {
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

    /// The next run of bodies that are not left to *Contact*.
    fn next_run(&self, from: usize) -> Option<Range<usize>> {
        let range = runs_of(self.near.len() - from, |i| !self.near[from + i].pending).next()?;
        Some(from + range.start..from + range.end)
    }

    /// Steps a run of consecutive bodies in place.
    fn run<S: Integrate>(&mut self, range: Range<usize>, tally: &mut Tally) {
        if !self.forces.scales_gravity() {
            let gravity = GravityField::Uniform(self.step.gravity);
            return self.group::<S>(range, gravity, tally);
        }
        for start in range.clone().step_by(GATHERED) {
            let part = start..range.end.min(start + GATHERED);
            let gravity: [DVec3; GATHERED] =
                core::array::from_fn(|k| self.gravity(part.end.min(start + k + 1) - 1));
            self.group::<S>(part, GravityField::Each(&gravity), tally);
        }
    }

    fn group<S: Integrate>(
        &mut self,
        range: Range<usize>,
        gravity: GravityField<'_>,
        tally: &mut Tally,
    ) {
        let mut faults = Vec::new();
        let mut meets = [false; CHUNK];
        let mut group = Group {
            bodies: &self.bodies[range.clone()],
            states: &mut self.states[range.clone()],
            memories: &mut self.memories[range.clone()],
            gravity,
            faults: &mut faults,
            floor: self.below.map(|below| (below, &mut meets[..])),
        };
        tally.outcome += S::step_group(&mut group, self.step.h);
        for (near, meets) in self.near[range.clone()].iter_mut().zip(meets) {
            near.pending = meets;
            tally.bodies += u64::from(!meets);
        }
        let first = self.first + range.start;
        tally.faults.extend(faults.iter().map(|i| first + i));
    }

    /// Steps scattered bodies as one group: at least one, at most [`GATHERED`].
    #[inline(never)]
    fn gathered<S: Integrate>(&mut self, chosen: &[usize], tally: &mut Tally) {
        let mut faults = Vec::new();
        // Entries beyond the last body are padding.
        let place = |k: usize| chosen[k.min(chosen.len() - 1)];
        let bodies: [RigidBox; GATHERED] = core::array::from_fn(|k| self.bodies[place(k)]);
        let mut states: [BodyState; GATHERED] = core::array::from_fn(|k| self.states[place(k)]);
        let mut memories: [IntegratorMemory; GATHERED] =
            core::array::from_fn(|k| match chosen.get(k) {
                Some(&i) => core::mem::take(&mut self.memories[i]),
                None => IntegratorMemory::default(),
            });
        let gravity: [DVec3; GATHERED] = core::array::from_fn(|k| self.gravity(place(k)));
        let mut meets = [false; GATHERED];
        let mut group = Group {
            bodies: &bodies[..chosen.len()],
            states: &mut states,
            memories: &mut memories,
            gravity: GravityField::Each(&gravity),
            faults: &mut faults,
            floor: self.below.map(|below| (below, &mut meets[..])),
        };
        tally.outcome += S::step_group(&mut group, self.step.h);
        for (((&i, state), memory), meets) in chosen.iter().zip(states).zip(memories).zip(meets) {
            self.states[i] = state;
            self.memories[i] = memory;
            self.near[i].pending = meets;
            tally.bodies += u64::from(!meets);
        }
        let faults = faults.iter().map(|&i| self.first + chosen[i]);
        tally.faults.extend(faults);
    }

    /// Steps the bodies that are not left to *Contact*, each under its own forces.
    fn each<S: Integrate, F: ForceModel>(&mut self, model: impl Fn(usize) -> F) -> Tally {
        let mut tally = Tally::default();
        if !self.step.has_contact() {
            self.forced::<S, F>(0..self.bodies.len(), &model, &mut tally);
            return tally;
        }
        let step = self.step;
        self.leave_to_contact(&model, |body, state, model| {
            step.may_touch(body, state, model)
        });
        let mut next = 0;
        while let Some(range) = self.next_run(next) {
            next = range.end;
            self.forced::<S, F>(range, &model, &mut tally);
        }
        tally
    }

    fn forced<S: Integrate, F: ForceModel>(
        &mut self,
        run: Range<usize>,
        model: &impl Fn(usize) -> F,
        tally: &mut Tally,
    ) {
        let mut faults = Vec::new();
        let columns = (
            &self.bodies[run.clone()],
            &mut self.states[run.clone()],
            &mut self.memories[run.clone()],
        );
        let forces = |k: usize| model(run.start + k);
        tally.outcome += ForcedGroup::step_each::<S>(columns, forces, self.step.h, &mut faults);
        tally.bodies += run.len() as u64;
        let first = self.first + run.start;
        tally.faults.extend(faults.iter().map(|i| first + i));
    }
}
