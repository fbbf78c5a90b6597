//! *Forces*: gathers everything that acts on the bodies during a step. The integrators evaluate the state-dependent
//! forces.

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

/// Data of a step that all bodies share.
#[derive(Resource, Default)]
pub(crate) struct Step {
    /// Step size \[s\].
    pub(crate) h: f64,
    /// Simulated time at the end of the step \[s\].
    pub(crate) time: f64,
    /// Gravity [m/s²].
    pub(crate) gravity: DVec3,
    /// Velocity of the air [m/s].
    pub(crate) wind: DVec3,
    /// The integrator of bodies without their own.
    pub(crate) integrator: Integrator,
    pub(crate) floor: Option<Floor>,
    /// The floor and all static planes. Empty if there are no static planes.
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
    /// Returns `true` if there is a floor or a plane.
    pub(crate) fn has_contact(&self) -> bool {
        self.floor.is_some() || !self.planes.is_empty()
    }

    /// Returns `true` if a body may touch the floor or a plane in this step.
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

/// Gathers the data of a step that all bodies share.
pub(crate) fn gather_forces(
    mut step: ResMut<Step>,
    clock: Res<PhysicsClock>,
    (gravity, wind): (Res<WorldGravity>, Option<Res<Wind>>),
    integrator: Res<GlobalIntegrator>,
    floor: Option<Res<Floor>>,
    (settings, contact): (Option<Res<ContactSettings>>, Option<Res<ContactEnabled>>),
    statics: Query<PlaneEntity, Without<RigidBox>>,
) {
    // Without its plugin, a floor has no effect.
    let floor = floor.filter(|_| contact.is_some()).map(|floor| *floor);
    let mut planes = core::mem::take(&mut step.planes);
    planes.clear();
    if contact.is_some() && !statics.is_empty() {
        let mut shapes: Vec<_> = statics.iter().collect();
        // Usually the order of spawning. Query order would depend on which components the planes have.
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

/// Columns of all forces that may act on a body.
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
    /// Returns `true` if every body of this table is subject only to the same gravity.
    pub(crate) fn only_uniform_gravity(&self) -> bool {
        self.only_gravity() && !self.scales_gravity()
    }

    /// Returns `true` if no force other than gravity acts on any body of this table.
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

    /// Acceleration due to gravity of body `i` [m/s²].
    #[inline(always)]
    pub(crate) fn gravity(&self, i: usize, world: DVec3) -> DVec3 {
        match self.gravity_scale {
            Some(scales) => world * scales[i].0,
            None => world,
        }
    }

    /// Returns `true` if gravity differs between bodies of this table.
    pub(crate) fn scales_gravity(&self) -> bool {
        self.gravity_scale.is_some()
    }

    /// The complete force model of body `i`.
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

/// Component `i` of a column, if its values are valid.
#[inline(always)]
fn valid<C: Checked>(column: Option<&[C]>, i: usize) -> Option<&C> {
    column
        .map(|column| &column[i])
        .filter(|c| c.check().is_ok())
}

/// Clears one-shot forces after the last step of the tick.
pub(crate) fn clear_one_shots(clock: Res<PhysicsClock>, mut forces: Query<&mut OneShotForce>) {
    if clock.is_tick_over() {
        for mut force in &mut forces {
            *force.bypass_change_detection() = OneShotForce::default();
        }
    }
}
