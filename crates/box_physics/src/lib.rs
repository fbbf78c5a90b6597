//! Rigid boxes over a floor for [Bevy](https://bevyengine.org), with a live choice of the numerical
//! integrator, and a default that spins right.
//!
//! # Quick start
//!
//! ```
//! use bevy::prelude::*;
//! use box_physics::prelude::*;
//!
//! fn main() {
//!     let mut app = App::new();
//!     app.add_plugins((MinimalPlugins, PhysicsPlugins::default())) // or DefaultPlugins, with a window
//!         .insert_resource(Floor::default()) // none, and there is no contact at all
//!         .add_systems(Startup, setup);
//!     # app.update();
//!     // app.run();
//! }
//!
//! fn setup(mut commands: Commands) -> Result {
//!     // A cube of 1 m and 1 kg, where its Transform says.
//!     commands.spawn((RigidBox::default(), Transform::from_xyz(0.0, 5.0, 0.0)));
//!     // A brick by its half-extents \[m\] and mass \[kg\], thrown and spinning.
//!     let brick = RigidBox::new(Vec3::new(0.5, 0.25, 0.125), 3.0)?;
//!     let thrown = BodyState::at(Vec3::Y * 2.0)
//!         .with_velocity(Vec3::X * 4.0)
//!         .with_angular_velocity(&brick, Vec3::new(1.5, 2.5, 1.0));
//!     commands.spawn((brick, thrown));
//!     Ok(())
//! }
//! ```
//!
//! A body is a [`RigidBox`](body::RigidBox); what else it needs comes along as required components. Its
//! motion is its [`BodyState`](state::BodyState) (f64); `Transform` is written once a step. A `Transform` given at the
//! start says where the body starts, and a `BodyState` does if there is none. Give it a mesh, or a child with one, and
//! it is on screen. New bodies and states that you write are shown in the same frame, paused or not.
//! (`Changed<Transform>` says that a body moved; the physics does not mark `BodyState` as changed. When *you* write to
//! it, do not bypass change detection: it wakes a box at rest.)
//!
//! To put a body elsewhere queue the command [`Teleport`](plugin::Teleport). A `Transform` that you change teleports
//! the body at its next step, unless smoothing between steps restores it first.
//!
//! Every component has a default and is patched in scene literals:
//!
//! ```
//! use bevy::prelude::*;
//! use box_physics::prelude::*;
//!
//! fn balloon() -> impl Scene {
//!     bsn! {
//!         RigidBox
//!         BodyState { position: DVec3 { y: 2.0 } }
//!         GravityScale(-0.1)
//!         LinearDrag(0.5)
//!         BodyIntegrator(Integrator::Split4)
//!     }
//! }
//! ```
//!
//! # What acts on it
//!
//! | | |
//! |---|---|
//! | gravity | [`WorldGravity`](plugin::WorldGravity), [`GravityScale`](plugin::GravityScale) |
//! | a push | the message [`ApplyImpulse`](plugin::ApplyImpulse): at the center, at a point, a torque, an explosion; at once by [`BodyMut`](plugin::BodyMut) |
//! | a force or torque for one tick | [`OneShotForce`](plugin::OneShotForce) |
//! | a force or torque, constant over a step | [`ExternalForce`](plugin::ExternalForce), [`BodyTorque`](plugin::BodyTorque) |
//! | at points of the body, evaluated at every stage of the integrator | [`PointForces`](plugin::PointForces), [`Springs`](plugin::Springs) |
//! | drag and damping, relative to the [`Wind`](plugin::Wind) | [`LinearDrag`](plugin::LinearDrag), [`QuadraticDrag`](plugin::QuadraticDrag), [`AngularDamping`](plugin::AngularDamping), [`AngularDrag`](plugin::AngularDrag) |
//! | anything else that depends on the state | the core, with a [`ForceModel`](force::ForceModel) of your own |
//! | the floor | the resource [`Floor`](floor::Floor); [`ReportContacts`](plugin::ReportContacts) for [`Landed`](plugin::Landed) and other messages about it; the events [`Settled`](plugin::Settled) and [`Woken`](plugin::Woken) |
//!
//! A force that no body has costs nothing.
//!
//! # One step
//!
//! [`PhysicsSchedule`](plugin::PhysicsSchedule) runs once a tick (once a substep) of
//! [`FixedPhysics`](plugin::FixedPhysics), which follows `FixedPostUpdate`, or of the schedule that you name: order
//! against [`RunPhysics`](plugin::RunPhysics) there. Its sets are chained; three are yours (two systems in one of
//! them that write the same must be ordered, or Bevy refuses the schedule):
//!
//! ```text
//! First      yours
//! Impulses   Transforms that were changed teleport, then impulses in their order of arrival
//! Forces     yours: set ExternalForce and the like
//! Integrate  bodies in free flight
//! Contact    bodies that may meet the floor
//! Refit      WorldAabb
//! Writeback  Transform
//! Last       yours: the state is that of PhysicsClock::time
//! ```
//!
//! [`PhysicsClock`](plugin::PhysicsClock) pauses and counts; [`StepPhysics`](plugin::StepPhysics) is the single
//! step; slow motion is `Time<Virtual>::set_relative_speed`. Each part is a plugin of its own and can be left
//! out: [`FloorPlugin`](plugin::FloorPlugin), [`AabbPlugin`](plugin::AabbPlugin),
//! [`PhysicsDiagnosticsPlugin`](plugin::PhysicsDiagnosticsPlugin). For smoothing between steps add
//! `bevy_transform_interpolation`; it restores `Transform` before each step, so move such a body by
//! [`Teleport`](plugin::Teleport) or its `BodyState`, not by its `Transform`.
//!
//! The feature `gizmos` draws bounding boxes, axes and contacts: `BodyGizmosPlugin`.
//!
//! # Integrators
//!
//! [`GlobalIntegrator`](plugin::GlobalIntegrator) and [`BodyIntegrator`](plugin::BodyIntegrator) choose an
//! [`Integrator`](integrators::Integrator) from the list, at any time. The default, `split`, never blows up on any
//! spin or drag; `exact` is right to rounding in free flight. What each says of itself, order by order, is in
//! its [`IntegratorInfo`](integrators::IntegratorInfo) and in the table of the README.
//!
//! # Without Bevy's `App`
//!
//! The modules [`body`], [`state`], [`force`], [`integrators`], [`floor`], … are plain f64 arithmetic and know no
//! `World`: see [`ForceModel`](force::ForceModel) for a loop of ten lines. The [`plugin`] is thin: it hands the
//! columns of the ECS to them.
//!
//! # The same bits everywhere
//!
//! Results do not depend on the run, the number of threads, the order of insertion, debug or release, or the
//! machine (no platform sine, no fused multiply-add); [`digest`] compares them, and
//! [`digest::fingerprint`] tells whether two builds compute the same. With the feature `serde` a
//! saved body continues bit for bit.
//!
//! # When something is wrong
//!
//! Constructors refuse what cannot be. At run time nothing panics, and each thing is logged once: a body that
//! is not finite, or beyond 1e38, is [`Quarantined`](plugin::Quarantined) where it last was; a setting out of its
//! range stops the clock until it is corrected ([`PhysicsClock::fault`](plugin::PhysicsClock::fault)), one that was
//! removed is restored; a hitch costs at most `Time<Virtual>::max_delta` of simulation, and what is lost is counted
//! ([`PhysicsClock::dropped`](plugin::PhysicsClock::dropped)).
//!
//! # Limits
//!
//! Boxes and one horizontal floor: no contact between boxes, no joints, no other shapes. Bodies stand at the
//! top of the hierarchy. Sizes from 1e-6 to 1e6 m, masses from 1e-12 to 1e12 kg, positions,
//! velocities and momenta within 1e38.

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

/// What most users need, by name.
pub mod prelude {
    pub use crate::body::RigidBox;
    pub use crate::error::InvalidValue;
    pub use crate::floor::{ContactReport, ContactSettings, ContactState, Floor, RestitutionLaw};
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

/// The code blocks of the guide are compiled and run.
#[cfg(all(doctest, feature = "bevy"))]
#[doc = include_str!("../../../docs/guide.md")]
struct Guide;

/// The code blocks of the page for users of Avian or Rapier are compiled and run.
#[cfg(all(doctest, feature = "bevy"))]
#[doc = include_str!("../../../docs/migration.md")]
struct Migration;
