//! The contacts that are reported: every one that began ends once, whatever happens to its body.

use bevy::app::App;
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::lifecycle::{Add, Remove};
use bevy::ecs::message::MessageWriter;
use bevy::ecs::observer::On;
use bevy::ecs::query::{Allow, With, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::Query;
use bevy::ecs::world::{DeferredWorld, World};

use super::components::{NearFloor, Quarantined, ReportContacts};
use super::messages::FloorContact;
use crate::aabb;
use crate::body::RigidBox;
use crate::floor::{ContactPhase, ContactPoint, ContactState};
use crate::state::BodyState;

/// The contacts of a body that are reported.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct ReportedContacts {
    /// The corners of which a [`FloorContact`] said that they began to touch, and not yet that they ended; bit k is
    /// corner k.
    began: u8,
    /// What the last step found.
    points: Vec<ContactPoint>,
}

/// Emits what the step found. A corner that touched before [`ReportContacts`] was inserted begins now; one whose
/// [`ContactState`] was reset ends.
pub(crate) fn report_contacts(
    mut bodies: Query<
        (
            Entity,
            &RigidBox,
            &BodyState,
            &ContactState,
            &mut ReportedContacts,
        ),
        (With<ReportContacts>, Without<Quarantined>),
    >,
    mut messages: MessageWriter<FloorContact>,
) {
    for (entity, body, state, contact, mut reported) in &mut bodies {
        let ReportedContacts { began, points } = &mut *reported;
        for point in points.drain(..) {
            let corner = 1 << point.corner;
            let known = *began & corner != 0;
            let phase = match point.phase {
                ContactPhase::Ended if !known => continue,
                ContactPhase::Ended => ContactPhase::Ended,
                _ if known => ContactPhase::Persists,
                _ => ContactPhase::Began,
            };
            match phase {
                ContactPhase::Ended => *began &= !corner,
                _ => *began |= corner,
            }
            messages.write(FloorContact {
                entity,
                corner: point.corner,
                point: point.point,
                normal_impulse: point.normal_impulse,
                phase,
            });
        }
        let forgotten = *began & !contact.touching();
        *began &= contact.touching();
        messages.write_batch(ended(entity, forgotten, body, state));
    }
}

/// The ends of the contacts of these corners.
fn ended(
    entity: Entity,
    corners: u8,
    body: &RigidBox,
    state: &BodyState,
) -> impl Iterator<Item = FloorContact> {
    let places = (0_u8..).zip(aabb::corners(body.half_extents()).map(|c| state.point(c)));
    places
        .filter(move |(corner, _)| corners >> corner & 1 == 1)
        .map(move |(corner, point)| FloorContact {
            entity,
            corner,
            point,
            normal_impulse: 0.0,
            phase: ContactPhase::Ended,
        })
}

impl ReportedContacts {
    /// The points of a step that begins.
    pub(crate) fn begin(&mut self) -> &mut Vec<ContactPoint> {
        self.points.clear();
        &mut self.points
    }
}

/// Ends the contacts of a body, with a message for each that was reported.
pub(crate) fn end_contacts(world: &mut DeferredWorld, entity: Entity) {
    end_reports(world, entity);
    let Ok(mut found) = world.get_entity_mut(entity) else {
        return;
    };
    if let Some(mut contact) = found.get_mut::<ContactState>() {
        *contact = ContactState::default();
    }
    if let Some(mut near) = found.get_mut::<NearFloor>() {
        *near = NearFloor::default();
    }
}

fn end_reports(world: &mut DeferredWorld, entity: Entity) {
    let Ok(mut found) = world.get_entity_mut(entity) else {
        return;
    };
    let Some(mut reported) = found.get_mut::<ReportedContacts>() else {
        return;
    };
    let corners = core::mem::take(&mut reported.began);
    if corners != 0
        && let Some((body, state)) = found.get::<RigidBox>().zip(found.get::<BodyState>())
    {
        let ended: Vec<_> = ended(entity, corners, body, state).collect();
        world.write_message_batch(ended);
    }
}

/// There is contact with a floor: its plugin was added.
#[derive(Resource)]
pub(crate) struct ContactEnabled;

/// The floor is gone: what touched it no longer does.
pub(crate) fn end_all_contacts(world: &mut World) {
    let mut bodies = world.query_filtered::<(Entity, &NearFloor), Allow<Disabled>>();
    let touching = |(entity, near): (Entity, &NearFloor)| near.touched.then_some(entity);
    let touching: Vec<_> = bodies.iter(world).filter_map(touching).collect();
    for entity in touching {
        end_contacts(&mut DeferredWorld::from(&mut *world), entity);
    }
}

/// Adds the observers of what ends the contacts of a body.
pub(crate) fn build(app: &mut App) {
    app.insert_resource(ContactEnabled)
        // Of a body that is despawned as well.
        .add_observer(|end: On<Remove, RigidBox>, mut world: DeferredWorld| {
            end_contacts(&mut world, end.entity);
        })
        .add_observer(|end: On<Remove, ContactState>, mut world: DeferredWorld| {
            end_contacts(&mut world, end.entity);
        })
        .add_observer(|end: On<Add, Disabled>, mut world: DeferredWorld| {
            end_contacts(&mut world, end.entity);
        })
        .add_observer(|end: On<Add, Quarantined>, mut world: DeferredWorld| {
            end_contacts(&mut world, end.entity);
        })
        .add_observer(
            |end: On<Remove, ReportContacts>, mut world: DeferredWorld| {
                end_reports(&mut world, end.entity);
            },
        );
}
