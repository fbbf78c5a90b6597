//! Free rotation by splitting: planar rotations and the exact rotation with one reference moment.

use glam::{DQuat, DVec3};

use super::{SplitFrame, compose, exponential_map_by, renormalize};
use crate::body::{RigidBox, Splitting};
use crate::math::Trigonometry;
use crate::state::BodyState;

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

impl SplitFrame {
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

/// The exact flow of |L|²/2I_r over `h`: a rotation about the constant momentum. It commutes with the planar
/// flows.
#[inline(always)]
fn reference_turn(
    splitting: &Splitting,
    l: [f64; 3],
    q: [f64; 4],
    h: f64,
    trigonometry: &mut impl Trigonometry,
) -> [f64; 4] {
    let turn = DVec3::from_array(l) * (h * splitting.reference);
    let turn = exponential_map_by(turn, trigonometry);
    compose(DQuat::from_array(q), turn).to_array()
}

/// Free rotation over `h` \[s\] by the symmetric-top splitting, order 2: the exact rotation with the middle moment,
/// then half a step about the outer axis, a whole step about the inner axis and half a step about the outer axis.
///
/// Source: Fassò, J. Comput. Phys. 189 (2003) 527; `Splitting` selects the axes. Symplectic and reversible. The world
/// angular momentum is constant to rounding and the energy error is bounded, at any step size. Exact for symmetric
/// bodies and cubes.
#[inline(always)]
pub(crate) fn free_rotation_strang(
    body: &RigidBox,
    state: &mut BodyState,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) {
    let s = body.splitting();
    let (mut l, q) = s.frame.enter(state);
    let mut q = reference_turn(s, l, q, h, trigonometry);
    planar::<0>(&mut l, &mut q, 0.5 * h * s.alpha, trigonometry);
    planar::<1>(&mut l, &mut q, h * s.beta, trigonometry);
    planar::<0>(&mut l, &mut q, 0.5 * h * s.alpha, trigonometry);
    s.frame
        .leave(state, l, renormalize(DQuat::from_array(q)).to_array());
}

/// First halves of the seven outer and six inner fractions of the order-4 composition S6 of Blanes and Moan (J. Comput.
/// Appl. Math. 142 (2002) 313). The second halves are symmetric.
mod blanes_moan {
    /// Fractions of the outer flow: A₁ A₂ A₃, then 1 − 2(A₁+A₂+A₃) in the middle.
    pub(super) const A: [f64; 3] = [0.0792036964311957, 0.353172906049774, -0.0420650803577195];
    /// Fractions of the inner flow: B₁ B₂, then ½ − (B₁+B₂).
    pub(super) const B: [f64; 2] = [0.209515106613362, -0.143851773179818];
    /// The middle fraction of the outer flow.
    pub(super) const A_MIDDLE: f64 = 1.0 - 2.0 * (A[0] + A[1] + A[2]);
    /// The third fraction of the inner flow.
    pub(super) const B_THIRD: f64 = 0.5 - (B[0] + B[1]);
}

/// Free rotation over `h` \[s\] by the same two planar flows in the composition of Blanes and Moan, order 4: (A B)⁶ A,
/// thirteen planar rotations. Conserves the same quantities as [`free_rotation_strang`].
#[inline(always)]
pub(crate) fn free_rotation_order4(
    body: &RigidBox,
    state: &mut BodyState,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) {
    use blanes_moan::{A, A_MIDDLE, B, B_THIRD};
    let s = body.splitting();
    let (mut l, q) = s.frame.enter(state);
    let mut q = reference_turn(s, l, q, h, trigonometry);
    // Unrolled: a loop over the fractions would not be vectorized over the bodies.
    planar::<0>(&mut l, &mut q, A[0] * h * s.alpha, trigonometry);
    planar::<1>(&mut l, &mut q, B[0] * h * s.beta, trigonometry);
    planar::<0>(&mut l, &mut q, A[1] * h * s.alpha, trigonometry);
    planar::<1>(&mut l, &mut q, B[1] * h * s.beta, trigonometry);
    planar::<0>(&mut l, &mut q, A[2] * h * s.alpha, trigonometry);
    planar::<1>(&mut l, &mut q, B_THIRD * h * s.beta, trigonometry);
    planar::<0>(&mut l, &mut q, A_MIDDLE * h * s.alpha, trigonometry);
    planar::<1>(&mut l, &mut q, B_THIRD * h * s.beta, trigonometry);
    planar::<0>(&mut l, &mut q, A[2] * h * s.alpha, trigonometry);
    planar::<1>(&mut l, &mut q, B[1] * h * s.beta, trigonometry);
    planar::<0>(&mut l, &mut q, A[1] * h * s.alpha, trigonometry);
    planar::<1>(&mut l, &mut q, B[0] * h * s.beta, trigonometry);
    planar::<0>(&mut l, &mut q, A[0] * h * s.alpha, trigonometry);
    s.frame
        .leave(state, l, renormalize(DQuat::from_array(q)).to_array());
}

/// Free rotation over `h` \[s\] by five planar rotations x½ y½ z y½ x½, order 2 (McLachlan 1993; Reich 1994).
/// This is the textbook splitting, which does not separate the exact part first.
#[inline(always)]
pub(crate) fn free_rotation_three_axes(
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
    use crate::math::AnyArgument;
    use crate::rotation::exponential_map;

    #[test]
    fn symmetric_bodies_are_exact() {
        // q(t) = exp(t L_w/I₁) ∘ q₀ ∘ exp(t (1/I₃ − 1/I₁) L₃ e₃) with the symmetry axis y.
        let body = RigidBox::new(DVec3::new(0.25, 0.5, 0.25), 6.0).expect("valid");
        let start =
            BodyState::default().with_body_angular_velocity(&body, DVec3::new(0.7, 12.0, -0.4));
        let mut state = start;
        for _ in 0..600 {
            free_rotation_strang(&body, &mut state, 1.0 / 60.0, &mut AnyArgument);
        }
        let (l, j) = (start.angular_momentum, body.inverse_inertia());
        let spin = exponential_map(DVec3::Y * (10.0 * (j.y - j.x) * l.y));
        let mut exact = start;
        exact.rotation = compose(exponential_map(l * (10.0 * j.x)), spin);
        assert!(state.attitude_difference(&exact) < 1e-12);
    }
}
