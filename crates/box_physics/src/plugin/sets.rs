//! The schedules of the physics and their sets.

use bevy::ecs::schedule::{ScheduleLabel, SystemSet};

/// Where the physics runs by default: a schedule of its own, once a tick of the fixed clock, after
/// `FixedPostUpdate` and before `FixedLast`, on one thread (to wake more for its one system would take several
/// times what a step of a hundred boxes does; the bodies are shared out within it).
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FixedPhysics;

/// The set of the one system that makes a tick, in [`FixedPhysics`] or in whatever schedule you named: what belongs
/// before or after a whole tick there is ordered against it.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn read_input() {}
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugins::in_schedule(Update)))
///     .add_systems(Update, read_input.before(RunPhysics));
/// app.update();
/// ```
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RunPhysics;

/// The schedule of one step. Systems of your own that belong to a step go here, into
/// [`PhysicsSystems::First`], [`Forces`](PhysicsSystems::Forces) or [`Last`](PhysicsSystems::Last).
///
/// Two systems here that may not run in either order are an error when the schedule is built, so that results
/// cannot depend on chance: two that write [`ExternalForce`](super::ExternalForce), say, or one outside of the sets
/// that reads what the physics writes. Order them (`.before`, `.after`, `.chain`, `.in_set`), or say `.ambiguous_with`
/// where it does not matter.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PhysicsSchedule;

/// What is done once a tick, paused or not, before its steps. On one thread: an executor of many would take
/// longer to wake them than these systems need.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct BeforeSteps;

/// The sets of [`PhysicsSchedule`], chained in this order.
///
/// A system between two of them finds what they promise.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// /// A system of a step: it runs once a step, and the state is that of `PhysicsClock::time`.
/// fn highest(clock: Res<PhysicsClock>, bodies: Query<&BodyState>, mut record: Local<f64>) {
///     for state in &bodies {
///         *record = record.max(state.position.y);
///     }
///     println!("{:.3} s: {:.3} m", clock.time(), *record);
/// }
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
///     .add_systems(PhysicsSchedule, highest.in_set(PhysicsSystems::Last));
/// app.update();
/// ```
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PhysicsSystems {
    /// Empty, for users.
    First,
    /// Teleports by `Transform` and impulses are applied.
    Impulses,
    /// Empty, for users' systems that set forces for this step; what is the same for every body is gathered after it.
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
