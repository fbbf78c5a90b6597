//! The inner loops: one integrator over a run of bodies of one table. Here what they share, and those at the
//! floor; those in free flight are in `flight`.

use core::ops::Range;

use bevy::ecs::change_detection::Tick;
use glam::DVec3;

use super::chunk::Chunk;
use super::columns::ForceColumnsContiguousItem;
use super::components::{BodyIntegrator, NearFloor};
use super::contacts::ReportedContacts;
use super::intake::any_newer;
use super::messages::FloorContact;
use crate::floor::{self, ContactPoint, ContactSettings, Floor, FloorOutcome};
use crate::force::{ForceModel, Gravity};
use crate::integrators::{Integrate, Integrator, IntegratorVisitor, StepOutcome};

/// What is the same for every body of a step.
#[derive(Clone, Copy)]
pub(crate) struct Setting<'a> {
    pub(crate) gravity: DVec3,
    pub(crate) h: f64,
    pub(crate) floor: Option<&'a Floor>,
    pub(crate) contact: &'a ContactSettings,
}

/// Maximal runs of bodies with one integrator: the whole table where no body has its own.
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

/// Maximal runs of those of `count` bodies that are `wanted`.
pub(crate) fn runs_of(
    count: usize,
    wanted: impl Fn(usize) -> bool,
) -> impl Iterator<Item = Range<usize>> {
    let mut next = 0;
    core::iter::from_fn(move || {
        let start = (next..count).find(|&i| wanted(i))?;
        next = (start..count).find(|&i| !wanted(i)).unwrap_or(count);
        Some(start..next)
    })
}

/// What a loop did.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) bodies: u64,
    pub(crate) outcome: StepOutcome,
    pub(crate) floor: FloorOutcome,
    /// Indices in the table of bodies whose state became unsound; they are left at their last good one.
    pub(crate) faults: Vec<usize>,
    pub(crate) spent: Spent,
}

/// Time of a thread \[ns\]; 0 if nothing is timed.
#[derive(Clone, Copy, Default)]
pub(crate) struct Spent {
    pub(crate) step: u64,
    pub(crate) refit: u64,
    pub(crate) writeback: u64,
}

impl core::ops::AddAssign for Tally {
    fn add_assign(&mut self, mut other: Self) {
        self.bodies += other.bodies;
        self.outcome += other.outcome;
        self.floor += other.floor;
        self.faults.append(&mut other.faults);
        self.spent.step += other.spent.step;
        self.spent.refit += other.spent.refit;
        self.spent.writeback += other.spent.writeback;
    }
}

/// Where contacts are reported.
pub(crate) struct Reporting<'a> {
    /// Of one body.
    pub(crate) points: &'a mut Vec<ContactPoint>,
    /// Of the whole table.
    pub(crate) reported: &'a mut [ReportedContacts],
    pub(crate) emit: &'a mut (dyn FnMut(FloorContact) + Send),
}

/// What tells of a body that lay still in the last run of *Contact* that nobody touched it since: the ticks at
/// which its parts changed. The physics leaves them as they are.
pub(crate) struct Untouched<'a> {
    /// Of whole columns.
    pub(crate) columns: [&'a [Tick]; 3],
    /// Of the system's last run, and of this one.
    pub(crate) last: Tick,
    pub(crate) now: Tick,
}

impl Untouched<'_> {
    /// Whether that is so for all of a range.
    fn all(&self, range: Range<usize>) -> bool {
        let mut columns = self.columns.iter();
        !columns.any(|ticks| any_newer(&ticks[range.clone()], self.last, self.now))
    }
}

/// Steps those bodies of a chunk that were left for the floor.
pub(crate) struct AtFloor<'a, 'c, 'r, 'w, 's> {
    pub(crate) floor: &'a Floor,
    pub(crate) setting: Setting<'a>,
    /// Of the whole table.
    pub(crate) forces: &'a ForceColumnsContiguousItem<'w, 's>,
    pub(crate) chunk: &'a mut Chunk<'c>,
    /// The number of this run of *Contact*, above 1.
    pub(crate) run: u32,
    /// Of tables in which nothing but these columns can tell of a change: floor and gravity are what they were.
    pub(crate) untouched: Option<&'a Untouched<'a>>,
    /// If the bodies of this table report their contacts.
    pub(crate) reporting: Option<Reporting<'r>>,
}

impl IntegratorVisitor for AtFloor<'_, '_, '_, '_, '_> {
    type Output = Tally;

    fn visit<S: Integrate>(self) -> Tally {
        let (forces, bodies, first) = (self.forces, self.chunk.bodies, self.chunk.first);
        let world = self.setting.gravity;
        if forces.only_gravity() {
            self.each::<S, _>(|i| Gravity(forces.gravity(first + i, world)))
        } else {
            self.each::<S, _>(|i| forces.forces(first + i, &bodies[i], world))
        }
    }
}

impl AtFloor<'_, '_, '_, '_, '_> {
    fn each<S: Integrate, F: ForceModel>(mut self, law: impl Fn(usize) -> F) -> Tally {
        let mut tally = Tally::default();
        let chunk = self.chunk;
        let first = chunk.first;
        let run = self.run;
        let plain = self.forces.only_gravity() && !self.forces.scales_gravity();
        // Asked of the chunk first: mostly nobody touched anything.
        let nobody_touched = self
            .untouched
            .is_some_and(|ticks| ticks.all(first..first + chunk.len()));
        let sleeps = |i: usize, near: &NearFloor| {
            let untouched = |ticks: &Untouched<'_>| ticks.all(first + i..first + i + 1);
            near.asleep == run - 1 && (nobody_touched || self.untouched.is_some_and(untouched))
        };
        for i in 0..chunk.len() {
            if !chunk.near[i].pending {
                continue;
            }
            if sleeps(i, &chunk.near[i]) {
                chunk.near[i].asleep = run;
                tally.bodies += 1;
                tally.floor.resting = true;
                continue;
            }
            let (body, state) = (&chunk.bodies[i], &mut chunk.states[i]);
            let before = *state;
            let contact = &mut chunk.contacts[i];
            let lay_still = contact.is_resting(state);
            if let Some(reporting) = &mut self.reporting {
                reporting.points.clear();
            }
            let outcome = floor::step_on_floor::<S, F>(
                &floor::FloorContext {
                    floor: self.floor,
                    settings: self.setting.contact,
                    body,
                    force: &law(i),
                },
                state,
                self.setting.h,
                &mut chunk.memories[i],
                contact,
                self.reporting.as_mut().map(|r| &mut *r.points),
            );
            tally.bodies += 1;
            tally.outcome += outcome.step;
            tally.floor += outcome;
            let near = &mut chunk.near[i];
            near.touched = contact.touching() != 0;
            near.still = lay_still && outcome.resting && *state == before;
            if !state.is_valid() {
                *state = before;
                near.still = false;
                tally.faults.push(chunk.first + i);
            } else if let Some(reporting) = &mut self.reporting {
                reporting.reported[first + i].report(
                    chunk.entities[i],
                    (body, state),
                    contact.touching(),
                    reporting.points,
                    &mut reporting.emit,
                );
            }
            let near = &mut chunk.near[i];
            near.asleep = if near.still && plain { run } else { 0 };
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
        let odd: Vec<_> = runs_of(7, |i| i % 4 > 1).collect();
        assert_eq!(odd, [2..4, 6..7]);
        assert_eq!(runs_of(3, |_| true).next(), Some(0..3));
        assert_eq!(runs_of(3, |_| false).count(), 0);
    }
}
