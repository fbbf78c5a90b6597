//! Rotation about one principal axis with angular drag and a constant torque about it.

use box_physics::state::BodyState;
use glam::{DQuat, DVec3};

use super::translation::phi;
use super::turn;
use crate::setup::Setup;

/// ω' = τ/I − (γ + c_ω/I) ω about a fixed body axis.
#[derive(Clone, Debug)]
pub(super) struct AxisRotation {
    rotation: DQuat,
    axis: DVec3,
    inertia: f64,
    /// ω(0) [rad/s]
    spin: f64,
    /// τ/I [rad/s²]
    acceleration: f64,
    /// γ + c_ω/I [1/s]
    rate: f64,
}

impl AxisRotation {
    /// Returns `None` unless spin and torque share a principal axis and nothing else turns the body. Without a torque,
    /// any axis of a body with equal moments qualifies.
    pub(super) fn of(setup: &Setup, start: &BodyState) -> Option<Self> {
        let f = &setup.forces;
        if f.world_torque != DVec3::ZERO || !f.point_forces.is_empty() || !f.springs.is_empty() {
            return None;
        }
        let i = setup.body.inertia();
        let l = start.angular_momentum;
        let both = l.abs() + f.body_torque.abs();
        let turning: Vec<usize> = (0..3).filter(|&k| both[k] != 0.0).collect();
        let sphere = i.x == i.y && i.y == i.z;
        let (axis, inertia) = match turning[..] {
            [] => (DVec3::X, i.x),
            [k] => (DVec3::AXES[k], i[k]),
            _ if sphere && f.body_torque == DVec3::ZERO => (l.normalize(), i.x),
            _ => return None,
        };
        Some(Self {
            rotation: start.rotation,
            axis,
            inertia,
            spin: l.dot(axis) / inertia,
            acceleration: f.body_torque.dot(axis) / inertia,
            rate: f.angular_damping + f.angular_drag / inertia,
        })
    }

    pub(super) fn write(&self, t: f64, state: &mut BodyState) {
        let (phi1, phi2) = phi(self.rate * t);
        let angle = t * (phi1 * self.spin + t * phi2 * self.acceleration);
        let spin = libm::exp(-self.rate * t) * self.spin + t * phi1 * self.acceleration;
        state.rotation = self.rotation * turn(self.axis, angle);
        state.angular_momentum = self.axis * (spin * self.inertia);
    }
}
