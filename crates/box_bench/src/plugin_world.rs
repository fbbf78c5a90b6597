//! The plugin in an app without a window, with the same step as in a game.

use bevy::MinimalPlugins;
use bevy::app::{App, FixedFirst, FixedLast};
use bevy::ecs::schedule::{ScheduleLabel, SingleThreadedExecutor};
use bevy::ecs::system::Command;
use bevy::time::{Fixed, Time};
use box_physics::plugin::PhysicsThreads;
use box_physics::prelude::*;

use crate::bodies::Situation;

/// An app with the bodies of a situation.
pub struct PluginWorld {
    app: App,
    start: Vec<(bevy::ecs::entity::Entity, BodyState)>,
    episode: u32,
}

impl PluginWorld {
    /// Creates an app with `n` bodies under `integrator`, and runs a few warm-up steps.
    pub fn new(situation: Situation, integrator: Integrator, n: usize) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
            .insert_resource(Time::<Fixed>::from_hz(60.0))
            .insert_resource(GlobalIntegrator(integrator))
            .insert_resource(WorldGravity(situation.gravity()));
        if let Some(floor) = situation.floor() {
            app.insert_resource(floor);
        }
        // A step also runs these schedules; a single-threaded executor keeps them out of the measurement.
        for label in [FixedFirst.intern(), FixedLast.intern()] {
            app.edit_schedule(label, |schedule| {
                schedule.set_executor(SingleThreadedExecutor::new());
            });
        }
        let start = situation
            .bodies(n)
            .into_iter()
            .map(|(body, state)| (app.world_mut().spawn((body, state)).id(), state))
            .collect();
        let mut this = Self {
            app,
            start,
            episode: situation.episode(),
        };
        this.app.finish();
        this.app.cleanup();
        for _ in 0..5 {
            this.step();
        }
        this
    }

    /// Number of steps per [`call`](Self::call).
    pub fn steps_per_call(&self) -> u32 {
        self.episode.max(1)
    }

    /// Runs the measured work: one step, or an episode from its start.
    pub fn call(&mut self) {
        if self.episode > 0 {
            self.restart();
        }
        for _ in 0..self.steps_per_call() {
            self.step();
        }
    }

    /// Sets the maximum number of threads.
    pub fn use_threads(&mut self, max_threads: usize) {
        self.app
            .world_mut()
            .resource_mut::<PhysicsThreads>()
            .max_threads = max_threads;
    }

    /// Runs one step of the plugin's schedule. Then clears the world's lists of changes, as each frame of an app does.
    pub fn step(&mut self) {
        let world = self.app.world_mut();
        StepPhysics(1).apply(world);
        world.clear_trackers();
    }

    /// The app.
    pub fn app(&mut self) -> &mut App {
        &mut self.app
    }

    /// Resets every body to its initial state.
    pub fn restart(&mut self) {
        for (entity, state) in &self.start {
            if let Some(mut now) = self.app.world_mut().get_mut::<BodyState>(*entity) {
                *now = *state;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of steps after which the histories of the diagnostics (120 values) have their final size.
    const WARM: u32 = 150;

    fn allocations(world: &mut PluginWorld, steps: u64) -> u64 {
        let total = allocation_counter::measure(|| {
            for _ in 0..steps {
                world.step();
            }
        });
        total.count_total.div_ceil(steps)
    }

    #[test]
    fn a_warm_step_on_one_thread_allocates_nothing() {
        for integrator in [Integrator::Split, Integrator::Exact, Integrator::Rk4] {
            for situation in [Situation::Flight, Situation::Falling, Situation::Rest] {
                let mut world = PluginWorld::new(situation, integrator, 300);
                world.use_threads(1);
                for _ in 0..WARM {
                    world.step();
                }
                let spent = allocations(&mut world, 10);
                assert_eq!(spent, 0, "{} under {integrator}", situation.name());
            }
        }
    }

    /// From the throw to rest: impacts, contact and the events at its end.
    #[test]
    fn boxes_that_settle_allocate_nothing() {
        for integrator in Integrator::ALL {
            let mut world = PluginWorld::new(Situation::Settling, *integrator, 300);
            world.use_threads(1);
            world.call();
            world.restart();
            world.step();
            let spent = allocation_counter::measure(|| (0..200).for_each(|_| world.step()));
            assert_eq!(spent.count_total, 0, "{integrator}: {spent:?}");
        }
    }

    #[test]
    fn with_threads_allocations_do_not_depend_on_the_number_of_bodies() {
        let spent = [5_000, 50_000].map(|n| {
            let mut world = PluginWorld::new(Situation::Falling, Integrator::Split, n);
            world.use_threads(2);
            for _ in 0..WARM {
                world.step();
            }
            allocations(&mut world, 20)
        });
        // Two tasks in each of four systems, plus allocations of the pool.
        assert!(spent.iter().all(|&count| count <= 64), "{spent:?}");
    }
}
