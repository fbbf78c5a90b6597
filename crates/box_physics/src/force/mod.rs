//! The force model of a body, as the integrators use it.
//!
//! ```text
//! m v' = m a − c₁ v − k₂ |v| v + F(x, q, v, ω)        world axes
//! L'   = L×ω − γ L − c_ω ω + τ(x, q, v, ω)           body axes, ω = L/I
//! ```
//!
//! The terms are separate because a good integrator treats them separately. The uniform acceleration and the isotropic
//! dissipation have exact flows. The rest, the *wrench*, is applied as a kick.

mod parts;

pub use crate::state::Frame;
pub use parts::{Forces, PointForce, Spring};

#[cfg(feature = "bevy")]
use crate::ecs::*;
use glam::{DMat3, DVec3};

use crate::body::RigidBox;
use crate::rotation::{compose, exponential_map};
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

/// Isotropic dissipation of a body. Every coefficient is ≥ 0; 0 means absent.
///
/// ```
/// use box_physics::force::Forces;
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
    /// Velocity w of the air [m/s], world axes; drag acts on v − w. Constant over a step.
    pub wind: DVec3,
}

impl Dissipation {
    /// A body in vacuum.
    pub const NONE: Self = Self {
        linear_drag: 0.0,
        quadratic_drag: 0.0,
        angular_damping: 0.0,
        angular_drag: 0.0,
        wind: DVec3::ZERO,
    };

    /// Applies `drag` to the velocity relative to the air: w + `drag`(v − w). Without wind the result has the
    /// bits of `drag`(v).
    #[inline(always)]
    pub(crate) fn in_air(&self, velocity: DVec3, drag: impl FnOnce(DVec3) -> DVec3) -> DVec3 {
        if self.wind == DVec3::ZERO {
            drag(velocity)
        } else {
            self.wind + drag(velocity - self.wind)
        }
    }

    /// Acceleration a plus the effect of wind through linear drag of `rate` c₁/m [1/s]: a + (c₁/m) w.
    #[inline(always)]
    pub(crate) fn blown(&self, acceleration: DVec3, rate: f64) -> DVec3 {
        if self.wind == DVec3::ZERO {
            acceleration
        } else {
            acceleration + rate * self.wind
        }
    }
}

/// The combined effect of viscous dampers at points of a body.
///
/// Each damper exerts a force −d u at its point, where u is the point's velocity. Any number of them act on the body
/// through ten numbers that do not depend on its pose. Force and torque in body axes:
///
/// ```text
/// F = −Σd (v + ω×r),   T = Σ r×F
/// ```
///
/// Add one damper at a time; every coefficient is ≥ 0.
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

    /// Adds a damper of `coefficient` d [N s/m] at `body_point` r \[m\], body axes from the center.
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

/// The forces and torques on one body. The integrators are generic over this trait, so an absent force costs
/// nothing: the compiler removes the terms that [`Gravity`] reports as absent.
///
/// Implement it for your own forces: return the state-dependent part from [`ForceModel::wrench`] and `true`
/// from [`ForceModel::has_wrench`].
///
/// ```
/// use box_physics::prelude::*;
/// /// A motor about the box's own z axis, whose torque decreases with the speed.
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
    /// Uniform acceleration [m/s²], world axes: gravity plus any constant force on the center, divided by the
    /// mass. Constant over a step.
    fn acceleration(&self) -> DVec3;

    /// Isotropic drag and damping. Constant over a step.
    #[inline(always)]
    fn dissipation(&self) -> Dissipation {
        Dissipation::NONE
    }

    /// Returns `true` if [`ForceModel::dissipation`] is nonzero.
    #[inline(always)]
    fn has_dissipation(&self) -> bool {
        self.dissipation() != Dissipation::NONE
    }

    /// Returns `true` if [`ForceModel::wrench`] can be nonzero. If not, integrators skip the kicks.
    #[inline(always)]
    fn has_wrench(&self) -> bool {
        false
    }

    /// All other forces and torques, evaluated at every stage of a multi-stage integrator.
    #[inline(always)]
    fn wrench(&self, _body: &RigidBox, _state: &BodyState) -> Wrench {
        Wrench::ZERO
    }

    /// The part of [`ForceModel::wrench`] that does not depend on the velocities, for integrators that apply it as a
    /// kick. [`ForceModel::damping`] must contain the rest. The default is the whole wrench; such an integrator then
    /// evaluates the velocity-dependent part at the current velocity (order 1).
    #[inline(always)]
    fn elastic_wrench(&self, body: &RigidBox, state: &BodyState) -> Wrench {
        self.wrench(body, state)
    }

    /// [`ForceModel::elastic_wrench`] after a small displacement: position + `shift` \[m\], world axes, and
    /// attitude∘exp(`turn`) \[rad\], body axes. Correct to first order in both.
    #[inline(always)]
    fn displaced_wrench(
        &self,
        body: &RigidBox,
        state: &BodyState,
        shift: DVec3,
        turn: DVec3,
    ) -> Wrench {
        let mut displaced = *state;
        displaced.position += shift;
        displaced.rotation = compose(state.rotation, exponential_map(turn));
        self.elastic_wrench(body, &displaced)
    }

    /// A hash of all parameters of [`ForceModel::wrench`] other than body and state.
    ///
    /// Multistep integrators compare it and restart when it changes. `None` means unknown and is the default for a
    /// model with a wrench; they then keep no history. Mix in a constant of your own, so that the hash differs from
    /// that of other models ([`fingerprint`]).
    #[inline(always)]
    fn wrench_fingerprint(&self) -> Option<u64> {
        (!self.has_wrench()).then_some(0)
    }

    /// The velocity-dependent part of [`ForceModel::wrench`], which [`ForceModel::elastic_wrench`] leaves out. It is
    /// linear in the velocities and constant over a step.
    #[inline(always)]
    fn damping(&self) -> Damping {
        Damping::NONE
    }

    /// Returns `true` if [`ForceModel::damping`] is nonzero.
    #[inline(always)]
    fn has_damping(&self) -> bool {
        self.damping() != Damping::NONE
    }
}

/// A digest of the bits of `numbers`, for [`ForceModel::wrench_fingerprint`].
///
/// ```
/// use box_physics::force::fingerprint;
/// assert_eq!(fingerprint([1.0, 2.0]), fingerprint([1.0, 2.0]));
/// assert_ne!(fingerprint([1.0, 2.0]), fingerprint([2.0, 1.0]));
/// ```
pub fn fingerprint(numbers: impl IntoIterator<Item = f64>) -> u64 {
    // Each number passes through the finalizer of splitmix64 (Steele, Lea, Flood, OOPSLA 2014). It is one to
    // one and every bit affects every other. Signs that change in pairs therefore do not cancel, as they
    // would in a plain product.
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

    // A constant, so that loops over free bodies have no branch.
    #[inline(always)]
    fn has_dissipation(&self) -> bool {
        false
    }
}

/// [`ForceModel::wrench`], zero if the model has none.
#[inline(always)]
pub(crate) fn wrench_of<F: ForceModel>(body: &RigidBox, state: &BodyState, force: &F) -> Wrench {
    if force.has_wrench() {
        force.wrench(body, state)
    } else {
        Wrench::ZERO
    }
}

/// Time derivatives (v', L') of the whole force model at `state`: one force evaluation.
#[inline(always)]
pub fn rates<F: ForceModel>(body: &RigidBox, state: &BodyState, force: &F) -> (DVec3, DVec3) {
    let (dv, torque) = applied_rates(body, state, force);
    let omega = state.body_angular_velocity(body);
    (dv, state.angular_momentum.cross(omega) + torque)
}

/// [`rates`] without the gyroscopic term L×ω, for integrators whose drift contains that term.
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
        let velocity = state.velocity - d.wind;
        let rate = (d.linear_drag + d.quadratic_drag * velocity.length()) * body.inverse_mass();
        let omega = state.body_angular_velocity(body);
        dv -= rate * velocity;
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
pub(crate) mod tests;
