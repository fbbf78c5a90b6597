//! The schedules of the physics and their sets.

use bevy::ecs::schedule::{ScheduleLabel, SystemSet};

/// The default schedule of the physics, run once per tick of the fixed clock, after `FixedPostUpdate` and before
/// `FixedLast`.
///
/// It is single-threaded: waking threads for its only system would take several times as long as a step of a hundred
/// boxes. The bodies are distributed over threads within that system.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FixedPhysics;

/// The set of the system that runs a tick, in [`FixedPhysics`] or in the schedule of your choice. Order systems that
/// must run before or after a whole tick against it.
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

/// The schedule of one step. Add your own systems to [`PhysicsSystems::First`], [`Forces`](PhysicsSystems::Forces) or
/// [`Last`](PhysicsSystems::Last).
///
/// Two systems here with an ambiguous order are an error when the schedule is built, so that results cannot depend on
/// chance. Examples are two systems that write [`ExternalForce`](super::ExternalForce), or one outside of the sets that
/// reads what the physics writes. Order them (`.before`, `.after`, `.chain`, `.in_set`), or use `.ambiguous_with` if
/// the order does not matter.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PhysicsSchedule;

/// Runs once per tick before its steps, even when paused. Single-threaded: waking threads would take longer than these
/// systems.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct BeforeSteps;

/// The sets of [`PhysicsSchedule`], chained in this order.
///
/// A system between two sets can rely on the results of the first.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// /// Runs once per step; the state belongs to `PhysicsClock::time`.
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
    /// Empty; for your systems.
    First,
    /// Applies teleports (changed `Transform`s) and impulses.
    Impulses,
    /// Empty; for your systems that set forces for this step. The data that all bodies share is gathered after it.
    Forces,
    /// Steps bodies in free flight.
    Integrate,
    /// Steps bodies at the floor.
    Contact,
    /// Refits bounding boxes.
    Refit,
    /// Writes `Transform`s.
    Writeback,
    /// Empty; for your systems.
    Last,
}
