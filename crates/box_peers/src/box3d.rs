//! Box3D through the crate `boxddd`, bare, without Bevy.

use bevy_boxddd::boxddd::{
    BodyId, BodyType, BoxHull, Error, Filter, Foundation, Quat, Vec3, World,
};
use box_physics::body::RigidBox;
use box_physics::state::BodyState;
use glam::{DQuat, DVec3};

use crate::engine::{
    Engine, FINE, FINE_BODIES, FRICTION, Place, RESTITUTION, SLAB, Simulation, Spec,
};

/// Box3D with its default settings.
pub struct Box3d {
    foundation: &'static Foundation,
    workers: u32,
    /// Uses more substeps.
    fine: bool,
}

impl Box3d {
    /// Starts the library once. Returns engines with one worker, with one worker per thread, and with one worker and
    /// more substeps.
    ///
    /// # Errors
    /// An error message of the library.
    pub fn all() -> Result<Vec<Self>, String> {
        let foundation = Foundation::initialize_default().map_err(|e| e.to_string())?;
        let threads = crate::engine::all_threads() as u32;
        let all = [(1, false), (threads, false), (1, true)].map(|(workers, fine)| Self {
            foundation,
            workers,
            fine,
        });
        Ok(all.into())
    }

    fn substeps(&self) -> i32 {
        if self.fine {
            FINE as i32 * SUBSTEPS
        } else {
            SUBSTEPS
        }
    }

    fn world(&self, spec: &Spec) -> Result<Running, Error> {
        let f = self.foundation;
        let gravity = Vec3::new(0.0, -spec.gravity, 0.0);
        let mut world = f.create_world(
            f.world_def_builder()
                .gravity(gravity)
                .worker_count(self.workers)
                .build()?,
        )?;
        let filter = |own, other| Filter {
            category_bits: own,
            mask_bits: other,
            group_index: 0,
        };
        if spec.floor {
            let ground = f.body_def_builder().position([0.0, -SLAB[1], 0.0]);
            let ground = world.create_body(ground.build()?)?;
            let shape = f.shape_def_builder().filter(filter(2, 1));
            let shape = shape.friction(FRICTION).restitution(RESTITUTION).build()?;
            let hull = BoxHull::new(SLAB[0], SLAB[1], SLAB[2])?;
            world.create_hull_shape(ground, &shape, &hull)?;
        }
        let mut bodies = Vec::new();
        for b in spec.bodies {
            let (half, s) = (b.shape.half_extents().as_vec3(), &b.start);
            let (x, q, v) = (
                s.position.as_vec3(),
                s.rotation.as_quat(),
                s.velocity.as_vec3(),
            );
            let w = s.angular_velocity(&b.shape).as_vec3();
            let body = f
                .body_def_builder()
                .body_type(BodyType::Dynamic)
                .position(x.to_array())
                .rotation(Quat::new(Vec3::new(q.x, q.y, q.z), q.w))
                .linear_velocity(v.to_array())
                .angular_velocity(w.to_array());
            let body = world.create_body(body.build()?)?;
            let density = b.shape.mass() as f32 / (8.0 * half.x * half.y * half.z);
            let shape = f.shape_def_builder().density(density).filter(filter(1, 2));
            let shape = shape.friction(FRICTION).restitution(RESTITUTION);
            let hull = BoxHull::new(half.x, half.y, half.z)?;
            world.create_hull_shape(body, &shape.build()?, &hull)?;
            bodies.push(body);
        }
        Ok(Running {
            world,
            bodies,
            shapes: spec.bodies.iter().map(|b| b.shape).collect(),
            h: 1.0 / spec.rate as f32,
            substeps: self.substeps(),
            steps: 0,
        })
    }
}

/// Number of substeps recommended by the documentation of Box3D.
const SUBSTEPS: i32 = 4;

struct Running {
    world: World,
    bodies: Vec<BodyId>,
    shapes: Vec<RigidBox>,
    h: f32,
    substeps: i32,
    steps: u32,
}

impl Engine for Box3d {
    fn id(&self) -> &'static str {
        match self.workers {
            _ if self.fine => "box3d-fine",
            1 => "box3d",
            _ => "box3d-parallel",
        }
    }

    fn name(&self) -> &'static str {
        if self.fine { "Box3D, fine" } else { "Box3D" }
    }

    fn is_timed(&self, place: Place, bodies: usize) -> bool {
        !self.fine || (place == Place::Free && bodies == FINE_BODIES)
    }

    fn version(&self) -> String {
        format!("via boxddd {}", crate::engine::locked_version("boxddd"))
    }

    fn driven(&self) -> String {
        format!("bare, without Bevy, f32, {} substeps", self.substeps())
    }

    fn threads(&self) -> usize {
        self.workers as usize
    }

    fn build(&self, spec: &Spec) -> Result<Box<dyn Simulation>, String> {
        let world = self.world(spec).map_err(|e| e.to_string())?;
        Ok(Box::new(world))
    }
}

impl Simulation for Running {
    fn step(&mut self) {
        if self.world.step(self.h, self.substeps).is_ok() {
            self.steps += 1;
        }
    }

    fn time(&self) -> f64 {
        f64::from(self.steps) * f64::from(self.h)
    }

    fn state(&self, body: usize) -> BodyState {
        let id = self.bodies[body];
        let read = || -> Result<BodyState, Error> {
            let (x, q) = (self.world.body_position(id)?, self.world.body_rotation(id)?);
            let v = self.world.body_linear_velocity(id)?;
            let w = self.world.body_angular_velocity(id)?;
            let vector = |v: Vec3| DVec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z));
            let turn = DQuat::from_xyzw(
                f64::from(q.v.x),
                f64::from(q.v.y),
                f64::from(q.v.z),
                f64::from(q.s),
            );
            let at = DVec3::new(f64::from(x.x), f64::from(x.y), f64::from(x.z));
            Ok(BodyState::at_pose(at, turn)
                .with_velocity(vector(v))
                .with_angular_velocity(&self.shapes[body], vector(w)))
        };
        read().unwrap_or_else(|_| BodyState::at(DVec3::NAN))
    }
}
