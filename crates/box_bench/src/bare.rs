//! The bare loop: the cost of a step without an ECS. It runs step, bounding box and `Transform` over plain
//! arrays; the plugin is compared with it.

use bevy::transform::components::Transform;
use box_physics::force::Gravity;
use box_physics::plugin::WorldAabb;
use box_physics::prelude::*;

/// Plain arrays of bodies.
pub struct Bare {
    bodies: Vec<RigidBox>,
    states: Vec<BodyState>,
    memories: Vec<IntegratorMemory>,
    aabbs: Vec<WorldAabb>,
    transforms: Vec<Transform>,
    gravity: Gravity,
}

impl Bare {
    /// Arrays for the bodies of `set` in a uniform gravity [m/s²].
    pub fn new(set: &[(RigidBox, BodyState)], gravity: DVec3) -> Self {
        Self {
            bodies: set.iter().map(|(body, _)| *body).collect(),
            states: set.iter().map(|(_, state)| *state).collect(),
            memories: set.iter().map(|_| IntegratorMemory::default()).collect(),
            aabbs: vec![WorldAabb::default(); set.len()],
            transforms: vec![Transform::default(); set.len()],
            gravity: Gravity(gravity),
        }
    }

    /// Bytes per body that a whole step must read and write.
    pub fn bytes_per_body() -> (usize, usize) {
        let written = size_of::<BodyState>() + size_of::<WorldAabb>() + size_of::<Transform>();
        (size_of::<RigidBox>() + written, written)
    }

    /// One step of `h` \[s\] with bounding boxes and transforms, as fast as the library allows: several
    /// bodies at a time if the integrator supports it.
    pub fn step(&mut self, integrator: Integrator, h: f64) {
        self.kernel(integrator, h);
        self.refit();
        self.write_transforms();
    }

    /// Only the integrator, several bodies at a time if it supports it.
    pub fn kernel(&mut self, integrator: Integrator, h: f64) {
        integrator.step_all(
            &self.bodies,
            &mut self.states,
            &mut self.memories,
            &self.gravity,
            h,
        );
    }

    /// Only the integrator, body by body.
    pub fn kernel_scalar(&mut self, integrator: Integrator, h: f64) {
        integrator.dispatch(Scalar { bare: self, h });
    }

    /// Computes bounding boxes.
    pub fn refit(&mut self) {
        WorldAabb::fit_all(&self.bodies, &self.states, &mut self.aabbs);
    }

    /// Computes transforms.
    pub fn write_transforms(&mut self) {
        for (state, transform) in self.states.iter().zip(&mut self.transforms) {
            transform.translation = state.position.as_vec3();
            transform.rotation = state.rotation.as_quat();
        }
    }
}

struct Scalar<'a> {
    bare: &'a mut Bare,
    h: f64,
}

impl box_physics::integrators::IntegratorVisitor for Scalar<'_> {
    type Output = ();

    fn visit<S: box_physics::integrators::Integrate>(self) {
        let bare = self.bare;
        let moving = bare.states.iter_mut().zip(&mut bare.memories);
        for (body, (state, memory)) in bare.bodies.iter().zip(moving) {
            S::step(body, state, &bare.gravity, self.h, memory);
        }
    }
}
