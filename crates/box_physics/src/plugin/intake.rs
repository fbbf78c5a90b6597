//! What a step takes in before it moves anything: new bodies, teleports, impulses.

use bevy::ecs::change_detection::{CheckChangeTicks, ContiguousMut, DetectChangesMut, Ref, Tick};
use bevy::ecs::entity::Entity;
use bevy::ecs::error::Result;
use bevy::ecs::message::{MessageCursor, MessageWriter, Messages};
use bevy::ecs::observer::On;
use bevy::ecs::query::{Added, Changed, Has, With, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Local, Query, Res, ResMut};
use bevy::transform::components::Transform;
use log::warn;

use super::components::{NearFloor, Quarantined, ReportContacts, WorldAabb, WrittenTransform};
use super::messages::{ApplyImpulse, FloorContact};
use super::parallel::{CHUNK, PhysicsThreads};
use crate::aabb::corners;
use crate::body::RigidBox;
use crate::floor::{ContactPhase, ContactState};
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

/// When bodies in flight were last shown: a `Transform` that changed later was changed by somebody else, or
/// belongs to a body at the floor, which is shown a little later.
#[derive(Resource, Default)]
pub(crate) struct LastShown(pub(crate) Option<Tick>);

impl LastShown {
    /// Keeps it from growing so old that ticks start again from the beginning.
    pub(crate) fn age(check: On<CheckChangeTicks>, mut shown: ResMut<Self>) {
        if let Some(tick) = &mut shown.0 {
            tick.check_tick(*check);
        }
    }
}

/// Whether any of these ticks is newer than `last`, seen from `now`. Without a branch on each, so that the
/// compiler can look at several at once.
pub(crate) fn any_newer(ticks: &[Tick], last: Tick, now: Tick) -> bool {
    ticks.chunks(64).any(|some| {
        let newer = |found, tick: &Tick| found | tick.is_newer_than(last, now);
        some.iter().fold(false, newer)
    })
}

/// Bodies whose `Transform` somebody changed are there now.
pub(crate) fn take_teleports(
    mut bodies: Query<(Entity, Ref<Transform>, &WrittenTransform, &mut BodyState), With<RigidBox>>,
    shown: Res<LastShown>,
    threads: Res<PhysicsThreads>,
    mut warned: Local<bool>,
) -> Result {
    for (entities, transforms, written, states) in bodies.contiguous_iter_mut()? {
        let (changed, now) = (transforms.changed_ticks_slice(), transforms.this_run_tick());
        let touched = |ticks: &[Tick]| shown.0.is_none_or(|last| any_newer(ticks, last, now));
        if !touched(changed) {
            continue;
        }
        let (states, mut ticks) = ContiguousMut::bypass_change_detection_split(states);
        let chunks = entities
            .chunks(CHUNK)
            .zip(transforms.chunks(CHUNK))
            .zip(changed.chunks(CHUNK))
            .zip(written.chunks(CHUNK))
            .zip(states.chunks_mut(CHUNK))
            .zip(ticks.changed_mut().chunks_mut(CHUNK));
        let take = |(((((entities, transforms), changed), written), states), stamps)| {
            let chunk = Teleports {
                entities,
                transforms,
                written,
                states,
                stamps,
                now,
            };
            if touched(changed) {
                chunk.take()
            } else {
                Refused(None)
            }
        };
        // A comparison costs some tenth of a step.
        let Refused(refused) = threads.share_out(entities.len() / 10, chunks, take);
        if let Some(entity) = refused
            && !core::mem::replace(&mut *warned, true)
        {
            warn!(
                "box_physics: the Transform of {entity} is not finite; it is ignored (said once)"
            );
        }
    }
    Ok(())
}

/// Neighbors in a table, of which some may have been teleported.
struct Teleports<'a> {
    entities: &'a [Entity],
    transforms: &'a [Transform],
    written: &'a [WrittenTransform],
    states: &'a mut [BodyState],
    /// When each state last changed.
    stamps: &'a mut [Tick],
    now: Tick,
}

impl Teleports<'_> {
    /// The state of a body is not even looked at unless its pose is not what we wrote.
    fn take(self) -> Refused {
        let mut refused = Refused(None);
        for (i, (transform, written)) in self.transforms.iter().zip(self.written).enumerate() {
            if transform.translation == written.translation
                && transform.rotation == written.rotation
            {
                continue;
            }
            match written.take_teleport(transform, &mut self.states[i]) {
                Ok(true) => self.stamps[i] = self.now,
                Ok(false) => {}
                Err(_) => refused += Refused(Some(self.entities[i])),
            }
        }
        refused
    }
}

/// A body whose `Transform` cannot be taken over: the first in the order of entities.
#[derive(Default)]
struct Refused(Option<Entity>);

impl core::ops::AddAssign for Refused {
    fn add_assign(&mut self, other: Self) {
        self.0 = self.0.into_iter().chain(other.0).min();
    }
}

/// The impulses asked for, in order of arrival. One that cannot be applied is dropped: its body is
/// gone or quarantined, or it would leave a state that is not finite.
pub(crate) fn apply_impulses(
    mut pending: ResMut<PendingImpulses>,
    mut bodies: Query<(&RigidBox, &mut BodyState, Has<Quarantined>)>,
    mut warned: Local<Vec<&'static str>>,
) {
    for impulse in pending.queue.drain(..) {
        let reason = match bodies.get_mut(impulse.entity) {
            Ok((body, mut state, false)) => {
                let mut pushed = *state;
                impulse.apply(body, &mut pushed);
                if pushed.is_valid() || !state.is_valid() {
                    *state = pushed;
                    continue;
                }
                "is not finite"
            }
            Ok((.., true)) => "is for a quarantined body",
            Err(_) => "is for an entity that is no body (any more)",
        };
        if !warned.contains(&reason) {
            warned.push(reason);
            let entity = impulse.entity;
            warn!("box_physics: an impulse on {entity} {reason}; dropped (said once)");
        }
    }
}

/// Places new bodies at once, also while paused: their `Transform` and bounding box show where they
/// start before the first step. (Whether there are any is asked of whole columns, not of every body.)
pub(crate) fn place_new_bodies(
    mut bodies: Query<
        (
            &RigidBox,
            &mut BodyState,
            &mut WrittenTransform,
            &mut Transform,
            &mut NearFloor,
            Option<&ContactState>,
            Option<&mut WorldAabb>,
        ),
        Added<RigidBox>,
    >,
    all: Query<Ref<RigidBox>>,
) -> Result {
    let mut tables = all.contiguous_iter()?;
    let none = !tables.any(|boxes| {
        let (last, now) = (boxes.last_run_tick(), boxes.this_run_tick());
        any_newer(boxes.added_ticks_slice(), last, now)
    });
    if none {
        return Ok(());
    }
    for (body, mut state, mut written, mut transform, mut near, contact, aabb) in &mut bodies {
        // A loaded body may bring its contacts along.
        near.touched = contact.is_some_and(|c| c.touching() != 0);
        if !state.is_valid() {
            // The first step quarantines it, where its Transform is.
            *written = WrittenTransform::shown_by(&transform).unwrap_or_default();
            continue;
        }
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
    Ok(())
}

/// While the clock stands no step shows what somebody wrote to a [`BodyState`]: this does. A `Transform` that was
/// changed as well is a teleport of the next step, and stays.
pub(crate) fn show_written(
    mut bodies: Query<
        (
            &RigidBox,
            &BodyState,
            &mut WrittenTransform,
            &mut Transform,
            Option<&mut WorldAabb>,
        ),
        (Changed<BodyState>, Without<Quarantined>),
    >,
) {
    for (body, state, mut written, mut transform, aabb) in &mut bodies {
        let shown =
            written.translation == transform.translation && written.rotation == transform.rotation;
        let now = WrittenTransform::of(state);
        if !shown || !state.is_valid() || now == *written {
            continue;
        }
        *written = now;
        transform.translation = now.translation;
        transform.rotation = now.rotation;
        if let Some(mut aabb) = aabb {
            *aabb = WorldAabb::of(body, state);
        }
    }
}

/// The floor is gone: what touched it no longer does.
pub(crate) fn forget_contacts(
    mut bodies: Query<(
        Entity,
        &RigidBox,
        &BodyState,
        &mut ContactState,
        &mut NearFloor,
        Has<ReportContacts>,
    )>,
    mut contacts: MessageWriter<FloorContact>,
) {
    for (entity, body, state, mut contact, mut near, heard) in &mut bodies {
        let touching = contact.touching();
        *contact.bypass_change_detection() = ContactState::default();
        *near.bypass_change_detection() = NearFloor::default();
        if !heard {
            continue;
        }
        for (corner, point) in (0_u8..).zip(corners(body.half_extents())) {
            if touching >> corner & 1 == 1 {
                contacts.write(FloorContact {
                    entity,
                    corner,
                    point: state.point(point),
                    normal_impulse: 0.0,
                    phase: ContactPhase::Ended,
                });
            }
        }
    }
}
