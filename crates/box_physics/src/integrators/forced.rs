//! Many bodies, each under its own forces: kicks one by one, free flight between them in SIMD lanes.

use core::array::from_fn;
use core::ops::Range;

use glam::DVec3;

use super::batch::BLOCK;
use super::{GravityField, Group, Integrate, IntegratorMemory, StepOutcome};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::state::BodyState;

/// Number of bodies in the widest vector.
const LANES: usize = 4;

/// Consecutive bodies, each with its own forces: at most 64, all in free flight. The methods are the operations from
/// which [`Integrate::step_forced`] composes a step.
pub struct ForcedGroup<'a, F> {
    /// The bodies, possibly padded with copies of the last one.
    bodies: &'a [RigidBox],
    states: &'a mut [BodyState],
    memories: &'a mut [IntegratorMemory],
    /// The force model of each body.
    pub forces: &'a [F],
    /// The uniform acceleration of each body [m/s²].
    gravity: &'a [DVec3],
    /// The state of each body before the step.
    before: &'a [BodyState],
    /// Indices of bodies whose states would become invalid; those states are left unchanged.
    faults: &'a mut Vec<usize>,
}

impl<F: ForceModel> ForcedGroup<'_, F> {
    /// Steps bodies in free flight, body `i` under `forces(i)`: up to 64 at a time if [`Integrate::FORCED_IN_LANES`] and
    /// the first of them is under a wrench without dissipation and dampers. Each result equals that of
    /// [`Integrate::step`] bit for bit. A state that would become invalid is left unchanged, and the index of its body is
    /// added to `faults`. The slices have equal lengths.
    pub fn step_each<S: Integrate>(
        (bodies, states, memories): (&[RigidBox], &mut [BodyState], &mut [IntegratorMemory]),
        forces: impl Fn(usize) -> F,
        h: f64,
        faults: &mut Vec<usize>,
    ) -> StepOutcome {
        let (mut total, count) = (StepOutcome::default(), bodies.len());
        for start in (0..count).step_by(BLOCK) {
            let range = start..count.min(start + BLOCK);
            if !S::FORCED_IN_LANES || range.len() == 1 || !is_wrench_alone(&forces(start)) {
                for i in range {
                    let before = states[i];
                    total += S::step(&bodies[i], &mut states[i], &forces(i), h, &mut memories[i]);
                    keep_valid(&mut states[i], &before, i, faults);
                }
                continue;
            }
            let known = faults.len();
            let columns = (
                &bodies[range.clone()],
                &mut states[range.clone()],
                &mut memories[range.clone()],
            );
            let forces = |k: usize| forces(start + k);
            // For a few bodies, copying costs more than it saves.
            total += match range.len() {
                2..=4 => Self::step_block::<S, 4>(columns, forces, h, faults),
                5..=8 => Self::step_block::<S, 8>(columns, forces, h, faults),
                9..=16 => Self::step_block::<S, 16>(columns, forces, h, faults),
                _ => Self::step_block::<S, BLOCK>(columns, forces, h, faults),
            };
            faults[known..].iter_mut().for_each(|i| *i += start);
        }
        total
    }

    /// Steps at least one body and at most `N`.
    fn step_block<S: Integrate, const N: usize>(
        (bodies, states, memories): (&[RigidBox], &mut [BodyState], &mut [IntegratorMemory]),
        forces: impl Fn(usize) -> F,
        h: f64,
        faults: &mut Vec<usize>,
    ) -> StepOutcome {
        let (count, last) = (bodies.len(), bodies.len() - 1);
        let forces: [F; N] = from_fn(|k| forces(last.min(k)));
        let gravity: [DVec3; N] = from_fn(|k| forces[k].acceleration());
        let mut moved: [BodyState; N] = from_fn(|k| states[last.min(k)]);
        // Copies of the last body fill up an incomplete vector of two or three bodies.
        let filled = match count % LANES {
            0 | 1 => count,
            left => count + LANES - left,
        };
        let copies: Option<[RigidBox; N]> =
            (filled > count).then(|| from_fn(|k| bodies[last.min(k)]));
        let mut kept: Option<[IntegratorMemory; N]> = (filled > count)
            .then(|| from_fn(|k| memories.get_mut(k).map(core::mem::take).unwrap_or_default()));
        let mut group = ForcedGroup {
            bodies: copies.as_ref().map_or(bodies, |copies| &copies[..filled]),
            states: &mut moved[..filled],
            memories: kept
                .as_mut()
                .map_or(&mut *memories, |kept| &mut kept[..filled]),
            forces: &forces[..count],
            gravity: &gravity[..filled],
            before: states,
            faults,
        };
        let outcome = S::step_forced(&mut group, h);
        states.copy_from_slice(&moved[..count]);
        for (memory, kept) in memories.iter_mut().zip(kept.into_iter().flatten()) {
            *memory = kept;
        }
        outcome
    }

    /// Steps runs of bodies under a wrench alone by `many`, the composition of `S`, with the outcome `each` per body.
    /// The other bodies take the plain step.
    pub fn wrench_in_lanes<S: Integrate>(
        &mut self,
        h: f64,
        each: StepOutcome,
        many: impl Fn(&mut Self, Range<usize>),
    ) -> StepOutcome {
        let (forces, count) = (self.forces, self.forces.len());
        let alone = |i: usize| h != 0.0 && is_wrench_alone(&forces[i]);
        let (mut total, mut start) = (StepOutcome::default(), 0);
        while start < count {
            let is = alone(start);
            let end = (start..count).find(|&i| alone(i) != is);
            let run = start..end.unwrap_or(count);
            start = run.end;
            if is && run.len() > 1 {
                total += each * run.len() as u64;
                many(self, run.clone());
                for i in run {
                    keep_valid(&mut self.states[i], &self.before[i], i, self.faults);
                }
            } else {
                total += self.one_by_one::<S>(run, h);
            }
        }
        total
    }

    /// Takes the integrator's plain step, body by body.
    pub fn one_by_one<S: Integrate>(&mut self, range: Range<usize>, h: f64) -> StepOutcome {
        let mut total = StepOutcome::default();
        for i in range {
            let (state, memory) = (&mut self.states[i], &mut self.memories[i]);
            total += S::step(&self.bodies[i], state, &self.forces[i], h, memory);
            keep_valid(state, &self.before[i], i, self.faults);
        }
        total
    }

    /// Applies `kick` to the bodies of `range`, one by one.
    pub fn kick(&mut self, range: Range<usize>, kick: impl Fn(&RigidBox, &mut BodyState, &F)) {
        for i in range {
            kick(&self.bodies[i], &mut self.states[i], &self.forces[i]);
        }
    }

    /// Advances the bodies of `range` in free flight over `h`, in SIMD lanes.
    pub fn drift<S: Integrate>(&mut self, mut range: Range<usize>, h: f64) {
        let (start, known) = (range.start, self.faults.len());
        if range.end == self.forces.len() {
            range.end = self.bodies.len();
        }
        let mut group = Group {
            bodies: &self.bodies[range.clone()],
            states: &mut self.states[range.clone()],
            memories: &mut self.memories[range.clone()],
            gravity: GravityField::Each(&self.gravity[range]),
            faults: self.faults,
            floor: None,
        };
        S::step_group(&mut group, h);
        // The group leaves an invalid state unchanged, but the body must be invalid at the end.
        for i in self.faults.drain(known..) {
            self.states[start + i].position = DVec3::NAN;
        }
    }
}

fn is_wrench_alone<F: ForceModel>(force: &F) -> bool {
    force.has_wrench() && !force.has_dissipation() && !force.has_damping()
}

fn keep_valid(state: &mut BodyState, before: &BodyState, i: usize, faults: &mut Vec<usize>) {
    if !state.is_valid() {
        *state = *before;
        faults.push(i);
    }
}
