//! *Forces*: what acts on the bodies in a step, gathered before it. What depends on the state is evaluated by the
//! integrators.

use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::{QueryData, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut};
use glam::DVec3;

use super::components::{
    AngularDamping, AngularDrag, BodyTorque, BodyWind, Checked, ExternalForce, GravityScale,
    LinearDrag, OneShotForce, PointForces, QuadraticDrag, Springs,
};
use super::contacts::ContactEnabled;
use super::resources::{GlobalIntegrator, PhysicsClock, Wind, WorldGravity};
use crate::body::RigidBox;
use crate::floor::{self, ContactSettings, Floor, Friction, Plane, Restitution, StaticPlane};
use crate::force::{Dissipation, ForceModel, Forces};
use crate::integrators::Integrator;
use crate::state::BodyState;

/// What is the same for every body of a step.
#[derive(Resource, Default)]
pub(crate) struct Step {
    /// Size \[s\].
    pub(crate) h: f64,
    /// Simulated time at its end \[s\].
    pub(crate) time: f64,
    /// [m/s²]
    pub(crate) gravity: DVec3,
    /// [m/s]
    pub(crate) wind: DVec3,
    /// Of bodies without one of their own.
    pub(crate) integrator: Integrator,
    pub(crate) floor: Option<Floor>,
    /// The floor and the static planes; empty without static planes.
    pub(crate) planes: Vec<Plane>,
    pub(crate) settings: ContactSettings,
}

/// A static plane and its surface.
type PlaneEntity = (
    Entity,
    &'static StaticPlane,
    Option<&'static Friction>,
    Option<&'static Restitution>,
);

impl Step {
    /// Whether there is anything to touch.
    pub(crate) fn has_contact(&self) -> bool {
        self.floor.is_some() || !self.planes.is_empty()
    }

    /// Whether a body may touch the floor or another plane in this step.
    #[inline]
    pub(crate) fn may_touch(
        &self,
        body: &RigidBox,
        state: &BodyState,
        force: &impl ForceModel,
    ) -> bool {
        if self.planes.is_empty() {
            let floor = self.floor.as_ref();
            floor.is_some_and(|floor| floor::may_touch(floor, body, state, force, self.h))
        } else {
            floor::may_touch_planes(&self.planes, body, state, force, self.h)
        }
    }
}

/// Gathers what is the same for every body.
pub(crate) fn gather_forces(
    mut step: ResMut<Step>,
    clock: Res<PhysicsClock>,
    (gravity, wind): (Res<WorldGravity>, Option<Res<Wind>>),
    integrator: Res<GlobalIntegrator>,
    floor: Option<Res<Floor>>,
    (settings, contact): (Option<Res<ContactSettings>>, Option<Res<ContactEnabled>>),
    statics: Query<PlaneEntity, Without<RigidBox>>,
) {
    // Without its plugin a floor is nothing.
    let floor = floor.filter(|_| contact.is_some()).map(|floor| *floor);
    let mut planes = core::mem::take(&mut step.planes);
    planes.clear();
    if contact.is_some() && !statics.is_empty() {
        let mut shapes: Vec<_> = statics.iter().collect();
        // In the order in which they were spawned, as a rule: not in one that depends on which components they have.
        shapes.sort_unstable_by_key(|(entity, ..)| entity.index_u32());
        let shapes = shapes
            .iter()
            .filter_map(|(_, shape, friction, restitution)| {
                Plane::of(**shape, *friction, *restitution).ok()
            });
        planes.extend(floor.map(Plane::from).into_iter().chain(shapes));
    }
    *step = Step {
        h: clock.step(),
        time: clock.time(),
        gravity: gravity.0,
        wind: wind.map_or(DVec3::ZERO, |wind| wind.0),
        integrator: integrator.0,
        floor,
        planes,
        settings: settings.map_or(ContactSettings::DEFAULT, |settings| *settings),
    };
}

/// What may act on a body besides gravity, as the slices that Bevy hands over.
#[derive(QueryData)]
#[query_data(contiguous(all))]
pub(crate) struct ForceColumns {
    gravity_scale: Option<&'static GravityScale>,
    linear_drag: Option<&'static LinearDrag>,
    quadratic_drag: Option<&'static QuadraticDrag>,
    angular_damping: Option<&'static AngularDamping>,
    angular_drag: Option<&'static AngularDrag>,
    external: Option<&'static ExternalForce>,
    one_shot: Option<&'static OneShotForce>,
    body_torque: Option<&'static BodyTorque>,
    point_forces: Option<&'static PointForces>,
    springs: Option<&'static Springs>,
    wind: Option<&'static BodyWind>,
}

impl ForceColumnsContiguousItem<'_, '_> {
    /// Whether nothing but the same gravity acts on every body of this table.
    pub(crate) fn only_uniform_gravity(&self) -> bool {
        self.only_gravity() && !self.scales_gravity()
    }

    /// Whether no body of this table has anything but gravity acting on it.
    pub(crate) fn only_gravity(&self) -> bool {
        self.linear_drag.is_none()
            && self.quadratic_drag.is_none()
            && self.angular_damping.is_none()
            && self.angular_drag.is_none()
            && self.external.is_none()
            && self.one_shot.is_none()
            && self.body_torque.is_none()
            && self.point_forces.is_none()
            && self.springs.is_none()
    }

    /// Gravity of body `i` [m/s²].
    #[inline(always)]
    pub(crate) fn gravity(&self, i: usize, world: DVec3) -> DVec3 {
        match self.gravity_scale {
            Some(scales) => world * scales[i].0,
            None => world,
        }
    }

    /// Whether gravity is not the same for all bodies of this table.
    pub(crate) fn scales_gravity(&self) -> bool {
        self.gravity_scale.is_some()
    }

    /// The whole force model of body `i`.
    #[inline]
    pub(crate) fn forces(&self, i: usize, body: &RigidBox, step: &Step) -> Forces<'_> {
        let (world, wind) = (step.gravity, step.wind);
        let mut external = self.external.map_or(ExternalForce::default(), |c| c[i]);
        if let Some(one_shot) = self.one_shot {
            external.force += one_shot[i].force;
            external.torque += one_shot[i].torque;
        }
        Forces {
            acceleration: self.gravity(i, world) + external.force * body.inverse_mass(),
            dissipation: Dissipation {
                linear_drag: valid(self.linear_drag, i).map_or(0.0, |c| c.0),
                quadratic_drag: valid(self.quadratic_drag, i).map_or(0.0, |c| c.0),
                angular_damping: valid(self.angular_damping, i).map_or(0.0, |c| c.0),
                angular_drag: valid(self.angular_drag, i).map_or(0.0, |c| c.0),
                wind: match (&self.linear_drag, &self.quadratic_drag) {
                    (None, None) => DVec3::ZERO,
                    _ => self.wind.map_or(wind, |c| c[i].0),
                },
            },
            body_torque: self.body_torque.map_or(DVec3::ZERO, |c| c[i].0),
            world_torque: external.torque,
            point_forces: self.point_forces.map_or(&[], |c| c[i].0.as_slice()),
            springs: valid(self.springs, i).map_or(&[], |c| c.0.as_slice()),
        }
    }
}

/// Component `i` of a column, unless its values are invalid.
#[inline(always)]
fn valid<C: Checked>(column: Option<&[C]>, i: usize) -> Option<&C> {
    column
        .map(|column| &column[i])
        .filter(|c| c.check().is_ok())
}

/// Clears what was meant for this tick alone, after the last step of it.
pub(crate) fn clear_one_shots(clock: Res<PhysicsClock>, mut forces: Query<&mut OneShotForce>) {
    if clock.is_tick_over() {
        for mut force in &mut forces {
            *force.bypass_change_detection() = OneShotForce::default();
        }
    }
}
