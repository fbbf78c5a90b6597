//! The closed-form motion of a body since its last event, for `exact`.

use glam::DVec3;

use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::free_motion::FreeRotation;
use crate::math::Exponential;
use crate::state::BodyState;

/// Inputs of the motion of the center and of the spin damping, besides the state.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlightForces {
    /// [m/s²]
    acceleration: DVec3,
    /// c₁/m [1/s]
    drag_rate: f64,
    /// γ [1/s]
    damping_rate: f64,
}

impl FlightForces {
    #[inline(always)]
    pub(super) fn new<F: ForceModel>(body: &RigidBox, force: &F) -> Self {
        let d = force.dissipation();
        let drag_rate = d.linear_drag * body.inverse_mass();
        Self {
            acceleration: d.blown(force.acceleration(), drag_rate),
            drag_rate,
            damping_rate: d.angular_damping,
        }
    }
}

/// The motion since the last event, and the time reached.
///
/// The motion has no clock. It continues whenever body, state and forces equal the result of its last step, however
/// that state arose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(from = "serialized::Fields", into = "serialized::Fields")
)]
pub struct Trajectory {
    /// \[kg m²\]
    inertia: DVec3,
    /// The state at the event.
    pub(super) event: BodyState,
    rotation: FreeRotation,
    /// Time since the event \[s\] is `origin` + `steps` × `step`, so that the time after n equal steps is n h up to one
    /// rounding. A sum of n terms would accumulate n/2 roundings.
    origin: f64,
    steps: f64,
    step: f64,
}

impl Trajectory {
    pub(super) fn new(body: &RigidBox, event: &BodyState) -> Self {
        Self::from_event(body.inertia(), event)
    }

    fn from_event(inertia: DVec3, event: &BodyState) -> Self {
        Self {
            inertia,
            event: *event,
            rotation: FreeRotation::new(inertia, event.rotation, event.angular_momentum),
            origin: 0.0,
            steps: 0.0,
            step: 0.0,
        }
    }

    /// Advances `state`, the result of the last step, by `h` \[s\].
    #[inline]
    pub(super) fn advance(&mut self, flight: &FlightForces, state: &mut BodyState, h: f64) {
        if h != self.step {
            self.origin += self.steps * self.step;
            self.step = h;
            self.steps = 0.0;
        }
        self.steps += 1.0;
        let t = self.origin + self.steps * h;
        let before = state.rotation;
        *state = self.at(flight, t);
        // Selects the sign of q that is continuous with the last attitude, for interpolation.
        if state.rotation.dot(before) < 0.0 {
            state.rotation = -state.rotation;
        }
    }

    /// The state at time `t` \[s\] since the event.
    #[inline]
    fn at(&self, flight: &FlightForces, t: f64) -> BodyState {
        let (position, velocity) = (self.event.position, self.event.velocity);
        let acceleration = flight.acceleration;
        let drag = Exponential::new(flight.drag_rate * t);
        let damping = Exponential::new(flight.damping_rate * t);
        let (rotation, momentum) = self.rotation.at(t * damping.phi1);
        BodyState {
            position: position + t * (drag.phi1 * velocity + (t * drag.phi2) * acceleration),
            velocity: drag.decay * velocity + (t * drag.phi1) * acceleration,
            rotation,
            angular_momentum: damping.decay * momentum,
        }
    }
}

#[cfg(feature = "serde")]
mod serialized {
    //! Serialized fields of a trajectory. The rotation is recomputed from the event, bit for bit.

    use super::{BodyState, DVec3, Trajectory};

    #[derive(serde::Serialize, serde::Deserialize)]
    #[serde(rename = "Trajectory")]
    pub(super) struct Fields {
        inertia: DVec3,
        event: BodyState,
        origin: f64,
        steps: f64,
        step: f64,
    }

    impl From<Trajectory> for Fields {
        fn from(t: Trajectory) -> Self {
            Self {
                inertia: t.inertia,
                event: t.event,
                origin: t.origin,
                steps: t.steps,
                step: t.step,
            }
        }
    }

    impl From<Fields> for Trajectory {
        fn from(f: Fields) -> Self {
            Self {
                origin: f.origin,
                steps: f.steps,
                step: f.step,
                ..Self::from_event(f.inertia, &f.event)
            }
        }
    }
}
