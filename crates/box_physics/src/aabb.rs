//! World-aligned bounding boxes.

use glam::{DMat3, DQuat, DVec3};

/// Half-extents \[m\] of the world-aligned bounding box of a rotated box with half-extents `half` \[m\].
///
/// The result is |R|·h, with the absolute values of the rotation matrix. It is exact and needs no loop over corners:
/// the extent along world axis i is the support Σ_j |R_ij| h_j (Ericson, *Real-Time Collision Detection*, 2005,
/// §4.2.6).
///
/// ```
/// use box_physics::{aabb::world_half_extents, prelude::*};
/// let turned = DQuat::from_xyzw(0.0, 0.0, 0.5f64.sqrt(), 0.5f64.sqrt()); // 90° about z
/// let h = world_half_extents(turned, DVec3::new(3.0, 2.0, 1.0));
/// assert!((h - DVec3::new(2.0, 3.0, 1.0)).length() < 1e-14);
/// ```
#[inline(always)]
pub fn world_half_extents(rotation: DQuat, half: DVec3) -> DVec3 {
    let r = DMat3::from_quat(rotation);
    r.x_axis.abs() * half.x + r.y_axis.abs() * half.y + r.z_axis.abs() * half.z
}

/// Minimum and maximum corner of a world-aligned box, rounded outward to f32. The f32 box contains the f64 box.
#[inline(always)]
pub fn outward(center: DVec3, half: DVec3) -> (glam::Vec3, glam::Vec3) {
    let (low, high) = (center - half, center + half);
    (
        glam::Vec3::new(below(low.x), below(low.y), below(low.z)),
        glam::Vec3::new(above(high.x), above(high.y), above(high.z)),
    )
}

/// The largest f32 not above `x`. Branchless: the direction of rounding is random, and six mispredicted branches cost
/// more than the rest of a bounding box.
#[inline(always)]
fn below(x: f64) -> f32 {
    let nearest = x as f32;
    moved(nearest, i32::wrapping_sub, f64::from(nearest) > x)
}

/// The smallest f32 not below `x`.
#[inline(always)]
fn above(x: f64) -> f32 {
    let nearest = x as f32;
    moved(nearest, i32::wrapping_add, f64::from(nearest) < x)
}

/// Returns `x`, or its neighbor if `leave` is true: the next f32 up (`by` adds) or down (`by` subtracts).
///
/// The bits of a float, read as an integer, grow with its magnitude. The next number up has one more if the float is
/// positive and one less if it is negative. This fails for −0, which never occurs here: no number is rounded across
/// zero, so `below` never leaves 0, nor `above` −0.
#[inline(always)]
fn moved(x: f32, by: impl Fn(i32, i32) -> i32, leave: bool) -> f32 {
    let bits = x.to_bits() as i32;
    let upward = (bits >> 31) | 1;
    f32::from_bits(by(bits, upward & -i32::from(leave)) as u32)
}

/// The eight corners in body axes. Bit k of the index selects the sign along axis k: 0 is −, 1 is +.
pub fn corners(half: DVec3) -> [DVec3; 8] {
    core::array::from_fn(|k| {
        let sign = |bit: usize| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
        DVec3::new(sign(0), sign(1), sign(2)) * half
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Compares with the standard library's `next_down` and `next_up`.
    #[test]
    fn neighbors_are_those_of_the_standard_library() {
        let tiny = f64::from(f32::from_bits(1));
        #[rustfmt::skip]
        let numbers = [
            0.0, 1.0, 1.0 + 1e-9, 0.1, 1e-50, tiny, 1.5 * tiny, 1e-40, 3e38, f64::from(f32::MAX), 3.5e38, 1e300,
            f64::INFINITY, 16_777_217.0,
        ];
        for x in numbers.into_iter().flat_map(|x| [x, -x]) {
            let nearest = x as f32;
            let (mut down, mut up) = (nearest, nearest);
            if f64::from(nearest) > x {
                down = nearest.next_down();
            } else if f64::from(nearest) < x {
                up = nearest.next_up();
            }
            assert_eq!(below(x).to_bits(), down.to_bits(), "below {x:e}");
            assert_eq!(above(x).to_bits(), up.to_bits(), "above {x:e}");
        }
        assert!(below(f64::NAN).is_nan() && above(f64::NAN).is_nan());
    }

    proptest! {
        /// The box contains all eight corners and touches them on every side; the f32 box contains it.
        #[test]
        fn contains_and_touches_every_corner(
            q in prop::array::uniform4(-1.0..1.0f64),
            h in prop::array::uniform3(1e-3..1e3f64),
            c in prop::array::uniform3(-1e5..1e5f64),
        ) {
            let q = DQuat::from_array(q);
            prop_assume!(q.length() > 1e-3);
            let (q, h, c) = (q / q.length(), DVec3::from_array(h), DVec3::from_array(c));
            let extents = world_half_extents(q, h);
            let mut reached = DVec3::ZERO;
            for corner in corners(h) {
                let r = (q * corner).abs();
                prop_assert!((r - extents).max_element() <= 1e-12 * extents.max_element());
                reached = reached.max(r);
            }
            prop_assert!((reached - extents).abs().max_element() <= 1e-12 * extents.max_element());
            let (low, high) = outward(c, extents);
            prop_assert!(low.as_dvec3().cmple(c - extents).all());
            prop_assert!(high.as_dvec3().cmpge(c + extents).all());
            let width = (high - low).as_dvec3();
            prop_assert!((width - 2.0 * extents).max_element() <= 4e-7 * (c.abs() + extents).max_element());
        }
    }
}
