//! The systems of a step: each hands columns to the core, and says what came of it.

use std::time::Instant;

use bevy::ecs::change_detection::DetectChangesMut;
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
use super::messages::{BodyQuarantined, FloorContact, QuarantineCause};
use super::resources::{GlobalIntegrator, PhysicsClock, WorldGravity};
use super::step::{AtFloor, FreeFlight, Setting, runs};
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
    mut faults: Local<Vec<usize>>,
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
            let tally = integrator.dispatch(FreeFlight {
                setting,
                range,
                bodies: boxes,
                forces: &forces,
                states,
                memories,
                near,
                faults: &mut faults,
            });
            if let (Some(timings), Some(start)) = (&mut timings, start) {
                timings.record_scheme(integrator, tally.bodies, nanoseconds(start), tally.outcome);
            }
            for i in faults.drain(..) {
                let (entity, state) = (entities[i], &mut states[i]);
                let written = &written[i];
                quarantine(
                    entity,
                    integrator,
                    &world.clock,
                    state,
                    written,
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
    (mut faults, mut points): (Local<Vec<usize>>, Local<Vec<ContactPoint>>),
) -> Result {
    let Some(floor) = &world.floor else {
        return Ok(());
    };
    let stage = timings.is_some().then(Instant::now);
    let setting = world.setting();
    let mut report = |entity: Entity, points: &[ContactPoint]| {
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
            let tally = integrator.dispatch(AtFloor {
                floor,
                setting,
                range,
                entities,
                bodies: boxes,
                forces: &forces,
                states,
                memories,
                contacts: touching,
                near,
                faults: &mut faults,
                points: heard.then_some(&mut *points),
                report: &mut report,
            });
            if let Some(timings) = &mut timings {
                timings.record_scheme(integrator, 0, 0, tally.outcome);
                timings.floor += tally.floor;
                timings.bodies_at_floor += tally.bodies;
            }
            for i in faults.drain(..) {
                let (entity, state) = (entities[i], &mut states[i]);
                let written = &written[i];
                quarantine(
                    entity,
                    integrator,
                    &world.clock,
                    state,
                    written,
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

/// Re-fits the bounding boxes: |R|·h, rounded outward.
pub(crate) fn refit_aabbs(
    mut bodies: Query<(&RigidBox, &BodyState, &mut WorldAabb)>,
    mut timings: Option<ResMut<PhysicsTimings>>,
) -> Result {
    let start = timings.is_some().then(Instant::now);
    for (boxes, states, mut boxes_in_world) in bodies.contiguous_iter_mut()? {
        let fitted = boxes_in_world.bypass_change_detection();
        for ((body, state), aabb) in boxes.iter().zip(states).zip(fitted) {
            *aabb = WorldAabb::of(body, state);
        }
    }
    if let (Some(timings), Some(start)) = (&mut timings, start) {
        timings.record_stage(Stage::Refit, start);
    }
    Ok(())
}

/// Writes `Transform` where the pose in f32 is another than it shows.
pub(crate) fn write_transforms(
    mut bodies: Query<(&BodyState, &mut WrittenTransform, &mut Transform), With<RigidBox>>,
    mut timings: Option<ResMut<PhysicsTimings>>,
) {
    let start = timings.is_some().then(Instant::now);
    for (state, mut written, mut transform) in &mut bodies {
        let now = WrittenTransform::of(state);
        *written.bypass_change_detection() = now;
        if transform.translation != now.translation || transform.rotation != now.rotation {
            transform.translation = now.translation;
            transform.rotation = now.rotation;
        }
    }
    if let (Some(timings), Some(start)) = (&mut timings, start) {
        timings.record_stage(Stage::Writeback, start);
    }
}
