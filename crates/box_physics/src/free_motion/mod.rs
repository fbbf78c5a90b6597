//! The torque-free rotation of a rigid body in closed form: attitude and momentum at *any* time, without
//! steps. It is the core of the `exact` integrator and a reference for the others.
//!
//! ```text
//! L' = L × ω,   q' = ½ q∘(ω, 0),   ω_i = L_i/I_i                body axes
//! ```
//!
//! The momentum moves along a closed curve (the polhode) on the sphere |L| = const. The curve is a point if
//! the body is at rest or spins about a principal axis, and a circle if two moments are equal. Otherwise it
//! is given by Jacobi's elliptic functions.
//!
//! The attitude follows because the world momentum is constant. Two of its three angles are those of L in the
//! body. The third (the precession about L) is an integral: elementary for the circle, otherwise an argument
//! of a theta function. Sources: Jacobi 1849; Landau, Lifshitz, *Mechanics* §37; van Zon, Schofield, J.
//! Comput. Phys. 225 (2007) 145; Celledoni, Fassò, Säfström, Zanna, SIAM J. Sci. Comput. 30 (2008) 2084.
//!
//! ```
//! use box_physics::free_motion::FreeRotation;
//! use box_physics::prelude::*;
//! // Thrown about its middle axis a box flips over and over.
//! let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0)?;
//! let start = BodyState::default().with_body_angular_velocity(&body, DVec3::new(0.01, 8.0, 0.0));
//! let motion = FreeRotation::new(body.inertia(), start.rotation, start.angular_momentum);
//! let (rotation, momentum) = motion.at(1.0);
//! assert!((rotation * momentum - start.angular_momentum_world()).length() < 1e-14);
//! # Ok::<(), InvalidValue>(())
//! ```

mod elliptic;
mod euler_top;
mod jacobi;
mod phase;
mod symmetric;
mod theta;
mod tumbling;

#[cfg(test)]
mod tests;

pub use elliptic::{complete_integral, incomplete_integral};
pub use euler_top::free_rotation;
pub(crate) use euler_top::free_rotation_by;

use glam::{DQuat, DVec3};

use symmetric::Symmetric;
use tumbling::Tumbling;

/// Relative deviation of the momentum from a principal axis below which the motion counts as a permanent spin
/// about that axis. Above it the squares of the general case do not underflow. Even about the middle axis
/// such a deviation takes ln(1e140) = 322 growth times to show.
const PRINCIPAL: f64 = 1e-140;

/// The motion of one freely rotating body, set up once at an instant (the *event*) and evaluated at any time
/// before or after it.
///
/// Errors do not accumulate. At time t \[s\] they are a few rounding units, times the phase |ω|t \[rad\],
/// times e^{λt} where the motion itself amplifies errors (near the separatrix).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeRotation {
    motion: Motion,
}

/// Branches of the solution.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "the large one is the usual one, and a box would be an allocation an event"
)]
enum Motion {
    /// One constant rate, or a constant rate and a constant precession.
    Symmetric(Symmetric),
    /// Three different moments.
    Tumbling(Tumbling),
}

impl FreeRotation {
    /// The motion of a body with principal moments `inertia` \[kg m²\] (positive, any scale), attitude
    /// `rotation` (body to world) and angular momentum `momentum` [kg m²/s], **body** axes, at time 0. Takes
    /// about 0.5 µs.
    ///
    /// Moments count as equal only if they are the same f64, so a gap of one rounding unit is resolved. There
    /// the general solution is exact; the symmetric one has an error of gap × phase.
    pub fn new(inertia: DVec3, rotation: DQuat, momentum: DVec3) -> Self {
        let rotation = rotation * (1.0 / rotation.length());
        // Powers of two scale inertia and momentum to the order of 1. The scaling is exact, and no product of
        // moments or squares of momenta can overflow or underflow.
        let (inertia, inertia_scale) = scaled(inertia);
        let (l, momentum_scale) = scaled(momentum);
        let rate = momentum_scale / inertia_scale;
        let (i, k) = (inertia.to_array(), l.to_array());
        // Equal moments first: the body is symmetric about the remaining axis. Three equal moments are a
        // sphere, which is symmetric about any axis.
        let symmetric_axis = (0..3).find(|&a| i[(a + 1) % 3] == i[(a + 2) % 3]);
        let motion = if l == DVec3::ZERO || !l.is_finite() {
            Motion::Symmetric(Symmetric::rest(rotation, momentum))
        } else if let Some(axis) = symmetric_axis {
            Motion::Symmetric(Symmetric::new(axis, inertia, rate, rotation, l, momentum))
        } else if let Some(axis) = (0..3).find(|&a| {
            let largest = k[(a + 1) % 3].abs().max(k[(a + 2) % 3].abs());
            largest <= PRINCIPAL
        }) {
            Motion::Symmetric(Symmetric::spin(axis, inertia, rate, rotation, l, momentum))
        } else {
            Motion::Tumbling(Tumbling::new(inertia, rate, rotation, l, momentum_scale))
        };
        Self { motion }
    }

    /// Attitude (body to world; q and −q are the same attitude) and angular momentum [kg m²/s], body axes, at
    /// time `t` \[s\] of either sign. Takes about 0.1 µs.
    #[inline]
    pub fn at(&self, t: f64) -> (DQuat, DVec3) {
        match &self.motion {
            Motion::Symmetric(motion) => motion.at(t),
            Motion::Tumbling(motion) => motion.at(t),
        }
    }
}

/// `v` divided by a power of two, and that power, so that the largest component is in [½, 1).
fn scaled(v: DVec3) -> (DVec3, f64) {
    let (_, exponent) = libm::frexp(v.abs().max_element());
    // Within ±1000 the power and its reciprocal are normal numbers.
    let exponent = exponent.clamp(-1000, 1000);
    (v * libm::ldexp(1.0, -exponent), libm::ldexp(1.0, exponent))
}
