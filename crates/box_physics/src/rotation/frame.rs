//! The axes of a splitting of the free rotation.

use glam::DVec3;

/// The axes of a splitting: outer, inner and third. The third is reversed if necessary to make the frame right-handed.
///
/// Vectors of the body **and** of the world are expressed in this frame. The change of frame only permutes their
/// components and those of the attitude's vector part, so the flows need no branch on the axis.
///
/// The frame is stored as selector bits, so that the conversions need no branch and no index. Bit 0: the outer axis is
/// x. Bit 1: it is y. Bits 2 and 3: the same for the inner axis. Bit 63: the third axis is reversed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SplitFrame(u64);

/// Sign bit of an f64 and of the third axis of a frame.
const SIGN: u64 = 1 << 63;

impl SplitFrame {
    /// The frame of two different axes, 0 to 2.
    pub(crate) fn new(outer: usize, inner: usize) -> Self {
        let bit = |set: bool, place: u32| u64::from(set) << place;
        Self(
            bit(outer == 0, 0)
                | bit(outer == 1, 1)
                | bit(inner == 0, 2)
                | bit(inner == 1, 3)
                | bit(inner != (outer + 1) % 3, 63),
        )
    }

    /// The body axis of the two rotations by half steps.
    #[inline(always)]
    pub(crate) fn outer(self) -> usize {
        let [x, y, ..] = self.bits();
        if x {
            0
        } else if y {
            1
        } else {
            2
        }
    }

    /// The component of a vector along the third axis, which has the reference moment.
    #[inline(always)]
    pub(crate) fn third_of(self, v: DVec3) -> f64 {
        let [outer_x, outer_y, inner_x, inner_y] = self.bits();
        if !(outer_x | inner_x) {
            v.x
        } else if !(outer_y | inner_y) {
            v.y
        } else {
            v.z
        }
    }

    #[inline(always)]
    fn bits(self) -> [bool; 4] {
        [0, 1, 2, 3].map(|place: u32| self.0 & (1 << place) != 0)
    }

    /// Returns `x`, negated if the third axis is reversed.
    #[inline(always)]
    fn turned(self, x: f64) -> f64 {
        f64::from_bits(x.to_bits() ^ (self.0 & SIGN))
    }

    #[inline(always)]
    pub(super) fn along(self, v: DVec3) -> [f64; 3] {
        let [outer_x, outer_y, inner_x, inner_y] = self.bits();
        let pick = |x: bool, y: bool| {
            if x {
                v.x
            } else if y {
                v.y
            } else {
                v.z
            }
        };
        [
            pick(outer_x, outer_y),
            pick(inner_x, inner_y),
            self.turned(self.third_of(v)),
        ]
    }

    #[inline(always)]
    pub(super) fn back(self, v: [f64; 3]) -> DVec3 {
        let [outer_x, outer_y, inner_x, inner_y] = self.bits();
        let third = self.turned(v[2]);
        let pick = |outer: bool, inner: bool| {
            if outer {
                v[0]
            } else if inner {
                v[1]
            } else {
                third
            }
        };
        DVec3::new(
            pick(outer_x, inner_x),
            pick(outer_y, inner_y),
            pick(!(outer_x | outer_y), !(inner_x | inner_y)),
        )
    }
}
