//! Exact corrections. They move held corners exactly onto the floor, and remove exactly the velocity that the contact
//! forbids. Both are the smallest in the body's metric (kinetic energy), so the velocity correction can only remove
//! energy.

use glam::{DMat3, DVec3};

use super::geometry::{Corner3, in_pairs, spans_face};
use super::operator::DelassusOperator;
use crate::body::RigidBox;

/// Impulses p of least norm with u + Wp = 0 along the normal +y, and in all components at the corners in `whole`.
pub(super) fn cancel(operator: &DelassusOperator, u: &Corner3, whole: &[bool; 8]) -> Corner3 {
    let n = operator.count;
    let mut p = [DVec3::ZERO; 8];
    let normal_only = !whole[..n].contains(&true);
    let corners = operator.place[..n].iter().fold(0, |set, k| set | 1 << k);
    if normal_only && (n <= 2 || spans_face(corners)) {
        let arm = operator.lever.map(|r| r.cross(DVec3::Y));
        let turn = |torque: DVec3| operator.inverse_inertia * torque;
        if let Some(found) = stop_normals(&arm[..n], operator.inverse_mass, turn, &u.map(|u| u.y)) {
            return found.map(|p| DVec3::Y * p);
        }
    }
    match n {
        1 => p[0] = -(operator.block(0, &operator.swing(0)).inverse() * u[0]),
        2 if !normal_only => {
            // Begins with the corner that is stopped in all components.
            let (i, j) = if whole[0] { (0, 1) } else { (1, 0) };
            [p[i], p[j]] = Pair::of(operator, i, j).stop([u[i], u[j]], whole[j]);
        }
        _ => {
            let allowed = |i: usize, v: DVec3| if whole[i] { v } else { DVec3::Y * v.y };
            p = cancel_iteratively(operator, u, allowed);
        }
    }
    p
}

/// Normal impulses of least norm that stop corners with the normal velocities `u`. An impulse at a corner turns the
/// body by `turn` of its `arm`, r × n. Three or four corners must belong to one face and have three degrees of freedom.
/// For four, with opposite ones as neighbors, these are the mean and the differences of opposite ones: loading one
/// diagonal against the other has no effect. The smallest impulses have the same form; three linear equations give
/// them. `None` if the corners are nearly on a line, or too many.
fn stop_normals(
    arm: &[DVec3],
    inverse_mass: f64,
    turn: impl Fn(DVec3) -> DVec3,
    u: &[f64; 8],
) -> Option<[f64; 8]> {
    let mut p = [0.0; 8];
    match arm.len() {
        1 => p[0] = -u[0] / (inverse_mass + arm[0].dot(turn(arm[0]))),
        2 => {
            let (first, second) = (turn(arm[0]), turn(arm[1]));
            let a = inverse_mass + arm[0].dot(first);
            let c = inverse_mass + arm[0].dot(second);
            let d = inverse_mass + arm[1].dot(second);
            let inverse = 1.0 / (a * d - c * c);
            p[0] = inverse * (c * u[1] - d * u[0]);
            p[1] = inverse * (c * u[0] - a * u[1]);
        }
        n @ 3..=4 => {
            let (mut weight, mut arms) = (DVec3::ONE, [arm[0], arm[1], arm[2]]);
            let mut speed = DVec3::new(u[0], u[1], u[2]);
            if n == 4 {
                weight = DVec3::X * 2.0;
                arms = [
                    0.5 * ((arm[0] + arm[1]) + (arm[2] + arm[3])),
                    0.5 * (arm[1] - arm[0]),
                    0.5 * (arm[3] - arm[2]),
                ];
                let mean = 0.5 * ((u[0] + u[1]) + (u[2] + u[3]));
                speed = DVec3::new(mean, 0.5 * (u[1] - u[0]), 0.5 * (u[3] - u[2]));
            }
            let turns = arms.map(&turn);
            let column = |k: usize| {
                let through = DVec3::from_array(arms.map(|a| a.dot(turns[k])));
                through + weight * (inverse_mass * weight[k])
            };
            let matrix = DMat3::from_cols(column(0), column(1), column(2));
            let size = matrix.x_axis.x * matrix.y_axis.y * matrix.z_axis.z;
            let determinant = matrix.determinant();
            if determinant.is_nan() || determinant <= 1e-10 * size {
                return None;
            }
            let q = -(matrix.inverse() * speed);
            p[..4].copy_from_slice(&if n == 4 {
                let q = 0.5 * q;
                [q.x - q.y, q.x + q.y, q.x - q.z, q.x + q.z]
            } else {
                [q.x, q.y, q.z, 0.0]
            });
        }
        _ => return None,
    }
    Some(p)
}

/// Corners held along the normal, in body axes.
pub(super) struct HeldNormals {
    pub(super) count: usize,
    pub(super) corner: [u8; 8],
    /// r_k × n, body axes \[m\].
    arm: [DVec3; 8],
    solvable: bool,
}

impl HeldNormals {
    /// The corners `held`.
    pub(super) fn new(held: u8) -> Self {
        let (count, corner) = in_pairs(held);
        Self {
            count,
            corner,
            arm: [DVec3::ZERO; 8],
            solvable: count <= 2 || spans_face(held),
        }
    }

    /// Sets the arms for an attitude.
    pub(super) fn turn(&mut self, body: &RigidBox, attitude: &DMat3) {
        let up = attitude.transpose().y_axis;
        for i in 0..self.count {
            let sign = |bit: u8| f64::from(2 * (self.corner[i] >> bit & 1)) - 1.0;
            let lever = DVec3::new(sign(0), sign(1), sign(2)) * body.half_extents();
            self.arm[i] = lever.cross(up);
        }
    }

    /// The impulses that stop the normal velocities `u` of the corners, in their order. Returns the impulses, their
    /// sum, and their angular impulse about the center in body axes.
    pub(super) fn stop(
        &self,
        body: &RigidBox,
        u: impl Fn(usize) -> f64,
    ) -> Option<([f64; 8], f64, DVec3)> {
        if !self.solvable {
            return None;
        }
        let turn = |torque| body.inverse_inertia() * torque;
        let mut speed = [0.0; 8];
        for i in 0..self.count {
            speed[i] = u(usize::from(self.corner[i]));
        }
        let p = stop_normals(&self.arm[..self.count], body.inverse_mass(), turn, &speed)?;
        let torque = |i: usize| p[i] * self.arm[i];
        let sum = (p[0] + p[1]) + (p[2] + p[3]);
        Some((p, sum, (torque(0) + torque(1)) + (torque(2) + torque(3))))
    }
}

/// Two corners that form an edge.
#[derive(Clone, Copy)]
pub(super) struct Pair {
    /// W_00 and W_11, W_01 and W_10 [1/kg].
    pub(super) own: [DMat3; 2],
    pub(super) other: [DMat3; 2],
    /// Vector from one to the other \[m\].
    edge: DVec3,
}

impl Pair {
    /// The contacts `i` and `j`.
    pub(super) fn of(operator: &DelassusOperator, i: usize, j: usize) -> Self {
        let (first, second) = (operator.swing(i), operator.swing(j));
        let cross = operator.block(i, &second);
        Self {
            own: [operator.block(i, &first), operator.block(j, &second)],
            other: [cross, cross.transpose()],
            edge: operator.lever[j] - operator.lever[i],
        }
    }

    /// A_jj − A_ji A_ii⁻¹ A_ij and u_j − A_ji A_ii⁻¹ u_i: corner j with corner `i` stuck.
    pub(super) fn without(&self, i: usize, inverse: &DMat3, u: [DVec3; 2]) -> (DMat3, DVec3) {
        let j = 1 - i;
        let through = self.other[j] * *inverse;
        let reduced = self.own[j] - through * self.other[i];
        (reduced, u[j] - through * u[i])
    }

    /// The smallest impulses that stop the first corner, p_0 = −W_00⁻¹(u_0 + W_01 p_1), and the second one along the
    /// normal, or in all components if `both`.
    pub(super) fn stop(&self, u: [DVec3; 2], both: bool) -> [DVec3; 2] {
        let inverse = self.own[0].inverse();
        let (reduced, left) = self.without(0, &inverse, u);
        let along = self.edge.normalize_or_zero();
        let second = if both {
            // If one end of an edge is stopped, nothing moves the other end along it.
            let fill = DMat3::from_cols(along * along.x, along * along.y, along * along.z);
            -((reduced + fill * self.own[1].y_axis.y).inverse() * left)
        } else {
            DVec3::Y * (-left.y / reduced.y_axis.y)
        };
        let first = -(inverse * (u[0] + self.other[0] * second));
        if !both {
            return [first, second];
        }
        // Opposite impulses along the edge have no effect.
        let shift = along * (0.5 * (first - second).dot(along));
        [first - shift, second + shift]
    }
}

/// Impulses p of least norm with u + Wp = 0 in the components selected by `allowed` at each contact. Conjugate
/// gradients from zero (Hestenes, Stiefel 1952) treat all contacts equally, to the last bit. W has rank six at most, so
/// six steps are exact up to rounding, which the other six reduce.
pub(super) fn cancel_iteratively<const N: usize>(
    operator: &DelassusOperator<N>,
    u: &[DVec3; N],
    allowed: impl Fn(usize, DVec3) -> DVec3,
) -> [DVec3; N] {
    let n = operator.count;
    let mut p = [DVec3::ZERO; N];
    let mut residual = p;
    for i in 0..n {
        residual[i] = -allowed(i, u[i]);
    }
    let mut direction = residual;
    let mut square = operator.dot(&residual, &residual);
    let enough = square * 1e-34;
    let null = 1e-12 * operator.norm_bound();
    for _ in 0..12 {
        if square <= enough {
            break;
        }
        let mut image = operator.response(&direction);
        for i in 0..n {
            image[i] = allowed(i, image[i]);
        }
        let curvature = operator.dot(&direction, &image);
        // Four coplanar corners have one distribution without effect, along which rounding leaves a residual. A step
        // along it would only amplify noise.
        if curvature <= null * operator.dot(&direction, &direction) {
            break;
        }
        let step = square / curvature;
        for i in 0..n {
            p[i] += step * direction[i];
            residual[i] -= step * image[i];
        }
        let next = operator.dot(&residual, &residual);
        let beta = next / square;
        for i in 0..n {
            direction[i] = residual[i] + beta * direction[i];
        }
        square = next;
    }
    p
}

#[cfg(test)]
mod tests;
