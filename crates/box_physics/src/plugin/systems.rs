//! The systems of a step: each hands columns to the core, and says what came of it.

use std::time::Instant;

use bevy::ecs::change_detection::ContiguousMut;
use bevy::ecs::entity::Entity;
use bevy::ecs::error::Result;
use bevy::ecs::message::MessageWriter;
use bevy::ecs::query::{Has, With, Without};
use bevy::ecs::system::{Commands, Local, Query, Res, ResMut, SystemParam};
use bevy::transform::components::Transform;

use super::columns::ForceColumns;
use super::components::{
    BodyIntegrator, NearFloor, Quarantined, ReportContacts, WorldAabb, WrittenTransform,
};
use super::flight::FreeFlight;
use super::messages::{BodyQuarantined, FloorContact, QuarantineCause};
use super::parallel::{CHUNK, PhysicsThreads};
use super::publish;
use super::resources::{GlobalIntegrator, PhysicsClock, WorldGravity};
use super::step::{AtFloor, Reporting, Setting, runs, runs_of};
use super::timing::{PhysicsTimings, Stage, nanoseconds};
use crate::body::RigidBox;
use crate::floor::{ContactPoint, ContactSettings, ContactState, Floor};
use crate::schemes::SchemeMemory;
use crate::state::BodyState;

/// What is the same for every body of a step.
#[derive(SystemParam)]
pub(crate) struct StepWorld<'w> {
    integrator: Res<'w, GlobalIntegrator>,
    gravity: Res<'w, WorldGravity>,
    clock: Res<'w, PhysicsClock>,
    contact: Option<Res<'w, ContactSettings>>,
    threads: Res<'w, PhysicsThreads>,
    floor: Option<Res<'w, Floor>>,
}

impl StepWorld<'_> {
    /// As the inner loops want it.
    fn setting(&self) -> Setting<'_> {
        // Without its plugin a floor is nothing.
        let contact = self.contact.as_deref();
        Setting {
            gravity: self.gravity.0,
            h: self.clock.step(),
            floor: self.floor.as_deref().filter(|_| contact.is_some()),
            contact: contact.unwrap_or(&ContactSettings::DEFAULT),
        }
    }
}

/// What the two stepping systems say of the bodies that went wrong.
fn quarantine(
    entity: Entity,
    integrator: crate::schemes::Integrator,
    clock: &PhysicsClock,
    state: &mut BodyState,
    written: &WrittenTransform,
    commands: &mut Commands,
    messages: &mut MessageWriter<BodyQuarantined>,
) {
    let cause = if state.is_sound() {
        QuarantineCause::Step
    } else {
        // It was not sound before the step either: what was last shown is the last good pose.
        *state = written.state_at_rest();
        QuarantineCause::State
    };
    let time = clock.time();
    commands.entity(entity).try_insert(Quarantined { time });
    messages.write(BodyQuarantined {
        entity,
        integrator,
        time,
        cause,
    });
}

/// Steps every body that stays clear of the floor.
pub(crate) fn integrate(
    world: StepWorld,
    mut timings: Option<ResMut<PhysicsTimings>>,
    mut bodies: Query<
        (
            Entity,
            &RigidBox,
            ForceColumns,
            &WrittenTransform,
            &mut BodyState,
            &mut SchemeMemory,
            &mut NearFloor,
            Option<&BodyIntegrator>,
        ),
        Without<Quarantined>,
    >,
    mut commands: Commands,
    mut messages: MessageWriter<BodyQuarantined>,
) -> Result {
    let stage = timings.is_some().then(Instant::now);
    let setting = world.setting();
    for (entities, boxes, forces, written, mut states, mut memories, mut near, own) in
        bodies.contiguous_iter_mut()?
    {
        let states = states.bypass_change_detection();
        let memories = memories.bypass_change_detection();
        let near = near.bypass_change_detection();
        for (integrator, range) in runs(world.integrator.0, own, boxes.len()) {
            let start = timings.is_some().then(Instant::now);
            let chunks = boxes[range.clone()]
                .chunks(CHUNK)
                .zip(states[range.clone()].chunks_mut(CHUNK))
                .zip(memories[range.clone()].chunks_mut(CHUNK))
                .zip(near[range.clone()].chunks_mut(CHUNK))
                .enumerate()
                .map(|(k, (((bodies, states), memories), near))| FreeFlight {
                    setting,
                    first: range.start + k * CHUNK,
                    bodies,
                    forces: &forces,
                    states,
                    memories,
                    near,
                });
            let mut tally = world
                .threads
                .share_out(range.len(), chunks, |chunk| integrator.dispatch(chunk));
            if let (Some(timings), Some(start)) = (&mut timings, start) {
                timings.record_scheme(integrator, tally.bodies, nanoseconds(start), tally.outcome);
            }
            tally.faults.sort_unstable();
            for i in tally.faults {
                quarantine(
                    entities[i],
                    integrator,
                    &world.clock,
                    &mut states[i],
                    &written[i],
                    &mut commands,
                    &mut messages,
                );
            }
        }
    }
    if let (Some(timings), Some(start)) = (&mut timings, stage) {
        timings.record_stage(Stage::Integrate, start);
    }
    Ok(())
}

/// Steps the bodies that *Integrate* left for the floor.
pub(crate) fn contact(
    world: StepWorld,
    mut timings: Option<ResMut<PhysicsTimings>>,
    mut bodies: Query<
        (
            Entity,
            &RigidBox,
            ForceColumns,
            &WrittenTransform,
            &mut BodyState,
            &mut SchemeMemory,
            &mut ContactState,
            &mut NearFloor,
            (Option<&BodyIntegrator>, Has<ReportContacts>),
        ),
        Without<Quarantined>,
    >,
    mut commands: Commands,
    (mut messages, mut contacts): (MessageWriter<BodyQuarantined>, MessageWriter<FloorContact>),
    mut points: Local<Vec<ContactPoint>>,
) -> Result {
    let Some(floor) = &world.floor else {
        return Ok(());
    };
    let stage = timings.is_some().then(Instant::now);
    let setting = world.setting();
    let mut tell = |entity: Entity, points: &[ContactPoint]| {
        contacts.write_batch(points.iter().map(|p| FloorContact {
            entity,
            corner: p.corner,
            point: p.point,
            normal_impulse: p.normal_impulse,
            phase: p.phase,
        }));
    };
    for (
        entities,
        boxes,
        forces,
        written,
        mut states,
        mut memories,
        mut touching,
        mut near,
        (own, heard),
    ) in bodies.contiguous_iter_mut()?
    {
        let states = states.bypass_change_detection();
        let memories = memories.bypass_change_detection();
        let touching = touching.bypass_change_detection();
        let near = near.bypass_change_detection();
        for (integrator, range) in runs(world.integrator.0, own, boxes.len()) {
            // Who listens hears of the bodies in their order: one chunk, one thread.
            let size = if heard { range.len() } else { CHUNK };
            let mut reporting = heard.then_some(Reporting {
                points: &mut points,
                tell: &mut tell,
            });
            let chunks = boxes[range.clone()]
                .chunks(size)
                .zip(entities[range.clone()].chunks(size))
                .zip(states[range.clone()].chunks_mut(size))
                .zip(memories[range.clone()].chunks_mut(size))
                .zip(touching[range.clone()].chunks_mut(size))
                .zip(near[range.clone()].chunks_mut(size))
                .enumerate()
                .map(
                    |(k, (((((bodies, entities), states), memories), contacts), near))| AtFloor {
                        floor,
                        setting,
                        first: range.start + k * size,
                        entities,
                        bodies,
                        forces: &forces,
                        states,
                        memories,
                        contacts,
                        near,
                        reporting: reporting.take(),
                    },
                );
            let mut tally = world
                .threads
                .share_out(range.len(), chunks, |chunk| integrator.dispatch(chunk));
            if let Some(timings) = &mut timings {
                timings.record_scheme(integrator, 0, 0, tally.outcome);
                timings.floor += tally.floor;
                timings.bodies_at_floor += tally.bodies;
            }
            tally.faults.sort_unstable();
            for i in tally.faults {
                quarantine(
                    entities[i],
                    integrator,
                    &world.clock,
                    &mut states[i],
                    &written[i],
                    &mut commands,
                    &mut messages,
                );
            }
        }
    }
    if let (Some(timings), Some(start)) = (&mut timings, stage) {
        timings.record_stage(Stage::Contact, start);
    }
    Ok(())
}

/// Re-fits the bounding boxes: |R|·h, rounded outward; not of boxes that lay still.
pub(crate) fn refit_aabbs(
    mut bodies: Query<(&RigidBox, &BodyState, &NearFloor, &mut WorldAabb)>,
    threads: Res<PhysicsThreads>,
    floor: Option<Res<Floor>>,
    mut timings: Option<ResMut<PhysicsTimings>>,
) -> Result {
    let start = timings.is_some().then(Instant::now);
    for (boxes, states, near, mut fitted) in bodies.contiguous_iter_mut()? {
        let fitted = fitted.bypass_change_detection();
        let chunks = boxes
            .chunks(CHUNK)
            .zip(states.chunks(CHUNK))
            .zip(near.chunks(CHUNK))
            .zip(fitted.chunks_mut(CHUNK));
        let any_floor = floor.is_some();
        threads.share_out(
            boxes.len(),
            chunks,
            |(((boxes, states), near), fitted): (
                ((&[RigidBox], &[BodyState]), &[NearFloor]),
                _,
            )| {
                for range in runs_of(boxes.len(), |i| !(any_floor && near[i].still)) {
                    let (boxes, states) = (&boxes[range.clone()], &states[range.clone()]);
                    WorldAabb::fit_all(boxes, states, &mut fitted[range]);
                }
                Done
            },
        );
    }
    if let (Some(timings), Some(start)) = (&mut timings, start) {
        timings.record_stage(Stage::Refit, start);
    }
    Ok(())
}

/// Writes `Transform` where the pose in f32 is another than it shows.
pub(crate) fn write_transforms(
    mut bodies: Query<(&BodyState, &mut WrittenTransform, &mut Transform), With<RigidBox>>,
    threads: Res<PhysicsThreads>,
    mut timings: Option<ResMut<PhysicsTimings>>,
) -> Result {
    let start = timings.is_some().then(Instant::now);
    for (states, mut written, transforms) in bodies.contiguous_iter_mut()? {
        let written = written.bypass_change_detection();
        let (transforms, mut ticks) = ContiguousMut::bypass_change_detection_split(transforms);
        let now = ticks.this_run();
        let chunks = states
            .chunks(CHUNK)
            .zip(written.chunks_mut(CHUNK))
            .zip(transforms.chunks_mut(CHUNK))
            .zip(ticks.changed_mut().chunks_mut(CHUNK));
        threads.share_out(
            states.len(),
            chunks,
            |(((states, written), transforms), changed): (((&[BodyState], _), _), _)| {
                publish::write_transforms(states, written, transforms, changed, now);
                Done
            },
        );
    }
    if let (Some(timings), Some(start)) = (&mut timings, start) {
        timings.record_stage(Stage::Writeback, start);
    }
    Ok(())
}

/// Nothing to add up.
#[derive(Default)]
struct Done;

impl core::ops::AddAssign for Done {
    fn add_assign(&mut self, _: Self) {}
}
