//! Snapshots of the complete state of the physics.

use bevy::ecs::bundle::Bundle;
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::ecs::world::{EntityWorldMut, World};
use glam::DVec3;

use super::components::{NearFloor, OneShotForce, Quarantined, RestingSince};
use super::contacts::ReportedContacts;
use super::impulses::PendingImpulses;
use super::messages::ApplyImpulse;
use super::resources::PhysicsClock;
use super::teleport::show_jump;
use crate::body::RigidBox;
use crate::floor::{ContactState, Floor, StaticPlane};
use crate::integrators::IntegratorMemory;
use crate::state::BodyState;

/// A snapshot of the physics, for rewind, rollback and replays. With the same settings and inputs, the simulation
/// continues from it bit for bit, with every integrator and every contact.
///
/// It contains what the physics writes: the clock, the positions of the [`Floor`] and of each [`StaticPlane`], and the
/// impulses waiting for the next step. For each body it contains its [`BodySnapshot`], the rest of its
/// [`OneShotForce`], its quarantine and the progress of its contact reports. It does not contain what only you write:
/// [`RigidBox`], forces, gravity, the other fields of floor and planes, the integrator, pause and substeps.
///
/// Take and restore it between ticks (for example in `Update` or in a command), or with an exclusive system in
/// [`PhysicsSystems::Last`](super::PhysicsSystems::Last).
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugins::default())).insert_resource(Floor::default());
/// let die = app.world_mut().spawn((RigidBox::default(), Transform::from_xyz(0.0, 3.0, 0.0))).id();
/// let future = |world: &mut World| {
///     world.commands().queue(StepPhysics(120));
///     world.flush();
///     *world.get::<BodyState>(die).expect("a body")
/// };
/// let snapshot = PhysicsSnapshot::take(app.world_mut());
/// let first = future(app.world_mut());
/// snapshot.restore(app.world_mut());
/// assert_eq!(future(app.world_mut()), first);
/// ```
#[doc(alias("rewind", "rollback", "save"))]
#[derive(Clone, Debug)]
pub struct PhysicsSnapshot {
    clock: PhysicsClock,
    floor_height: Option<f64>,
    planes: Vec<(Entity, DVec3)>,
    pending: Vec<ApplyImpulse>,
    bodies: Vec<(Entity, BodySnapshot, Marks)>,
}

/// The state of one body that the physics maintains. It is a bundle: spawn a saved body with it, its [`RigidBox`] and
/// its forces. With the feature `serde` it is serializable; a loaded body continues bit for bit.
#[derive(Bundle, Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodySnapshot {
    /// The motion state.
    pub state: BodyState,
    /// The memory of the integrator.
    pub memory: IntegratorMemory,
    /// The memory of the contact with the floor.
    pub contact: ContactState,
    /// The time at which it came to rest.
    pub resting: RestingSince,
}

/// Optional components of a body.
#[derive(Clone, Debug)]
struct Marks {
    one_shot: Option<OneShotForce>,
    quarantined: Option<Quarantined>,
    reported: Option<ReportedContacts>,
}

/// Replaces a component that the body has.
fn put<C: Component<Mutability = Mutable>>(body: &mut EntityWorldMut, value: C) {
    if let Some(mut component) = body.get_mut::<C>() {
        *component = value;
    }
}

impl PhysicsSnapshot {
    /// Takes a snapshot of the current state, with all bodies that are not disabled.
    pub fn take(world: &mut World) -> Self {
        let mut bodies = world.query_filtered::<(
            Entity,
            &BodyState,
            &IntegratorMemory,
            Option<&ContactState>,
            Option<&RestingSince>,
            Option<&OneShotForce>,
            Option<&Quarantined>,
            Option<&ReportedContacts>,
        ), With<RigidBox>>();
        let bodies = bodies.iter(world).map(
            |(entity, state, memory, contact, resting, one_shot, quarantined, reported)| {
                let body = BodySnapshot {
                    state: *state,
                    memory: memory.clone(),
                    contact: contact.cloned().unwrap_or_default(),
                    resting: resting.copied().unwrap_or_default(),
                };
                let marks = Marks {
                    one_shot: one_shot.copied(),
                    quarantined: quarantined.copied(),
                    reported: reported.cloned(),
                };
                (entity, body, marks)
            },
        );
        let bodies = bodies.collect();
        let mut planes = world.query::<(Entity, &StaticPlane)>();
        let planes = planes
            .iter(world)
            .map(|(entity, plane)| (entity, plane.point));
        let planes = planes.collect();
        Self {
            clock: world.get_resource().copied().unwrap_or_default(),
            floor_height: world.get_resource().map(|floor: &Floor| floor.height),
            planes,
            pending: PendingImpulses::snapshot(world),
            bodies,
        }
    }

    /// Restores this snapshot. Bodies are displayed at the restored pose in this frame, without smoothing. No events
    /// are sent. Bodies spawned since the snapshot are unchanged. Returns the bodies of the snapshot that no longer
    /// exist.
    pub fn restore(&self, world: &mut World) -> Vec<Entity> {
        if let Some(mut clock) = world.get_resource_mut::<PhysicsClock>() {
            clock.continue_from(&self.clock);
        }
        if let (Some(height), Some(mut floor)) =
            (self.floor_height, world.get_resource_mut::<Floor>())
            && floor.height != height
        {
            floor.height = height;
        }
        for &(entity, point) in &self.planes {
            if let Some(mut plane) = world.get_mut::<StaticPlane>(entity)
                && plane.point != point
            {
                plane.point = point;
            }
        }
        PendingImpulses::restore(world, &self.pending);
        let mut missing = Vec::new();
        for (entity, body, marks) in &self.bodies {
            let Ok(mut found) = world.get_entity_mut(*entity) else {
                missing.push(*entity);
                continue;
            };
            if !found.contains::<RigidBox>() {
                missing.push(*entity);
                continue;
            }
            // Must be first, because inserting `Quarantined` ends contacts.
            if let Some(quarantined) = marks.quarantined {
                found.insert(quarantined);
            } else {
                found.remove::<Quarantined>();
            }
            put(&mut found, body.memory.clone());
            put(&mut found, body.contact.clone());
            put(&mut found, body.resting);
            put(&mut found, marks.one_shot.unwrap_or_default());
            put(&mut found, marks.reported.clone().unwrap_or_default());
            if let Some(mut near) = found.get_mut::<NearFloor>() {
                near.touched = body.contact.touching() != 0;
            }
            show_jump(world, *entity, body.state);
        }
        missing
    }

    /// Simulated time of the snapshot \[s\].
    pub fn time(&self) -> f64 {
        self.clock.time()
    }

    /// The bodies of the snapshot.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = (Entity, &BodySnapshot)> {
        self.bodies.iter().map(|(entity, body, _)| (*entity, body))
    }
}
