//! Free rotation with two or three equal moments, or about a principal axis: elementary functions.

use glam::{DQuat, DVec3};

use super::phase::sin_cos_of_phase;
use crate::rotation::compose;

/// ```text
/// q(t) = q₀ ∘ exp(t L/I₁) ∘ exp(t (1/I₃ − 1/I₁) L₃ e₃)
/// L(t) = L turned by −t (1/I₃ − 1/I₁) L₃ about e₃              body axes, 3 the symmetry axis
/// ```
///
/// L' = L×ω = (1/I₃ − 1/I₁) L₃ L×e₃ since ω = L/I₁ + (1/I₃ − 1/I₁) L₃ e₃: a steady turn. In the axes that
/// turn with it ω is constant, hence the first factor (Landau, Lifshitz §35). The second factor is absent for
/// a sphere and for a body that spins about e₃.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Symmetric {
    rotation: DQuat,
    momentum: DVec3,
    /// Direction of the axis of the first factor.
    axis: DVec3,
    /// Half the rate of the first factor [rad/s].
    half_rate: f64,
    /// The symmetry axis, 0 to 2.
    third: usize,
    /// Half the rate of the second factor [rad/s].
    half_slip: f64,
}

impl Symmetric {
    pub(super) fn rest(rotation: DQuat, momentum: DVec3) -> Self {
        Self {
            rotation,
            momentum,
            axis: DVec3::Z,
            half_rate: 0.0,
            third: 2,
            half_slip: 0.0,
        }
    }

    /// `inertia` and `l` are scaled to the order of 1. `rate` [rad/s] times l/I is the angular velocity;
    /// `momentum` is l unscaled.
    pub(super) fn new(
        third: usize,
        inertia: DVec3,
        rate: f64,
        rotation: DQuat,
        l: DVec3,
        momentum: DVec3,
    ) -> Self {
        let (i3, i1) = (inertia[third], inertia[(third + 1) % 3]);
        let length = l.length();
        Self {
            rotation,
            momentum,
            axis: l / length,
            half_rate: 0.5 * rate * (length / i1),
            third,
            half_slip: 0.5 * rate * ((i1 - i3) / (i1 * i3) * l[third]),
        }
    }

    /// Pure spin about principal axis `axis`. Other components of `l` are negligible and stay constant.
    pub(super) fn spin(
        axis: usize,
        inertia: DVec3,
        rate: f64,
        rotation: DQuat,
        l: DVec3,
        momentum: DVec3,
    ) -> Self {
        Self {
            axis: DVec3::AXES[axis],
            half_rate: 0.5 * rate * (l[axis] / inertia[axis]),
            ..Self::rest(rotation, momentum)
        }
    }

    #[inline]
    pub(super) fn at(&self, t: f64) -> (DQuat, DVec3) {
        let (s, c) = sin_cos_of_phase(self.half_rate * t);
        let v = s * self.axis;
        let mut q = compose(self.rotation, DQuat::from_xyzw(v.x, v.y, v.z, c));
        let mut l = self.momentum.to_array();
        if self.half_slip != 0.0 {
            let (s, c) = sin_cos_of_phase(self.half_slip * t);
            let v = s * DVec3::AXES[self.third];
            q = compose(q, DQuat::from_xyzw(v.x, v.y, v.z, c));
            // Turned backward by twice the half angle, with the versine 2 s² for 1 − cos.
            let (sine, versine) = (2.0 * s * c, 2.0 * s * s);
            let (i, j) = ((self.third + 1) % 3, (self.third + 2) % 3);
            let (a, b) = (l[i], l[j]);
            l[i] = a + (sine * b - versine * a);
            l[j] = b - (sine * a + versine * b);
        }
        (q, DVec3::from_array(l))
    }
}
