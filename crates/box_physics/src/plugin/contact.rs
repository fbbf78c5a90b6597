//! *Contact*: steps the bodies that *Integrate* leaves because they may touch the floor.

use bevy::ecs::change_detection::ContiguousMut;
use bevy::ecs::error::Result;
use bevy::ecs::query::{Has, QueryData, Without};
use bevy::ecs::system::{Commands, Query, Res, ResMut};

use super::chunks::{Columns, integrator_runs};
use super::components::{NearFloor, Quarantined, ReportContacts, ReportPersisting, RestingSince};
use super::contacts::ReportedContacts;
use super::forces::{ForceColumnsContiguousItem, Step};
use super::integrate::{BodyColumns, Tally};
use super::messages::{Settled, Woken};
use super::parallel::{CHUNK, PhysicsThreads};
use super::quarantine::Quarantine;
use super::sleeping::{Changes, Sleep, SleepClock, Sleepers};
use super::timing::{LapTimer, PhysicsTimings, Stage};
use super::transforms::LIGHT_PASS_DIVISOR;
use crate::body::RigidBox;
use crate::floor::{
    ContactState, Floor, FloorContext, Friction, PlanesContext, Restitution, StaticPlane,
    step_on_floor, step_on_planes,
};
use crate::force::{ForceModel, Gravity};
use crate::integrators::{Integrate, IntegratorMemory, IntegratorVisitor};
use crate::state::BodyState;

/// Additional columns for contact with the floor.
#[derive(QueryData)]
#[query_data(mutable, contiguous(mutable))]
pub(crate) struct FloorColumns {
    contact: &'static mut ContactState,
    sleep: &'static mut Sleep,
    reported: Option<&'static mut ReportedContacts>,
    reports: Has<ReportContacts>,
    persisting: Has<ReportPersisting>,
    resting: &'static mut RestingSince,
    material: Material,
}

/// Own surface properties of bodies.
#[derive(QueryData)]
#[query_data(contiguous(all))]
pub(crate) struct Material {
    friction: Option<&'static Friction>,
    restitution: Option<&'static Restitution>,
}

impl MaterialContiguousItem<'_, '_> {
    fn is_none(&self) -> bool {
        self.friction.is_none() && self.restitution.is_none()
    }

    /// Friction and restitution of body `i`.
    fn of(&self, i: usize) -> (Option<&Friction>, Option<&Restitution>) {
        let friction = self.friction.map(|c| &c[i]);
        (friction, self.restitution.map(|c| &c[i]))
    }
}

/// Cost of a step at the floor, in steps in free flight. The value lies between the cost of a settling box and that of
/// a sliding box (`cargo bench --bench step`).
const FLOOR_STEP_COST: usize = 16;

/// *Contact*: steps the bodies that *Integrate* left because they may touch the floor.
pub(crate) fn contact(
    step: Res<Step>,
    mut clock: ResMut<SleepClock>,
    mut bodies: Query<(BodyColumns, FloorColumns), Without<Quarantined>>,
    threads: Res<PhysicsThreads>,
    mut quarantine: Quarantine,
    mut commands: Commands,
    mut timings: Option<ResMut<PhysicsTimings>>,
) -> Result {
    clock.begin_run(&step);
    if !step.has_contact() {
        return Ok(());
    }
    let mut watch = LapTimer::start(timings.is_some());
    for (mut table, at_floor) in bodies.contiguous_iter_mut()? {
        let (bodies, forces) = (&*table.body, &table.forces);
        let (states, written) = ContiguousMut::bypass_change_detection_split(table.state);
        let (contacts, forgotten) = ContiguousMut::bypass_change_detection_split(at_floor.contact);
        let (mut sleep, mut reported) = (at_floor.sleep, at_floor.reported);
        let sleepers = Sleepers::new(
            &clock,
            forces.only_uniform_gravity() && !at_floor.persisting && at_floor.material.is_none(),
            Changes {
                columns: [
                    table.body.changed_ticks_slice(),
                    written.changed(),
                    forgotten.changed(),
                ],
                last: written.last_run(),
                now: written.this_run(),
            },
        );
        let (resting, mut changes) = ContiguousMut::bypass_change_detection_split(at_floor.resting);
        let memories = table.memory.bypass_change_detection();
        let near = table.near.bypass_change_detection();
        let sleep = sleep.bypass_change_detection();
        let mut reported = reported
            .as_mut()
            .filter(|_| at_floor.reports)
            .map(|reported| reported.bypass_change_detection());
        for (integrator, range) in integrator_runs(step.integrator, table.own, bodies.len()) {
            let awake = (near[range.clone()].iter().zip(&sleep[range.clone()]))
                .filter(|(near, sleep)| near.pending && !sleepers.slept(sleep))
                .count();
            let columns = (
                bodies,
                &mut *states,
                &mut *memories,
                &mut *near,
                &mut *contacts,
                &mut *sleep,
                reported.as_deref_mut(),
                &*resting,
            );
            // A few bodies at the floor are enough work for a thread; with larger chunks, the others would wait for the
            // last one.
            let chunk = (awake / 16).clamp(16, CHUNK);
            let tally = threads.share_out(
                awake * FLOOR_STEP_COST + range.len() / LIGHT_PASS_DIVISOR,
                columns.chunks(range.clone(), chunk),
                |(first, (bodies, states, memories, near, contacts, sleep, reported, resting))| {
                    integrator.dispatch(AtFloor {
                        step: &step,
                        forces,
                        material: &at_floor.material,
                        sleepers: &sleepers,
                        first,
                        bodies,
                        states,
                        memories,
                        near,
                        contacts,
                        sleep,
                        reported,
                        resting,
                    })
                },
            );
            if let Some(timings) = &mut timings {
                timings.record_stage(Stage::Contact, watch.lap());
                timings.record_integrator(integrator, 0, 0, tally.outcome);
                timings.floor += tally.floor;
                timings.bodies_at_floor += tally.bodies;
            }
            let (now, time) = (changes.this_run(), step.time);
            // By row, so that the result does not depend on the threads.
            let changed = range.filter(|&i| core::mem::take(&mut near[i].rest_changed));
            for i in changed.take(tally.rest_changes) {
                let entity = table.entity[i];
                changes.changed_mut()[i] = now;
                resting[i].0 = match resting[i].0 {
                    None => {
                        commands.trigger(Settled { entity, time });
                        Some(time)
                    }
                    Some(_) => {
                        commands.trigger(Woken { entity, time });
                        None
                    }
                };
            }
            let (entities, published) = (table.entity, table.published);
            quarantine.take(tally.faults, integrator, entities, states, published);
        }
    }
    Ok(())
}

/// Advances moving floors and planes.
pub(crate) fn move_surfaces(
    step: Res<Step>,
    floor: Option<ResMut<Floor>>,
    mut planes: Query<&mut StaticPlane, Without<RigidBox>>,
) {
    if let Some(mut floor) = floor
        && step.floor.is_some_and(|floor| floor.velocity.y != 0.0)
    {
        floor.advance(step.h);
    }
    for mut plane in &mut planes {
        if plane.velocity.dot(plane.normal) != 0.0 && plane.validate().is_ok() {
            plane.advance(step.h);
        }
    }
}

/// Steps the bodies of a chunk that were left to *Contact*.
struct AtFloor<'a, 'w, 's> {
    step: &'a Step,
    /// Forces of the whole table.
    forces: &'a ForceColumnsContiguousItem<'w, 's>,
    material: &'a MaterialContiguousItem<'w, 's>,
    sleepers: &'a Sleepers<'a>,
    /// Row of the first body.
    first: usize,
    bodies: &'a [RigidBox],
    states: &'a mut [BodyState],
    memories: &'a mut [IntegratorMemory],
    near: &'a mut [NearFloor],
    contacts: &'a mut [ContactState],
    sleep: &'a mut [Sleep],
    reported: Option<&'a mut [ReportedContacts]>,
    resting: &'a [RestingSince],
}

impl IntegratorVisitor for AtFloor<'_, '_, '_> {
    type Output = Tally;

    fn visit<S: Integrate>(self) -> Tally {
        let (forces, bodies, first) = (self.forces, self.bodies, self.first);
        let step = self.step;
        if forces.only_gravity() {
            self.each::<S, _>(|i| Gravity(forces.gravity(first + i, step.gravity)))
        } else {
            self.each::<S, _>(|i| forces.forces(first + i, &bodies[i], step))
        }
    }
}

impl AtFloor<'_, '_, '_> {
    fn each<S: Integrate, F: ForceModel>(mut self, model: impl Fn(usize) -> F) -> Tally {
        let mut tally = Tally::default();
        let rows = self.first..self.first + self.bodies.len();
        let untouched = self.sleepers.untouched(rows.clone());
        let (same, mut planes) = (self.material.is_none(), Vec::new());
        for (i, row) in rows.enumerate() {
            if !self.near[i].pending {
                continue;
            }
            tally.bodies += 1;
            if self.sleepers.sleeps_on(row, &mut self.sleep[i], untouched) {
                tally.floor.resting = true;
                continue;
            }
            let (state, contact) = (&mut self.states[i], &mut self.contacts[i]);
            let before = *state;
            let was_resting = contact.is_resting(state);
            let mut reported = self.reported.as_mut().map(|r| &mut r[i]);
            let report = reported.as_mut().map(|reported| reported.begin());
            let (step, body, memory) = (self.step, &self.bodies[i], &mut self.memories[i]);
            let (settings, force, h) = (&step.settings, &model(i), step.h);
            let (friction, restitution) = self.material.of(row);
            let outcome = if let ([], Some(floor)) = (&step.planes[..], &step.floor) {
                let own = (!same).then(|| floor.against(friction, restitution));
                let context = FloorContext {
                    floor: own.as_ref().unwrap_or(floor),
                    settings,
                    body,
                    force,
                };
                step_on_floor::<S, F>(&context, state, h, memory, contact, report)
            } else {
                if !same {
                    planes.clear();
                    let all = step.planes.iter();
                    planes.extend(all.map(|plane| plane.against(friction, restitution)));
                }
                let context = PlanesContext {
                    planes: if same { &step.planes } else { &planes },
                    settings,
                    body,
                    force,
                };
                step_on_planes::<S, F>(&context, state, h, memory, contact, report)
            };
            tally.outcome += outcome.step;
            tally.floor += outcome;
            self.near[i].touched = contact.touching() != 0;
            let still = was_resting && outcome.resting && *state == before;
            self.sleep[i] = self.sleepers.after_step(still && state.is_valid());
            if !state.is_valid() {
                *state = before;
                tally.faults.push(row);
                if let Some(reported) = reported {
                    reported.clear();
                }
            } else if outcome.resting != self.resting[i].0.is_some() {
                self.near[i].rest_changed = true;
                tally.rest_changes += 1;
            }
        }
        tally
    }
}
