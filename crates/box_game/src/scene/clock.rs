//! The clock: speed, pause and step size.

use core::time::Duration;

use bevy::prelude::*;
use box_physics::prelude::PhysicsClock;

use super::session::Session;
use crate::action::Action;
use crate::parameters::SPEEDS;

pub(crate) fn on_action(
    action: On<Action>,
    session: Res<Session>,
    mut clock: ResMut<PhysicsClock>,
    mut commands: Commands,
) {
    let now = session.speed;
    if *action == Action::TogglePause {
        clock.paused ^= true;
    }
    let speed = match *action {
        Action::SetSpeed(speed) => Some(speed),
        Action::Slower => SPEEDS.into_iter().rfind(|&s| s < now * 0.999),
        Action::Faster => SPEEDS.into_iter().find(|&s| s > now * 1.001),
        _ => None,
    };
    if let Some(speed) = speed {
        commands.queue(move |world: &mut World| set_speed(world, speed));
    }
}

/// Sets the target speed, within its ladder.
pub(crate) fn set_speed(world: &mut World, speed: f64) {
    if !speed.is_finite() {
        return;
    }
    let speed = speed.clamp(SPEEDS[0], SPEEDS[SPEEDS.len() - 1]);
    world.resource_mut::<Session>().speed = speed;
    let mut time = world.resource_mut::<Time<Virtual>>();
    time.set_relative_speed_f64(speed);
}

/// Sets the step and substeps of the clocks to those of the session.
pub(crate) fn set_step(world: &mut World) {
    let parameters = world.resource::<Session>().parameters;
    world
        .resource_mut::<Time<Fixed>>()
        .set_timestep(Duration::from_secs_f64(parameters.step));
    world.resource_mut::<PhysicsClock>().substeps = parameters.substeps();
}
