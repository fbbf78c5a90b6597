//! The systems of a step: each hands columns to the core, and says what came of it.

use std::time::Instant;

use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::entity::Entity;
use bevy::ecs::error::Result;
use bevy::ecs::message::{MessageCursor, MessageWriter, Messages};
use bevy::ecs::query::{Added, Has, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Command, Commands, Local, Query, Res, ResMut};
use bevy::ecs::world::World;
use bevy::time::Time;
use bevy::transform::components::Transform;
use log::warn;

use super::PhysicsSchedule;
use super::columns::ForceColumns;
use super::components::{
    BodyIntegrator, NearFloor, Quarantined, ReportContacts, WorldAabb, WrittenTransform,
};
use super::messages::{ApplyImpulse, BodyQuarantined, FloorContact};
use super::resources::{GlobalIntegrator, PhysicsClock, WorldGravity};
use super::step::{AtFloor, FreeFlight, Setting, runs};
use super::timing::{PhysicsTimings, Stage, nanoseconds};
use crate::body::RigidBox;
use crate::floor::{ContactPoint, ContactSettings, ContactState, Floor};
use crate::schemes::SchemeMemory;
use crate::state::BodyState;

/// Impulses that wait for the next step, in order of arrival.
#[derive(Resource, Default)]
pub(crate) struct PendingImpulses {
    cursor: MessageCursor<ApplyImpulse>,
    queue: Vec<ApplyImpulse>,
}

/// Takes impulses out of the message buffer every tick, so that those asked for while paused are not
/// lost with it.
pub(crate) fn collect_impulses(
    messages: Res<Messages<ApplyImpulse>>,
    mut pending: ResMut<PendingImpulses>,
) {
    let PendingImpulses { cursor, queue } = &mut *pending;
    queue.extend(cursor.read(&messages));
}

/// Runs the physics by one tick of the clock of this schedule, unless it is paused.
pub(crate) fn run_physics(world: &mut World, mut warned: Local<bool>) {
    if world.resource::<PhysicsClock>().paused {
        return;
    }
    let Some(time) = world.get_resource::<Time>() else {
        if !core::mem::replace(&mut *warned, true) {
            warn!("box_physics: there is no `Time` resource (TimePlugin), so nothing moves");
        }
        return;
    };
    let delta = time.delta();
    tick(world, delta);
}

/// Runs one tick of `delta`, divided into the clock's substeps. A tick of zero changes nothing.
fn tick(world: &mut World, delta: core::time::Duration) {
    if delta.is_zero() {
        return;
    }
    let substeps = world.resource::<PhysicsClock>().substeps.clamp(1, 1024);
    world.resource_mut::<PhysicsClock>().step = delta.as_secs_f64() / f64::from(substeps);
    for substep in 1..=substeps {
        world.resource_mut::<PhysicsClock>().into_tick = substep;
        world.run_schedule(PhysicsSchedule);
        world.resource_mut::<PhysicsClock>().steps += 1;
    }
    let mut clock = world.resource_mut::<PhysicsClock>();
    clock.into_tick = 0;
    clock.elapsed += delta;
}

/// Command: takes this many ticks of `Time<Fixed>` at once, paused or not: the single step.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn on_step_button(mut commands: Commands) {
///     commands.queue(StepPhysics(1));
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepPhysics(pub u32);

impl Command for StepPhysics {
    type Out = ();

    fn apply(self, world: &mut World) {
        let Some(time) = world.get_resource::<Time<bevy::time::Fixed>>() else {
            warn!("box_physics: StepPhysics needs `Time<Fixed>` (TimePlugin)");
            return;
        };
        let delta = time.timestep();
        // Impulses asked for in this frame belong to this step.
        if let Err(error) = world.run_system_cached(collect_impulses) {
            warn!("box_physics: impulses could not be collected: {error}");
        }
        for _ in 0..self.0 {
            tick(world, delta);
        }
    }
}

/// Bodies whose `Transform` somebody changed are there now.
pub(crate) fn take_teleports(
    mut bodies: Query<(Entity, &Transform, &WrittenTransform, &mut BodyState)>,
    mut warned: Local<bool>,
) {
    for (entity, transform, written, mut state) in &mut bodies {
        let taken = written.take_teleport(transform, state.bypass_change_detection());
        if taken.is_err() && !core::mem::replace(&mut *warned, true) {
            warn!(
                "box_physics: the Transform of {entity} is not finite; it is ignored (said once)"
            );
        }
    }
}

/// The impulses asked for, in order of arrival. One that cannot be applied is dropped: its body is
/// gone or quarantined, or it would leave a state that is not finite.
pub(crate) fn apply_impulses(
    mut pending: ResMut<PendingImpulses>,
    mut bodies: Query<(&RigidBox, &mut BodyState, Has<Quarantined>)>,
    mut warned: Local<bool>,
) {
    for impulse in pending.queue.drain(..) {
        let reason = match bodies.get_mut(impulse.entity) {
            Ok((body, mut state, false)) => {
                let mut pushed = *state;
                impulse.apply(body, &mut pushed);
                if pushed.is_sound() || !state.is_sound() {
                    *state = pushed;
                    continue;
                }
                "is not finite"
            }
            Ok((.., true)) => "is for a quarantined body",
            Err(_) => "is for an entity that is no body (any more)",
        };
        if !core::mem::replace(&mut *warned, true) {
            let entity = impulse.entity;
            warn!("box_physics: an impulse on {entity} {reason}; dropped (said once)");
        }
    }
}

/// Places new bodies at once, also while paused: their `Transform` and bounding box show where they
/// start before the first step.
pub(crate) fn place_new_bodies(
    mut bodies: Query<
        (
            &RigidBox,
            &mut BodyState,
            &mut WrittenTransform,
            &mut Transform,
            Option<&mut WorldAabb>,
        ),
        Added<RigidBox>,
    >,
) {
    for (body, mut state, mut written, mut transform, aabb) in &mut bodies {
        if written.take_teleport(&transform, &mut state).is_err() {
            continue;
        }
        *written = WrittenTransform::of(&state);
        transform.translation = written.translation;
        transform.rotation = written.rotation;
        if let Some(mut aabb) = aabb {
            *aabb = WorldAabb::of(body, &state);
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
    if !state.is_sound() {
        // It was not sound before the step either: what was last shown is the last good pose.
        *state = BodyState::at(written.translation.as_dvec3())
            .with_rotation(written.rotation.as_dquat());
    }
    let time = clock.time();
    warn!(
        "box_physics: {entity} is quarantined at t = {time} s under {integrator}: its motion is not finite"
    );
    commands.entity(entity).insert(Quarantined { time });
    messages.write(BodyQuarantined {
        entity,
        integrator,
        time,
    });
}

/// Steps every body that stays clear of the floor.
pub(crate) fn integrate(
    (global, gravity, clock, settings): (
        Res<GlobalIntegrator>,
        Res<WorldGravity>,
        Res<PhysicsClock>,
        Res<ContactSettings>,
    ),
    floor: Option<Res<Floor>>,
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
    let setting = Setting {
        gravity: gravity.0,
        h: clock.step(),
        floor: floor.as_deref(),
        contact: &settings,
    };
    for (entities, boxes, forces, written, mut states, mut memories, mut near, own) in
        bodies.contiguous_iter_mut()?
    {
        let states = states.bypass_change_detection();
        let memories = memories.bypass_change_detection();
        let near = near.bypass_change_detection();
        for (integrator, range) in runs(global.0, own, boxes.len()) {
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
                    &clock,
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
    (global, gravity, clock, settings): (
        Res<GlobalIntegrator>,
        Res<WorldGravity>,
        Res<PhysicsClock>,
        Res<ContactSettings>,
    ),
    floor: Option<Res<Floor>>,
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
    let Some(floor) = floor else {
        return Ok(());
    };
    let stage = timings.is_some().then(Instant::now);
    let setting = Setting {
        gravity: gravity.0,
        h: clock.step(),
        floor: Some(&floor),
        contact: &settings,
    };
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
        for (integrator, range) in runs(global.0, own, boxes.len()) {
            let tally = integrator.dispatch(AtFloor {
                floor: &floor,
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
                    &clock,
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
    mut bodies: Query<(&BodyState, &mut WrittenTransform, &mut Transform)>,
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
