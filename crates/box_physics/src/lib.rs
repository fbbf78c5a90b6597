//! Rigid boxes over a floor for [Bevy](https://bevyengine.org), with a live choice of the numerical
//! integrator, and a default that spins right.
//!
//! The crate is two layers. The **core** ([`body`], [`state`], [`force`], [`schemes`], [`floor`], …)
//! is plain f64 arithmetic: it knows no `World` and runs without an `App`. The **plugin**
//! ([`plugin`]) is thin: it hands the columns of the ECS to the core once per fixed step.

pub mod aabb;
pub mod body;
pub mod energy;
pub mod error;
pub mod floor;
pub mod force;
pub mod free_motion;
pub mod math;
pub mod plugin;
pub mod rotation;
pub mod schemes;
pub mod state;
pub mod translation;

/// What most users need, by name.
pub mod prelude {
    pub use crate::body::RigidBox;
    pub use crate::error::InvalidValue;
    pub use crate::floor::{ContactPhase, ContactSettings, Floor};
    pub use crate::force::{
        Dissipation, ForceLaw, Forces, Frame, Gravity, PointForce, Spring, Wrench,
    };
    pub use crate::plugin::{
        AabbPlugin, AngularDamping, AngularDrag, ApplyImpulse, BodyIntegrator, BodyQuarantined,
        BodyTorque, ExternalForce, FloorContact, GlobalIntegrator, GravityScale, ImpulsePoint,
        LinearDrag, PhysicsClock, PhysicsDiagnosticsPlugin, PhysicsPlugin, PhysicsPlugins,
        PhysicsSchedule, PhysicsSystems, PhysicsTimings, PointForces, QuadraticDrag, Quarantined,
        ReportContacts, Springs, StepPhysics, WorldAabb, WorldGravity,
    };
    pub use crate::schemes::{Integrator, SchemeMemory, StepOutcome};
    pub use crate::state::BodyState;
    pub use glam::{DQuat, DVec3};
}
