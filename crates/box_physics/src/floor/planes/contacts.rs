//! The corners over several planes, and how the body answers impulses where they touch.

use glam::{DMat3, DVec3};

use super::Plane;
use crate::body::RigidBox;
use crate::floor::geometry::{Corner3, levers};
use crate::state::BodyState;

/// Planes that may be near at once: as many as a closed box has.
pub(super) const PLANES: usize = 6;
/// Pairs of a plane and a corner: pair 8j + k is corner k over plane j.
pub(super) const PAIRS: usize = 8 * PLANES;

/// One vector a contact.
pub(super) type Each = [DVec3; PAIRS];
pub(super) const NONE: Each = [DVec3::ZERO; PAIRS];

/// The set of the pairs for which `f` holds.
pub(super) fn pairs(f: impl Fn(usize) -> bool) -> u64 {
    (0..PAIRS).fold(0, |set, i| if f(i) { set | 1 << i } else { set })
}

/// The pairs of a set.
pub(super) fn each(set: u64) -> impl Iterator<Item = usize> {
    (0..PAIRS).filter(move |i| set >> i & 1 == 1)
}

/// Where all corners are over all planes.
#[derive(Clone, Copy)]
pub(super) struct Gaps {
    /// From the center to the corners \[m\], world axes.
    pub(super) lever: Corner3,
    /// Heights of the corners over the planes \[m\]; infinite where there is no plane.
    pub(super) gap: [f64; PAIRS],
}

impl Gaps {
    pub(super) const NONE: Self = Self {
        lever: [DVec3::ZERO; 8],
        gap: [f64::INFINITY; PAIRS],
    };

    /// `elapsed` \[s\] after the planes were where they say.
    pub(super) fn at(planes: &[Plane], body: &RigidBox, state: &BodyState, elapsed: f64) -> Self {
        let lever = levers(body, DMat3::from_quat(state.rotation), 0xff);
        let mut new = Self {
            lever,
            ..Self::NONE
        };
        new.rise(planes, state, elapsed);
        new
    }

    /// The same attitude at the place of `state`.
    fn rise(&mut self, planes: &[Plane], state: &BodyState, elapsed: f64) {
        for (j, plane) in planes.iter().enumerate() {
            let base = plane.height(state.position) - plane.rise() * elapsed;
            for k in 0..8 {
                self.gap[8 * j + k] = base + plane.shape.normal.dot(self.lever[k]);
            }
        }
    }

    /// The pair whose corner is lowest, and its height \[m\].
    pub(super) fn lowest(&self) -> (usize, f64) {
        let mut lowest = (0, f64::INFINITY);
        for (i, &gap) in self.gap.iter().enumerate() {
            if gap < lowest.1 {
                lowest = (i, gap);
            }
        }
        lowest
    }

    /// The pairs not higher than `tolerance` \[m\].
    pub(super) fn touching(&self, tolerance: f64) -> u64 {
        pairs(|i| self.gap[i] <= tolerance)
    }

    /// Moves the body out of the deepest plane, until it is in none; never pushes it into one. Between planes that
    /// leave no room for it that does not end.
    pub(super) fn recover(&mut self, planes: &[Plane], state: &mut BodyState, elapsed: f64) {
        for _ in 0..8 * planes.len() {
            let (pair, gap) = self.lowest();
            if gap >= 0.0 || !gap.is_finite() {
                break;
            }
            state.position -= planes[pair / 8].shape.normal * gap;
            self.rise(planes, state, elapsed);
        }
    }
}

/// The velocities of all pairs along their normals, relative to the planes [m/s].
pub(super) fn normal_velocities(
    planes: &[Plane],
    body: &RigidBox,
    state: &BodyState,
    gaps: &Gaps,
) -> [f64; PAIRS] {
    let omega = state.angular_velocity(body);
    let mut speed = [0.0; PAIRS];
    for (j, plane) in planes.iter().enumerate() {
        for k in 0..8 {
            let u = state.velocity + omega.cross(gaps.lever[k]) - plane.surface.velocity;
            speed[8 * j + k] = plane.shape.normal.dot(u);
        }
    }
    speed
}

/// Some contacts and the mass behind them: the operator W, as at the floor, in world axes. The change of the twist (v, ω)
/// tells that of all velocities.
#[derive(Clone, Copy)]
pub(super) struct Contacts {
    pub(super) count: usize,
    pub(super) pair: [u8; PAIRS],
    /// From the center \[m\].
    pub(super) lever: Each,
    pub(super) normal: Each,
    /// Of the plane [m/s].
    velocity: Each,
    pub(super) inverse_mass: f64,
    pub(super) inverse_inertia: DMat3,
}

impl Contacts {
    /// The contacts `set` of a body whose world axes are `attitude`.
    pub(super) fn new(
        planes: &[Plane],
        body: &RigidBox,
        attitude: DMat3,
        lever: &Corner3,
        set: u64,
    ) -> Self {
        let j = body.inverse_inertia();
        let scaled = DMat3::from_cols(
            attitude.x_axis * j.x,
            attitude.y_axis * j.y,
            attitude.z_axis * j.z,
        );
        let mut new = Self {
            count: 0,
            pair: [0; PAIRS],
            lever: NONE,
            normal: NONE,
            velocity: NONE,
            inverse_mass: body.inverse_mass(),
            inverse_inertia: scaled * attitude.transpose(),
        };
        for pair in each(set) {
            let (i, plane) = (new.count, &planes[pair / 8]);
            new.pair[i] = pair as u8;
            new.lever[i] = lever[pair % 8];
            new.normal[i] = plane.shape.normal;
            new.velocity[i] = plane.surface.velocity;
            new.count += 1;
        }
        new
    }

    /// Σ p_k and Σ r_k × p_k.
    pub(super) fn resultant(&self, p: &Each) -> (DVec3, DVec3) {
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        for i in 0..self.count {
            force += p[i];
            torque += self.lever[i].cross(p[i]);
        }
        (force, torque)
    }

    /// The change of (v, ω) that the impulses p \[N s\] make.
    pub(super) fn twist(&self, p: &Each) -> (DVec3, DVec3) {
        let (force, torque) = self.resultant(p);
        (force * self.inverse_mass, self.inverse_inertia * torque)
    }

    /// The contacts' velocities for the twist (v, ω).
    pub(super) fn velocities(&self, (v, omega): (DVec3, DVec3)) -> Each {
        let mut u = NONE;
        for i in 0..self.count {
            u[i] = v + omega.cross(self.lever[i]);
        }
        u
    }

    /// The same relative to the planes.
    pub(super) fn slips(&self, twist: (DVec3, DVec3)) -> Each {
        let mut u = self.velocities(twist);
        for i in 0..self.count {
            u[i] -= self.velocity[i];
        }
        u
    }

    /// Largest length of a contact's vector.
    pub(super) fn largest(&self, u: &Each) -> f64 {
        let squares = u[..self.count].iter().map(|v| v.length_squared());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// Σ a_k·b_k
    pub(super) fn dot(&self, a: &Each, b: &Each) -> f64 {
        (0..self.count).map(|i| a[i].dot(b[i])).sum()
    }

    /// The part of a contact's vector along its plane.
    pub(super) fn along(&self, i: usize, u: DVec3) -> DVec3 {
        u - self.normal[i] * self.normal[i].dot(u)
    }

    /// An upper bound of the largest eigenvalue of W [1/kg], as at the floor.
    pub(super) fn norm_bound(&self) -> f64 {
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

    /// Applies the impulses p to the state.
    pub(super) fn apply(&self, state: &mut BodyState, p: &Each) {
        let (force, torque) = self.resultant(p);
        state.velocity += force * self.inverse_mass;
        state.angular_momentum += state.rotation.inverse() * torque;
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

    /// Impulses p with u + Wp = 0 along the normals, and at the contacts in `whole` altogether, of least norm: by
    /// conjugate gradients from zero, as at the floor.
    pub(super) fn cancel(&self, u: &Each, whole: u64) -> Each {
        let n = self.count;
        let allowed = |i: usize, v: DVec3| {
            if whole >> i & 1 == 1 {
                v
            } else {
                self.normal[i] * self.normal[i].dot(v)
            }
        };
        let (mut p, mut residual) = (NONE, NONE);
        for i in 0..n {
            residual[i] = -allowed(i, u[i]);
        }
        let mut direction = residual;
        let mut square = self.dot(&residual, &residual);
        let enough = square * 1e-34;
        let null = 1e-12 * self.norm_bound();
        for _ in 0..12 {
            if square <= enough {
                break;
            }
            let mut image = self.velocities(self.twist(&direction));
            for i in 0..n {
                image[i] = allowed(i, image[i]);
            }
            let curvature = self.dot(&direction, &image);
            if curvature <= null * self.dot(&direction, &direction) {
                break;
            }
            let step = square / curvature;
            for i in 0..n {
                p[i] += step * direction[i];
                residual[i] -= step * image[i];
            }
            let next = self.dot(&residual, &residual);
            let beta = next / square;
            for i in 0..n {
                direction[i] = residual[i] + beta * direction[i];
            }
            square = next;
        }
        p
    }
}
