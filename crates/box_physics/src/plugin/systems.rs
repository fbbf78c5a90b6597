//! The systems of a step: each hands columns to the core, and says what came of it.

use bevy::ecs::change_detection::{ContiguousMut, Ref};
use bevy::ecs::entity::Entity;
use bevy::ecs::error::Result;
use bevy::ecs::message::MessageWriter;
use bevy::ecs::query::{Has, With, Without};
use bevy::ecs::system::{Commands, Local, Query, Res, ResMut, SystemParam};
use bevy::transform::components::Transform;
use glam::DVec3;

use super::chunk::{Chunk, Shown, Stepped};
use super::columns::ForceColumns;
use super::components::{
    BodyIntegrator, NearFloor, PublishedPose, Quarantined, ReportContacts, WorldAabb,
};
use super::contacts::{ContactEnabled, ReportedContacts};
use super::flight::FreeFlight;
use super::intake::LastShown;
use super::messages::{BodyQuarantined, FloorContact, QuarantineCause};
use super::parallel::{CHUNK, PhysicsThreads};
use super::plan::StepPlan;
use super::publish;
use super::resources::{GlobalIntegrator, PhysicsClock, WorldGravity};
use super::step::{AtFloor, Reporting, Setting, Tally, Untouched, runs};
use super::timing::{PhysicsTimings, Stage, Stopwatch};
use crate::body::RigidBox;
use crate::floor::{ContactPoint, ContactSettings, ContactState, Floor};
use crate::integrators::{Integrator, IntegratorMemory};
use crate::state::BodyState;

/// What is the same for every body of a step.
#[derive(SystemParam)]
pub(crate) struct StepWorld<'w> {
    integrator: Res<'w, GlobalIntegrator>,
    gravity: Res<'w, WorldGravity>,
    clock: Res<'w, PhysicsClock>,
    contact: Option<Res<'w, ContactSettings>>,
    contact_enabled: Option<Res<'w, ContactEnabled>>,
    threads: Res<'w, PhysicsThreads>,
    floor: Option<Res<'w, Floor>>,
    plan: Res<'w, StepPlan>,
}

impl StepWorld<'_> {
    /// As the inner loops want it.
    fn setting(&self) -> Setting<'_> {
        // Without its plugin a floor is nothing.
        let enabled = self.contact_enabled.is_some();
        Setting {
            gravity: self.gravity.0,
            h: self.clock.step(),
            floor: self.floor.as_deref().filter(|_| enabled),
            contact: self.contact.as_deref().unwrap_or(&ContactSettings::DEFAULT),
        }
    }
}

/// What the two stepping systems say of the bodies that went wrong.
fn quarantine(
    entity: Entity,
    integrator: Integrator,
    clock: &PhysicsClock,
    state: &mut BodyState,
    published: &PublishedPose,
    commands: &mut Commands,
    messages: &mut MessageWriter<BodyQuarantined>,
) {
    let cause = if state.is_valid() {
        QuarantineCause::Step
    } else {
        // It was not sound before the step either: what was last shown is the last good pose.
        *state = published.state_at_rest();
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

/// What came of the chunks of a run, and of the time \[ns\] that they took, by the share that each stage had
/// in the threads' own: what is not accounted for, sharing out, is the stage's own.
fn record(
    timings: &mut PhysicsTimings,
    own: Stage,
    integrator: Integrator,
    tally: &Tally,
    time: u64,
) {
    let spent = tally.spent;
    let all = (spent.step + spent.refit + spent.writeback).max(1);
    let share = |part: u64| (u128::from(time) * u128::from(part) / u128::from(all)) as u64;
    let (refit, writeback) = (share(spent.refit), share(spent.writeback));
    timings.record_stage(Stage::Refit, refit);
    timings.record_stage(Stage::Writeback, writeback);
    timings.record_stage(own, time - refit - writeback);
    if own == Stage::Integrate {
        let time = time - refit - writeback;
        timings.record_integrator(integrator, tally.bodies, time, tally.outcome);
    } else {
        timings.record_integrator(integrator, 0, 0, tally.outcome);
        timings.floor += tally.floor;
        timings.bodies_at_floor += tally.bodies;
    }
}

/// Steps every body that stays clear of the floor; and shows it, if the plan says so.
pub(crate) fn integrate(
    world: StepWorld,
    mut last_shown: ResMut<LastShown>,
    mut timings: Option<ResMut<PhysicsTimings>>,
    mut bodies: Query<
        (
            Entity,
            &RigidBox,
            ForceColumns,
            &mut BodyState,
            &mut IntegratorMemory,
            &mut NearFloor,
            (&mut PublishedPose, &mut Transform, Option<&mut WorldAabb>),
            Option<&BodyIntegrator>,
        ),
        Without<Quarantined>,
    >,
    mut commands: Commands,
    mut messages: MessageWriter<BodyQuarantined>,
) -> Result {
    let timed = timings.is_some();
    let mut stage = Stopwatch::start(timed);
    let setting = world.setting();
    for (
        entities,
        boxes,
        forces,
        mut states,
        mut memories,
        mut near,
        (mut published, transforms, mut fitted),
        own,
    ) in bodies.contiguous_iter_mut()?
    {
        let (transforms, mut ticks) = ContiguousMut::bypass_change_detection_split(transforms);
        let mut table = Chunk {
            first: 0,
            entities,
            bodies: boxes,
            states: states.bypass_change_detection(),
            memories: memories.bypass_change_detection(),
            contacts: &mut [],
            near: near.bypass_change_detection(),
            shown: Shown {
                fitted: world.plan.column(&mut fitted),
                published: published.bypass_change_detection(),
                transforms,
                last: ticks.last_run(),
                now: ticks.this_run(),
                changed: ticks.changed_mut(),
            },
        };
        if world.plan.at_once {
            last_shown.0 = Some(table.shown.now);
        }
        for (integrator, range) in runs(world.integrator.0, own, boxes.len()) {
            let chunks = table.part(range.clone()).chunks(CHUNK);
            let mut tally = world.threads.share_out(range.len(), chunks, |mut chunk| {
                let mut watch = Stopwatch::start(timed);
                let mut tally = integrator.dispatch(FreeFlight {
                    setting,
                    forces: &forces,
                    chunk: &mut chunk,
                });
                tally.spent.step += watch.lap();
                if world.plan.at_once {
                    let floor = setting.floor.is_some();
                    let stepped = if floor { Stepped::Clear } else { Stepped::All };
                    chunk.show(stepped, &mut tally, &mut watch);
                }
                tally
            });
            if let Some(timings) = &mut timings {
                record(timings, Stage::Integrate, integrator, &tally, stage.lap());
            }
            tally.faults.sort_unstable();
            for i in tally.faults {
                quarantine(
                    entities[i],
                    integrator,
                    &world.clock,
                    &mut table.states[i],
                    &table.shown.published[i],
                    &mut commands,
                    &mut messages,
                );
            }
        }
    }
    Ok(())
}

/// Steps the bodies that *Integrate* left for the floor; and shows them, if the plan says so.
pub(crate) fn contact(
    world: StepWorld,
    mut timings: Option<ResMut<PhysicsTimings>>,
    mut bodies: Query<
        (
            Entity,
            Ref<RigidBox>,
            ForceColumns,
            &mut BodyState,
            &mut IntegratorMemory,
            (&mut ContactState, &mut NearFloor),
            (&mut PublishedPose, &mut Transform, Option<&mut WorldAabb>),
            (
                Option<&BodyIntegrator>,
                Has<ReportContacts>,
                Option<&mut ReportedContacts>,
            ),
        ),
        Without<Quarantined>,
    >,
    mut commands: Commands,
    (mut messages, mut contacts): (MessageWriter<BodyQuarantined>, MessageWriter<FloorContact>),
    mut points: Local<Vec<ContactPoint>>,
    (mut before, mut run): (Local<Option<(DVec3, Floor)>>, Local<u32>),
) -> Result {
    // Runs without a floor count as well: who slept before them may have moved.
    *run = run.checked_add(1).unwrap_or(0).max(2);
    let setting = world.setting();
    let Some(floor) = setting.floor else {
        return Ok(());
    };
    let timed = timings.is_some();
    let mut stage = Stopwatch::start(timed);
    // Who lay still in the last run, and in the same world, and was not touched since, still does.
    let surroundings = Some((setting.gravity, *floor));
    let same_world = core::mem::replace(&mut *before, surroundings) == surroundings;
    let mut emit = |contact: FloorContact| {
        contacts.write(contact);
    };
    for (
        entities,
        boxes,
        forces,
        states,
        mut memories,
        (touching, mut near),
        (mut published, transforms, mut fitted),
        (own, reports, mut reported),
    ) in bodies.contiguous_iter_mut()?
    {
        let (transforms, mut ticks) = ContiguousMut::bypass_change_detection_split(transforms);
        let (states, states_changed) = ContiguousMut::bypass_change_detection_split(states);
        let (touching, touching_changed) = ContiguousMut::bypass_change_detection_split(touching);
        // Who listens hears of those that lie still, too; and a force may have changed unseen.
        let untouched =
            (same_world && !reports && forces.only_gravity() && !forces.scales_gravity()).then(
                || Untouched {
                    columns: [
                        boxes.changed_ticks_slice(),
                        states_changed.changed(),
                        touching_changed.changed(),
                    ],
                    last: ticks.last_run(),
                    now: ticks.this_run(),
                },
            );
        let mut table = Chunk {
            first: 0,
            entities,
            bodies: &boxes,
            states,
            memories: memories.bypass_change_detection(),
            contacts: touching,
            near: near.bypass_change_detection(),
            shown: Shown {
                fitted: world.plan.column(&mut fitted),
                published: published.bypass_change_detection(),
                transforms,
                last: ticks.last_run(),
                now: ticks.this_run(),
                changed: ticks.changed_mut(),
            },
        };
        for (integrator, range) in runs(world.integrator.0, own, boxes.len()) {
            // Who listens hears of the bodies in their order: one chunk, one thread.
            let size = if reports { range.len() } else { CHUNK };
            let mut reporting = reported
                .as_mut()
                .filter(|_| reports)
                .map(|reported| Reporting {
                    points: &mut points,
                    reported: reported.bypass_change_detection(),
                    emit: &mut emit,
                });
            let chunks = table
                .part(range.clone())
                .chunks(size)
                .map(|chunk| (chunk, reporting.take()));
            let mut tally =
                world
                    .threads
                    .share_out(range.len(), chunks, |(mut chunk, reporting)| {
                        let mut watch = Stopwatch::start(timed);
                        let mut tally = integrator.dispatch(AtFloor {
                            floor,
                            setting,
                            forces: &forces,
                            chunk: &mut chunk,
                            run: *run,
                            untouched: untouched.as_ref(),
                            reporting,
                        });
                        tally.spent.step += watch.lap();
                        if world.plan.at_once {
                            chunk.show(Stepped::AtFloor, &mut tally, &mut watch);
                        }
                        tally
                    });
            if let Some(timings) = &mut timings {
                record(timings, Stage::Contact, integrator, &tally, stage.lap());
            }
            tally.faults.sort_unstable();
            for i in tally.faults {
                quarantine(
                    entities[i],
                    integrator,
                    &world.clock,
                    &mut table.states[i],
                    &table.shown.published[i],
                    &mut commands,
                    &mut messages,
                );
            }
        }
    }
    Ok(())
}

/// Re-fits the bounding boxes: |R|·h, rounded outward; not of those that were shown when they were stepped.
pub(crate) fn refit_aabbs(
    mut bodies: Query<(&RigidBox, &BodyState, &mut WorldAabb, Has<Quarantined>)>,
    threads: Res<PhysicsThreads>,
    plan: Res<StepPlan>,
    mut timings: Option<ResMut<PhysicsTimings>>,
) -> Result {
    let mut stage = Stopwatch::start(timings.is_some());
    for (boxes, states, mut fitted, quarantined) in bodies.contiguous_iter_mut()? {
        if plan.at_once && !quarantined {
            continue;
        }
        let chunks = boxes
            .chunks(CHUNK)
            .zip(states.chunks(CHUNK))
            .zip(fitted.bypass_change_detection().chunks_mut(CHUNK));
        threads.share_out(
            boxes.len(),
            chunks,
            |((boxes, states), fitted): ((&[RigidBox], &[BodyState]), _)| {
                WorldAabb::fit_all(boxes, states, fitted);
                Done
            },
        );
    }
    if let Some(timings) = &mut timings {
        timings.record_stage(Stage::Refit, stage.lap());
    }
    Ok(())
}

/// Writes `Transform` where the pose in f32 is another than it shows; not of bodies that were shown when
/// they were stepped.
pub(crate) fn write_transforms(
    mut bodies: Query<
        (
            &BodyState,
            &mut PublishedPose,
            &mut Transform,
            Has<Quarantined>,
        ),
        With<RigidBox>,
    >,
    threads: Res<PhysicsThreads>,
    plan: Res<StepPlan>,
    mut last_shown: ResMut<LastShown>,
    mut timings: Option<ResMut<PhysicsTimings>>,
) -> Result {
    let mut stage = Stopwatch::start(timings.is_some());
    for (states, mut published, transforms, quarantined) in bodies.contiguous_iter_mut()? {
        if plan.at_once && !quarantined {
            continue;
        }
        let (transforms, mut ticks) = ContiguousMut::bypass_change_detection_split(transforms);
        let now = ticks.this_run();
        if !plan.at_once {
            last_shown.0 = Some(now);
        }
        let chunks = states
            .chunks(CHUNK)
            .zip(published.bypass_change_detection().chunks_mut(CHUNK))
            .zip(transforms.chunks_mut(CHUNK))
            .zip(ticks.changed_mut().chunks_mut(CHUNK));
        threads.share_out(
            states.len(),
            chunks,
            |(((states, published), transforms), changed): (((&[BodyState], _), _), _)| {
                publish::write_transforms(states, published, transforms, changed, now);
                Done
            },
        );
    }
    if let Some(timings) = &mut timings {
        timings.record_stage(Stage::Writeback, stage.lap());
    }
    Ok(())
}

/// Nothing to add up.
#[derive(Default)]
struct Done;

impl core::ops::AddAssign for Done {
    fn add_assign(&mut self, _: Self) {}
}
