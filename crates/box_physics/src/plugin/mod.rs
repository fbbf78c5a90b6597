//! The Bevy plugin: components, resources, messages, and the schedule of one step.
//!
//! # Forces and impulses
//!
//! | | |
//! |---|---|
//! | gravity | [`WorldGravity`], [`GravityScale`] |
//! | an impulse | the message [`ApplyImpulse`]: at the center, at a point, angular, an explosion; immediately with [`BodyMut`] |
//! | a force or torque for one tick | [`OneShotForce`] |
//! | a force or torque, constant over a step | [`ExternalForce`], [`BodyTorque`] |
//! | forces at points of the body, evaluated at every stage of the integrator | [`PointForces`], [`Springs`] |
//! | drag and damping, relative to the [`Wind`] | [`LinearDrag`], [`QuadraticDrag`], [`AngularDamping`], [`AngularDrag`] |
//! | any other state-dependent force | the core, with your own [`ForceModel`](crate::force::ForceModel) |
//! | the floor, walls and ramps | the resource [`Floor`](crate::floor::Floor), entities with [`StaticPlane`](crate::floor::StaticPlane); [`ReportContacts`] enables [`Landed`] and other messages; the events [`Settled`] and [`Woken`] |
//!
//! Unused kinds of force cost nothing.
//!
//! # One step
//!
//! [`PhysicsSchedule`] runs once per tick (once per substep) of [`FixedPhysics`], which follows `FixedPostUpdate`, or
//! of the schedule of your choice. Its sets are chained; three of them are empty, for your systems:
//!
//! ```text
//! FixedPhysics ─ run_physics ─┬─ paused? nothing
//!                             └─ PhysicsSchedule, once per substep:
//!   First      (yours)
//!   Impulses   take_teleports, from Transform; apply_impulses
//!   Forces     (yours: ExternalForce and the like); gather_forces
//!   Integrate  integrate: every body clear of the floor; the others are left to…
//!   Contact    contact: the same integrator, impacts located, contact forces; report_contacts
//!   Refit      refit_aabbs
//!   Writeback  write_transforms
//!   Last       (yours): the state is that of PhysicsClock::time
//! ```
//!
//! Outside of the step, order your systems against [`RunPhysics`]. Inside it, two systems in one set with conflicting
//! access must be ordered, or the schedule fails to build. [`PhysicsClock`] pauses the physics and counts the steps;
//! for slow motion use `Time<Virtual>::set_relative_speed`. These parts are plugins and can be disabled:
//! [`FloorPlugin`], [`AabbPlugin`], [`PhysicsDiagnosticsPlugin`].
//!
//! # State and `Transform`
//!
//! A new body starts at its `Transform`, unless it has a `BodyState`. New bodies and states that you write are
//! displayed in the same frame, even when paused. `Changed<Transform>` detects that a body moved; the physics does not
//! mark `BodyState` as changed. When you write to it, do not bypass change detection, which wakes a sleeping box.
//!
//! To move a body, queue the command [`Teleport`]. Changing its `Transform` teleports the body at its next step, unless
//! smoothing between steps (`bevy_transform_interpolation`) restores the `Transform` first.
//!
//! # Error handling
//!
//! Constructors reject invalid values. At run time nothing panics, and each fault is logged once. A body with values
//! that are not finite or exceed 1e38 is [`Quarantined`] at its last valid pose. Invalid coefficients and invalid
//! planes have no effect. A setting out of its range stops the clock until it is corrected ([`PhysicsClock::fault`]); a
//! setting that was removed is restored. After a hitch at most `Time<Virtual>::max_delta` is simulated, and the dropped
//! time is counted ([`PhysicsClock::dropped`]).

/// Registers types for inspectors, remote tools and scene files.
macro_rules! register {
    [$app:ident: $($Type:ty),+] => { $app$(.register_type::<$Type>())+ };
}

mod chunks;
mod components;
mod contact;
mod contacts;
mod faults;
mod flight;
mod floor;
mod forces;
#[cfg(feature = "gizmos")]
mod gizmos;
mod impulses;
mod integrate;
mod messages;
mod parallel;
mod placement;
mod quarantine;
mod queries;
mod refit;
mod resources;
mod run;
mod sets;
mod sleeping;
mod snapshot;
mod teleport;
mod timing;
mod transforms;

pub use components::{
    AngularDamping, AngularDrag, BodyIntegrator, BodyTorque, BodyWind, ExternalForce, GravityScale,
    LinearDrag, OneShotForce, PointForces, QuadraticDrag, Quarantined, ReportContacts,
    ReportPersisting, RestingSince, Springs, WorldAabb,
};
pub use floor::FloorPlugin;
#[cfg(feature = "gizmos")]
pub use gizmos::{BodyGizmos, BodyGizmosPlugin, BodyGizmosSystems};
pub use messages::{
    ApplyImpulse, BodyQuarantined, ContactPhase, Explosion, FloorContact, ImpulsePoint, Landed,
    QuarantineCause, Settled, WhilePaused, Woken,
};
pub use parallel::PhysicsThreads;
pub use queries::{
    BodyMut, BodyMutItem, BodyMutReadOnly, BodyMutReadOnlyItem, BodyRef, BodyRefItem,
};
pub use refit::AabbPlugin;
pub use resources::{GlobalIntegrator, PhysicsClock, Wind, WorldGravity};
pub use run::StepPhysics;
pub use sets::{FixedPhysics, PhysicsSchedule, PhysicsSystems, RunPhysics};
pub use snapshot::{BodySnapshot, PhysicsSnapshot};
pub use teleport::{PassPortal, Teleport};
pub use timing::{
    IntegratorTiming, PhysicsDiagnosticsPlugin, PhysicsTimings, Stage, integrator_path,
};

use bevy::app::{
    App, FixedMainScheduleOrder, FixedPostUpdate, Plugin, PluginGroup, PluginGroupBuilder,
    PreUpdate, Startup,
};
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::{
    IntoScheduleConfigs, LogLevel, ScheduleBuildSettings, ScheduleLabel, SingleThreadedExecutor,
};
use bevy::transform::components::Transform;

use self::components::NearFloor;
use self::sleeping::Sleep;
use self::transforms::PublishedPose;
use crate::body::RigidBox;
use crate::floor::{Friction, Restitution};
use crate::force::{Dissipation, Gravity, Wrench};
use crate::integrators::IntegratorMemory;
use crate::state::BodyState;

/// All plugins of the library.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
///
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
///     .insert_resource(Floor::default())
///     .add_systems(Startup, |mut commands: Commands| {
///         commands.spawn((RigidBox::default(), Transform::from_xyz(0.0, 5.0, 0.0)));
///     });
/// app.update();
/// ```
///
/// To omit a part: `PhysicsPlugins::default().build().disable::<AabbPlugin>()`; likewise [`FloorPlugin`] and
/// [`PhysicsDiagnosticsPlugin`]. Without a [`Floor`](crate::floor::Floor) or a
/// [`StaticPlane`](crate::floor::StaticPlane) there is no contact work.
#[derive(Clone, Debug, Default)]
pub struct PhysicsPlugins {
    physics: PhysicsPlugin,
}

impl PhysicsPlugins {
    /// Runs the physics in `schedule` instead of [`FixedPhysics`].
    pub fn in_schedule(schedule: impl ScheduleLabel) -> Self {
        Self {
            physics: PhysicsPlugin::in_schedule(schedule),
        }
    }
}

impl PluginGroup for PhysicsPlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(self.physics)
            .add(FloorPlugin)
            .add(AabbPlugin)
            .add(PhysicsDiagnosticsPlugin)
    }
}

/// The core plugin: the schedule, the clock, bodies and forces.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// // Only the core, in another schedule: no floor, no bounding boxes, no timings.
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugin::in_schedule(FixedUpdate)));
/// let body = app.world_mut().spawn(RigidBox::default()).id();
/// app.update();
/// assert!(app.world().get::<BodyState>(body).is_some());
/// assert!(app.world().get::<WorldAabb>(body).is_none());
/// ```
///
/// If this plugin was already added, for example by another plugin, a second one is ignored. The same holds for the
/// other plugins of the library.
#[derive(Clone, Debug, Default)]
pub struct PhysicsPlugin {
    /// The schedule that replaces [`FixedPhysics`].
    schedule: Option<Interned<dyn ScheduleLabel>>,
}

impl PhysicsPlugin {
    /// Runs the physics in `schedule`, with the time step of `Time` there.
    pub fn in_schedule(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: Some(schedule.intern()),
        }
    }
}

/// Inserts [`FixedPhysics`] into the fixed main loop.
fn add_own_schedule(app: &mut App) {
    app.init_schedule(FixedPhysics)
        .edit_schedule(FixedPhysics, |schedule| {
            schedule.set_executor(SingleThreadedExecutor::new());
        });
    let order = &mut app
        .world_mut()
        .get_resource_or_init::<FixedMainScheduleOrder>()
        .labels;
    let before = order.iter().position(|l| *l == FixedPostUpdate.intern());
    order.insert(before.map_or(order.len(), |i| i + 1), FixedPhysics.intern());
}

impl Plugin for PhysicsPlugin {
    // Bevy panics if a unique plugin is added twice.
    fn is_unique(&self) -> bool {
        false
    }

    fn build(&self, app: &mut App) {
        if app.is_plugin_added::<Self>() {
            log::warn!("box_physics: PhysicsPlugin was added twice; the second is ignored");
            return;
        }
        app.init_resource::<WorldGravity>()
            .init_resource::<GlobalIntegrator>()
            .init_resource::<PhysicsClock>()
            .init_resource::<PhysicsThreads>()
            .init_resource::<forces::Step>()
            .init_resource::<sleeping::SleepClock>()
            .init_resource::<impulses::PendingImpulses>()
            .init_resource::<transforms::LastWriteback>()
            .add_observer(transforms::LastWriteback::age)
            .add_message::<ApplyImpulse>()
            .add_message::<BodyQuarantined>();
        register![app: RigidBox, BodyState, IntegratorMemory, BodyIntegrator, GravityScale, LinearDrag, QuadraticDrag,
            AngularDamping, AngularDrag, ExternalForce, OneShotForce, Explosion, BodyTorque, PointForces, Springs,
            Quarantined, Wind, BodyWind, WorldGravity, GlobalIntegrator, PhysicsClock, PhysicsThreads, Dissipation,
            Wrench, Gravity, ApplyImpulse, BodyQuarantined];
        placement::build(app);
        // A missing state is restored from the pose at which the body is displayed.
        faults::require::<BodyState, (BodyState, PublishedPose)>(app);
        faults::require::<IntegratorMemory, IntegratorMemory>(app);
        faults::require::<Transform, Transform>(app);
        faults::require::<PublishedPose, PublishedPose>(app);
        faults::require::<NearFloor, NearFloor>(app);
        faults::require::<Sleep, Sleep>(app);

        let schedule = self.schedule.unwrap_or_else(|| FixedPhysics.intern());
        // Unlike `add_schedule`, this keeps systems that were added before this plugin.
        app.init_schedule(PhysicsSchedule)
            .edit_schedule(PhysicsSchedule, |schedule| {
                // The systems of a step run one after the other anyway; within each, the bodies are distributed over
                // threads.
                schedule.set_executor(SingleThreadedExecutor::new());
                schedule.set_build_settings(ScheduleBuildSettings {
                    ambiguity_detection: LogLevel::Error,
                    ..Default::default()
                });
            });
        app.configure_sets(
            PhysicsSchedule,
            (
                PhysicsSystems::First,
                PhysicsSystems::Impulses,
                PhysicsSystems::Forces,
                PhysicsSystems::Integrate,
                PhysicsSystems::Contact,
                PhysicsSystems::Refit,
                PhysicsSystems::Writeback,
                PhysicsSystems::Last,
            )
                .chain(),
        );
        app.add_systems(
            PhysicsSchedule,
            (
                (
                    timing::begin_step,
                    quarantine::guard_quarantined,
                    transforms::take_teleports,
                    impulses::apply_impulses,
                )
                    .chain()
                    .in_set(PhysicsSystems::Impulses),
                forces::gather_forces
                    .after(PhysicsSystems::Forces)
                    .before(PhysicsSystems::Integrate),
                integrate::integrate.in_set(PhysicsSystems::Integrate),
                (transforms::write_transforms, forces::clear_one_shots)
                    .chain()
                    .in_set(PhysicsSystems::Writeback),
            ),
        );
        app.init_schedule(sets::BeforeSteps)
            .edit_schedule(sets::BeforeSteps, |schedule| {
                schedule.set_executor(SingleThreadedExecutor::new());
            })
            .add_systems(
                sets::BeforeSteps,
                (
                    placement::show_changes::<true>,
                    faults::report_parents,
                    (
                        faults::report_invalid::<LinearDrag>,
                        faults::report_invalid::<QuadraticDrag>,
                        faults::report_invalid::<AngularDamping>,
                        faults::report_invalid::<AngularDrag>,
                        faults::report_invalid::<Springs>,
                        faults::report_invalid::<Friction>,
                        faults::report_invalid::<Restitution>,
                    ),
                    impulses::collect_impulses,
                )
                    .chain(),
            )
            .insert_resource(run::RunsIn(schedule))
            .add_systems(schedule, run::run_physics.in_set(RunPhysics));
        if self.schedule.is_none() {
            add_own_schedule(app);
        }
        app.add_systems(Startup, faults::warn_without_time);
        app.add_systems(PreUpdate, faults::count_dropped_time);
    }
}
