//! Ticks of the clock: when the schedule runs, and single steps.

use std::sync::Once;

use bevy::app::{FixedFirst, FixedLast, FixedMainScheduleOrder};
use bevy::ecs::intern::Interned;
use bevy::ecs::message::Messages;
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::ecs::system::Command;
use bevy::ecs::world::World;
use bevy::time::{Fixed, Time};
use log::warn;

use super::faults::{restore_resources, settings_are_valid};
use super::messages::BodyQuarantined;
use super::placement::{Unsmoothed, show_changes};
use super::quarantine::report_quarantined;
use super::resources::PhysicsClock;
use super::sets::{BeforeSteps, PhysicsSchedule};

/// Runs one tick of the schedule's clock. While paused, nothing moves.
pub(crate) fn run_physics(world: &mut World) {
    restore_resources(world);
    Unsmoothed::begin_tick(world);
    world.run_schedule(BeforeSteps);
    advance(world);
    // Usually empty.
    let quarantined = world.get_resource::<Messages<BodyQuarantined>>();
    if quarantined.is_some_and(|messages| !messages.is_empty())
        && let Err(error) = world.run_system_cached(report_quarantined)
    {
        warn!("box_physics: quarantines could not be reported: {error}");
    }
}

fn advance(world: &mut World) {
    if world.resource::<PhysicsClock>().paused {
        return;
    }
    // There is no `Time`, which was logged at startup.
    let Some(time) = world.get_resource::<Time>() else {
        return;
    };
    let delta = time.delta();
    tick(world, delta);
}

/// Runs one tick of `delta`, divided into the clock's substeps. A tick of zero changes nothing.
fn tick(world: &mut World, delta: core::time::Duration) {
    if delta.is_zero() || !settings_are_valid(world) {
        return;
    }
    let substeps = world.resource::<PhysicsClock>().substeps.max(1);
    for _ in 0..substeps {
        let mut clock = world.resource_mut::<PhysicsClock>();
        clock.begin_step(delta, substeps);
        world.run_schedule(PhysicsSchedule);
    }
}

/// The schedule in which the physics runs.
#[derive(Resource)]
pub(crate) struct RunsIn(pub(crate) Interned<dyn ScheduleLabel>);

/// Command: runs this number of ticks immediately, even when paused.
///
/// By default the ticks have the length of `Time<Fixed>`. `FixedFirst` and `FixedLast` run around each of them, but
/// `FixedUpdate` does not. If the physics runs outside of the fixed loop (for example
/// [`PhysicsPlugins::in_schedule`](super::PhysicsPlugins::in_schedule) with `Update`), each tick has the length of the
/// last tick there, or of the current frame if there was none.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn on_step_button(mut commands: Commands) {
///     commands.queue(StepPhysics(1));
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepPhysics(pub u32);

/// Logs once why [`StepPhysics`] has no effect.
fn cannot_step(what: &str) {
    static SAID: Once = Once::new();
    SAID.call_once(|| warn!("box_physics: StepPhysics needs {what}"));
}

impl Command for StepPhysics {
    type Out = ();

    fn apply(self, world: &mut World) {
        let Some(RunsIn(schedule)) = world.get_resource() else {
            return cannot_step("PhysicsPlugin");
        };
        let fixed = world
            .get_resource::<FixedMainScheduleOrder>()
            .is_some_and(|order| order.labels.contains(schedule));
        let delta = if fixed {
            world.get_resource::<Time<Fixed>>().map(Time::timestep)
        } else {
            let last = world.get_resource().map(PhysicsClock::tick);
            last.filter(|tick| !tick.is_zero())
                .or_else(|| world.get_resource::<Time>().map(Time::delta))
        };
        let Some(delta) = delta else {
            return cannot_step("`Time<Fixed>` (TimePlugin)");
        };
        restore_resources(world);
        // Includes new bodies, written states and impulses sent in this frame.
        if let Err(error) = world.run_system_cached(show_changes::<false>) {
            warn!("box_physics: changes could not be shown: {error}");
        }
        world.run_schedule(BeforeSteps);
        for _ in 0..self.0 {
            // The same as around a tick of the fixed loop, so that smoothing between steps takes part: it first
            // restores the pose of the last step, which would otherwise look like a teleport. An app without these
            // schedules needs neither.
            if fixed {
                let _ = world.try_run_schedule(FixedFirst);
            }
            Unsmoothed::begin_tick(world);
            tick(world, delta);
            if fixed {
                let _ = world.try_run_schedule(FixedLast);
            }
        }
    }
}
