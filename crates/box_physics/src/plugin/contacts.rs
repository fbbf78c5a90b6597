//! The contacts that are reported: every one that began ends once, whatever happens to its body.

use bevy::app::App;
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::lifecycle::{Add, Remove};
use bevy::ecs::observer::On;
use bevy::ecs::query::Allow;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::{DeferredWorld, World};

use super::components::{NearFloor, Quarantined, ReportContacts};
use super::messages::FloorContact;
use crate::aabb::corners;
use crate::body::RigidBox;
use crate::floor::{ContactPhase, ContactPoint, ContactState};
use crate::state::BodyState;

/// The corners of which a [`FloorContact`] said that they began to touch, and not yet that they ended; bit k is
/// corner k.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ReportedContacts(u8);

impl ReportedContacts {
    /// Emits what a step found. A corner that touched before anybody listened begins now; one whose contact was
    /// forgotten from outside ends.
    pub(crate) fn report(
        &mut self,
        entity: Entity,
        (body, state): (&RigidBox, &BodyState),
        touching: u8,
        points: &[ContactPoint],
        mut emit: impl FnMut(FloorContact),
    ) {
        for point in points {
            let corner = 1 << point.corner;
            let known = self.0 & corner != 0;
            let phase = match point.phase {
                ContactPhase::Ended if !known => continue,
                ContactPhase::Ended => ContactPhase::Ended,
                _ if known => ContactPhase::Persists,
                _ => ContactPhase::Began,
            };
            match phase {
                ContactPhase::Ended => self.0 &= !corner,
                _ => self.0 |= corner,
            }
            emit(FloorContact {
                entity,
                corner: point.corner,
                point: point.point,
                normal_impulse: point.normal_impulse,
                phase,
            });
        }
        if self.0 & !touching != 0 {
            let forgotten = Self(self.0 & !touching);
            self.0 &= touching;
            forgotten.ended(entity, body, state).for_each(emit);
        }
    }

    /// The ends of all of them.
    fn ended(
        self,
        entity: Entity,
        body: &RigidBox,
        state: &BodyState,
    ) -> impl Iterator<Item = FloorContact> {
        let corners = (0_u8..).zip(corners(body.half_extents()).map(|c| state.point(c)));
        corners
            .filter(move |(corner, _)| self.0 >> corner & 1 == 1)
            .map(move |(corner, point)| FloorContact {
                entity,
                corner,
                point,
                normal_impulse: 0.0,
                phase: ContactPhase::Ended,
            })
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
    let reported = core::mem::take(&mut *reported);
    if let Some((body, state)) = found.get::<RigidBox>().zip(found.get::<BodyState>()) {
        let ended: Vec<_> = reported.ended(entity, body, state).collect();
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
