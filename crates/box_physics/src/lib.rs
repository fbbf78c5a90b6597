//! Rigid-body simulation of boxes with a floor, walls and ramps, for [Bevy](https://bevyengine.org).
//!
//! The numerical integrator is selectable at run time; the default is exact in free flight. The state is f64;
//! `Transform` remains f32.
//!
//! ```
//! use bevy::prelude::*;
//! use box_physics::prelude::*;
//!
//! fn main() {
//!     let mut app = App::new();
//!     app.add_plugins((MinimalPlugins, PhysicsPlugins::default())) // or DefaultPlugins, with a window
//!         .insert_resource(Floor::default()) // without it there is no contact
//!         .add_systems(Startup, setup);
//!     # app.update();
//!     // app.run();
//! }
//!
//! fn setup(mut commands: Commands) -> Result {
//!     // A cube of 1 m and 1 kg, placed by its Transform.
//!     commands.spawn((RigidBox::default(), Transform::from_xyz(0.0, 5.0, 0.0)));
//!     // A brick given by its half-extents \[m\] and mass \[kg\], thrown and spinning.
//!     let brick = RigidBox::new(Vec3::new(0.5, 0.25, 0.125), 3.0)?;
//!     let thrown = BodyState::at(Vec3::Y * 2.0)
//!         .with_velocity(Vec3::X * 4.0)
//!         .with_angular_velocity(&brick, Vec3::new(1.5, 2.5, 1.0));
//!     commands.spawn((brick, thrown));
//!     Ok(())
//! }
//! ```
//!
//! A body is an entity with a [`RigidBox`](body::RigidBox). Its other components are required components and are
//! inserted automatically. Its motion is a [`BodyState`](state::BodyState); `Transform` is written once per step.
//!
//! | to | see |
//! |---|---|
//! | push, pull and brake bodies; systems in a step; faults | the module [`plugin`] |
//! | set up a floor, walls and ramps, react to landings and rest | [`Floor`](floor::Floor), [`StaticPlane`](floor::StaticPlane), [`Landed`](plugin::Landed), [`Settled`](plugin::Settled) |
//! | move a body directly | [`Teleport`](plugin::Teleport), [`BodyMut`](plugin::BodyMut) |
//! | pause, step once, slow down | [`PhysicsClock`](plugin::PhysicsClock), [`StepPhysics`](plugin::StepPhysics) |
//! | rewind, roll back, save | [`PhysicsSnapshot`](plugin::PhysicsSnapshot) |
//! | choose the integrator | [`GlobalIntegrator`](plugin::GlobalIntegrator), [`BodyIntegrator`](plugin::BodyIntegrator), the module [`integrators`] |
//! | compare runs, builds and machines | the module [`digest`]: results are the same bits everywhere |
//! | use the core without Bevy | [`ForceModel`](force::ForceModel): a loop of ten lines |
//!
//! The guide in the repository (`docs/guide.md`) covers each of these, and also dice, debris, replays, netcode and
//! saving.
//!
//! Features: `bevy` (default) provides the plugin; without it, the crate depends only on `glam` and `libm`. `gizmos`
//! draws bounding boxes, axes and contacts. `serde` makes bodies serializable; a loaded body continues bit for bit.
//!
//! Limits: boxes, a floor and planes; no contact between boxes, no joints, no other shapes. Sizes from 1e-6 to 1e6 m,
//! masses from 1e-12 to 1e12 kg, positions, velocities and momenta within 1e38.

pub mod aabb;
pub mod body;
pub mod digest;
#[cfg(feature = "bevy")]
mod ecs;
pub mod energy;
pub mod error;
pub mod floor;
pub mod force;
pub mod free_motion;
pub mod integrators;
pub mod math;
#[cfg(feature = "bevy")]
pub mod plugin;
pub mod rotation;
pub mod state;
pub mod translation;

/// The types that most users need.
pub mod prelude {
    pub use crate::body::RigidBox;
    pub use crate::error::InvalidValue;
    pub use crate::floor::{
        CoefficientCombine, ContactReport, ContactSettings, ContactState, Floor, Friction,
        Restitution, RestitutionLaw, StaticPlane,
    };
    pub use crate::force::{Dissipation, ForceModel, Frame, PointForce, Spring, Wrench};
    pub use crate::integrators::{Integrator, IntegratorMemory, StepOutcome};
    #[cfg(feature = "bevy")]
    pub use crate::plugin::{
        AabbPlugin, AngularDamping, AngularDrag, ApplyImpulse, BodyIntegrator, BodyMut,
        BodyQuarantined, BodyRef, BodySnapshot, BodyTorque, BodyWind, ContactPhase, Explosion,
        ExternalForce, FixedPhysics, FloorContact, FloorPlugin, GlobalIntegrator, GravityScale,
        ImpulsePoint, Landed, LinearDrag, OneShotForce, PassPortal, PhysicsClock,
        PhysicsDiagnosticsPlugin, PhysicsPlugin, PhysicsPlugins, PhysicsSchedule, PhysicsSnapshot,
        PhysicsSystems, PhysicsThreads, PhysicsTimings, PointForces, QuadraticDrag,
        QuarantineCause, Quarantined, ReportContacts, ReportPersisting, RestingSince, RunPhysics,
        Settled, Springs, StepPhysics, Teleport, WhilePaused, Wind, Woken, WorldAabb, WorldGravity,
    };
    pub use crate::state::BodyState;
    pub use glam::{DQuat, DVec3};
}
