//! Quarantine: bodies with an invalid state are frozen at their last valid pose. Other bodies are not affected.

use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::entity::Entity;
use bevy::ecs::message::{MessageReader, MessageWriter};
use bevy::ecs::query::With;
use bevy::ecs::system::{Commands, Local, Query, Res, SystemParam};
use log::warn;

use super::components::Quarantined;
use super::messages::{BodyQuarantined, QuarantineCause};
use super::resources::PhysicsClock;
use super::transforms::PublishedPose;
use crate::body::RigidBox;
use crate::integrators::Integrator;
use crate::state::BodyState;

/// System parameter for quarantining bodies.
#[derive(SystemParam)]
pub(crate) struct Quarantine<'w, 's> {
    clock: Res<'w, PhysicsClock>,
    commands: Commands<'w, 's>,
    messages: MessageWriter<'w, BodyQuarantined>,
}

impl Quarantine<'_, '_> {
    /// Quarantines the bodies in these rows, whose step led to an invalid state. `states` are those before that step.
    pub(crate) fn take(
        &mut self,
        mut rows: Vec<usize>,
        integrator: Integrator,
        entities: &[Entity],
        states: &mut [BodyState],
        published: &[PublishedPose],
    ) {
        let time = self.clock.time();
        // Sorted, so that the result does not depend on the threads.
        rows.sort_unstable();
        for i in rows {
            let cause = if states[i].is_valid() {
                QuarantineCause::Step
            } else {
                // The state was invalid before the step. The last displayed pose is the last valid one.
                states[i] = published[i].state_at_rest();
                QuarantineCause::State
            };
            let entity = entities[i];
            self.commands
                .entity(entity)
                .try_insert(Quarantined { time });
            self.messages.write(BodyQuarantined {
                entity,
                integrator,
                time,
                cause,
            });
        }
    }
}

/// Restores the state of a quarantined body if an invalid one was written.
pub(crate) fn guard_quarantined(
    mut bodies: Query<(&mut BodyState, &PublishedPose), (With<Quarantined>, With<RigidBox>)>,
) {
    for (mut state, published) in &mut bodies {
        if !state.is_valid() {
            *state.bypass_change_detection() = published.state_at_rest();
        }
    }
}

/// Maximum number of log lines about quarantines, so that many invalid bodies cannot flood the log.
const MAX_QUARANTINE_LINES: u32 = 10;

/// Logs the bodies quarantined since the last tick, in one line.
pub(crate) fn report_quarantined(
    mut quarantined: MessageReader<BodyQuarantined>,
    mut lines: Local<u32>,
) {
    let mut messages = quarantined.read();
    let Some(first) = messages.next() else {
        return;
    };
    let BodyQuarantined {
        entity,
        integrator,
        time,
        cause,
    } = first;
    let others = match messages.count() {
        0 => String::new(),
        n => format!("; {n} more with it"),
    };
    if *lines == MAX_QUARANTINE_LINES {
        return;
    }
    *lines += 1;
    let end = if *lines == MAX_QUARANTINE_LINES {
        " (further quarantines are only reported as BodyQuarantined messages)"
    } else {
        ""
    };
    warn!(
        "box_physics: {entity} is quarantined at t = {time} s under {integrator}: {cause}{others}{end}"
    );
}
