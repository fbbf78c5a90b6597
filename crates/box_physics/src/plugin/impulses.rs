//! Impulses: collected while the clock runs or stands, applied at the start of a step.

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

/// Impulses that wait for the next step, in order of arrival.
#[derive(Resource, Default)]
pub(crate) struct PendingImpulses {
    cursor: MessageCursor<ApplyImpulse>,
    queue: Vec<ApplyImpulse>,
}

impl PendingImpulses {
    /// Those that wait for the next step, sent just now included.
    pub(crate) fn snapshot(world: &mut World) -> Vec<ApplyImpulse> {
        let _ = world.run_system_cached(collect_impulses);
        let pending = world.get_resource::<Self>();
        pending.map_or(Vec::new(), |pending| pending.queue.clone())
    }

    /// Replaces what waits, and drops what was sent since.
    pub(crate) fn restore(world: &mut World, queue: &[ApplyImpulse]) {
        let _ = world.run_system_cached(collect_impulses);
        if let Some(mut pending) = world.get_resource_mut::<Self>() {
            pending.queue = queue.to_vec();
        }
    }
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

/// Applies the collected impulses in order of arrival. One that cannot be applied is dropped: its body is
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
