//! Messages: what is asked of the physics, and what happened in it.

use bevy::ecs::entity::Entity;
use bevy::ecs::message::Message;
use glam::DVec3;

use crate::body::RigidBox;
use crate::floor::ContactPhase;
use crate::schemes::Integrator;
use crate::state::BodyState;

/// Asks for an impulse on a body at the start of the next step. Several are applied in their order of
/// arrival. Asked while paused, they wait.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct ApplyImpulse {
    /// The body.
    pub entity: Entity,
    /// Impulse J \[N s\], world axes.
    pub impulse: DVec3,
    /// Where it acts.
    pub at: ImpulsePoint,
}

/// Where an impulse acts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ImpulsePoint {
    /// At the centre of mass: no spin.
    #[default]
    Centre,
    /// At this point of the world \[m\].
    World(DVec3),
    /// At this point in body axes from the centre \[m\].
    Body(DVec3),
}

impl ApplyImpulse {
    /// At the centre of mass.
    pub fn centre(entity: Entity, impulse: impl Into<DVec3>) -> Self {
        Self {
            entity,
            impulse: impulse.into(),
            at: ImpulsePoint::Centre,
        }
    }

    /// At a point of the world \[m\].
    pub fn at_world_point(
        entity: Entity,
        impulse: impl Into<DVec3>,
        point: impl Into<DVec3>,
    ) -> Self {
        Self {
            entity,
            impulse: impulse.into(),
            at: ImpulsePoint::World(point.into()),
        }
    }

    /// At a point in body axes from the centre \[m\].
    pub fn at_body_point(
        entity: Entity,
        impulse: impl Into<DVec3>,
        point: impl Into<DVec3>,
    ) -> Self {
        Self {
            entity,
            impulse: impulse.into(),
            at: ImpulsePoint::Body(point.into()),
        }
    }

    /// Applies it to `state`.
    pub fn apply(&self, body: &RigidBox, state: &mut BodyState) {
        match self.at {
            ImpulsePoint::Centre => state.velocity += self.impulse * body.inverse_mass(),
            ImpulsePoint::World(point) => state.apply_impulse(body, self.impulse, point),
            ImpulsePoint::Body(point) => {
                state.apply_impulse_at_body_point(body, self.impulse, point);
            }
        }
    }
}

/// A corner of a body with [`ReportContacts`](super::ReportContacts) met, lay on or left the floor
/// during a step.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct FloorContact {
    /// The body.
    pub entity: Entity,
    /// Which corner: bit k is set where it lies on the positive side of body axis k.
    pub corner: u8,
    /// Where, in the world \[m\].
    pub point: DVec3,
    /// Normal impulse over the step \[N s\], ≥ 0.
    pub normal_impulse: f64,
    /// Began, persists or ended.
    pub phase: ContactPhase,
}

/// A body was quarantined: see [`Quarantined`](super::Quarantined).
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct BodyQuarantined {
    /// The body.
    pub entity: Entity,
    /// The scheme that was to step it.
    pub integrator: Integrator,
    /// Simulated time \[s\].
    pub time: f64,
}
