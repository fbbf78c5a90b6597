//! Inverse-mass (Delassus) operator: the velocities of a body's corners due to impulses at the corners.

use glam::{DMat3, DVec3};

use super::geometry::{each, half_edges, lever};
use crate::body::RigidBox;
use crate::state::BodyState;

/// Contacts (corners at a plane) and their inverse-mass operator W, with the 3×3 blocks
/// W_jk = 1/m − [r_j]× I_w⁻¹ [r_k]×. W is never formed: the velocity Wp of the corners after the impulses p is one sum
/// over the contacts and one twist.
#[derive(Clone, Copy)]
pub(super) struct DelassusOperator<const N: usize = 8> {
    /// Number of contacts.
    pub(super) count: usize,
    /// Places of the contacts.
    pub(super) place: [u8; N],
    /// Levers of the contacts' corners \[m\].
    pub(super) lever: [DVec3; N],
    pub(super) inverse_mass: f64,
    /// I_w⁻¹
    pub(super) inverse_inertia: DMat3,
}

impl<const N: usize> DelassusOperator<N> {
    /// `true` if sums are formed in pairs: the corners on a floor are in the order of [`super::geometry::in_pairs`].
    const IN_PAIRS: bool = N == 8;

    /// The operator of the first `count` contacts in `place`, for a body with the world axes `attitude`.
    pub(super) fn at(body: &RigidBox, attitude: DMat3, (count, place): (usize, [u8; N])) -> Self {
        let j = body.inverse_inertia();
        let scaled = DMat3::from_cols(
            attitude.x_axis * j.x,
            attitude.y_axis * j.y,
            attitude.z_axis * j.z,
        );
        let mut new = Self {
            count,
            place,
            lever: [DVec3::ZERO; N],
            inverse_mass: body.inverse_mass(),
            inverse_inertia: scaled * attitude.transpose(),
        };
        let edges = half_edges(body, attitude);
        for i in 0..count {
            new.lever[i] = lever(edges, usize::from(place[i]) % 8);
        }
        new
    }

    /// Σ p_k and Σ r_k × p_k. The impulses beyond `count` must be 0.
    #[inline]
    pub(super) fn resultant(&self, p: &[DVec3; N]) -> (DVec3, DVec3) {
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        for i in (0..self.count).step_by(1 + usize::from(Self::IN_PAIRS)) {
            let (mut push, mut turn) = (p[i], self.lever[i].cross(p[i]));
            if Self::IN_PAIRS {
                let j = i + 1; // below N, which is even
                push += p[j];
                turn += self.lever[j].cross(p[j]);
            }
            force += push;
            torque += turn;
        }
        (force, torque)
    }

    /// The change of (v, ω) due to the impulses p \[N s\].
    #[inline]
    pub(super) fn twist(&self, p: &[DVec3; N]) -> (DVec3, DVec3) {
        self.twist_of(self.resultant(p))
    }

    /// The change of (v, ω) due to an impulse \[N s\] at the center and an angular impulse \[N m s\].
    #[inline]
    pub(super) fn twist_of(&self, (force, torque): (DVec3, DVec3)) -> (DVec3, DVec3) {
        (force * self.inverse_mass, self.inverse_inertia * torque)
    }

    /// The corners' velocities for the twist (v, ω).
    #[inline]
    pub(super) fn velocities(&self, (v, omega): (DVec3, DVec3)) -> [DVec3; N] {
        let mut u = [DVec3::ZERO; N];
        for i in 0..self.count {
            u[i] = v + omega.cross(self.lever[i]);
        }
        u
    }

    /// W p.
    #[inline]
    pub(super) fn response(&self, p: &[DVec3; N]) -> [DVec3; N] {
        self.velocities(self.twist(p))
    }

    /// b + Wp.
    pub(super) fn after(&self, b: &[DVec3; N], p: &[DVec3; N]) -> [DVec3; N] {
        self.moved(b, self.twist(p))
    }

    /// The velocities `b` plus those of the twist (v, ω).
    #[inline]
    pub(super) fn moved(&self, b: &[DVec3; N], (v, omega): (DVec3, DVec3)) -> [DVec3; N] {
        let mut w = *b;
        for i in 0..self.count {
            w[i] += v + omega.cross(self.lever[i]);
        }
        w
    }

    /// Largest length of a contact's vector.
    pub(super) fn largest(&self, u: &[DVec3; N]) -> f64 {
        let squares = u[..self.count].iter().map(|v| v.length_squared());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// Σ a_k·b_k
    pub(super) fn dot(&self, a: &[DVec3; N], b: &[DVec3; N]) -> f64 {
        (0..self.count).map(|i| a[i].dot(b[i])).sum()
    }

    /// The impulses in the order of places.
    pub(super) fn by_place(&self, p: &[DVec3; N]) -> [DVec3; N] {
        let mut placed = [DVec3::ZERO; N];
        self.add_to(&mut placed, p);
        placed
    }

    /// Adds impulses to `placed`, in the order of places.
    pub(super) fn add_to(&self, placed: &mut [DVec3; N], p: &[DVec3; N]) {
        for i in 0..self.count {
            placed[usize::from(self.place[i])] += p[i];
        }
    }

    /// Applies the impulses p to the state.
    pub(super) fn apply(&self, state: &mut BodyState, p: &[DVec3; N]) {
        let (force, torque) = self.resultant(p);
        state.velocity += force * self.inverse_mass;
        state.angular_momentum += state.rotation.inverse() * torque;
    }

    /// The operator of the contacts at the indices `kept`, in the same order.
    pub(super) fn part(&self, kept: u64) -> Self {
        let mut part = Self { count: 0, ..*self };
        for i in each(kept) {
            part.place[part.count] = self.place[i];
            part.lever[part.count] = self.lever[i];
            part.count += 1;
        }
        part
    }

    /// An upper bound of the largest eigenvalue of W [1/kg]: its trace.
    pub(super) fn norm_bound(&self) -> f64 {
        let j = &self.inverse_inertia;
        let trace = j.x_axis.x + j.y_axis.y + j.z_axis.z;
        let swing = |r: &DVec3| trace * r.length_squared() - r.dot(*j * *r);
        let swings: f64 = self.lever[..self.count].iter().map(swing).sum();
        3.0 * self.count as f64 * self.inverse_mass + swings
    }
}

impl DelassusOperator {
    /// The operator of the corners `set` of a body on a floor, with the world axes `attitude`.
    #[cfg(test)]
    pub(super) fn new(body: &RigidBox, attitude: DMat3, set: u8) -> Self {
        Self::at(body, attitude, super::geometry::in_pairs(set))
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
}

#[cfg(test)]
mod tests;
