//! The main box and what acts on it, as the comparison reads them from the world.

use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use box_physics::floor::{ContactSettings, ContactState};
use box_physics::prelude::{
    AngularDamping, AngularDrag, BodyIntegrator, BodyState, BodyTorque, DVec3, ExternalForce,
    Floor, GlobalIntegrator, GravityScale, Integrator, LinearDrag, PhysicsClock, PointForces,
    QuadraticDrag, RigidBox, Springs, WorldGravity,
};
use box_scenarios::{ForceSet, Model, ReferenceSolution};

use super::Comparison;
use crate::scene::session::{MainBox, Session};

/// What may act on the main box.
#[derive(QueryData)]
pub(super) struct MainBoxForces {
    scale: Option<&'static GravityScale>,
    linear_drag: Option<&'static LinearDrag>,
    quadratic_drag: Option<&'static QuadraticDrag>,
    angular_damping: Option<&'static AngularDamping>,
    angular_drag: Option<&'static AngularDrag>,
    external: Option<&'static ExternalForce>,
    body_torque: Option<&'static BodyTorque>,
    point_forces: Option<&'static PointForces>,
    springs: Option<&'static Springs>,
}

impl MainBoxForcesItem<'_, '_> {
    /// The same as the plugin gives its bodies.
    fn set(&self, gravity: DVec3) -> ForceSet {
        let external = self.external.copied().unwrap_or_default();
        ForceSet {
            gravity: self.scale.map_or(gravity, |s| gravity * s.0),
            force: external.force,
            linear_drag: self.linear_drag.map_or(0.0, |c| c.0),
            quadratic_drag: self.quadratic_drag.map_or(0.0, |c| c.0),
            angular_damping: self.angular_damping.map_or(0.0, |c| c.0),
            angular_drag: self.angular_drag.map_or(0.0, |c| c.0),
            body_torque: self.body_torque.map(|c| c.0).unwrap_or_default(),
            world_torque: external.torque,
            point_forces: self.point_forces.map(|c| c.0.clone()).unwrap_or_default(),
            springs: self.springs.map(|c| c.0.clone()).unwrap_or_default(),
        }
    }
}

/// The main box and what it is in.
#[derive(SystemParam)]
pub(crate) struct Scene<'w, 's> {
    main_box: Query<
        'w,
        's,
        (
            Entity,
            &'static RigidBox,
            &'static BodyState,
            MainBoxForces,
            Option<&'static BodyIntegrator>,
            Option<&'static ContactState>,
        ),
        With<MainBox>,
    >,
    gravity: Res<'w, WorldGravity>,
    floor: Option<Res<'w, Floor>>,
    settings: Option<Res<'w, ContactSettings>>,
    integrator: Res<'w, GlobalIntegrator>,
    pub(super) clock: Res<'w, PhysicsClock>,
    fixed: Option<Res<'w, Time<Fixed>>>,
    session: Option<Res<'w, Session>>,
}

impl Scene<'_, '_> {
    /// (entity, state, law, integrator) of the first main box.
    pub(super) fn main_box(&self) -> Option<(Entity, BodyState, Model, Integrator)> {
        let (entity, body, state, forces, own, _) = self.main_box.iter().next()?;
        let law = Model {
            body: *body,
            forces: forces.set(self.gravity.0),
            floor: self.floor.as_deref().copied(),
            tray: self.tray(),
            settings: self.settings.as_deref().cloned().unwrap_or_default(),
        };
        let integrator = own.map_or(self.integrator.0, |own| own.0);
        Some((entity, *state, law, integrator))
    }

    /// From the middle of the scene's tray to its walls \[m\]; 0 without.
    fn tray(&self) -> f64 {
        let session = self.session.as_deref();
        let floor = session.and_then(|session| session.scenario.setup.floor);
        floor.map_or(0.0, |floor| floor.tray)
    }

    /// Corners of the first main box at the floor.
    pub(super) fn contacts(&self) -> u32 {
        let contact = self.main_box.iter().next().and_then(|main_box| main_box.5);
        contact.map_or(0, |c| c.touching().count_ones())
    }

    /// The clock's (sub)step \[s\].
    pub(super) fn step(&self) -> f64 {
        let substeps = f64::from(self.clock.substeps.max(1));
        match &self.fixed {
            Some(fixed) => fixed.timestep().as_secs_f64() / substeps,
            None => self.clock.step(),
        }
    }

    /// Begins a new run where there is a new main box. A session knows the scene; otherwise it is what the
    /// main box's components say.
    pub(super) fn begin(
        &self,
        comparison: &mut Comparison,
        new: (Entity, BodyState, &Model, Integrator),
    ) {
        let (entity, state, law, integrator) = new;
        if comparison.main_box == Some(entity) {
            return;
        }
        comparison.main_box = Some(entity);
        let step = self.step();
        match &self.session {
            Some(session) => {
                let scene = (session.scenario.id, session.scenario.recommended());
                let (setup, truth) = (session.setup(), session.truth.clone());
                comparison.begin(Some(scene), &setup, truth, integrator, step);
            }
            None => {
                let setup = law.setup(state, 3600.0);
                let truth = ReferenceSolution::closed_form(&setup);
                comparison.begin(None, &setup, truth, integrator, step);
            }
        }
    }
}
