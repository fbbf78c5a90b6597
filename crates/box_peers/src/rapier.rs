//! Rapier without Bevy.

use box_physics::body::RigidBox;
use box_physics::state::BodyState;
use glam::{DQuat, DVec3};
use rapier3d::prelude::*;

use crate::engine::{
    Engine, FINE, FINE_BODIES, FRICTION, Place, RESTITUTION, SLAB, Simulation, Spec,
};

/// Rapier with its default settings.
pub struct Rapier {
    /// Number of threads of its pool.
    threads: usize,
    /// `true` for more iterations of its solver, which are its substeps.
    fine: bool,
}

impl Rapier {
    /// On one thread, on all threads, and with more iterations.
    pub fn all() -> [Self; 3] {
        let all = crate::engine::all_threads();
        [(1, false), (all, false), (1, true)].map(|(threads, fine)| Self { threads, fine })
    }

    fn iterations(&self) -> usize {
        let default = IntegrationParameters::default().num_solver_iterations;
        if self.fine {
            FINE as usize * default
        } else {
            default
        }
    }
}

struct World {
    physics: PhysicsWorld,
    handles: Vec<RigidBodyHandle>,
    shapes: Vec<RigidBox>,
    steps: u32,
}

impl Engine for Rapier {
    fn id(&self) -> &'static str {
        match self.threads {
            _ if self.fine => "rapier-fine",
            1 => "rapier",
            _ => "rapier-parallel",
        }
    }

    fn name(&self) -> &'static str {
        if self.fine { "Rapier, fine" } else { "Rapier" }
    }

    fn is_timed(&self, place: Place, bodies: usize) -> bool {
        !self.fine || (place == Place::Free && bodies == FINE_BODIES)
    }

    fn version(&self) -> String {
        crate::engine::locked_version("rapier3d")
    }

    fn driven(&self) -> String {
        format!(
            "bare, without Bevy, f32, {} solver iterations",
            self.iterations()
        )
    }

    fn threads(&self) -> usize {
        self.threads
    }

    fn build(&self, spec: &Spec) -> Result<Box<dyn Simulation>, String> {
        let mut physics = PhysicsWorld::new();
        physics
            .configure_thread_pool(self.threads)
            .map_err(|e| e.to_string())?;
        physics.gravity = Vector::new(0.0, -spec.gravity, 0.0);
        physics.integration_parameters.dt = 1.0 / spec.rate as f32;
        physics.integration_parameters.num_solver_iterations = self.iterations();
        let groups = |own, other| InteractionGroups::new(own, other, InteractionTestMode::And);
        if spec.floor {
            physics.insert(
                RigidBodyBuilder::fixed().translation(Vector::new(0.0, -SLAB[1], 0.0)),
                ColliderBuilder::cuboid(SLAB[0], SLAB[1], SLAB[2])
                    .friction(FRICTION)
                    .restitution(RESTITUTION)
                    .collision_groups(groups(Group::GROUP_2, Group::GROUP_1)),
            );
        }
        let handles = spec.bodies.iter().map(|b| {
            let (half, s) = (b.shape.half_extents(), &b.start);
            let (x, q, v) = (s.position, s.rotation, s.velocity);
            let w = s.angular_velocity(&b.shape);
            let vector = |v: DVec3| Vector::new(v.x as f32, v.y as f32, v.z as f32);
            let turn = Rotation::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32);
            let body = RigidBodyBuilder::dynamic()
                .pose(Pose::from_parts(vector(x), turn))
                .linvel(vector(v))
                .angvel(vector(w));
            let collider = ColliderBuilder::cuboid(half.x as f32, half.y as f32, half.z as f32)
                .mass(b.shape.mass() as f32)
                .friction(FRICTION)
                .restitution(RESTITUTION)
                .collision_groups(groups(Group::GROUP_1, Group::GROUP_2));
            physics.insert(body, collider).0
        });
        let handles = handles.collect();
        Ok(Box::new(World {
            physics,
            handles,
            shapes: spec.bodies.iter().map(|b| b.shape).collect(),
            steps: 0,
        }))
    }
}

impl Simulation for World {
    fn step(&mut self) {
        self.physics.step();
        self.steps += 1;
    }

    fn time(&self) -> f64 {
        f64::from(self.steps) * f64::from(self.physics.integration_parameters.dt)
    }

    fn state(&self, body: usize) -> BodyState {
        let b = &self.physics.bodies[self.handles[body]];
        let (x, q, v, w) = (b.translation(), b.rotation(), b.linvel(), b.angvel());
        let vector = |v: Vector| DVec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z));
        let turn = DQuat::from_xyzw(
            f64::from(q.x),
            f64::from(q.y),
            f64::from(q.z),
            f64::from(q.w),
        );
        BodyState::at_pose(vector(x), turn)
            .with_velocity(vector(v))
            .with_angular_velocity(&self.shapes[body], vector(w))
    }
}
