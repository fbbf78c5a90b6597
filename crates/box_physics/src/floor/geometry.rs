//! Where the corners are, and how the body answers impulses at them (the Delassus operator).

use glam::{DMat3, DVec3};

use super::Floor;
use crate::body::RigidBox;
use crate::state::BodyState;

/// One vector a corner.
pub(super) type Corner3 = [DVec3; 8];

/// The eight corners at one instant; index bits as in [`crate::aabb::corners`].
#[derive(Clone, Copy, Default)]
pub(super) struct Corners {
    /// r_k = R (±h_x, ±h_y, ±h_z): from the center to the corner \[m\], world axes.
    pub(super) lever: Corner3,
    /// c_k = n·(x + r_k) − height \[m\].
    pub(super) height: [f64; 8],
}

impl Corners {
    /// The terms are added in an order in which opposite corners of a level face get levers that
    /// are opposite to the last bit: a flat landing then has a torque of exactly zero.
    pub(super) fn at(floor: &Floor, body: &RigidBox, state: &BodyState) -> Self {
        let edges = half_edges(body, DMat3::from_quat(state.rotation));
        let lever = core::array::from_fn(|k| lever(edges, k));
        let mut new = Self {
            lever,
            height: [0.0; 8],
        };
        new.rise(floor, state);
        new
    }

    /// The same attitude at the height of `state`.
    pub(super) fn rise(&mut self, floor: &Floor, state: &BodyState) {
        let base = state.position.y - floor.height;
        self.height = self.lever.map(|r| base + r.y);
    }

    /// The height of the lowest corner \[m\].
    pub(super) fn lowest(&self) -> f64 {
        self.height.iter().fold(f64::INFINITY, |a, &c| a.min(c))
    }

    /// The corners not higher than `tolerance` \[m\].
    pub(super) fn touching(&self, tolerance: f64) -> u8 {
        mask(|k| self.height[k] <= tolerance)
    }
}

/// The box's axes in the world, as long as its half-extents \[m\].
fn half_edges(body: &RigidBox, attitude: DMat3) -> [DVec3; 3] {
    let h = body.half_extents();
    [
        attitude.x_axis * h.x,
        attitude.y_axis * h.y,
        attitude.z_axis * h.z,
    ]
}

/// r_k \[m\].
#[inline(always)]
fn lever([x, y, z]: [DVec3; 3], k: usize) -> DVec3 {
    let sign = |bit: usize| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
    (sign(0) * x + sign(2) * z) + sign(1) * y
}

/// The levers of the corners in `set`; what stands for the others is not used.
pub(super) fn levers(body: &RigidBox, attitude: DMat3, set: u8) -> Corner3 {
    let edges = half_edges(body, attitude);
    let mut levers = [DVec3::ZERO; 8];
    for (k, r) in levers.iter_mut().enumerate() {
        if has(set, k) {
            *r = lever(edges, k);
        }
    }
    levers
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
    (0..8).fold(0, |m, k| if f(k) { m | 1 << k } else { m })
}

/// Whether corner `k` is in the set.
#[inline(always)]
pub(super) fn has(set: u8, k: usize) -> bool {
    set >> k & 1 == 1
}

/// Whether the corners hold a face: three of one face do, and so do four.
pub(super) fn spans_face(set: u8) -> bool {
    FACES.iter().any(|f| (set & f).count_ones() >= 3)
}

/// How many corners are in the set, and which: opposite ones of a face are neighbors, so that their sums cancel.
pub(super) fn in_pairs(set: u8) -> (usize, [u8; 8]) {
    // The bit that all have in common names the face; its opposite corner flips the other two.
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

/// A few corners and the mass behind them: the operator W with the 3×3 blocks
/// W_jk = 1/m − [r_j]× I_w⁻¹ [r_k]×, never formed: Wp is the velocity of the corners after the
/// impulses p, that is, one sum over the corners and one twist.
#[derive(Clone, Copy)]
pub(super) struct DelassusOperator {
    /// How many corners.
    pub(super) count: usize,
    /// Their indices, as [`in_pairs`] tells them.
    pub(super) corner: [u8; 8],
    /// Their levers \[m\].
    pub(super) lever: Corner3,
    inverse_mass: f64,
    inverse_inertia: DMat3,
}

impl DelassusOperator {
    /// The corners `set` of a body whose world axes are `attitude`.
    pub(super) fn new(body: &RigidBox, attitude: DMat3, lever: &Corner3, set: u8) -> Self {
        let j = body.inverse_inertia();
        let scaled = DMat3::from_cols(
            attitude.x_axis * j.x,
            attitude.y_axis * j.y,
            attitude.z_axis * j.z,
        );
        let (count, corner) = in_pairs(set);
        let mut new = Self {
            count,
            corner,
            lever: [DVec3::ZERO; 8],
            inverse_mass: body.inverse_mass(),
            inverse_inertia: scaled * attitude.transpose(),
        };
        for i in 0..count {
            new.lever[i] = lever[usize::from(corner[i])];
        }
        new
    }

    /// Σ p_k and Σ r_k × p_k, added in pairs.
    #[inline]
    pub(super) fn resultant(&self, p: &Corner3) -> (DVec3, DVec3) {
        let mut force = DVec3::ZERO;
        let mut torque = DVec3::ZERO;
        let mut i = 0;
        while i < self.count {
            // Beyond `count` the impulses are zero.
            let j = (i + 1).min(7);
            let second = if i + 1 < self.count {
                (p[j], self.lever[j].cross(p[j]))
            } else {
                (DVec3::ZERO, DVec3::ZERO)
            };
            force += p[i] + second.0;
            torque += self.lever[i].cross(p[i]) + second.1;
            i += 2;
        }
        (force, torque)
    }

    /// The change of (v, ω) that the impulses p \[N s\] make.
    #[inline]
    pub(super) fn twist(&self, p: &Corner3) -> (DVec3, DVec3) {
        self.twist_of(self.resultant(p))
    }

    /// The change of (v, ω) that an impulse \[N s\] at the center and an angular impulse \[N m s\] make.
    #[inline]
    pub(super) fn twist_of(&self, (force, torque): (DVec3, DVec3)) -> (DVec3, DVec3) {
        (force * self.inverse_mass, self.inverse_inertia * torque)
    }

    /// The corners' velocities for the twist (v, ω).
    #[inline]
    pub(super) fn velocities(&self, (v, omega): (DVec3, DVec3)) -> Corner3 {
        let mut u = [DVec3::ZERO; 8];
        for i in 0..self.count {
            u[i] = v + omega.cross(self.lever[i]);
        }
        u
    }

    /// W p.
    #[inline]
    pub(super) fn response(&self, p: &Corner3) -> Corner3 {
        self.velocities(self.twist(p))
    }

    /// The corners at the places `kept` alone, in the same order.
    pub(super) fn part(&self, kept: u8) -> Self {
        let mut part = Self { count: 0, ..*self };
        for i in (0..self.count).filter(|&i| has(kept, i)) {
            part.corner[part.count] = self.corner[i];
            part.lever[part.count] = self.lever[i];
            part.count += 1;
        }
        part
    }

    /// Whether its corners hold a face.
    pub(super) fn spans_face(&self) -> bool {
        let corners = self.corner[..self.count].iter();
        spans_face(corners.fold(0, |set, k| set | 1 << k))
    }

    /// I_w⁻¹
    pub(super) fn inverse_inertia(&self) -> DMat3 {
        self.inverse_inertia
    }

    /// 1/m [1/kg].
    pub(super) fn inverse_mass(&self) -> f64 {
        self.inverse_mass
    }

    /// J_w [r_j]×: the change of ω by impulses along the axes at the j-th corner.
    pub(super) fn swing(&self, j: usize) -> DMat3 {
        let (r, i) = (self.lever[j], &self.inverse_inertia);
        DMat3::from_cols(
            r.z * i.y_axis - r.y * i.z_axis,
            r.x * i.z_axis - r.z * i.x_axis,
            r.y * i.x_axis - r.x * i.y_axis,
        )
    }

    /// W_ij [1/kg]: the velocity of the i-th corner for an impulse at the j-th, whose [`DelassusOperator::swing`] this is.
    pub(super) fn block(&self, i: usize, swing: &DMat3) -> DMat3 {
        let (r, m) = (self.lever[i], self.inverse_mass);
        DMat3::from_cols(
            swing.x_axis.cross(r) + DVec3::new(m, 0.0, 0.0),
            swing.y_axis.cross(r) + DVec3::new(0.0, m, 0.0),
            swing.z_axis.cross(r) + DVec3::new(0.0, 0.0, m),
        )
    }

    /// An upper bound of the largest eigenvalue of W [1/kg]: its trace.
    pub(super) fn norm_bound(&self) -> f64 {
        let j = &self.inverse_inertia;
        let trace = j.x_axis.x + j.y_axis.y + j.z_axis.z;
        let swing = |r: &DVec3| trace * r.length_squared() - r.dot(*j * *r);
        let swings: f64 = self.lever[..self.count].iter().map(swing).sum();
        3.0 * self.count as f64 * self.inverse_mass + swings
    }

    /// Largest length of a corner's vector.
    pub(super) fn largest(&self, u: &Corner3) -> f64 {
        u[..self.count]
            .iter()
            .fold(0.0, |a: f64, v| a.max(v.length_squared()))
            .sqrt()
    }

    /// Σ a_k·b_k
    pub(super) fn dot(&self, a: &Corner3, b: &Corner3) -> f64 {
        (0..self.count).map(|i| a[i].dot(b[i])).sum()
    }

    /// Applies the impulses p to the state.
    pub(super) fn apply(&self, body: &RigidBox, state: &mut BodyState, p: &Corner3) {
        let (force, torque) = self.resultant(p);
        state.velocity += force * body.inverse_mass();
        state.angular_momentum += state.rotation.inverse() * torque;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn tilted() -> (RigidBox, BodyState) {
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.375), 3.0).expect("valid");
        let state = BodyState::at_pose(
            DVec3::new(1.0, 2.0, 3.0),
            DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7),
        )
        .with_velocity(DVec3::new(0.1, -0.4, 0.9))
        .with_angular_velocity(&body, DVec3::new(2.0, -1.0, 0.5));
        (body, state)
    }

    #[test]
    fn corners_are_where_the_state_says() {
        let (body, state) = tilted();
        let floor = Floor::new(0.5, 0.3, 0.5).expect("valid");
        let c = Corners::at(&floor, &body, &state);
        for (k, r) in crate::aabb::corners(body.half_extents())
            .into_iter()
            .enumerate()
        {
            let point = state.point(r);
            assert!((state.position + c.lever[k] - point).length() < 1e-15);
            assert!((c.height[k] - (point.y - 0.5)).abs() < 1e-15);
        }
    }

    /// An impulse's effect on the corners' velocities is what applying it and looking gives.
    #[test]
    fn response_is_what_an_impulse_does() {
        let (body, state) = tilted();
        let c = Corners::at(&Floor::default(), &body, &state);
        let attitude = DMat3::from_quat(state.rotation);
        let operator = DelassusOperator::new(&body, attitude, &c.lever, 0b1011_0010);
        assert_eq!(operator.count, 4);
        let mut p = [DVec3::ZERO; 8];
        for (i, q) in p.iter_mut().enumerate().take(4) {
            let i = i as f64;
            *q = DVec3::new(0.3 - i, 0.7 * i, 1.1 - 0.2 * i);
        }
        let mut after = state;
        operator.apply(&body, &mut after, &p);
        let change = operator.response(&p);
        let twist = |s: &BodyState| operator.velocities((s.velocity, s.angular_velocity(&body)));
        let (before, after) = (twist(&state), twist(&after));
        for i in 0..4 {
            assert!((after[i] - before[i] - change[i]).length() < 1e-13);
        }
        // The bound bounds: a Rayleigh quotient never exceeds it.
        let quotient = operator.dot(&p, &change) / operator.dot(&p, &p);
        assert!(quotient > 0.0 && quotient <= operator.norm_bound());
    }

    #[test]
    fn faces() {
        assert!(spans_face(0b0000_1111) && spans_face(0b0011_0001) && spans_face(0b1111_1111));
        assert!(!spans_face(0b0000_0011) && !spans_face(0b1000_0001) && !spans_face(0));
    }

    #[test]
    fn a_level_face_has_no_torque_to_the_bit() {
        let body = RigidBox::new(DVec3::new(0.7, 0.2, 0.3), 1.0).expect("valid");
        for i in 0..100 {
            let (s, c) = crate::math::sin_cos(0.1 + f64::from(i));
            let state = BodyState::at_pose(DVec3::Y, DQuat::from_xyzw(0.0, s, 0.0, c));
            let corners = Corners::at(&Floor::default(), &body, &state);
            let bottom = corners.touching(0.85);
            assert_eq!(bottom.count_ones(), 4);
            let attitude = DMat3::from_quat(state.rotation);
            let operator = DelassusOperator::new(&body, attitude, &corners.lever, bottom);
            let mut p = [DVec3::ZERO; 8];
            p[..4].fill(DVec3::Y * 0.3);
            assert_eq!(operator.resultant(&p).1, DVec3::ZERO);
        }
    }
}
