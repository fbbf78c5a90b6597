//! `Transform`: written once per step, and read as a teleport if other code changed it.

use core::ops::Range;

use bevy::ecs::change_detection::{CheckChangeTicks, ContiguousMut, Ref, Tick};
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::error::Result;
use bevy::ecs::observer::On;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Local, Query, Res, ResMut};
use bevy::transform::components::Transform;
use glam::{Quat, Vec3};
use log::warn;

use super::chunks::Columns;
use super::parallel::{CHUNK, Done, PhysicsThreads};
use super::sleeping::{Changes, Sleep, SleepClock, any_newer};
use super::timing::{LapTimer, PhysicsTimings, Stage};
use crate::body::RigidBox;
use crate::state::{BodyState, Frame};

/// The pose last written to `Transform`, in its f32 bits. A `Transform` that has changed since and differs from it was
/// changed by other code: a teleport. (Change detection alone does not suffice, because smoothing between steps writes
/// `Transform` every frame.)
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub(crate) struct PublishedPose {
    pub(crate) translation: Vec3,
    pub(crate) rotation: Quat,
    /// `false` until the body is placed. Until then its `Transform` determines where it starts, whatever wrote it.
    pub(crate) placed: bool,
}

impl Default for PublishedPose {
    /// The pose of the default `Transform`. A body spawned with a `Transform` therefore starts there, and a body
    /// spawned with only a `BodyState` starts at that state.
    fn default() -> Self {
        Self {
            translation: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            placed: false,
        }
    }
}

impl PublishedPose {
    /// The pose of `state` in f32.
    #[inline(always)]
    pub(crate) fn of(state: &BodyState) -> Self {
        Self {
            translation: state.position.as_vec3(),
            rotation: state.rotation.as_quat(),
            placed: true,
        }
    }

    /// The pose of `transform`, or `None` if it is not finite or its rotation is nearly zero.
    pub(crate) fn shown_by(transform: &Transform) -> Option<Self> {
        let norm = transform.rotation.as_dquat().length();
        let usable = transform.translation.is_finite() && norm.is_finite() && norm > 1e-6;
        usable.then_some(Self {
            translation: transform.translation,
            rotation: transform.rotation,
            placed: true,
        })
    }

    pub(crate) fn is_shown_by(&self, transform: &Transform) -> bool {
        transform.translation == self.translation && transform.rotation == self.rotation
    }

    pub(crate) fn show(&self, transform: &mut Transform) {
        transform.translation = self.translation;
        transform.rotation = self.rotation;
    }

    /// A state at rest at this pose, for a body whose state is lost.
    pub(crate) fn state_at_rest(&self) -> BodyState {
        BodyState::at_pose(self.translation.as_dvec3(), self.rotation.as_dquat())
    }

    /// Applies changes that other code made to `transform` to `state`. Returns `true` if there were any, or an error if
    /// `transform` is invalid; `state` is then unchanged.
    pub(crate) fn take_teleport(
        &self,
        body: &RigidBox,
        transform: &Transform,
        state: &mut BodyState,
    ) -> Result<bool, NotFinite> {
        let now = Self::of(state);
        let moved =
            transform.translation != self.translation && transform.translation != now.translation;
        // Smoothing between two equal rotations may change their last bits, which is not a teleport.
        let turned = !same_rotation(transform.rotation, self.rotation)
            && !same_rotation(transform.rotation, now.rotation);
        if !moved && !turned {
            return Ok(false);
        }
        if Self::shown_by(transform).is_none() {
            return Err(NotFinite);
        }
        if moved {
            state.position = transform.translation.as_dvec3();
        }
        if turned {
            state.turn_to(body, transform.rotation.as_dquat(), Frame::World);
        }
        Ok(true)
    }
}

/// Returns `true` if two f32 rotations are equal up to rounding (four units in the last place of 1).
#[inline(always)]
fn same_rotation(a: Quat, b: Quat) -> bool {
    const MAX_DIFFERENCE: f32 = 4.0 * f32::EPSILON;
    a == b || (a - b).length_squared() < MAX_DIFFERENCE * MAX_DIFFERENCE
}

/// The error for a `Transform` that is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NotFinite;

/// Tick of the last *Writeback*. A `Transform` that changed later was changed by other code.
#[derive(Resource, Default)]
pub(crate) struct LastWriteback(Option<Tick>);

impl LastWriteback {
    /// Keeps the stored tick from becoming so old that tick comparison wraps around.
    pub(crate) fn age(check: On<CheckChangeTicks>, mut last: ResMut<Self>) {
        if let Some(tick) = &mut last.0 {
            tick.check_tick(*check);
        }
    }
}

/// Teleports the bodies whose `Transform` was changed by other code.
pub(crate) fn take_teleports(
    mut bodies: Query<(
        Entity,
        &RigidBox,
        Ref<Transform>,
        &PublishedPose,
        &mut BodyState,
    )>,
    last: Res<LastWriteback>,
    threads: Res<PhysicsThreads>,
    mut warned: Local<bool>,
) -> Result {
    for (entities, boxes, transforms, published, states) in bodies.contiguous_iter_mut()? {
        let (changed, now) = (transforms.changed_ticks_slice(), transforms.this_run_tick());
        let touched = |ticks: &[Tick]| last.0.is_none_or(|last| any_newer(ticks, last, now));
        if !touched(changed) {
            continue;
        }
        let (states, mut ticks) = ContiguousMut::bypass_change_detection_split(states);
        let columns = (
            entities,
            boxes,
            &*transforms,
            changed,
            published,
            states,
            ticks.changed_mut(),
        );
        let Refused(refused) = threads.share_out(
            entities.len() / LIGHT_PASS_DIVISOR,
            columns.chunks(0..entities.len(), CHUNK),
            |(_, (entities, boxes, transforms, changed, published, states, stamps))| {
                let mut refused = Refused(None);
                if !touched(changed) {
                    return refused;
                }
                for (i, (transform, published)) in transforms.iter().zip(published).enumerate() {
                    // Reads the state only if the displayed pose differs from the published one.
                    if published.is_shown_by(transform) {
                        continue;
                    }
                    match published.take_teleport(&boxes[i], transform, &mut states[i]) {
                        Ok(true) => stamps[i] = now,
                        Ok(false) => {}
                        Err(NotFinite) => refused += Refused(Some(entities[i])),
                    }
                }
                refused
            },
        );
        if let Some(entity) = refused
            && !core::mem::replace(&mut *warned, true)
        {
            warn!(
                "box_physics: the Transform of {entity} is not finite; it is ignored (logged once)"
            );
        }
    }
    Ok(())
}

/// Number of bodies that count as one in a pass that takes a small fraction of a step per body.
pub(crate) const LIGHT_PASS_DIVISOR: usize = 8;

/// The first body, in the order of entities, whose `Transform` is invalid.
#[derive(Default)]
struct Refused(Option<Entity>);

impl core::ops::AddAssign for Refused {
    fn add_assign(&mut self, other: Self) {
        self.0 = self.0.into_iter().chain(other.0).min();
    }
}

/// *Writeback*: writes `Transform` if the pose in f32 has changed. Sleeping bodies are skipped.
pub(crate) fn write_transforms(
    mut bodies: Query<(Ref<BodyState>, &Sleep, &mut PublishedPose, &mut Transform), With<RigidBox>>,
    clock: Res<SleepClock>,
    threads: Res<PhysicsThreads>,
    mut last_writeback: ResMut<LastWriteback>,
    mut timings: Option<ResMut<PhysicsTimings>>,
) -> Result {
    let mut watch = LapTimer::start(timings.is_some());
    for (states, sleep, mut published, transforms) in bodies.contiguous_iter_mut()? {
        let (transforms, mut ticks) = ContiguousMut::bypass_change_detection_split(transforms);
        let (last, now) = (ticks.last_run(), ticks.this_run());
        last_writeback.0 = Some(now);
        let columns = (
            &*states,
            states.changed_ticks_slice(),
            sleep,
            published.bypass_change_detection(),
            transforms,
            ticks.changed_mut(),
        );
        threads.share_out(
            states.len() / LIGHT_PASS_DIVISOR,
            columns.chunks(0..states.len(), CHUNK),
            |(_, (states, written, sleep, published, transforms, changed))| {
                let overwritten = any_newer(changed, last, now);
                let mut write = |rows: Range<usize>| {
                    let each = states[rows.clone()]
                        .iter()
                        .zip(&mut published[rows.clone()])
                        .zip(&mut transforms[rows.clone()])
                        .zip(&mut changed[rows]);
                    for (((state, published), transform), changed) in each {
                        *published = PublishedPose::of(state);
                        if !published.is_shown_by(transform) {
                            published.show(transform);
                            *changed = now;
                        }
                    }
                };
                if overwritten {
                    write(0..states.len());
                } else {
                    let columns = [written];
                    clock.on_awake(sleep, &Changes { columns, last, now }, write);
                }
                Done
            },
        );
    }
    if let Some(timings) = &mut timings {
        timings.record_stage(Stage::Writeback, watch.lap());
    }
    Ok(())
}
