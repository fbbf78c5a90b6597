//! The corners over several planes, and how the body answers impulses where they touch.

use glam::{DMat3, DVec3};

use super::Plane;
use crate::body::RigidBox;
use crate::floor::geometry::Places;
use crate::floor::operator::DelassusOperator;
use crate::state::BodyState;

/// Planes that may be near at once: as many as a closed box has.
pub(super) const PLANES: usize = 6;
/// Pairs of a plane and a corner: pair 8j + k is corner k over plane j.
pub(super) const PAIRS: usize = 8 * PLANES;

/// One vector a contact.
pub(super) type Each = [DVec3; PAIRS];
pub(super) const NONE: Each = [DVec3::ZERO; PAIRS];

/// Where all corners are over all planes.
pub(in crate::floor) type Gaps = Places<PAIRS>;

impl Gaps {
    /// `elapsed` \[s\] after the planes were where they say.
    pub(in crate::floor) fn over(
        planes: &[Plane],
        body: &RigidBox,
        state: &BodyState,
        elapsed: f64,
    ) -> Self {
        let mut new = Self::turned(body, DMat3::from_quat(state.rotation));
        new.move_to(planes, state, elapsed);
        new
    }

    /// The same attitude at the place of `state`.
    fn move_to(&mut self, planes: &[Plane], state: &BodyState, elapsed: f64) {
        for (j, plane) in planes.iter().enumerate() {
            let base = plane.height(state.position) - plane.rise() * elapsed;
            for k in 0..8 {
                self.height[8 * j + k] = base + plane.shape.normal.dot(self.lever(k));
            }
        }
    }

    /// The pair whose corner is lowest, and its height \[m\].
    pub(super) fn deepest(&self) -> (usize, f64) {
        let heights = self.height.into_iter().enumerate();
        let lower = heights.reduce(|a, b| if b.1 < a.1 { b } else { a });
        lower.unwrap_or((0, f64::INFINITY))
    }

    /// Moves the body out of the deepest plane, until it is in none; never pushes it into one. Between planes that
    /// leave no room for it that does not end.
    pub(super) fn leave(&mut self, planes: &[Plane], state: &mut BodyState, elapsed: f64) {
        for _ in 0..8 * planes.len() {
            let (pair, gap) = self.deepest();
            if gap >= 0.0 || !gap.is_finite() {
                break;
            }
            state.position -= planes[pair / 8].shape.normal * gap;
            self.move_to(planes, state, elapsed);
        }
    }
}

impl DelassusOperator<PAIRS> {
    /// An upper bound of the largest eigenvalue of W [1/kg].
    pub(super) fn bound(&self) -> f64 {
        let mut spread = DMat3::ZERO;
        for r in &self.lever[..self.count] {
            let outer = DMat3::from_cols(*r * r.x, *r * r.y, *r * r.z);
            spread += DMat3::from_diagonal(DVec3::splat(r.length_squared())) - outer;
        }
        let block = self.inverse_inertia * spread;
        let frobenius = (block.x_axis.length_squared()
            + block.y_axis.length_squared()
            + block.z_axis.length_squared())
        .sqrt();
        self.count as f64 * self.inverse_mass + frobenius
    }

    /// Whether the places of the contacts span a plane: then no turn leaves all of them where they are, and a body that
    /// they hold is not merely balanced.
    pub(super) fn support(&self) -> bool {
        let Some(&first) = self.lever[..self.count].first() else {
            return false;
        };
        let arm = |i: usize| self.lever[i] - first;
        let far = (0..self.count).fold(DVec3::ZERO, |far, i| {
            if arm(i).length_squared() > far.length_squared() {
                arm(i)
            } else {
                far
            }
        });
        let least = 1e-3 * far.length_squared();
        (0..self.count).any(|i| far.cross(arm(i)).length() > least)
    }
}
