//! The force model of a body, as the integrators see it.
//!
//! ```text
//! m v' = m a − c₁ v − k₂ |v| v + F(x, q, v, ω)        world axes
//! L'   = L×ω − γ L − c_ω ω + τ(x, q, v, ω)           body axes, ω = L/I
//! ```
//!
//! The parts are kept apart because a good integrator treats them apart: the uniform acceleration and the
//! isotropic dissipation have exact flows, the rest (the *wrench*) is what a kick applies.

mod parts;

pub use crate::state::Frame;
pub use parts::{Forces, PointForce, Spring};

#[cfg(feature = "bevy")]
use crate::ecs::*;
use glam::{DMat3, DVec3};

use crate::body::RigidBox;
use crate::state::BodyState;

/// A force through the center of mass \[N\], world axes, and a torque about it \[N m\], **body** axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Default, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Wrench {
    /// Force \[N\], world axes.
    pub force: DVec3,
    /// Torque about the center of mass \[N m\], body axes.
    pub torque: DVec3,
}

impl Wrench {
    /// No force, no torque.
    pub const ZERO: Self = Self {
        force: DVec3::ZERO,
        torque: DVec3::ZERO,
    };
}

impl core::ops::AddAssign for Wrench {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.force += other.force;
        self.torque += other.torque;
    }
}

/// The isotropic dissipation of a body; every coefficient ≥ 0, and 0 means absent.
///
/// ```
/// use box_physics::prelude::*;
/// // Falling through air: the speed at which drag equals weight.
/// let body = RigidBox::default(); // 1 kg
/// let law = Forces {
///     acceleration: DVec3::new(0.0, -9.81, 0.0),
///     dissipation: Dissipation { quadratic_drag: 0.1, ..Dissipation::NONE },
///     ..Forces::default()
/// };
/// let (mut state, mut memory) = (BodyState::default(), IntegratorMemory::default());
/// for _ in 0..600 {
///     Integrator::Rk4.step(&body, &mut state, &law, 1.0 / 60.0, &mut memory);
/// }
/// assert!((state.velocity.y + (9.81_f64 / 0.1).sqrt()).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Default, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Dissipation {
    /// c₁ [N s/m]: force −c₁ v.
    pub linear_drag: f64,
    /// k₂ [N s²/m²]: force −k₂ |v| v.
    pub quadratic_drag: f64,
    /// γ [1/s]: torque −γ L.
    pub angular_damping: f64,
    /// c_ω \[N m s\]: torque −c_ω ω.
    pub angular_drag: f64,
}

impl Dissipation {
    /// A body in vacuum.
    pub const NONE: Self = Self {
        linear_drag: 0.0,
        quadratic_drag: 0.0,
        angular_damping: 0.0,
        angular_drag: 0.0,
    };
}

/// Dampers at points of a body, each a force −d u at its point, u the point's velocity. Any number of them act on the
/// body through ten numbers, which do not depend on its pose: the force and torque in body axes are
///
/// ```text
/// F = −Σd (v + ω×r),   T = Σ r×F
/// ```
///
/// Add one at a time; every coefficient ≥ 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// Σ d [N s/m].
    pub(crate) total: f64,
    /// Σ d r [N s].
    pub(crate) moment: DVec3,
    /// Σ d (|r|² − r rᵀ) [N s m].
    pub(crate) second: DMat3,
}

impl Damping {
    /// No damper.
    pub const NONE: Self = Self {
        total: 0.0,
        moment: DVec3::ZERO,
        second: DMat3::ZERO,
    };

    /// The same and a damper of `coefficient` d [N s/m] at `body_point` r \[m\], body axes from the center.
    #[must_use]
    pub fn with(mut self, body_point: DVec3, coefficient: f64) -> Self {
        let r = body_point;
        let outer = DMat3::from_cols(r * r.x, r * r.y, r * r.z);
        self.total += coefficient;
        self.moment += coefficient * r;
        self.second +=
            (DMat3::from_diagonal(DVec3::splat(r.length_squared())) - outer) * coefficient;
        self
    }
}

/// What acts on one body. The integrators are generic over it, so a body without a force pays nothing
/// for it: the compiler removes what [`Gravity`] says is absent.
///
/// Implement it for forces of your own: give the state-dependent part in [`ForceModel::wrench`] and
/// say so in [`ForceModel::has_wrench`].
///
/// ```
/// use box_physics::prelude::*;
/// /// A rotor that drives the box about its own z axis, weaker the faster it turns.
/// struct Motor;
/// impl ForceModel for Motor {
///     fn acceleration(&self) -> DVec3 { DVec3::ZERO }
///     fn has_wrench(&self) -> bool { true }
///     fn wrench(&self, body: &RigidBox, state: &BodyState) -> Wrench {
///         let spin = state.body_angular_velocity(body).z;
///         Wrench { force: DVec3::ZERO, torque: DVec3::Z * (1.0 - 0.1 * spin) }
///     }
/// }
/// let body = RigidBox::default();
/// let (mut state, mut memory) = (BodyState::default(), IntegratorMemory::default());
/// for _ in 0..60 {
///     Integrator::Rk4.step(&body, &mut state, &Motor, 1.0 / 60.0, &mut memory);
/// }
/// assert!(state.angular_velocity(&body).z > 4.0);
/// ```
pub trait ForceModel {
    /// The uniform acceleration [m/s²], world axes: gravity and whatever constant force acts on the
    /// center, divided by the mass. Constant over a step.
    fn acceleration(&self) -> DVec3;

    /// Isotropic drag and damping. Constant over a step.
    #[inline(always)]
    fn dissipation(&self) -> Dissipation {
        Dissipation::NONE
    }

    /// Whether [`ForceModel::dissipation`] is anything.
    #[inline(always)]
    fn has_dissipation(&self) -> bool {
        self.dissipation() != Dissipation::NONE
    }

    /// Whether [`ForceModel::wrench`] is ever different from zero; integrators skip the kicks if not.
    #[inline(always)]
    fn has_wrench(&self) -> bool {
        false
    }

    /// Everything else, evaluated at every stage of a multi-stage integrator.
    #[inline(always)]
    fn wrench(&self, _body: &RigidBox, _state: &BodyState) -> Wrench {
        Wrench::ZERO
    }

    /// The part of [`ForceModel::wrench`] that does not depend on the velocities, for integrators that
    /// kick: what it leaves out must be in [`ForceModel::damping`]. By default the whole wrench, whose
    /// velocity-dependent part such an integrator then takes at the velocity it has (order 1).
    #[inline(always)]
    fn elastic_wrench(&self, body: &RigidBox, state: &BodyState) -> Wrench {
        self.wrench(body, state)
    }

    /// A number that differs wherever [`ForceModel::wrench`] does: over the parameters it depends on, besides body
    /// and state. Integrators that remember past forces compare it and start again where it changes. `None`, the
    /// default for a model with a wrench, says that this is not known: they then remember nothing. Mix in a
    /// constant of your own, so that the number is not that of another model ([`fingerprint`]).
    #[inline(always)]
    fn wrench_fingerprint(&self) -> Option<u64> {
        (!self.has_wrench()).then_some(0)
    }

    /// The part of [`ForceModel::wrench`] that [`ForceModel::elastic_wrench`] leaves out: what is linear in the
    /// velocities. Constant over a step.
    #[inline(always)]
    fn damping(&self) -> Damping {
        Damping::NONE
    }
}

/// A digest of `numbers`, to the bit, for [`ForceModel::wrench_fingerprint`].
///
/// ```
/// use box_physics::force::fingerprint;
/// assert_eq!(fingerprint([1.0, 2.0]), fingerprint([1.0, 2.0]));
/// assert_ne!(fingerprint([1.0, 2.0]), fingerprint([2.0, 1.0]));
/// ```
pub fn fingerprint(numbers: impl IntoIterator<Item = f64>) -> u64 {
    // Per number the finalizer of splitmix64 (Steele, Lea, Flood, OOPSLA 2014), which is one to one and lets every
    // bit reach every other: signs that change in pairs do not cancel, as they would in a bare product.
    numbers.into_iter().fold(0x9e37_79b9_7f4a_7c15, |hash, x| {
        let mut z = (hash ^ x.to_bits()).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}

/// Uniform acceleration [m/s²] alone: a body in free flight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Default, Clone, PartialEq))]
pub struct Gravity(pub DVec3);

impl ForceModel for Gravity {
    #[inline(always)]
    fn acceleration(&self) -> DVec3 {
        self.0
    }

    // A constant, so that no loop over free bodies carries the branch.
    #[inline(always)]
    fn has_dissipation(&self) -> bool {
        false
    }
}

/// The time derivatives (v', L') of the whole law at `state`: one force evaluation.
#[inline(always)]
pub fn rates<F: ForceModel>(body: &RigidBox, state: &BodyState, force: &F) -> (DVec3, DVec3) {
    let (dv, torque) = applied_rates(body, state, force);
    let omega = state.body_angular_velocity(body);
    (dv, state.angular_momentum.cross(omega) + torque)
}

/// [`rates`] without the gyroscopic term L×ω, for integrators whose drift contains it.
#[inline(always)]
pub(crate) fn applied_rates<F: ForceModel>(
    body: &RigidBox,
    state: &BodyState,
    force: &F,
) -> (DVec3, DVec3) {
    let d = force.dissipation();
    let mut dv = force.acceleration();
    let mut torque = DVec3::ZERO;
    if d != Dissipation::NONE {
        let speed = state.velocity.length();
        let rate = (d.linear_drag + d.quadratic_drag * speed) * body.inverse_mass();
        let omega = state.body_angular_velocity(body);
        dv -= rate * state.velocity;
        torque -= d.angular_damping * state.angular_momentum + d.angular_drag * omega;
    }
    if force.has_wrench() {
        let w = force.wrench(body, state);
        dv += w.force * body.inverse_mass();
        torque += w.torque;
    }
    (dv, torque)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    /// A box, and a state without any symmetry.
    pub(super) fn setting() -> (RigidBox, BodyState) {
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.375), 3.0).expect("valid");
        let state = BodyState::at_pose(
            DVec3::new(0.2, 1.0, -0.4),
            DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7),
        )
        .with_velocity(DVec3::new(1.0, -2.0, 0.5))
        .with_angular_velocity(&body, DVec3::new(3.0, 1.0, -2.0));
        (body, state)
    }

    #[test]
    fn rates_are_the_law() {
        let (body, state) = setting();
        let d = Dissipation {
            linear_drag: 0.3,
            quadratic_drag: 0.2,
            angular_damping: 0.1,
            angular_drag: 0.05,
        };
        let law = Forces {
            acceleration: DVec3::NEG_Y,
            dissipation: d,
            body_torque: DVec3::X,
            ..Default::default()
        };
        let (dv, dl) = rates(&body, &state, &law);
        let (v, l, w) = (
            state.velocity,
            state.angular_momentum,
            state.body_angular_velocity(&body),
        );
        let expected = DVec3::NEG_Y - (0.3 * v + 0.2 * v.length() * v) / 3.0;
        assert!((dv - expected).length() < 1e-15);
        let expected = l.cross(w) - 0.1 * l - 0.05 * w + DVec3::X;
        assert!((dl - expected).length() < 1e-15);
    }
}
