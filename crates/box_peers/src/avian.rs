//! Avian as a plugin in a Bevy app, its usual form.

use std::time::Duration;

use avian3d::prelude::*;
use bevy::prelude::*;
use box_physics::state::BodyState;

use crate::engine::{
    Engine, FINE, FINE_BODIES, FRICTION, Place, RESTITUTION, SLAB, Simulation, Spec,
};
use crate::in_bevy;

/// Avian with its default settings.
pub struct Avian {
    /// `true` for more substeps.
    pub fine: bool,
}

struct World {
    app: App,
    entities: Vec<Entity>,
    shapes: Vec<box_physics::body::RigidBox>,
}

/// Boxes are in the first layer and collide with the second, the floor.
const BOXES: LayerMask = LayerMask(1);
const FLOOR: LayerMask = LayerMask(2);

impl Avian {
    fn substeps(&self) -> SubstepCount {
        let default = SubstepCount::default();
        SubstepCount(if self.fine {
            FINE * default.0
        } else {
            default.0
        })
    }
}

impl Engine for Avian {
    fn id(&self) -> &'static str {
        if self.fine { "avian-fine" } else { "avian" }
    }

    fn name(&self) -> &'static str {
        if self.fine { "Avian, fine" } else { "Avian" }
    }

    fn is_timed(&self, place: Place, bodies: usize) -> bool {
        !self.fine || (place == Place::Free && bodies == FINE_BODIES)
    }

    fn version(&self) -> String {
        crate::engine::locked_version("avian3d")
    }

    fn threads(&self) -> usize {
        crate::engine::all_threads()
    }

    fn driven(&self) -> String {
        let substeps = self.substeps().0;
        format!("PhysicsPlugins in a Bevy app, f32, parallel, {substeps} substeps")
    }

    fn build(&self, spec: &Spec) -> Result<Box<dyn Simulation>, String> {
        let mut app = in_bevy::app(spec.rate, |app| {
            in_bevy::clock_fixed_post_update(app);
            app.add_plugins(PhysicsPlugins::default())
                .insert_resource(Gravity(Vec3::NEG_Y * spec.gravity))
                .insert_resource(self.substeps());
        });
        let material = (Friction::new(FRICTION), Restitution::new(RESTITUTION));
        if spec.floor {
            app.world_mut().spawn((
                RigidBody::Static,
                material,
                Collider::cuboid(2.0 * SLAB[0], 2.0 * SLAB[1], 2.0 * SLAB[2]),
                CollisionLayers::new(FLOOR, BOXES),
                Transform::from_xyz(0.0, -SLAB[1], 0.0),
            ));
        }
        let bundles: Vec<_> = spec
            .bodies
            .iter()
            .map(|b| {
                let size = (2.0 * b.shape.half_extents()).as_vec3();
                let density = b.shape.mass() as f32 / (size.x * size.y * size.z);
                let s = &b.start;
                (
                    RigidBody::Dynamic,
                    material,
                    Collider::cuboid(size.x, size.y, size.z),
                    ColliderDensity(density),
                    CollisionLayers::new(BOXES, FLOOR),
                    Transform::from_translation(s.position.as_vec3())
                        .with_rotation(s.rotation.as_quat()),
                    LinearVelocity(s.velocity.as_vec3()),
                    AngularVelocity(s.angular_velocity(&b.shape).as_vec3()),
                )
            })
            .collect();
        let entities = app.world_mut().spawn_batch(bundles).collect();
        Ok(Box::new(World {
            app,
            entities,
            shapes: spec.bodies.iter().map(|b| b.shape).collect(),
        }))
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
        let (world, entity) = (self.app.world(), self.entities[body]);
        let position = world.get::<Position>(entity).map_or(Vec3::NAN, |p| p.0);
        let rotation = world.get::<Rotation>(entity).map_or(Quat::NAN, |r| r.0);
        let v = world
            .get::<LinearVelocity>(entity)
            .map_or(Vec3::NAN, |v| v.0);
        let w = world
            .get::<AngularVelocity>(entity)
            .map_or(Vec3::NAN, |w| w.0);
        BodyState::at_pose(position.as_dvec3(), rotation.as_dquat())
            .with_velocity(v.as_dvec3())
            .with_angular_velocity(&self.shapes[body], w.as_dvec3())
    }
}
