//! Many bodies, each under its own forces: kicks one by one, free flight between them in SIMD lanes.

use core::ops::Range;

use glam::DVec3;

use super::batch::BLOCK;
use super::{GravityField, Group, Integrate, IntegratorMemory, StepOutcome};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::state::BodyState;

/// Consecutive bodies of a table, each with its own forces. The slices have equal lengths.
pub struct ForcedGroup<'a, F> {
    /// The bodies.
    pub bodies: &'a [RigidBox],
    /// Their states. A state that would become invalid in the step is left unchanged.
    pub states: &'a mut [BodyState],
    /// Their integrators' memories.
    pub memories: &'a mut [IntegratorMemory],
    /// Their force models.
    pub forces: &'a [F],
    /// Receives the indices of bodies whose states would become invalid.
    pub faults: &'a mut Vec<usize>,
}

impl<F: ForceModel> ForcedGroup<'_, F> {
    /// The integrator's plain step, body by body.
    pub(super) fn one_by_one<S: Integrate>(&mut self, range: Range<usize>, h: f64) -> StepOutcome {
        let mut total = StepOutcome::default();
        for i in range {
            let before = self.states[i];
            let memory = &mut self.memories[i];
            total += S::step(
                &self.bodies[i],
                &mut self.states[i],
                &self.forces[i],
                h,
                memory,
            );
            self.keep_valid(i, before);
        }
        total
    }

    /// Applies `kick` to the bodies of `range`, one by one.
    pub(super) fn kick(
        &mut self,
        range: Range<usize>,
        kick: impl Fn(&RigidBox, &mut BodyState, &F),
    ) {
        for i in range {
            kick(&self.bodies[i], &mut self.states[i], &self.forces[i]);
        }
    }

    /// Free flight of at most [`BLOCK`] bodies over `h` by the integrator's step in lanes.
    pub(super) fn drift<S: Integrate>(&mut self, range: Range<usize>, h: f64) {
        let (start, known) = (range.start, self.faults.len());
        let last = range.end - 1;
        let gravity: [DVec3; BLOCK] =
            core::array::from_fn(|k| self.forces[last.min(start + k)].acceleration());
        let mut group = Group {
            bodies: &self.bodies[range.clone()],
            states: &mut self.states[range.clone()],
            memories: &mut self.memories[range.clone()],
            gravity: GravityField::Each(&gravity[..range.len()]),
            faults: self.faults,
            floor: None,
        };
        S::step_group(&mut group, h);
        // The group left an invalid state as it was. The body is to be invalid at the end.
        for i in self.faults.drain(known..) {
            self.states[start + i].position = DVec3::NAN;
        }
    }

    /// Steps the range in blocks of [`BLOCK`] bodies by `step`. A body whose state is invalid after it stays unchanged.
    pub(super) fn in_blocks(
        &mut self,
        range: Range<usize>,
        mut step: impl FnMut(&mut Self, Range<usize>),
    ) {
        for start in range.clone().step_by(BLOCK) {
            let block = start..range.end.min(start + BLOCK);
            let last = block.end - 1;
            let before: [BodyState; BLOCK] =
                core::array::from_fn(|k| self.states[last.min(start + k)]);
            step(self, block.clone());
            for i in block {
                self.keep_valid(i, before[i - start]);
            }
        }
    }

    fn keep_valid(&mut self, i: usize, before: BodyState) {
        if !self.states[i].is_valid() {
            self.states[i] = before;
            self.faults.push(i);
        }
    }
}
