//! Free rotation: the exponential map, and the flows of the splittings.

mod frame;
mod splitting;

pub(crate) use frame::SplitFrame;
pub(crate) use splitting::{free_rotation_order4, free_rotation_strang, free_rotation_three_axes};

use glam::{DQuat, DVec3};

use crate::math::{AnyArgument, Trigonometry};

/// The quaternion of the rotation vector `u` \[rad\]: (u sin(|u|/2)/|u|, cos(|u|/2)). Exact for any |u|,
/// without a special case at 0.
#[inline(always)]
pub fn exponential_map(u: DVec3) -> DQuat {
    exponential_map_by(u, &mut AnyArgument)
}

/// [`exponential_map`] with a given sine and cosine.
#[inline(always)]
pub(crate) fn exponential_map_by(u: DVec3, trigonometry: &mut impl Trigonometry) -> DQuat {
    let half = 0.5 * u;
    let (sinc, cos) = trigonometry.sinc_cos(half.length_squared());
    let v = sinc * half;
    DQuat::from_xyzw(v.x, v.y, v.z, cos)
}

/// The product q∘p, written out to fix the order of operations and therefore every bit.
#[inline(always)]
pub fn compose(q: DQuat, p: DQuat) -> DQuat {
    DQuat::from_xyzw(
        (q.w * p.x + q.x * p.w) + (q.y * p.z - q.z * p.y),
        (q.w * p.y + q.y * p.w) + (q.z * p.x - q.x * p.z),
        (q.w * p.z + q.z * p.w) + (q.x * p.y - q.y * p.x),
        (q.w * p.w - q.x * p.x) - (q.y * p.y + q.z * p.z),
    )
}

/// One Newton step toward unit length: q (3 − |q|²)/2. In group methods the quaternion deviates from unit length only
/// by rounding errors; the step is then exact to rounding and cheaper than a square root.
#[inline(always)]
pub(crate) fn renormalize(q: DQuat) -> DQuat {
    q * (1.5 - 0.5 * q.length_squared())
}

/// q' = ½ q∘(ω, 0) for the body angular velocity `omega` [rad/s].
#[inline(always)]
pub fn quaternion_rate(q: DQuat, omega: DVec3) -> DQuat {
    compose(
        q,
        DQuat::from_xyzw(0.5 * omega.x, 0.5 * omega.y, 0.5 * omega.z, 0.0),
    )
}

/// The Cayley map of the rotation vector u = hω: the unit quaternion along (u/2, 1), a rotation by 2 atan(|u|/2) about
/// u.
#[inline(always)]
pub fn cayley_map(u: DVec3) -> DQuat {
    let c = 0.5 * u;
    let scale = 1.0 / (1.0 + c.length_squared()).sqrt();
    DQuat::from_xyzw(scale * c.x, scale * c.y, scale * c.z, scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_map_turns_by_its_length() {
        for angle in [0.0, 1e-12, 0.3, 1.5, 1.6, 3.0, 100.0] {
            let q = exponential_map(DVec3::new(0.6, 0.0, 0.8) * angle);
            assert!((q.w - libm::cos(0.5 * angle)).abs() < 3e-16);
            assert!((q.length() - 1.0).abs() < 4e-16);
            assert!((q.x - 0.6 * libm::sin(0.5 * angle)).abs() < 3e-16);
        }
    }

    #[test]
    fn cayley_turns_by_twice_the_arctangent() {
        let q = cayley_map(DVec3::Z * 1.2);
        let angle = 2.0 * libm::atan2(q.z, q.w);
        assert!((angle - 2.0 * libm::atan(0.6)).abs() < 1e-15);
    }
}
