//! The Bevy plugin: components, resources, messages, and the schedule of one step.
//!
//! # What acts on a body
//!
//! | | |
//! |---|---|
//! | gravity | [`WorldGravity`], [`GravityScale`] |
//! | a push | the message [`ApplyImpulse`]: at the center, at a point, a torque, an explosion; at once by [`BodyMut`] |
//! | a force or torque for one tick | [`OneShotForce`] |
//! | a force or torque, constant over a step | [`ExternalForce`], [`BodyTorque`] |
//! | at points of the body, evaluated at every stage of the integrator | [`PointForces`], [`Springs`] |
//! | drag and damping, relative to the [`Wind`] | [`LinearDrag`], [`QuadraticDrag`], [`AngularDamping`], [`AngularDrag`] |
//! | anything else that depends on the state | the core, with a [`ForceModel`](crate::force::ForceModel) of your own |
//! | the floor, walls and ramps | the resource [`Floor`](crate::floor::Floor), entities with [`StaticPlane`](crate::floor::StaticPlane); [`ReportContacts`] for [`Landed`] and other messages about it; the events [`Settled`] and [`Woken`] |
//!
//! A force that no body has costs nothing.
//!
//! # One step
//!
//! [`PhysicsSchedule`] runs once a tick (once a substep) of [`FixedPhysics`], which follows `FixedPostUpdate`, or of the
//! schedule that you name. Its sets are chained; three are yours:
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
//! Order your systems against [`RunPhysics`] outside of the step. Inside it, two systems in one set that write the same must
//! be ordered, or Bevy refuses the schedule. [`PhysicsClock`] pauses and counts; slow motion is
//! `Time<Virtual>::set_relative_speed`. Each part is a plugin and can be left out: [`FloorPlugin`], [`AabbPlugin`],
//! [`PhysicsDiagnosticsPlugin`].
//!
//! # State and `Transform`
//!
//! A `Transform` given at the start says where the body starts, unless there is a `BodyState`. New bodies and states that
//! you write are shown in the same frame, paused or not. `Changed<Transform>` says that a body moved; the physics does not
//! mark `BodyState` as changed. When you write to it, do not bypass change detection: it wakes a box at rest.
//!
//! To move a body, queue the command [`Teleport`]. A `Transform` that you change teleports the body at its next step,
//! unless smoothing between steps (`bevy_transform_interpolation`) restores it first.
//!
//! # When something is wrong
//!
//! Constructors refuse invalid values. At run time nothing panics, and each fault is logged once. A body that is not finite,
//! or beyond 1e38, is [`Quarantined`] where it last was. An invalid coefficient of a body, and an invalid plane, do not act.
//! A setting out of its range stops the clock until it is corrected ([`PhysicsClock::fault`]); one that was removed is
//! restored. A hitch costs at most `Time<Virtual>::max_delta` of simulation, and what is lost is counted
//! ([`PhysicsClock::dropped`]).

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

/// Everything a game wants: one line.
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
/// To leave a part out: `PhysicsPlugins::default().build().disable::<AabbPlugin>()`; the same for
/// [`FloorPlugin`] and [`PhysicsDiagnosticsPlugin`]. Without a [`Floor`](crate::floor::Floor)
/// resource there is no contact work.
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

/// The physics itself: the schedule, the clock, bodies and forces.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// // Nothing but the physics, in a schedule of one's choice: no floor, no boxes, no timings.
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugin::in_schedule(FixedUpdate)));
/// let body = app.world_mut().spawn(RigidBox::default()).id();
/// app.update();
/// assert!(app.world().get::<BodyState>(body).is_some());
/// assert!(app.world().get::<WorldAabb>(body).is_none());
/// ```
///
/// Where it is there already, in another plugin of yours say, a second one is ignored, and so are those of its parts.
#[derive(Clone, Debug, Default)]
pub struct PhysicsPlugin {
    /// Instead of [`FixedPhysics`].
    schedule: Option<Interned<dyn ScheduleLabel>>,
}

impl PhysicsPlugin {
    /// Runs in `schedule`, with the time step that `Time` shows there.
    pub fn in_schedule(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: Some(schedule.intern()),
        }
    }
}

/// Makes [`FixedPhysics`] a part of the tick.
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
    // Bevy refuses a second unique plugin by a panic.
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
        register_types(app);
        placement::build(app);
        // A state that is lost begins again where the body is shown.
        faults::require::<BodyState, (BodyState, PublishedPose)>(app);
        faults::require::<IntegratorMemory, IntegratorMemory>(app);
        faults::require::<Transform, Transform>(app);
        faults::require::<PublishedPose, PublishedPose>(app);
        faults::require::<NearFloor, NearFloor>(app);
        faults::require::<Sleep, Sleep>(app);

        let schedule = self.schedule.unwrap_or_else(|| FixedPhysics.intern());
        // Not `add_schedule`: systems that users gave it before the plugin stay.
        app.init_schedule(PhysicsSchedule)
            .edit_schedule(PhysicsSchedule, |schedule| {
                // The systems of a step wait for each other anyway; threads share the bodies of each.
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

/// What inspectors, remote tools and scene files see.
fn register_types(app: &mut App) {
    app.register_type::<RigidBox>()
        .register_type::<BodyState>()
        .register_type::<IntegratorMemory>()
        .register_type::<BodyIntegrator>()
        .register_type::<GravityScale>()
        .register_type::<LinearDrag>()
        .register_type::<QuadraticDrag>()
        .register_type::<AngularDamping>()
        .register_type::<AngularDrag>()
        .register_type::<ExternalForce>()
        .register_type::<OneShotForce>()
        .register_type::<Explosion>()
        .register_type::<BodyTorque>()
        .register_type::<PointForces>()
        .register_type::<Springs>()
        .register_type::<Quarantined>()
        .register_type::<Wind>()
        .register_type::<BodyWind>()
        .register_type::<WorldGravity>()
        .register_type::<GlobalIntegrator>()
        .register_type::<PhysicsClock>()
        .register_type::<PhysicsThreads>()
        .register_type::<Dissipation>()
        .register_type::<Wrench>()
        .register_type::<Gravity>()
        .register_type::<ApplyImpulse>()
        .register_type::<BodyQuarantined>();
}
