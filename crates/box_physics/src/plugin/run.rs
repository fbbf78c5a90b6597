//! The clock's ticks: when the schedule runs, and the single step.

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

/// One tick of the clock of this schedule. Paused, nothing moves.
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
    // Without one nothing can move: said at startup.
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

/// Command: takes this many ticks at once, paused or not: the single step. By default they are those of `Time<Fixed>`, and
/// round each of them `FixedFirst` and `FixedLast` run, but not `FixedUpdate`. Where the physics runs in a schedule
/// outside of the fixed loop ([`PhysicsPlugins::in_schedule`](super::PhysicsPlugins::in_schedule) with `Update`, say),
/// each is as long as the last tick that ran there; before the first one, as long as the present frame.
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

/// Logs once why [`StepPhysics`] does nothing.
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
        // New bodies, states that were written and impulses that were sent in this frame belong to this step.
        if let Err(error) = world.run_system_cached(show_changes::<false>) {
            warn!("box_physics: changes could not be shown: {error}");
        }
        world.run_schedule(BeforeSteps);
        for _ in 0..self.0 {
            // As around a tick of the fixed loop, so that smoothing between steps takes part: it first
            // shows the pose of the last step, which would else look like a teleport. An app without
            // these schedules needs none of it.
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
