//! What a step takes in before it moves anything: teleports and impulses.

use bevy::ecs::change_detection::{CheckChangeTicks, ContiguousMut, Ref, Tick};
use bevy::ecs::entity::Entity;
use bevy::ecs::error::Result;
use bevy::ecs::message::{MessageCursor, Messages};
use bevy::ecs::observer::On;
use bevy::ecs::query::{Has, With};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Local, Query, Res, ResMut};
use bevy::time::{Time, Virtual};
use bevy::transform::components::Transform;
use log::warn;

use super::components::{PublishedPose, Quarantined};
use super::messages::{ApplyImpulse, WhilePaused};
use super::parallel::{CHUNK, PhysicsThreads};
use super::resources::PhysicsClock;
use crate::body::RigidBox;
use crate::state::BodyState;

/// Impulses that wait for the next step, in order of arrival.
#[derive(Resource, Default)]
pub(crate) struct PendingImpulses {
    cursor: MessageCursor<ApplyImpulse>,
    queue: Vec<ApplyImpulse>,
}

/// Takes impulses out of the message buffer, every tick and every frame: those that were sent while the physics
/// stood still are kept or dropped, as their sender chose.
pub(crate) fn collect_impulses(
    messages: Res<Messages<ApplyImpulse>>,
    mut pending: ResMut<PendingImpulses>,
    clock: Option<Res<PhysicsClock>>,
    time: Option<Res<Time<Virtual>>>,
) {
    let stands = clock.is_some_and(|clock| clock.paused)
        || time.is_some_and(|time| time.is_paused() || time.relative_speed_f64() == 0.0);
    let PendingImpulses { cursor, queue } = &mut *pending;
    let kept = |impulse: &&ApplyImpulse| !stands || impulse.while_paused == WhilePaused::Keep;
    queue.extend(cursor.read(&messages).filter(kept));
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
    mut bodies: Query<(Entity, Ref<Transform>, &PublishedPose, &mut BodyState), With<RigidBox>>,
    shown: Res<LastShown>,
    threads: Res<PhysicsThreads>,
    mut warned: Local<bool>,
) -> Result {
    for (entities, transforms, published, states) in bodies.contiguous_iter_mut()? {
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
            .zip(published.chunks(CHUNK))
            .zip(states.chunks_mut(CHUNK))
            .zip(ticks.changed_mut().chunks_mut(CHUNK));
        let take = |(((((entities, transforms), changed), published), states), stamps)| {
            let chunk = Teleports {
                entities,
                transforms,
                published,
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
    published: &'a [PublishedPose],
    states: &'a mut [BodyState],
    /// When each state last changed.
    stamps: &'a mut [Tick],
    now: Tick,
}

impl Teleports<'_> {
    /// The state of a body is not even looked at unless its pose is not what we wrote.
    fn take(self) -> Refused {
        let mut refused = Refused(None);
        for (i, (transform, published)) in self.transforms.iter().zip(self.published).enumerate() {
            if published.is_shown_by(transform) {
                continue;
            }
            match published.take_teleport(transform, &mut self.states[i]) {
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
