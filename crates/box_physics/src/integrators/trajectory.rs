//! The closed-form motion of a body since its last event, for `exact`.

use glam::DVec3;

use crate::body::RigidBox;
use crate::force::Dissipation;
use crate::free_motion::FreeRotation;
use crate::math::Exponential;
use crate::state::BodyState;

/// All that the motion depends on besides the state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Law {
    /// \[kg m²\]
    inertia: DVec3,
    /// [m/s²]
    acceleration: DVec3,
    /// c₁/m [1/s]
    drag_rate: f64,
    /// γ [1/s]
    damping_rate: f64,
}

impl Law {
    #[inline(always)]
    pub(super) fn new(body: &RigidBox, acceleration: DVec3, d: &Dissipation) -> Self {
        Self {
            inertia: body.inertia(),
            acceleration,
            drag_rate: d.linear_drag * body.inverse_mass(),
            damping_rate: d.angular_damping,
        }
    }
}

/// The motion since the last event, and how far it has been followed.
///
/// The motion has no clock of its own: it may be taken up again whenever the state is `last`, however
/// it came to be so.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(from = "serialized::Fields", into = "serialized::Fields")
)]
pub(super) struct Trajectory {
    law: Law,
    /// The state at the event.
    pub(super) event: BodyState,
    rotation: FreeRotation,
    /// The state left by the last step.
    pub(super) last: BodyState,
    /// Time since the event \[s\]: `origin` + `steps` × `step`, so that the time after n equal steps is
    /// n h to rounding; a sum of n terms would be off by n/2 roundings.
    origin: f64,
    steps: f64,
    step: f64,
}

impl Trajectory {
    pub(super) fn new(law: Law, event: &BodyState) -> Self {
        Self {
            law,
            event: *event,
            rotation: FreeRotation::new(law.inertia, event.rotation, event.angular_momentum),
            last: *event,
            origin: 0.0,
            steps: 0.0,
            step: 0.0,
        }
    }

    /// Whether it leads on from `state` under `law`: both as they were left, to the last bit (but for
    /// the sign of a zero).
    #[inline(always)]
    pub(super) fn continues(&self, law: &Law, state: &BodyState) -> bool {
        self.last == *state && self.law == *law
    }

    /// Moves `last` on by `h` \[s\].
    #[inline]
    pub(super) fn advance(&mut self, h: f64) {
        if h != self.step {
            self.origin += self.steps * self.step;
            self.step = h;
            self.steps = 0.0;
        }
        self.steps += 1.0;
        let t = self.origin + self.steps * h;
        let before = self.last.rotation;
        self.last = self.at(t);
        // Of q and −q the one that continues the motion, for those who interpolate.
        if self.last.rotation.dot(before) < 0.0 {
            self.last.rotation = -self.last.rotation;
        }
    }

    /// The state at time `t` \[s\] since the event.
    #[inline]
    fn at(&self, t: f64) -> BodyState {
        let Law {
            acceleration,
            drag_rate,
            damping_rate,
            ..
        } = self.law;
        let (position, velocity) = (self.event.position, self.event.velocity);
        let drag = Exponential::new(drag_rate * t);
        let damping = Exponential::new(damping_rate * t);
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
    //! What of a trajectory is saved. The rotation follows from the event, to the last bit; whether a
    //! loaded one fits its body is checked like any other, by [`Trajectory::continues`].

    use super::{BodyState, Law, Trajectory};

    #[derive(serde::Serialize, serde::Deserialize)]
    #[serde(rename = "Trajectory")]
    pub(super) struct Fields {
        law: Law,
        event: BodyState,
        last: BodyState,
        origin: f64,
        steps: f64,
        step: f64,
    }

    impl From<Trajectory> for Fields {
        fn from(t: Trajectory) -> Self {
            Self {
                law: t.law,
                event: t.event,
                last: t.last,
                origin: t.origin,
                steps: t.steps,
                step: t.step,
            }
        }
    }

    impl From<Fields> for Trajectory {
        fn from(f: Fields) -> Self {
            Self {
                last: f.last,
                origin: f.origin,
                steps: f.steps,
                step: f.step,
                ..Self::new(f.law, &f.event)
            }
        }
    }
}
