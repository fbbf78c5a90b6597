//! The time derivative of a whole state, for integrators that apply one formula to all variables. Also the rotation by
//! a given angular velocity.

use glam::{DQuat, DVec3};

use crate::body::RigidBox;
use crate::force::{ForceModel, rates};
use crate::math::Trigonometry;
use crate::rotation::{exponential_map_by, quaternion_rate};
use crate::state::BodyState;

/// The time derivative of the whole state: (x', q', v', L').
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Slope {
    pub(crate) position: DVec3,
    pub(crate) rotation: DQuat,
    pub(crate) velocity: DVec3,
    pub(crate) momentum: DVec3,
}

impl Slope {
    /// The slope at `state`: one force evaluation.
    #[inline(always)]
    pub(crate) fn at<F: ForceModel>(body: &RigidBox, state: &BodyState, force: &F) -> Self {
        let (velocity, momentum) = rates(body, state, force);
        Self {
            position: state.velocity,
            rotation: quaternion_rate(state.rotation, state.body_angular_velocity(body)),
            velocity,
            momentum,
        }
    }

    /// Returns `state` + `h` × this slope. The quaternion is not normalized. Within a step it deviates from unit length
    /// only by O(h²), and every order condition holds for the field extended to such quaternions.
    #[inline(always)]
    pub(crate) fn from(&self, state: &BodyState, h: f64) -> BodyState {
        BodyState {
            position: state.position + h * self.position,
            rotation: state.rotation + self.rotation * h,
            velocity: state.velocity + h * self.velocity,
            angular_momentum: state.angular_momentum + h * self.momentum,
        }
    }

    /// [`from`](Self::from) as the end of a step: the quaternion is normalized.
    #[inline(always)]
    pub(crate) fn step(&self, state: &BodyState, h: f64) -> BodyState {
        let mut end = self.from(state, h);
        end.rotation = end.rotation * (1.0 / end.rotation.length());
        end
    }
}

/// q ← q∘exp(hω) with the angular velocity ω of `state`.
#[inline(always)]
pub(super) fn turn(
    body: &RigidBox,
    state: &mut BodyState,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) {
    let turn = exponential_map_by(h * state.body_angular_velocity(body), trigonometry);
    state.turn_by(turn);
}

/// Rotates `l` backward by `turn`: with p its vector part and w its scalar part, L − 2w p×L + 2p×(p×L).
#[inline(always)]
pub(super) fn turned_back(l: DVec3, turn: DQuat) -> DVec3 {
    let across = turn.xyz().cross(l);
    l + 2.0 * (turn.xyz().cross(across) - turn.w * across)
}
