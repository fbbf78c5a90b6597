//! *Integrate*: steps every body that cannot touch the floor.

use bevy::ecs::change_detection::Ref;
use bevy::ecs::entity::Entity;
use bevy::ecs::error::Result;
use bevy::ecs::query::{QueryData, Without};
use bevy::ecs::system::{Query, Res, ResMut};

use super::chunks::{Columns, integrator_runs};
use super::components::{BodyIntegrator, NearFloor, Quarantined};
use super::flight::FreeFlight;
use super::forces::{ForceColumns, Step};
use super::parallel::{CHUNK, PhysicsThreads};
use super::quarantine::Quarantine;
use super::timing::{LapTimer, PhysicsTimings, Stage};
use super::transforms::PublishedPose;
use crate::body::RigidBox;
use crate::floor::FloorOutcome;
use crate::integrators::{IntegratorMemory, StepOutcome};
use crate::state::BodyState;

/// Columns of a body that a step reads and writes.
#[derive(QueryData)]
#[query_data(mutable, contiguous(mutable))]
pub(crate) struct BodyColumns {
    pub(crate) entity: Entity,
    pub(crate) body: Ref<'static, RigidBox>,
    pub(crate) forces: ForceColumns,
    pub(crate) state: &'static mut BodyState,
    pub(crate) memory: &'static mut IntegratorMemory,
    pub(crate) near: &'static mut NearFloor,
    pub(crate) published: &'static PublishedPose,
    pub(crate) own: Option<&'static BodyIntegrator>,
}

/// Result of stepping a chunk.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) bodies: u64,
    pub(crate) outcome: StepOutcome,
    pub(crate) floor: FloorOutcome,
    /// Rows of bodies whose new state was invalid. They keep their previous state.
    pub(crate) faults: Vec<usize>,
    /// Number of bodies that came to rest on the floor, or no longer rest.
    pub(crate) rest_changes: usize,
}

impl core::ops::AddAssign for Tally {
    fn add_assign(&mut self, mut other: Self) {
        self.bodies += other.bodies;
        self.outcome += other.outcome;
        self.floor += other.floor;
        self.faults.append(&mut other.faults);
        self.rest_changes += other.rest_changes;
    }
}

/// Minimum cost of a step under forces, in steps in free flight (`docs/performance.md`).
const FORCED_STEP_COST: usize = 4;

/// *Integrate*: steps every body that cannot touch the floor. The others are left to *Contact*.
pub(crate) fn integrate(
    step: Res<Step>,
    mut bodies: Query<BodyColumns, Without<Quarantined>>,
    threads: Res<PhysicsThreads>,
    mut quarantine: Quarantine,
    mut timings: Option<ResMut<PhysicsTimings>>,
) -> Result {
    let mut watch = LapTimer::start(timings.is_some());
    for mut table in bodies.contiguous_iter_mut()? {
        let (bodies, forces) = (&*table.body, &table.forces);
        let states = table.state.bypass_change_detection();
        let memories = table.memory.bypass_change_detection();
        let near = table.near.bypass_change_detection();
        for (integrator, range) in integrator_runs(step.integrator, table.own, bodies.len()) {
            let columns = (bodies, &mut *states, &mut *memories, &mut *near);
            let each = if forces.only_gravity() {
                1
            } else {
                FORCED_STEP_COST
            };
            let tally = threads.share_out(
                range.len() * each,
                columns.chunks(range, CHUNK),
                |(first, (bodies, states, memories, near))| {
                    integrator.dispatch(FreeFlight {
                        step: &step,
                        forces,
                        first,
                        bodies,
                        states,
                        memories,
                        near,
                        below: None,
                    })
                },
            );
            if let Some(timings) = &mut timings {
                let time = watch.lap();
                timings.record_stage(Stage::Integrate, time);
                timings.record_integrator(integrator, tally.bodies, time, tally.outcome);
            }
            let (entities, published) = (table.entity, table.published);
            quarantine.take(tally.faults, integrator, entities, states, published);
        }
    }
    Ok(())
}
