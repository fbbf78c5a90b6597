//! The inner loops: one scheme over a run of bodies of one table.

use core::ops::Range;

use bevy::ecs::entity::Entity;
use glam::DVec3;

use super::columns::ForceColumnsContiguousItem;
use super::components::{BodyIntegrator, NearFloor};
use crate::body::RigidBox;
use crate::floor::{self, ContactPoint, ContactSettings, ContactState, Floor, FloorOutcome};
use crate::force::{ForceLaw, Gravity};
use crate::schemes::{Integrator, Scheme, SchemeMemory, SchemeVisitor, StepOutcome};
use crate::state::BodyState;

/// What is the same for every body of a step.
#[derive(Clone, Copy)]
pub(crate) struct Setting<'a> {
    pub(crate) gravity: DVec3,
    pub(crate) h: f64,
    pub(crate) floor: Option<&'a Floor>,
    pub(crate) contact: &'a ContactSettings,
}

/// Maximal runs of bodies with one scheme: the whole table where no body has its own.
pub(crate) fn runs(
    global: Integrator,
    own: Option<&[BodyIntegrator]>,
    bodies: usize,
) -> impl Iterator<Item = (Integrator, Range<usize>)> {
    let mut start = 0;
    core::iter::from_fn(move || {
        if start >= bodies {
            return None;
        }
        let begin = start;
        let Some(own) = own else {
            start = bodies;
            return Some((global, begin..bodies));
        };
        let chosen = own[begin].0;
        start = (begin..bodies)
            .find(|&i| own[i].0 != chosen)
            .unwrap_or(bodies);
        Some((chosen, begin..start))
    })
}

/// Steps a run of bodies in free flight; those that may meet the floor are marked and left alone.
pub(crate) struct FreeFlight<'a, 'w, 's> {
    pub(crate) setting: Setting<'a>,
    pub(crate) range: Range<usize>,
    pub(crate) bodies: &'a [RigidBox],
    pub(crate) forces: &'a ForceColumnsContiguousItem<'w, 's>,
    pub(crate) states: &'a mut [BodyState],
    pub(crate) memories: &'a mut [SchemeMemory],
    pub(crate) near: &'a mut [NearFloor],
    /// Indices of bodies whose state became non-finite; they are left at their last good one.
    pub(crate) faults: &'a mut Vec<usize>,
}

/// What a loop did.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) bodies: u64,
    pub(crate) outcome: StepOutcome,
    pub(crate) floor: FloorOutcome,
}

impl SchemeVisitor for FreeFlight<'_, '_, '_> {
    type Output = Tally;

    fn visit<S: Scheme>(self) -> Tally {
        let world = self.setting.gravity;
        let (forces, bodies) = (self.forces, self.bodies);
        if forces.only_gravity() {
            self.each::<S, _>(|i| Gravity(forces.gravity(i, world)))
        } else {
            self.each::<S, _>(|i| forces.forces(i, &bodies[i], world))
        }
    }
}

impl FreeFlight<'_, '_, '_> {
    fn each<S: Scheme, F: ForceLaw>(self, law: impl Fn(usize) -> F) -> Tally {
        let mut tally = Tally::default();
        for i in self.range {
            let (body, state) = (&self.bodies[i], &mut self.states[i]);
            let law = law(i);
            if let Some(floor) = self.setting.floor {
                let near = &mut self.near[i];
                near.pending =
                    near.touched || floor::may_touch(floor, body, state, &law, self.setting.h);
                if near.pending {
                    continue;
                }
            }
            let before = *state;
            let memory = &mut self.memories[i];
            tally.outcome += S::step(body, state, &law, self.setting.h, memory);
            tally.bodies += 1;
            if !state.is_sound() {
                *state = before;
                self.faults.push(i);
            }
        }
        tally
    }
}

/// Steps those bodies of a run that were left for the floor.
pub(crate) struct AtFloor<'a, 'w, 's> {
    pub(crate) floor: &'a Floor,
    pub(crate) setting: Setting<'a>,
    pub(crate) range: Range<usize>,
    pub(crate) entities: &'a [Entity],
    pub(crate) bodies: &'a [RigidBox],
    pub(crate) forces: &'a ForceColumnsContiguousItem<'w, 's>,
    pub(crate) states: &'a mut [BodyState],
    pub(crate) memories: &'a mut [SchemeMemory],
    pub(crate) contacts: &'a mut [ContactState],
    pub(crate) near: &'a mut [NearFloor],
    pub(crate) faults: &'a mut Vec<usize>,
    /// Where contact points go, if this table reports them.
    pub(crate) points: Option<&'a mut Vec<ContactPoint>>,
    /// Called after each body with its contact points.
    pub(crate) report: &'a mut dyn FnMut(Entity, &[ContactPoint]),
}

impl SchemeVisitor for AtFloor<'_, '_, '_> {
    type Output = Tally;

    fn visit<S: Scheme>(self) -> Tally {
        let world = self.setting.gravity;
        let (forces, bodies) = (self.forces, self.bodies);
        if forces.only_gravity() {
            self.each::<S, _>(|i| Gravity(forces.gravity(i, world)))
        } else {
            self.each::<S, _>(|i| forces.forces(i, &bodies[i], world))
        }
    }
}

impl AtFloor<'_, '_, '_> {
    fn each<S: Scheme, F: ForceLaw>(mut self, law: impl Fn(usize) -> F) -> Tally {
        let mut tally = Tally::default();
        for i in self.range {
            if !self.near[i].pending {
                continue;
            }
            let (body, state) = (&self.bodies[i], &mut self.states[i]);
            let before = *state;
            if let Some(points) = &mut self.points {
                points.clear();
            }
            let outcome = floor::step_on_floor::<S, F>(
                self.floor,
                self.setting.contact,
                body,
                state,
                &law(i),
                self.setting.h,
                &mut self.memories[i],
                &mut self.contacts[i],
                self.points.as_deref_mut(),
            );
            tally.bodies += 1;
            tally.outcome += outcome.step;
            tally.floor += outcome;
            self.near[i].touched = self.contacts[i].touching() != 0;
            if !state.is_sound() {
                *state = before;
                self.faults.push(i);
            } else if let Some(points) = &self.points {
                (self.report)(self.entities[i], points);
            }
        }
        tally
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_cover_the_table_once_and_in_order() {
        let whole: Vec<_> = runs(Integrator::Rk4, None, 5).collect();
        assert_eq!(whole, [(Integrator::Rk4, 0..5)]);
        assert_eq!(runs(Integrator::Rk4, None, 0).count(), 0);
        let [a, b] = [Integrator::Split, Integrator::ExplicitEuler].map(BodyIntegrator);
        let own = [a, a, b, a];
        let parts: Vec<_> = runs(Integrator::Rk4, Some(&own), 4).collect();
        assert_eq!(parts, [(a.0, 0..2), (b.0, 2..3), (a.0, 3..4)]);
    }
}
