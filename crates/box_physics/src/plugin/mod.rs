//! The Bevy plugin: components, resources, messages, and the schedule of one step.
//!
//! ```text
//! FixedPostUpdate ─ run_physics ─┬─ paused? nothing
//!                                └─ PhysicsSchedule, once per substep:
//!   First      (yours)
//!   Impulses   teleports taken from Transform, then the impulses asked for
//!   Forces     (yours: ExternalForce and the like)
//!   Integrate  every body clear of the floor: one scheme step; the others are left to…
//!   Contact    …this: the same scheme, impacts located, contact forces
//!   Refit      world bounding boxes
//!   Writeback  Transform, where it changed
//!   Last       (yours)
//! ```

mod columns;
mod components;
mod intake;
mod messages;
mod parallel;
mod resources;
mod run;
mod step;
mod systems;
mod timing;

pub use components::{
    AngularDamping, AngularDrag, BodyIntegrator, BodyTorque, ExternalForce, GravityScale,
    LinearDrag, PointForces, QuadraticDrag, Quarantined, ReportContacts, Springs, WorldAabb,
};
pub(crate) use components::{NearFloor, WrittenTransform};
pub use messages::{ApplyImpulse, BodyQuarantined, FloorContact, ImpulsePoint};
pub use parallel::PhysicsThreads;
pub use resources::{GlobalIntegrator, PhysicsClock, WorldGravity};
pub use run::StepPhysics;
pub use timing::{PhysicsDiagnosticsPlugin, PhysicsTimings, SchemeTiming, Stage, scheme_path};

use bevy::app::{App, FixedPostUpdate, Plugin, PluginGroup, PluginGroupBuilder};
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::{
    IntoScheduleConfigs, LogLevel, Schedule, ScheduleBuildSettings, ScheduleLabel,
    SingleThreadedExecutor, SystemSet,
};

use crate::body::RigidBox;
use crate::floor::{ContactSettings, ContactState, Floor};
use crate::state::BodyState;

/// The schedule of one step. Systems of your own that belong to a step go here, into
/// [`PhysicsSystems::First`], [`Forces`](PhysicsSystems::Forces) or [`Last`](PhysicsSystems::Last).
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PhysicsSchedule;

/// The sets of [`PhysicsSchedule`], chained in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PhysicsSystems {
    /// Empty, for users.
    First,
    /// Teleports and impulses are taken over.
    Impulses,
    /// Empty but for users' systems that set forces for this step.
    Forces,
    /// Bodies in free flight are stepped.
    Integrate,
    /// Bodies at the floor are stepped.
    Contact,
    /// Bounding boxes are re-fitted.
    Refit,
    /// `Transform` is written.
    Writeback,
    /// Empty, for users.
    Last,
}

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
/// [`PhysicsDiagnosticsPlugin`]. Without a [`Floor`] resource there is no contact work.
#[derive(Clone, Debug, Default)]
pub struct PhysicsPlugins {
    physics: PhysicsPlugin,
}

impl PhysicsPlugins {
    /// Runs the physics in `schedule` instead of `FixedPostUpdate`.
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
            .add(AabbPlugin)
            .add(PhysicsDiagnosticsPlugin)
    }
}

/// The physics itself: the schedule, the clock, bodies, forces, floor.
#[derive(Clone, Debug)]
pub struct PhysicsPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl Default for PhysicsPlugin {
    fn default() -> Self {
        Self::in_schedule(FixedPostUpdate)
    }
}

impl PhysicsPlugin {
    /// Runs in `schedule`, with the time step that `Time` shows there.
    pub fn in_schedule(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl Plugin for PhysicsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<WorldGravity>()
            .init_resource::<GlobalIntegrator>()
            .init_resource::<PhysicsClock>()
            .init_resource::<PhysicsThreads>()
            .init_resource::<ContactSettings>()
            .init_resource::<intake::PendingImpulses>()
            .add_message::<ApplyImpulse>()
            .add_message::<FloorContact>()
            .add_message::<BodyQuarantined>()
            .register_type::<BodyState>()
            .register_type::<BodyIntegrator>()
            .register_type::<GravityScale>()
            .register_type::<LinearDrag>()
            .register_type::<QuadraticDrag>()
            .register_type::<AngularDamping>()
            .register_type::<AngularDrag>()
            .register_type::<ExternalForce>()
            .register_type::<BodyTorque>()
            .register_type::<PointForces>()
            .register_type::<Springs>()
            .register_type::<WorldAabb>()
            .register_type::<ReportContacts>()
            .register_type::<Quarantined>()
            .register_type::<WorldGravity>()
            .register_type::<GlobalIntegrator>()
            .register_type::<PhysicsClock>()
            .register_type::<PhysicsThreads>()
            .register_type::<Floor>();
        app.register_required_components::<RigidBox, ContactState>();

        let mut schedule = Schedule::new(PhysicsSchedule);
        // The systems of a step wait for each other anyway; threads share the bodies of each.
        schedule.set_executor(SingleThreadedExecutor::new());
        schedule.set_build_settings(ScheduleBuildSettings {
            ambiguity_detection: LogLevel::Error,
            ..Default::default()
        });
        app.add_schedule(schedule);
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
                    intake::take_teleports,
                    intake::apply_impulses,
                )
                    .chain()
                    .in_set(PhysicsSystems::Impulses),
                systems::integrate.in_set(PhysicsSystems::Integrate),
                systems::contact.in_set(PhysicsSystems::Contact),
                systems::write_transforms.in_set(PhysicsSystems::Writeback),
            ),
        );
        app.add_systems(
            self.schedule,
            (
                intake::place_new_bodies,
                intake::collect_impulses,
                run::run_physics,
            )
                .chain(),
        );
    }
}

/// Re-fits a [`WorldAabb`] on every body after each step. Leave it out and bodies have none.
#[derive(Clone, Copy, Debug, Default)]
pub struct AabbPlugin;

impl Plugin for AabbPlugin {
    fn build(&self, app: &mut App) {
        app.register_required_components::<RigidBox, WorldAabb>();
        app.add_systems(
            PhysicsSchedule,
            systems::refit_aabbs.in_set(PhysicsSystems::Refit),
        );
    }
}
