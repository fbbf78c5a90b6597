//! What must hold of the contact whatever the scene. (The measured hard cases 25 to 32 are
//! `box_scenarios::contact_cases`.)

mod bounce;
mod moving;
mod react;
mod rest;
mod robust;
mod slide;

use glam::{DQuat, DVec3};

use super::{
    ContactReport, ContactSettings, ContactState, Floor, FloorContext, FloorOutcome,
    RestitutionLaw, step_on_floor,
};
use crate::body::RigidBox;
use crate::force::{ForceModel, Gravity};
use crate::integrators::{Integrate, IntegratorMemory};
use crate::math::sin_cos;
use crate::state::BodyState;

pub(super) const G: f64 = 9.81;
pub(super) const SIXTIETH: f64 = 1.0 / 60.0;

/// One box over the floor, and what it needs between steps.
#[derive(Clone)]
pub(super) struct Scene {
    pub(super) floor: Floor,
    pub(super) settings: ContactSettings,
    pub(super) body: RigidBox,
    pub(super) state: BodyState,
    pub(super) gravity: Gravity,
    pub(super) memory: IntegratorMemory,
    pub(super) contact: ContactState,
    pub(super) total: FloorOutcome,
}

impl Scene {
    pub(super) fn new(half: DVec3, e: f64, mu: f64) -> Self {
        let body = RigidBox::new(half, 3.0).expect("valid");
        Self {
            floor: Floor::new(0.0, e, mu).expect("valid"),
            settings: ContactSettings::default(),
            body,
            state: BodyState::at(DVec3::Y * half.y),
            gravity: Gravity(DVec3::NEG_Y * G),
            memory: IntegratorMemory::default(),
            contact: ContactState::default(),
            total: FloorOutcome::default(),
        }
    }

    pub(super) fn with_state(mut self, state: BodyState) -> Self {
        self.state = state;
        self
    }

    /// Gravity tilted by `theta` \[rad\] toward +x: a slope.
    pub(super) fn on_slope(mut self, theta: f64) -> Self {
        let (s, c) = sin_cos(theta);
        self.gravity = Gravity(DVec3::new(G * s, -G * c, 0.0));
        self
    }

    pub(super) fn step<S: Integrate>(&mut self, h: f64) -> FloorOutcome {
        let gravity = self.gravity;
        self.step_under::<S>(&gravity, h, None)
    }

    pub(super) fn step_under<S: Integrate>(
        &mut self,
        force: &impl ForceModel,
        h: f64,
        report: Option<&mut ContactReport>,
    ) -> FloorOutcome {
        let context = FloorContext {
            floor: &self.floor,
            settings: &self.settings,
            body: &self.body,
            force,
        };
        let (state, memory, contact) = (&mut self.state, &mut self.memory, &mut self.contact);
        let outcome = step_on_floor::<S, _>(&context, state, h, memory, contact, report);
        self.floor.advance(h);
        self.total += outcome;
        outcome
    }

    pub(super) fn run<S: Integrate>(&mut self, h: f64, steps: u32) {
        for _ in 0..steps {
            self.step::<S>(h);
        }
    }

    /// Height of the lowest corner over the floor \[m\].
    pub(super) fn lowest(&self) -> f64 {
        super::geometry::Corners::at(&self.floor, &self.body, &self.state).lowest()
    }

    /// Kinetic energy and that of gravity over the floor \[J\].
    pub(super) fn energy(&self) -> f64 {
        let x = self.state.position - DVec3::Y * self.floor.height;
        self.state.kinetic_energy(&self.body) - self.body.mass() * self.gravity.0.dot(x)
    }
}

pub(super) fn about(axis: DVec3, angle: f64) -> DQuat {
    crate::rotation::exponential_map(axis * angle)
}

/// A small generator (Marsaglia's xorshift64*, 2003), so that every run tries the same boxes.
pub(super) struct Random(pub(super) u64);

impl Random {
    /// In [low, high).
    pub(super) fn range(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        low + (high - low) * (bits as f64 / (1_u64 << 53) as f64)
    }

    /// Log-uniform.
    pub(super) fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        crate::math::exp(self.range(libm::log(low), libm::log(high)))
    }

    pub(super) fn vector(&mut self, size: f64) -> DVec3 {
        DVec3::new(
            self.range(-size, size),
            self.range(-size, size),
            self.range(-size, size),
        )
    }

    pub(super) fn attitude(&mut self) -> DQuat {
        loop {
            let v = self.vector(1.0);
            let q = DQuat::from_xyzw(v.x, v.y, v.z, self.range(-1.0, 1.0));
            if (0.1..1.0).contains(&q.length()) {
                return q / q.length();
            }
        }
    }
}
