//! Positions of the corners, and sets of corners.

use glam::{DMat3, DVec3};

use crate::body::RigidBox;

/// One vector per corner.
pub(super) type Corner3 = [DVec3; 8];

/// Positions of the corners at one instant, with the heights of the `N` places where they may touch. Places are the
/// corners over one floor, or pairs of a plane and a corner. Place i belongs to corner i mod 8.
#[derive(Clone, Copy)]
pub(super) struct Places<const N: usize> {
    /// The box's axes in the world, scaled by its half-extents \[m\].
    edges: [DVec3; 3],
    /// c_i = n·(x + r_k) − height \[m\]; infinite where there is no plane.
    pub(super) height: [f64; N],
}

/// The corners over one floor.
pub(super) type Corners = Places<8>;

impl<const N: usize> Places<N> {
    pub(super) const NONE: Self = Self {
        edges: [DVec3::ZERO; 3],
        height: [f64::INFINITY; N],
    };

    /// The corners of a body at `attitude`, with unknown heights.
    pub(super) fn turned(body: &RigidBox, attitude: DMat3) -> Self {
        Self {
            edges: half_edges(body, attitude),
            ..Self::NONE
        }
    }

    /// r_k = R (±h_x, ±h_y, ±h_z): from the center to corner `k` \[m\], world axes. The bits of the index are those of
    /// [`crate::aabb::corners`].
    #[inline(always)]
    pub(super) fn lever(&self, k: usize) -> DVec3 {
        lever(self.edges, k)
    }

    /// The height of the lowest corner \[m\].
    pub(super) fn lowest(&self) -> f64 {
        self.height.iter().fold(f64::INFINITY, |a, &c| a.min(c))
    }

    /// The place whose corner is lowest, and its height \[m\].
    pub(super) fn deepest(&self) -> (usize, f64) {
        let heights = self.height.into_iter().enumerate();
        let lower = heights.reduce(|a, b| if b.1 < a.1 { b } else { a });
        lower.unwrap_or((0, f64::INFINITY))
    }

    /// The places not higher than `tolerance` \[m\].
    pub(super) fn touching(&self, tolerance: f64) -> u64 {
        set::<N>(|i| self.height[i] <= tolerance)
    }
}

/// The box's axes in the world, scaled by its half-extents \[m\].
#[inline(always)]
pub(super) fn half_edges(body: &RigidBox, attitude: DMat3) -> [DVec3; 3] {
    let h = body.half_extents();
    [
        attitude.x_axis * h.x,
        attitude.y_axis * h.y,
        attitude.z_axis * h.z,
    ]
}

/// r_k \[m\]. The order of the terms makes the levers of opposite corners of a level face opposite to the last bit, so
/// a flat landing has a torque of exactly zero.
#[inline(always)]
pub(super) fn lever([x, y, z]: [DVec3; 3], k: usize) -> DVec3 {
    let sign = |bit: usize| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
    (sign(0) * x + sign(2) * z) + sign(1) * y
}

/// The corners of the faces: those whose bit 0 is 0, is 1, and so on.
const FACES: [u8; 6] = [
    0b0101_0101,
    0b1010_1010,
    0b0011_0011,
    0b1100_1100,
    0b0000_1111,
    0b1111_0000,
];

/// The set of the corners for which `f` holds.
pub(super) fn mask(f: impl Fn(usize) -> bool) -> u8 {
    set::<8>(f) as u8
}

/// The set of the places for which `f` holds.
pub(super) fn set<const N: usize>(f: impl Fn(usize) -> bool) -> u64 {
    (0..N).fold(0, |set, i| if f(i) { set | 1 << i } else { set })
}

/// Returns `true` if corner or place `k` is in the set.
#[inline(always)]
pub(super) fn has(set: impl Into<u64>, k: usize) -> bool {
    set.into() >> k & 1 == 1
}

/// The places in a set.
pub(super) fn each(mut set: u64) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let next = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (next < 64).then_some(next)
    })
}

/// Returns `true` if the corners span a face: at least three belong to the same one.
pub(super) fn spans_face(set: u8) -> bool {
    FACES.iter().any(|f| (set & f).count_ones() >= 3)
}

/// Number of corners in the set, and the corners. Opposite ones of a face are neighbors, so that their sums cancel.
pub(super) fn in_pairs(set: u8) -> (usize, [u8; 8]) {
    // The bit that all corners have in common selects the face. The opposite corner differs in the other two.
    let flip = match (0..3).find(|&bit| {
        let ones = FACES[2 * bit + 1];
        set & ones == set || set & !ones == set
    }) {
        Some(bit) => 7 ^ (1 << bit),
        None => 7,
    };
    let (mut count, mut corner, mut left) = (0, [0; 8], set);
    while left != 0 {
        let k = left.trailing_zeros() as usize;
        for j in [k, k ^ flip] {
            if has(left, j) {
                corner[count] = j as u8;
                count += 1;
                left &= !(1 << j);
            }
        }
    }
    (count, corner)
}

#[cfg(test)]
mod tests;
