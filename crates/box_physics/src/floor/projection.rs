//! Exact corrections: held corners exactly on the floor, and exactly without the velocity that the
//! contact forbids. Both are the smallest correction in the body's own metric (kinetic energy), so
//! the velocity one can only take energy.

use glam::{DMat3, DVec3};

use super::Floor;
use super::geometry::{Corner3, Corners, in_pairs, spans_face};
use super::operator::DelassusOperator;
use crate::body::RigidBox;
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// Impulses p with u + Wp = 0 in the components that `mask` lets through, and none in the others: of least
/// norm. A corner's mask is Y (the normal alone) or ONE.
pub(super) fn cancel(operator: &DelassusOperator, u: &Corner3, mask: &Corner3) -> Corner3 {
    let n = operator.count;
    let mut p = [DVec3::ZERO; 8];
    let normal_only = mask[..n].iter().all(|m| *m == DVec3::Y);
    if normal_only && (n <= 2 || operator.spans_face()) {
        let arm = operator.lever.map(|r| r.cross(DVec3::Y));
        let turn = |torque: DVec3| operator.inverse_inertia * torque;
        if let Some(found) = stop_normals(&arm[..n], operator.inverse_mass, turn, &u.map(|u| u.y)) {
            return found.map(|p| DVec3::Y * p);
        }
    }
    match n {
        1 => p[0] = -(operator.block(0, &operator.swing(0)).inverse() * u[0]),
        2 if !normal_only => {
            (p[0], p[1]) = cancel_two(operator, u, [0, 1].map(|i| mask[i] == DVec3::ONE));
        }
        _ => {
            p = cancel_iteratively(operator, operator.norm_bound(), u, |i, v| v * mask[i]);
        }
    }
    p
}

/// Normal impulses that stop corners with the normal velocities `u`, of least norm: an impulse at a corner turns the
/// body by `turn` of its `arm`, r × n. Three or four corners must be of one face, and tell three numbers: for three
/// corners their own; for four, of which opposite ones are neighbors, their mean and the differences of opposite ones,
/// since loading one diagonal against the other does nothing. Impulses in the same three proportions are the smallest,
/// and three linear equations tell how much of each. `None` if the corners are as good as on a line, or too many.
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

/// Corners that are held along the normal, seen from the body.
pub(super) struct HeldNormals {
    count: usize,
    pub(super) corner: [u8; 8],
    /// r_k and r_k × n, body axes \[m\].
    lever: [DVec3; 8],
    arm: [DVec3; 8],
    solvable: bool,
}

impl HeldNormals {
    /// The corners `held`.
    pub(super) fn new(body: &RigidBox, held: u8) -> Self {
        let (count, corner) = in_pairs(held);
        let mut lever = [DVec3::ZERO; 8];
        for i in 0..count {
            let sign = |bit: u8| if corner[i] >> bit & 1 == 1 { 1.0 } else { -1.0 };
            lever[i] = DVec3::new(sign(0), sign(1), sign(2)) * body.half_extents();
        }
        Self {
            count,
            corner,
            lever,
            arm: [DVec3::ZERO; 8],
            solvable: count <= 2 || spans_face(held),
        }
    }

    /// Sets the arms for an attitude. The heights of the corners over the floor \[m\], the same to the last bit as those of
    /// [`Corners`].
    fn at(&mut self, floor: &Floor, state: &BodyState) -> [f64; 8] {
        let r = DMat3::from_quat(state.rotation);
        let n = DVec3::new(r.x_axis.y, r.y_axis.y, r.z_axis.y);
        let base = state.position.y - floor.height;
        let mut height = [0.0; 8];
        for i in 0..self.count {
            let lever = self.lever[i];
            self.arm[i] = lever.cross(n);
            height[i] = base + ((lever.x * n.x + lever.z * n.z) + lever.y * n.y);
        }
        height
    }

    /// The impulses that stop the normal velocities `u`, in the order of the corners: each, their sum, and their
    /// angular impulse about the center in body axes.
    pub(super) fn stop(&self, body: &RigidBox, u: &[f64; 8]) -> Option<([f64; 8], f64, DVec3)> {
        if !self.solvable {
            return None;
        }
        let turn = |torque| body.inverse_inertia() * torque;
        let p = stop_normals(&self.arm[..self.count], body.inverse_mass(), turn, u)?;
        let torque = |i: usize| p[i] * self.arm[i];
        let sum = (p[0] + p[1]) + (p[2] + p[3]);
        Some((p, sum, (torque(0) + torque(1)) + (torque(2) + torque(3))))
    }
}

/// Two corners: the linear equations of one after the other.
fn cancel_two(operator: &DelassusOperator, u: &Corner3, whole: [bool; 2]) -> (DVec3, DVec3) {
    // First the one that is stopped whole: p_i = −W_ii⁻¹(u_i + W_ij p_j).
    let i = usize::from(!whole[0]);
    let j = 1 - i;
    let swing = operator.swing(j);
    let inverse = operator.block(i, &operator.swing(i)).inverse();
    let cross = operator.block(i, &swing);
    let through = cross.transpose() * inverse;
    let own = operator.block(j, &swing);
    let reduced = own - through * cross;
    let rest = u[j] - through * u[i];
    let other = if whole[j] {
        stopped_along(reduced, operator.lever[1] - operator.lever[0], own.y_axis.y) * -rest
    } else {
        DVec3::Y * (-rest.y / reduced.y_axis.y)
    };
    let mut p = [other; 2];
    p[i] = -(inverse * (u[i] + cross * other));
    if whole[j] {
        least_along(operator.lever[1] - operator.lever[0], &mut p);
    }
    (p[0], p[1])
}

/// The inverse of what a corner has left when the other end of its edge is stopped: nothing moves it along the
/// edge, which is filled by `norm`.
pub(super) fn stopped_along(reduced: DMat3, edge: DVec3, norm: f64) -> DMat3 {
    let e = edge.normalize_or_zero();
    (reduced + DMat3::from_cols(e * e.x, e * e.y, e * e.z) * norm).inverse()
}

/// Takes from two impulses at the ends of an edge the opposite parts along it, which do nothing.
pub(super) fn least_along(edge: DVec3, p: &mut [DVec3; 2]) {
    let e = edge.normalize_or_zero();
    let shift = e * (0.5 * (p[0] - p[1]).dot(e));
    p[0] -= shift;
    p[1] += shift;
}

/// Impulses p with u + Wp = 0 in the components that `allowed` leaves of each contact's vector, of least norm: by
/// conjugate gradients from zero (Hestenes, Stiefel 1952), which treat all contacts alike, to the last bit.
/// W, of which `norm_bound` bounds the norm, has rank six at most, so six steps are exact but for rounding; the rest
/// of the twelve polish.
pub(super) fn cancel_iteratively<const N: usize>(
    operator: &DelassusOperator<N>,
    norm_bound: f64,
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
    let null = 1e-12 * norm_bound;
    for _ in 0..12 {
        if square <= enough {
            break;
        }
        let mut image = operator.response(&direction);
        for i in 0..n {
            image[i] = allowed(i, image[i]);
        }
        let curvature = operator.dot(&direction, &image);
        // Four coplanar corners have one distribution that does nothing, and rounding leaves a residual
        // along it: there is nothing to gain there, and a step would be noise over noise.
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

/// Moves and turns the body so that the corners `held` lie on the floor: Newton's method on their
/// heights. The center moves along the normal only. Returns where the corners are then; `normals`, of the same corners, has
/// the arms there.
pub(super) fn project_positions(
    floor: &Floor,
    body: &RigidBox,
    state: &mut BodyState,
    held: u8,
    normals: &mut HeldNormals,
) -> Corners {
    for round in 0..4 {
        let height = normals.at(floor, state);
        let worst = height.iter().fold(0.0, |a: f64, c| a.max(c.abs()));
        let rounding = 4.0 * f64::EPSILON * (body.radius() + state.position.y.abs());
        if round == 3 || worst <= rounding {
            break;
        }
        if round > 0 && normals.count == 1 {
            // What is left of one corner's height, the square of what was, needs no turn.
            state.position.y -= height[0];
            continue;
        }
        if let Some((_, shift, turn)) = normals.stop(body, &height) {
            state.position.y += shift * body.inverse_mass();
            let turn = turn * body.inverse_inertia();
            if turn != DVec3::ZERO {
                state.rotation = compose(state.rotation, exponential_map(turn));
                state.renormalize();
            }
            continue;
        }
        let attitude = DMat3::from_quat(state.rotation);
        let operator = DelassusOperator::new(body, attitude, held);
        let gap = height.map(|height| DVec3::Y * height);
        let (shift, turn) = operator.twist(&cancel(&operator, &gap, &[DVec3::Y; 8]));
        state.position += shift;
        // World turn: q ← exp(turn)∘q. The angular momentum keeps its body components.
        state.rotation = compose(exponential_map(turn), state.rotation);
        state.renormalize();
    }
    Corners::at(floor, body, state)
}

/// Lifts the body so that no corner, of which `corners` knows, is below the floor; never pushes it down.
pub(super) fn recover_penetration(floor: &Floor, state: &mut BodyState, corners: &mut Corners) {
    // Rounding may leave the last bit below: a second pass takes it.
    for _ in 0..2 {
        let depth = -corners.lowest();
        if depth <= 0.0 || !depth.is_finite() {
            break;
        }
        state.position.y += depth;
        corners.rise(floor, state);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor::tests::{Random, about};

    /// A corner, an edge or a face on the floor: both ways agree, and what was to be canceled is.
    #[test]
    fn directly_or_not_the_same_is_canceled() {
        let mut random = Random(3);
        for i in 0..1000 {
            let half = random.half_extents(0.1, 1.0);
            let body = RigidBox::new(half, 3.0).expect("valid");
            let mut state = BodyState::at(DVec3::ZERO).with_velocity(random.vector(1.0));
            state.set_angular_velocity(&body, random.vector(3.0));
            state.rotation =
                about(DVec3::Y, random.range(0.0, 6.0)) * about(DVec3::Z, random.range(0.2, 1.3));
            let operator = DelassusOperator::new(
                &body,
                DMat3::from_quat(state.rotation),
                [0b0000_0001, 0b0001_0001, 0b0101_0101, 0b0101_0100][i % 4],
            );
            let u = operator.velocities((state.velocity, state.angular_velocity(&body)));
            let mut mask = [DVec3::ONE; 8];
            if i % 4 < 2 {
                mask[0] = [DVec3::ONE, DVec3::Y][i / 4 % 2];
                mask[1] = [DVec3::ONE, DVec3::Y][i / 8 % 2];
            } else {
                mask = [DVec3::Y; 8];
            }
            let p = cancel(&operator, &u, &mask);
            let bound = operator.norm_bound();
            let mut q = cancel_iteratively(&operator, bound, &u, |i, v| v * mask[i]);
            // Of least norm to rounding, which conjugate gradients are not quite: equal loads on one diagonal
            // against the other, and the opposite ones along an edge, do nothing.
            let diagonals = |p: &Corner3| 0.25 * (p[0] + p[1] - p[2] - p[3]);
            if operator.count == 4 {
                let idle = diagonals(&q);
                for (q, sign) in q.iter_mut().zip([-1.0, -1.0, 1.0, 1.0]) {
                    *q += sign * idle;
                }
                assert!(diagonals(&p).length() < 1e-13);
            }
            let answer = operator.response(&p);
            for k in 0..operator.count {
                assert!(((u[k] + answer[k]) * mask[k]).length() < 1e-12);
                assert!((p[k] - q[k]).length() < 1e-6 * q[k].length(), "{p:?} {q:?}");
            }
            let along = (p[0] - p[1]).dot(operator.lever[1] - operator.lever[0]);
            assert!(operator.count == 1 || mask[..2] != [DVec3::ONE; 2] || along.abs() < 1e-13);
        }
    }
}
