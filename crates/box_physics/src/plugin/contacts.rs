//! Reported contacts. Every contact that began ends exactly once, whatever the cause.

use bevy::app::App;
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::lifecycle::{Add, Remove, RemovedComponents};
use bevy::ecs::message::MessageWriter;
use bevy::ecs::observer::On;
use bevy::ecs::query::{Allow, Has, With, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Commands, Query, Res};
use bevy::ecs::world::{DeferredWorld, World};
use glam::DVec3;

use super::components::{NearFloor, Quarantined, ReportContacts, ReportPersisting, RestingSince};
use super::forces::Step;
use super::messages::{ContactPhase, FloorContact, Landed, Woken};
use crate::aabb;
use crate::body::RigidBox;
use crate::floor::{ContactReport, ContactState, Floor, StaticPlane};
use crate::state::BodyState;

/// Impacts that follow each other within this time \[s\] count as one landing.
const LANDING_PAUSE: f64 = 0.1;
/// Time over which impulses are summed before a landing is reported \[s\]: two ticks of 1/64 s.
const LANDING_WINDOW: f64 = 0.03;

/// Reporting state of a body's contacts.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct ReportedContacts {
    /// A [`FloorContact`] with phase `Began` was emitted, and none with `Ended` since.
    began: bool,
    /// Contacts of the current step.
    report: Option<ContactReport>,
    /// Simulated time of the last impact \[s\].
    last_impact: Option<f64>,
    /// A landing whose impulses are still being summed.
    landing: Option<Landed>,
}

impl ReportedContacts {
    /// Starts the report of a new step.
    pub(crate) fn begin(&mut self) -> &mut ContactReport {
        self.report.insert(ContactReport::default())
    }

    /// Discards the report of the step.
    pub(crate) fn clear(&mut self) {
        self.report = None;
    }

    /// Adds the impacts of a step of `h` \[s\] that ends at `time`. Returns the landing if it is complete.
    fn land(
        &mut self,
        entity: Entity,
        (time, h): (f64, f64),
        report: Option<&ContactReport>,
        slowest: f64,
    ) -> Option<Landed> {
        if let Some(report) = report.filter(|r| r.approach_speed > slowest) {
            let at = time - h + report.impact_time;
            // The lower bound rejects a clock that was set back.
            let goes_on = self
                .last_impact
                .is_some_and(|last| (-h..LANDING_PAUSE).contains(&(at - last)));
            self.last_impact = Some(time);
            let mut landed = self.landing.unwrap_or(Landed {
                entity,
                time: at,
                point: DVec3::ZERO,
                normal: report.normal,
                normal_impulse: 0.0,
                tangential_impulse: DVec3::ZERO,
                approach_speed: 0.0,
            });
            let (before, impulse) = (landed.normal_impulse, report.normal_impulse());
            landed.normal_impulse += impulse;
            landed.point =
                (landed.point * before + report.point() * impulse) / landed.normal_impulse;
            landed.tangential_impulse += report.tangential_impulse;
            landed.approach_speed = landed.approach_speed.max(report.approach_speed);
            if self.landing.is_some() || !goes_on {
                self.landing = Some(landed);
            }
        }
        self.landing
            .take_if(|landed| !(0.0..LANDING_WINDOW).contains(&(time - landed.time)))
    }
}

/// Emits the contacts of the step. A contact that existed before [`ReportContacts`] was inserted begins now; a contact
/// whose [`ContactState`] was reset ends.
pub(crate) fn report_contacts(
    mut bodies: Query<
        (
            Entity,
            &RigidBox,
            &BodyState,
            &ContactState,
            &mut ReportedContacts,
            Has<ReportPersisting>,
        ),
        (With<ReportContacts>, Without<Quarantined>),
    >,
    step: Res<Step>,
    mut messages: MessageWriter<FloorContact>,
    mut landings: MessageWriter<Landed>,
    mut commands: Commands,
) {
    let time = step.time;
    for (entity, body, state, contact, mut reported, persisting) in &mut bodies {
        let reported = reported.bypass_change_detection();
        let (report, began) = (reported.report.take(), reported.began);
        let touches = contact.touching() != 0;
        if report.is_none() && began == touches && reported.landing.is_none() {
            continue;
        }
        let slowest = step.settings.restitution_threshold;
        if let Some(landed) = reported.land(entity, (time, step.h), report.as_ref(), slowest) {
            landings.write(landed);
            commands.trigger(landed);
        }
        let report = report.unwrap_or_else(|| touching_report(contact.touching(), body, state));
        let mut write = |phase| {
            messages.write(FloorContact {
                entity,
                phase,
                time,
                report,
            });
        };
        if !began && report.corners != 0 {
            write(ContactPhase::Began);
        } else if began && touches && persisting {
            write(ContactPhase::Persists);
        }
        if !touches && (began || report.corners != 0) {
            write(ContactPhase::Ended);
        }
        reported.began = touches;
    }
}

/// A report in which these corners touch, without impulses.
fn touching_report(corners: u8, body: &RigidBox, state: &BodyState) -> ContactReport {
    ContactReport {
        corners,
        points: aabb::corners(body.half_extents()).map(|c| state.point(c)),
        ..ContactReport::default()
    }
}

/// Ends the contacts of a body: emits a message if they were reported, and an event if the body was at rest.
pub(crate) fn end_contacts(world: &mut DeferredWorld, entity: Entity) {
    if forget_contacts(world, entity) {
        let time = world.get_resource::<Step>().map_or(0.0, |step| step.time);
        world.trigger(Woken { entity, time });
    }
}

/// Clears the contacts of a body. Returns `true` if it was at rest.
fn forget_contacts(world: &mut DeferredWorld, entity: Entity) -> bool {
    end_reports(world, entity);
    let Ok(mut found) = world.get_entity_mut(entity) else {
        return false;
    };
    if let Some(mut contact) = found.get_mut::<ContactState>() {
        *contact = ContactState::default();
    }
    if let Some(mut near) = found.get_mut::<NearFloor>() {
        *near = NearFloor::default();
    }
    let resting = found
        .get_mut::<RestingSince>()
        .filter(|since| since.0.is_some());
    resting.is_some_and(|mut since| since.0.take().is_some())
}

fn end_reports(world: &mut DeferredWorld, entity: Entity) {
    let time = world.get_resource::<Step>().map_or(0.0, |step| step.time);
    let Ok(mut found) = world.get_entity_mut(entity) else {
        return;
    };
    let Some(mut reported) = found.get_mut::<ReportedContacts>() else {
        return;
    };
    if core::mem::take(&mut *reported).began
        && let Some((body, state)) = found.get::<RigidBox>().zip(found.get::<BodyState>())
    {
        let ended = FloorContact {
            entity,
            phase: ContactPhase::Ended,
            time,
            report: touching_report(0, body, state),
        };
        world.write_message(ended);
    }
}

/// Marker: [`FloorPlugin`](super::FloorPlugin) was added.
#[derive(Resource)]
pub(crate) struct ContactEnabled;

/// Ends all contacts after the floor was removed.
pub(crate) fn end_all_contacts(world: &mut World) {
    let mut bodies = world.query_filtered::<(Entity, &NearFloor), Allow<Disabled>>();
    let touching = |(entity, near): (Entity, &NearFloor)| near.touched.then_some(entity);
    let touching: Vec<_> = bodies.iter(world).filter_map(touching).collect();
    for entity in touching {
        end_contacts(&mut DeferredWorld::from(&mut *world), entity);
    }
}

/// Run condition: the last static plane was removed, and there is no floor.
pub(crate) fn last_plane_removed(
    mut removed: RemovedComponents<StaticPlane>,
    left: Query<(), With<StaticPlane>>,
    floor: Option<Res<Floor>>,
) -> bool {
    removed.read().count() > 0 && left.is_empty() && floor.is_none()
}

/// Adds the observers that end the contacts of a body.
pub(crate) fn build(app: &mut App) {
    app.insert_resource(ContactEnabled)
        // Also runs when the body is despawned.
        .add_observer(
            |end: On<Remove, (RigidBox, ContactState)>, mut world: DeferredWorld| {
                forget_contacts(&mut world, end.entity);
            },
        )
        .add_observer(
            |end: On<Add, (Disabled, Quarantined)>, mut world: DeferredWorld| {
                end_contacts(&mut world, end.entity);
            },
        )
        .add_observer(
            |end: On<Remove, ReportContacts>, mut world: DeferredWorld| {
                end_reports(&mut world, end.entity);
            },
        );
}
