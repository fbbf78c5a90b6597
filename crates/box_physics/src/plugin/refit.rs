//! Refits the bounding boxes of all bodies.

use bevy::app::{App, Plugin};
use bevy::ecs::change_detection::Ref;
use bevy::ecs::error::Result;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::{Query, Res, ResMut};

use super::chunks::Columns;
use super::components::WorldAabb;
use super::faults::require;
use super::parallel::{CHUNK, Done, PhysicsThreads};
use super::sets::{PhysicsSchedule, PhysicsSystems};
use super::sleeping::{Changes, Sleep, SleepClock};
use super::timing::{LapTimer, PhysicsTimings, Stage};
use super::transforms::LIGHT_PASS_DIVISOR;
use crate::aabb::{outward, world_half_extents};
use crate::body::RigidBox;
use crate::math::{VectorLoop, vectorized};
use crate::state::BodyState;

impl WorldAabb {
    /// Fits many boxes at once, with the same bits as [`WorldAabb::of`] for each. Processes four bodies at a time where
    /// the processor has AVX2. The slices must have equal lengths; entries beyond the shortest are not processed.
    pub fn fit_all(bodies: &[RigidBox], states: &[BodyState], fitted: &mut [Self]) {
        vectorized(Fit {
            bodies,
            states,
            fitted,
        });
    }
}

struct Fit<'a> {
    bodies: &'a [RigidBox],
    states: &'a [BodyState],
    fitted: &'a mut [WorldAabb],
}

impl VectorLoop for Fit<'_> {
    #[inline(always)]
    fn run(self) {
        fit_each(self.bodies, self.states, self.fitted);
    }
}

/// Writes the corners component by component. Assigning whole vectors would prevent vectorization.
#[inline(always)]
fn fit_each(bodies: &[RigidBox], states: &[BodyState], fitted: &mut [WorldAabb]) {
    for ((body, state), WorldAabb(fitted)) in bodies.iter().zip(states).zip(fitted) {
        let half = world_half_extents(state.rotation, body.half_extents());
        let (min, max) = outward(state.position, half);
        fitted.min.x = min.x;
        fitted.min.y = min.y;
        fitted.min.z = min.z;
        fitted.max.x = max.x;
        fitted.max.y = max.y;
        fitted.max.z = max.z;
    }
}

/// *Refit*: fits the bounding boxes of all awake bodies: |R|·h, rounded outward.
pub(crate) fn refit_aabbs(
    mut bodies: Query<(Ref<RigidBox>, Ref<BodyState>, &Sleep, &mut WorldAabb)>,
    clock: Res<SleepClock>,
    threads: Res<PhysicsThreads>,
    mut timings: Option<ResMut<PhysicsTimings>>,
) -> Result {
    let mut watch = LapTimer::start(timings.is_some());
    for (boxes, states, sleep, mut fitted) in bodies.contiguous_iter_mut()? {
        let (last, now) = (states.last_run_tick(), states.this_run_tick());
        let columns = (
            &*boxes,
            boxes.changed_ticks_slice(),
            &*states,
            states.changed_ticks_slice(),
            sleep,
            fitted.bypass_change_detection(),
        );
        threads.share_out(
            boxes.len() / LIGHT_PASS_DIVISOR,
            columns.chunks(0..boxes.len(), CHUNK),
            |(_, (boxes, replaced, states, written, sleep, fitted))| {
                let columns = [replaced, written];
                clock.on_awake(sleep, &Changes { columns, last, now }, |rows| {
                    let (boxes, states) = (&boxes[rows.clone()], &states[rows.clone()]);
                    WorldAabb::fit_all(boxes, states, &mut fitted[rows]);
                });
                Done
            },
        );
    }
    if let Some(timings) = &mut timings {
        timings.record_stage(Stage::Refit, watch.lap());
    }
    Ok(())
}

/// Adds a [`WorldAabb`] to every body and refits it after each step. Without this plugin, bodies have none.
#[derive(Clone, Copy, Debug, Default)]
pub struct AabbPlugin;

impl Plugin for AabbPlugin {
    fn is_unique(&self) -> bool {
        false
    }

    fn build(&self, app: &mut App) {
        if app.is_plugin_added::<Self>() {
            return;
        }
        app.register_type::<WorldAabb>();
        require::<WorldAabb, WorldAabb>(app);
        app.add_systems(PhysicsSchedule, refit_aabbs.in_set(PhysicsSystems::Refit));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};
    use proptest::prelude::*;

    fn bits(aabb: &WorldAabb) -> [u32; 6] {
        let WorldAabb(aabb) = aabb;
        let (low, high) = (aabb.min, aabb.max);
        [low.x, low.y, low.z, high.x, high.y, high.z].map(f32::to_bits)
    }

    proptest! {
        /// For any number of bodies, any attitude, near and far, the result has the bits of fitting them one by one.
        #[test]
        fn all_at_once_is_one_by_one(
            set in prop::collection::vec(
                (
                    prop::array::uniform3(1e-3..1e3_f64),
                    prop::array::uniform4(-1.0..1.0_f64),
                    prop::array::uniform3(prop_oneof![-10.0..10.0_f64, -1e30..1e30_f64, Just(0.0)]),
                ),
                1..40,
            ),
        ) {
            let bodies: Vec<_> = set
                .iter()
                .map(|(half, ..)| RigidBox::new(DVec3::from_array(*half), 1.0).expect("valid"))
                .collect();
            let states: Vec<_> = set
                .iter()
                .map(|(_, q, x)| {
                    BodyState::at_pose(DVec3::from_array(*x), DQuat::from_array(*q))
                })
                .collect();
            let mut fitted = vec![WorldAabb::default(); set.len()];
            WorldAabb::fit_all(&bodies, &states, &mut fitted);
            for ((body, state), fitted) in bodies.iter().zip(&states).zip(&fitted) {
                prop_assert_eq!(bits(fitted), bits(&WorldAabb::of(body, state)));
            }
        }
    }
}
