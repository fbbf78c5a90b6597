//! Free rotation: the exponential map, planar rotations, and the exact sub-flows of the splitting.

use glam::{DQuat, DVec3};

use crate::body::{RigidBox, Splitting};
use crate::math::{AnyArgument, Trigonometry};
use crate::state::BodyState;

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

/// One Newton step toward unit length: q (3 − |q|²)/2. In group methods the quaternion is off by rounding
/// alone; there the step is exact to rounding and cheaper than a square root.
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

/// The Cayley map of the rotation vector u = hω: the unit quaternion along (u/2, 1), a turn of 2 atan(|u|/2)
/// about u.
#[inline(always)]
pub fn cayley_map(u: DVec3) -> DQuat {
    let c = 0.5 * u;
    let scale = 1.0 / (1.0 + c.length_squared()).sqrt();
    DQuat::from_xyzw(scale * c.x, scale * c.y, scale * c.z, scale)
}

/// Turns the body by `rate`·L_K \[rad\] about its own axis `K`: the flow of ½ δ L_K² over τ with `rate` = τδ.
/// The body momentum turns backward, because it is constant in the world. The versine 2 sin²(θ/2) in place of
/// the cosine keeps |L| ten times better.
#[inline(always)]
fn planar<const K: usize>(
    l: &mut [f64; 3],
    q: &mut [f64; 4],
    rate: f64,
    trigonometry: &mut impl Trigonometry,
) {
    let (i, j) = ((K + 1) % 3, (K + 2) % 3);
    let theta = rate * l[K];
    let (s, c) = trigonometry.sin_cos(0.5 * theta);
    let (sine, versine) = (2.0 * s * c, 2.0 * s * s);
    let (a, b) = (l[i], l[j]);
    l[i] = a + (sine * b - versine * a);
    l[j] = b - (sine * a + versine * b);
    let (qi, qj, qk, w) = (q[i], q[j], q[K], q[3]);
    q[i] = c * qi + s * qj;
    q[j] = c * qj - s * qi;
    q[K] = c * qk + s * w;
    q[3] = c * w - s * qk;
}

/// The axes of a splitting: outer, inner and third. The third is reversed if necessary, so that they are
/// right-handed. Body **and** world use this frame: it only permutes the components of vectors and of the
/// attitude's vector part, and the flows need no branch on the axis.
///
/// Stored as selector bits, so that entering and leaving the frame needs no branch and no index. Bit 0: the
/// outer axis is x. Bit 1: it is y. Bits 2 and 3: the same for the inner axis. Bit 63: the third axis is
/// reversed.
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

    /// The body axis that is turned about twice, by half steps.
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

    /// The component of a vector along the third axis, that of the reference moment.
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

    /// The third component, negated if the third axis is reversed.
    #[inline(always)]
    fn turned(self, x: f64) -> f64 {
        f64::from_bits(x.to_bits() ^ (self.0 & SIGN))
    }

    #[inline(always)]
    fn along(self, v: DVec3) -> [f64; 3] {
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
    fn back(self, v: [f64; 3]) -> DVec3 {
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

    /// Converts L and q to the frame's axes.
    #[inline(always)]
    pub(crate) fn enter(self, state: &BodyState) -> ([f64; 3], [f64; 4]) {
        let q = state.rotation;
        let [x, y, z] = self.along(DVec3::new(q.x, q.y, q.z));
        (self.along(state.angular_momentum), [x, y, z, q.w])
    }

    /// Converts L and q back to body axes and stores them.
    #[inline(always)]
    pub(crate) fn leave(self, state: &mut BodyState, l: [f64; 3], q: [f64; 4]) {
        let v = self.back([q[0], q[1], q[2]]);
        state.angular_momentum = self.back(l);
        state.rotation = DQuat::from_xyzw(v.x, v.y, v.z, q[3]);
    }
}

/// Rates of the three flows of a splitting.
#[derive(Clone, Copy)]
pub(crate) struct SplitRates {
    /// J_r of the reference axis.
    pub(crate) reference: f64,
    /// α of the outer axis.
    pub(crate) outer: f64,
    /// β of the inner axis.
    pub(crate) inner: f64,
}

impl SplitRates {
    #[inline(always)]
    pub(crate) fn of(s: &Splitting) -> Self {
        Self {
            reference: s.reference,
            outer: s.alpha,
            inner: s.beta,
        }
    }

    /// The exact flow of |L|²/2I_r over `h`: a rotation about the constant momentum. It commutes with the
    /// planar flows.
    #[inline(always)]
    fn reference_turn(
        &self,
        l: [f64; 3],
        q: [f64; 4],
        h: f64,
        trigonometry: &mut impl Trigonometry,
    ) -> [f64; 4] {
        let turn = DVec3::from_array(l) * (h * self.reference);
        let turn = exponential_map_by(turn, trigonometry);
        compose(DQuat::from_array(q), turn).to_array()
    }

    /// [`free_rotation_strang`] in the frame of the splitting.
    #[inline(always)]
    fn strang(
        &self,
        mut l: [f64; 3],
        q: [f64; 4],
        h: f64,
        trigonometry: &mut impl Trigonometry,
    ) -> ([f64; 3], [f64; 4]) {
        let mut q = self.reference_turn(l, q, h, trigonometry);
        planar::<0>(&mut l, &mut q, 0.5 * h * self.outer, trigonometry);
        planar::<1>(&mut l, &mut q, h * self.inner, trigonometry);
        planar::<0>(&mut l, &mut q, 0.5 * h * self.outer, trigonometry);
        (l, renormalize(DQuat::from_array(q)).to_array())
    }
}

/// Free rotation over `h` \[s\] by the symmetric-top splitting, order 2: exact rotation with the middle
/// moment, then a half, c whole, a half. Source: Fassò, J. Comput. Phys. 189 (2003) 527; `Splitting` selects
/// the axes. Symplectic and reversible. The world angular momentum is constant to rounding and the energy is
/// bounded, at any step. Exact for symmetric bodies and cubes.
#[inline(always)]
pub fn free_rotation_strang(body: &RigidBox, state: &mut BodyState, h: f64) {
    free_rotation_strang_by(body, state, h, &mut AnyArgument);
}

/// [`free_rotation_strang`] with a given sine and cosine.
#[inline(always)]
pub(crate) fn free_rotation_strang_by(
    body: &RigidBox,
    state: &mut BodyState,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) {
    let frame = body.splitting().frame;
    let (l, q) = frame.enter(state);
    let (l, q) = SplitRates::of(body.splitting()).strang(l, q, h, trigonometry);
    frame.leave(state, l, q);
}

/// The seven outer and six inner fractions of the order-4 composition S6 of Blanes and Moan (J. Comput. Appl.
/// Math. 142 (2002) 313): first halves. The rest is symmetric.
pub(crate) mod blanes_moan {
    /// Fractions of the outer flow: A₁ A₂ A₃, then 1 − 2(A₁+A₂+A₃) in the middle.
    pub(crate) const A: [f64; 3] = [0.0792036964311957, 0.353172906049774, -0.0420650803577195];
    /// Fractions of the inner flow: B₁ B₂, then ½ − (B₁+B₂).
    pub(crate) const B: [f64; 2] = [0.209515106613362, -0.143851773179818];
    /// The middle fraction of the outer flow.
    pub(crate) const A_MIDDLE: f64 = 1.0 - 2.0 * (A[0] + A[1] + A[2]);
    /// The third fraction of the inner flow.
    pub(crate) const B_THIRD: f64 = 0.5 - (B[0] + B[1]);
}

/// Free rotation over `h` \[s\] by the same two planar flows in the composition of Blanes and Moan, order 4:
/// A B A B A B A B A B A B A, thirteen planar rotations. Conserves the same quantities as
/// [`free_rotation_strang`].
pub fn free_rotation_order4(body: &RigidBox, state: &mut BodyState, h: f64) {
    free_rotation_order4_by(body, state, h, &mut AnyArgument);
}

/// [`free_rotation_order4`] with a given sine and cosine.
#[inline(always)]
pub(crate) fn free_rotation_order4_by(
    body: &RigidBox,
    state: &mut BodyState,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) {
    use blanes_moan::{A, A_MIDDLE, B, B_THIRD};
    let (frame, rates) = (body.splitting().frame, SplitRates::of(body.splitting()));
    let (mut l, q) = frame.enter(state);
    let mut q = rates.reference_turn(l, q, h, trigonometry);
    // Unrolled: a loop over the fractions would not be vectorized over the bodies.
    planar::<0>(&mut l, &mut q, A[0] * h * rates.outer, trigonometry);
    planar::<1>(&mut l, &mut q, B[0] * h * rates.inner, trigonometry);
    planar::<0>(&mut l, &mut q, A[1] * h * rates.outer, trigonometry);
    planar::<1>(&mut l, &mut q, B[1] * h * rates.inner, trigonometry);
    planar::<0>(&mut l, &mut q, A[2] * h * rates.outer, trigonometry);
    planar::<1>(&mut l, &mut q, B_THIRD * h * rates.inner, trigonometry);
    planar::<0>(&mut l, &mut q, A_MIDDLE * h * rates.outer, trigonometry);
    planar::<1>(&mut l, &mut q, B_THIRD * h * rates.inner, trigonometry);
    planar::<0>(&mut l, &mut q, A[2] * h * rates.outer, trigonometry);
    planar::<1>(&mut l, &mut q, B[1] * h * rates.inner, trigonometry);
    planar::<0>(&mut l, &mut q, A[1] * h * rates.outer, trigonometry);
    planar::<1>(&mut l, &mut q, B[0] * h * rates.inner, trigonometry);
    planar::<0>(&mut l, &mut q, A[0] * h * rates.outer, trigonometry);
    frame.leave(state, l, renormalize(DQuat::from_array(q)).to_array());
}

/// Free rotation over `h` \[s\] by five planar rotations x½ y½ z y½ x½, order 2 (McLachlan 1993; Reich 1994).
/// This is the textbook splitting, which does not separate the exact part first.
pub fn free_rotation_three_axes(body: &RigidBox, state: &mut BodyState, h: f64) {
    free_rotation_three_axes_by(body, state, h, &mut AnyArgument);
}

/// [`free_rotation_three_axes`] with a given sine and cosine.
#[inline(always)]
pub(crate) fn free_rotation_three_axes_by(
    body: &RigidBox,
    state: &mut BodyState,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) {
    let j = body.inverse_inertia();
    let mut l = state.angular_momentum.to_array();
    let mut q = state.rotation.to_array();
    planar::<0>(&mut l, &mut q, 0.5 * h * j.x, trigonometry);
    planar::<1>(&mut l, &mut q, 0.5 * h * j.y, trigonometry);
    planar::<2>(&mut l, &mut q, h * j.z, trigonometry);
    planar::<1>(&mut l, &mut q, 0.5 * h * j.y, trigonometry);
    planar::<0>(&mut l, &mut q, 0.5 * h * j.x, trigonometry);
    state.angular_momentum = DVec3::from_array(l);
    state.rotation = renormalize(DQuat::from_array(q));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tumbling() -> (RigidBox, BodyState) {
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid");
        let state =
            BodyState::default().with_body_angular_velocity(&body, DVec3::new(1.5, 2.5, 1.0));
        (body, state)
    }

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
    fn every_splitting_conserves_world_momentum_and_is_reversible() {
        type Flow = fn(&RigidBox, &mut BodyState, f64);
        let flows: [Flow; 3] = [
            free_rotation_strang,
            free_rotation_order4,
            free_rotation_three_axes,
        ];
        for flow in flows {
            let (body, start) = tumbling();
            let mut state = start;
            let l = start.angular_momentum_world();
            for _ in 0..600 {
                flow(&body, &mut state, 1.0 / 60.0);
            }
            assert!((state.angular_momentum_world() - l).length() < 1e-12 * l.length());
            for _ in 0..600 {
                flow(&body, &mut state, -1.0 / 60.0);
            }
            assert!(state.attitude_difference(&start) < 1e-12);
        }
    }

    #[test]
    fn symmetric_bodies_are_exact() {
        // q(t) = exp(t L_w/I₁) ∘ q₀ ∘ exp(t (1/I₃ − 1/I₁) L₃ e₃) with the symmetry axis y.
        let body = RigidBox::new(DVec3::new(0.25, 0.5, 0.25), 6.0).expect("valid");
        let start =
            BodyState::default().with_body_angular_velocity(&body, DVec3::new(0.7, 12.0, -0.4));
        let mut state = start;
        for _ in 0..600 {
            free_rotation_strang(&body, &mut state, 1.0 / 60.0);
        }
        let (l, j) = (start.angular_momentum, body.inverse_inertia());
        let spin = exponential_map(DVec3::Y * (10.0 * (j.y - j.x) * l.y));
        let mut exact = start;
        exact.rotation = compose(exponential_map(l * (10.0 * j.x)), spin);
        assert!(state.attitude_difference(&exact) < 1e-12);
    }

    #[test]
    fn cayley_turns_by_twice_the_arctangent() {
        let q = cayley_map(DVec3::Z * 1.2);
        let angle = 2.0 * libm::atan2(q.z, q.w);
        assert!((angle - 2.0 * libm::atan(0.6)).abs() < 1e-15);
    }
}
