//! Impulses: collected at any time, applied at the start of a step.

use bevy::ecs::message::{MessageCursor, Messages};
use bevy::ecs::query::Has;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Local, Query, Res, ResMut};
use bevy::ecs::world::World;
use bevy::time::{Time, Virtual};
use log::warn;

use super::components::Quarantined;
use super::messages::{ApplyImpulse, WhilePaused};
use super::resources::PhysicsClock;
use crate::body::RigidBox;
use crate::state::BodyState;

/// Impulses waiting for the next step, in order of arrival.
#[derive(Resource, Default)]
pub(crate) struct PendingImpulses {
    cursor: MessageCursor<ApplyImpulse>,
    queue: Vec<ApplyImpulse>,
}

impl PendingImpulses {
    /// The waiting impulses, including those just sent.
    pub(crate) fn snapshot(world: &mut World) -> Vec<ApplyImpulse> {
        let _ = world.run_system_cached(collect_impulses);
        let pending = world.get_resource::<Self>();
        pending.map_or(Vec::new(), |pending| pending.queue.clone())
    }

    /// Replaces the waiting impulses, and drops those sent since.
    pub(crate) fn restore(world: &mut World, queue: &[ApplyImpulse]) {
        let _ = world.run_system_cached(collect_impulses);
        if let Some(mut pending) = world.get_resource_mut::<Self>() {
            pending.queue = queue.to_vec();
        }
    }
}

/// Moves impulses from the message buffer to the queue, every tick and every frame. Impulses sent while the physics is
/// paused are kept or dropped, as [`WhilePaused`] requests.
pub(crate) fn collect_impulses(
    messages: Res<Messages<ApplyImpulse>>,
    mut pending: ResMut<PendingImpulses>,
    clock: Option<Res<PhysicsClock>>,
    time: Option<Res<Time<Virtual>>>,
) {
    let paused = clock.is_some_and(|clock| clock.paused)
        || time.is_some_and(|time| time.is_paused() || time.relative_speed_f64() == 0.0);
    let PendingImpulses { cursor, queue } = &mut *pending;
    let kept = |impulse: &&ApplyImpulse| !paused || impulse.while_paused == WhilePaused::Keep;
    queue.extend(cursor.read(&messages).filter(kept));
}

/// Applies the collected impulses in order of arrival. An impulse is dropped if its body no longer exists or is
/// quarantined, or if the resulting state would be invalid.
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
            Err(_) => "is for an entity that is not a body",
        };
        if !warned.contains(&reason) {
            warned.push(reason);
            let entity = impulse.entity;
            warn!("box_physics: an impulse on {entity} {reason}; dropped (logged once)");
        }
    }
}
