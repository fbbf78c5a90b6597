//! The complete plugin of this project: bounding boxes, `Transform`, diagnostics.

use std::time::Duration;

use bevy::prelude::*;
use box_physics::prelude::*;

use crate::engine::{Engine, FRICTION, Place, RESTITUTION, Simulation, Spec};
use crate::in_bevy;

/// `box_physics` with its default integrator.
pub struct Ours {
    /// `true` if impacts slower than 1 m/s do not bounce, as in Avian and Box3D.
    pub no_slow_bounces: bool,
}

struct World {
    app: App,
    entities: Vec<Entity>,
}

impl Ours {
    fn settings(&self) -> ContactSettings {
        let mut settings = ContactSettings::default();
        if self.no_slow_bounces {
            settings.restitution_threshold = 1.0;
        }
        settings
    }
}

impl Engine for Ours {
    fn id(&self) -> &'static str {
        if self.no_slow_bounces {
            "box_physics-no-slow-bounces"
        } else {
            "box_physics"
        }
    }

    fn name(&self) -> &'static str {
        if self.no_slow_bounces {
            "box_physics, slow impacts without a bounce"
        } else {
            "box_physics (split)"
        }
    }

    fn is_timed(&self, place: Place, _: usize) -> bool {
        !self.no_slow_bounces || place == Place::Landing
    }

    fn version(&self) -> String {
        crate::engine::locked_version("box_physics")
    }

    fn threads(&self) -> usize {
        crate::engine::all_threads()
    }

    fn driven(&self) -> String {
        let threshold = self.settings().restitution_threshold;
        format!("whole plugin in a Bevy app, f64, bounces from {threshold} m/s on")
    }

    fn build(&self, spec: &Spec) -> Result<Box<dyn Simulation>, String> {
        let mut app = in_bevy::app(spec.rate, |app| {
            app.add_plugins(PhysicsPlugins::default())
                .add_systems(
                    FixedPhysics,
                    (
                        in_bevy::start_clock.before(RunPhysics),
                        in_bevy::stop_clock.after(RunPhysics),
                    ),
                )
                .insert_resource(WorldGravity(DVec3::NEG_Y * f64::from(spec.gravity)));
            if spec.floor {
                app.insert_resource(Floor {
                    friction: f64::from(FRICTION),
                    restitution: f64::from(RESTITUTION),
                    ..Floor::default()
                })
                .insert_resource(self.settings());
            }
        });
        let spawned = spec.bodies.iter().map(|b| (b.shape, b.start));
        let bundles: Vec<_> = spawned.collect();
        let entities = app.world_mut().spawn_batch(bundles).collect();
        Ok(Box::new(World { app, entities }))
    }
}

impl Simulation for World {
    fn step(&mut self) {
        self.app.update();
    }

    fn time(&self) -> f64 {
        in_bevy::time(&self.app)
    }

    fn physics_time(&self) -> Option<Duration> {
        Some(in_bevy::physics_time(&self.app))
    }

    fn state(&self, body: usize) -> BodyState {
        let found = self.app.world().get::<BodyState>(self.entities[body]);
        found.copied().unwrap_or_default()
    }
}
