//! A box over a floor under gravity and an optional push, stepped by any integrator.

use box_physics::body::RigidBox;
use box_physics::floor::{ContactSettings, ContactState, Floor, FloorContext, FloorOutcome};
use box_physics::force::{Forces, PointForce};
use box_physics::integrators::{Integrator, IntegratorMemory};
use box_physics::math::sin_cos;
use box_physics::rotation::exponential_map;
use box_physics::state::BodyState;
use glam::{DQuat, DVec3};

use super::G;

/// The simulation of a contact case, without an `App`.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The floor.
    pub floor: Floor,
    /// Settings of the contact solver.
    pub settings: ContactSettings,
    /// The box.
    pub body: RigidBox,
    /// State of the box.
    pub state: BodyState,
    /// Gravity [m/s²].
    pub gravity: DVec3,
    /// A constant force at a body point.
    pub push: Option<PointForce>,
    /// The integrator.
    pub integrator: Integrator,
    /// Sum of all outcomes so far.
    pub total: FloorOutcome,
    memory: IntegratorMemory,
    contact: ContactState,
}

impl Trial {
    /// Creates a box of half-extents `half` \[m\] and 3 kg at rest on a floor at y = 0 with restitution `e` and
    /// friction `mu`.
    pub fn new(integrator: Integrator, half: DVec3, e: f64, mu: f64) -> Self {
        Self {
            floor: Floor {
                height: 0.0,
                restitution: e,
                friction: mu,
                ..Floor::default()
            },
            settings: ContactSettings::default(),
            body: RigidBox::new(half, 3.0).expect("the examinations' boxes are valid"),
            state: BodyState::at(DVec3::Y * half.y),
            gravity: DVec3::NEG_Y * G,
            push: None,
            integrator,
            total: FloorOutcome::default(),
            memory: IntegratorMemory::default(),
            contact: ContactState::default(),
        }
    }

    /// Sets the attitude, and places the lowest corner on the floor.
    #[must_use]
    pub fn turned(mut self, rotation: DQuat) -> Self {
        self.state.rotation = rotation;
        self.state.position.y -= self.lowest();
        self
    }

    /// Runs `n` steps of `h` \[s\].
    pub fn run(&mut self, h: f64, n: u32) -> FloorOutcome {
        let mut sum = FloorOutcome::default();
        for _ in 0..n {
            sum += self.step(h);
        }
        self.total += sum;
        sum
    }

    fn step(&mut self, h: f64) -> FloorOutcome {
        let force = Forces {
            acceleration: self.gravity,
            point_forces: self.push.as_slice(),
            ..Default::default()
        };
        let context = FloorContext {
            floor: &self.floor,
            settings: &self.settings,
            body: &self.body,
            force: &force,
        };
        let (state, memory, contact) = (&mut self.state, &mut self.memory, &mut self.contact);
        self.integrator
            .step_on_floor(&context, state, h, memory, contact, None)
    }

    /// Height of the lowest corner above the floor \[m\].
    pub fn lowest(&self) -> f64 {
        let reach =
            box_physics::aabb::world_half_extents(self.state.rotation, self.body.half_extents());
        self.state.position.y - self.floor.height - reach.y
    }

    /// Kinetic energy plus potential energy relative to the floor \[J\].
    pub fn energy(&self) -> f64 {
        let x = self.state.position - DVec3::Y * self.floor.height;
        self.state.kinetic_energy(&self.body) - self.body.mass() * self.gravity.dot(x)
    }

    /// Returns `true` if the box is at rest on the floor.
    pub fn rests(&self) -> bool {
        self.contact.is_resting(&self.state)
    }
}

/// Rotation by `angle` \[rad\] about `axis` (a unit vector).
pub(super) fn about(axis: DVec3, angle: f64) -> DQuat {
    exponential_map(axis * angle)
}

/// Unit vector at `angle` \[rad\] from x in the floor's plane.
pub(super) fn heading(angle: f64) -> DVec3 {
    let (s, c) = sin_cos(angle);
    DVec3::new(c, 0.0, s)
}
