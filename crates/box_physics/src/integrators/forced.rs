//! Many bodies, each under its own forces: kicks one by one, free flight between them in SIMD lanes.

use core::ops::Range;

use glam::DVec3;

use super::batch::BLOCK;
use super::{GravityField, Group, Integrate, IntegratorMemory, StepOutcome};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::state::BodyState;

/// Fewer bodies than this are stepped one by one.
const FEW: usize = 16;

/// Consecutive bodies, each with its own forces, as [`Integrate::step_forced`] gets them: at most 64, all in free flight.
/// It composes its step of the methods.
pub struct ForcedGroup<'a, F> {
    bodies: &'a [RigidBox],
    states: &'a mut [BodyState],
    memories: &'a mut [IntegratorMemory],
    /// The force model of each body.
    pub forces: &'a [F],
    /// Indices of bodies whose states would become invalid; those states are left unchanged.
    faults: &'a mut Vec<usize>,
}

impl<F: ForceModel> ForcedGroup<'_, F> {
    /// Steps bodies in free flight, body `i` under `forces(i)`: in groups if [`Integrate::FORCED_IN_LANES`]. Each result
    /// equals that of [`Integrate::step`] bit for bit. A state that would become invalid is left unchanged, and the index
    /// of its body is added to `faults`. The slices have equal lengths.
    pub fn step_each<S: Integrate>(
        (bodies, states, memories): (&[RigidBox], &mut [BodyState], &mut [IntegratorMemory]),
        forces: impl Fn(usize) -> F,
        h: f64,
        faults: &mut Vec<usize>,
    ) -> StepOutcome {
        let (mut total, count) = (StepOutcome::default(), bodies.len());
        for start in (0..count).step_by(BLOCK) {
            let range = start..count.min(start + BLOCK);
            if S::FORCED_IN_LANES && range.len() >= FEW {
                let known = faults.len();
                let forces: [F; BLOCK] =
                    core::array::from_fn(|k| forces((start + k).min(range.end - 1)));
                let mut group = ForcedGroup {
                    bodies: &bodies[range.clone()],
                    states: &mut states[range.clone()],
                    memories: &mut memories[range.clone()],
                    forces: &forces[..range.len()],
                    faults,
                };
                total += S::step_forced(&mut group, h);
                faults[known..].iter_mut().for_each(|i| *i += start);
                continue;
            }
            for i in range {
                let before = states[i];
                total += S::step(&bodies[i], &mut states[i], &forces(i), h, &mut memories[i]);
                keep_valid(&mut states[i], &before, i, faults);
            }
        }
        total
    }

    /// The integrator's plain step, body by body.
    pub fn one_by_one<S: Integrate>(&mut self, range: Range<usize>, h: f64) -> StepOutcome {
        let mut total = StepOutcome::default();
        for i in range {
            let (state, memory) = (&mut self.states[i], &mut self.memories[i]);
            let before = *state;
            total += S::step(&self.bodies[i], state, &self.forces[i], h, memory);
            keep_valid(state, &before, i, self.faults);
        }
        total
    }

    /// Applies `kick` to the bodies of `range`, one by one.
    pub fn kick(&mut self, range: Range<usize>, kick: impl Fn(&RigidBox, &mut BodyState, &F)) {
        for i in range {
            kick(&self.bodies[i], &mut self.states[i], &self.forces[i]);
        }
    }

    /// Free flight of the bodies of `range` over `h` by the integrator's step in lanes.
    pub fn drift<S: Integrate>(&mut self, range: Range<usize>, h: f64) {
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

    /// Steps the bodies of `range` by `step`. A body whose state is invalid after it stays unchanged.
    pub fn keeping_valid(&mut self, range: Range<usize>, step: impl FnOnce(&mut Self)) {
        let (start, last) = (range.start, range.end - 1);
        let before: [BodyState; BLOCK] = core::array::from_fn(|k| self.states[last.min(start + k)]);
        step(self);
        for i in range {
            keep_valid(&mut self.states[i], &before[i - start], i, self.faults);
        }
    }
}

fn keep_valid(state: &mut BodyState, before: &BodyState, i: usize, faults: &mut Vec<usize>) {
    if !state.is_valid() {
        *state = *before;
        faults.push(i);
    }
}
