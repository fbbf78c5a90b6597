//! Exact corrections: held corners exactly on the floor, and exactly without the velocity that the
//! contact forbids. Both are the smallest correction in the body's own metric (kinetic energy), so
//! the velocity one can only take energy.

use glam::{DMat3, DVec3};

use super::Floor;
use super::geometry::{Corner3, Corners, DelassusOperator, has};
use crate::body::RigidBox;
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// Impulses p with u + Wp = 0 in the components that `mask` lets through, and none in the others: of least
/// norm. A corner's mask is Y (the normal alone) or ONE.
pub(super) fn cancel(operator: &DelassusOperator, u: &Corner3, mask: &Corner3) -> Corner3 {
    let mut p = [DVec3::ZERO; 8];
    match operator.count {
        1 => p[0] = cancel_one(operator, u[0], mask[0] == DVec3::ONE),
        2 => (p[0], p[1]) = cancel_two(operator, u, [0, 1].map(|i| mask[i] == DVec3::ONE)),
        n => {
            let normal_only = mask[..n].iter().all(|m| *m == DVec3::Y);
            let face = normal_only && n <= 4 && operator.spans_face();
            p = face
                .then(|| cancel_on_face(operator, u))
                .flatten()
                .unwrap_or_else(|| cancel_iteratively(operator, u, mask));
        }
    }
    p
}

/// The normal velocities of three or four corners of a face, which tell three numbers: for three corners their
/// own; for four, of which opposite ones are neighbors, their mean and the differences of opposite ones, since
/// loading one diagonal against the other does nothing. Impulses in the same three proportions are the smallest,
/// and three linear equations tell how much of each. `None` if the corners are as good as on a line.
fn cancel_on_face(operator: &DelassusOperator, u: &Corner3) -> Option<Corner3> {
    let arm = |i: usize| DVec3::new(1.0, operator.lever[i].x, operator.lever[i].z);
    let four = operator.count == 4;
    let (arms, speeds) = if four {
        let opposite = |i: usize| (0.5 * (arm(i + 1) - arm(i)), 0.5 * (u[i + 1].y - u[i].y));
        let ((a, v), (b, w)) = (opposite(0), opposite(2));
        let mean = 0.5 * ((arm(0) + arm(1)) + (arm(2) + arm(3)));
        let speed = 0.5 * ((u[0].y + u[1].y) + (u[2].y + u[3].y));
        ([mean, a, b], DVec3::new(speed, v, w))
    } else {
        let speeds = DVec3::new(u[0].y, u[1].y, u[2].y);
        ([0, 1, 2].map(arm), speeds)
    };
    let [a, b, c] = arms.map(|s| operator.normal_response(s));
    let through = DMat3::from_cols(arms[0], arms[1], arms[2]).transpose();
    let matrix = through * DMat3::from_cols(a, b, c);
    let size = matrix.x_axis.x * matrix.y_axis.y * matrix.z_axis.z;
    let determinant = matrix.determinant();
    if determinant.is_nan() || determinant <= 1e-10 * size {
        return None;
    }
    let q = -(matrix.inverse() * speeds);
    let mut p = [DVec3::ZERO; 8];
    let loads = if four {
        let q = 0.5 * q;
        [q.x - q.y, q.x + q.y, q.x - q.z, q.x + q.z]
    } else {
        [q.x, q.y, q.z, 0.0]
    };
    for (p, load) in p.iter_mut().zip(loads) {
        p.y = load;
    }
    Some(p)
}

/// u_n + W_nn p_n = 0, or u + Wp = 0.
fn cancel_one(operator: &DelassusOperator, u: DVec3, whole: bool) -> DVec3 {
    if whole {
        -(operator.block(0, 0, 1.0).inverse() * u)
    } else {
        DVec3::Y * (-u.y / operator.normal_column(0)[0])
    }
}

/// Two corners: the linear equations of one after the other.
fn cancel_two(operator: &DelassusOperator, u: &Corner3, whole: [bool; 2]) -> (DVec3, DVec3) {
    if whole == [false; 2] {
        let ([a, c], [_, d]) = (operator.normal_column(0), operator.normal_column(1));
        let inverse = 1.0 / (a * d - c * c);
        let normal = |n: f64| DVec3::Y * (inverse * n);
        return (
            normal(c * u[1].y - d * u[0].y),
            normal(c * u[0].y - a * u[1].y),
        );
    }
    // First the one that is stopped whole: p_i = −W_ii⁻¹(u_i + W_ij p_j).
    let i = usize::from(!whole[0]);
    let j = 1 - i;
    let inverse = operator.block(i, i, 1.0).inverse();
    let cross = operator.block(i, j, 1.0);
    let through = cross.transpose() * inverse;
    let own = operator.block(j, j, 1.0);
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

/// By conjugate gradients from zero (Hestenes, Stiefel 1952), which treat all corners alike, to the last bit.
/// W has rank six at most, so six steps are exact but for rounding; the rest of the twelve polish.
fn cancel_iteratively(operator: &DelassusOperator, u: &Corner3, mask: &Corner3) -> Corner3 {
    let n = operator.count;
    let mut p = [DVec3::ZERO; 8];
    let mut residual = p;
    for i in 0..n {
        residual[i] = -(u[i] * mask[i]);
    }
    let mut direction = residual;
    let mut square = operator.dot(&residual, &residual);
    let floor = square * 1e-34;
    if square <= floor {
        return p;
    }
    let null = 1e-12 * operator.norm_bound();
    for _ in 0..12 {
        if square <= floor {
            break;
        }
        let mut image = operator.response(&direction);
        for i in 0..n {
            image[i] *= mask[i];
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
/// heights. The center moves along the normal only. Returns where the corners are then.
pub(super) fn project_positions(
    floor: &Floor,
    body: &RigidBox,
    state: &mut BodyState,
    held: u8,
) -> Corners {
    let mut corners = Corners::at(floor, body, state);
    for round in 0..3 {
        let worst = (0..8)
            .filter(|&k| has(held, k))
            .fold(0.0, |a: f64, k| a.max(corners.height[k].abs()));
        if worst <= 4.0 * f64::EPSILON * (body.radius() + state.position.y.abs()) {
            break;
        }
        if round > 0 && held.is_power_of_two() {
            // What is left of one corner's height, the square of what was, needs no turn.
            state.position.y -= corners.height[held.trailing_zeros() as usize];
            corners.rise(floor, state);
            continue;
        }
        let attitude = DMat3::from_quat(state.rotation);
        let operator = DelassusOperator::new(body, attitude, &corners.lever, held);
        let mut gap = [DVec3::ZERO; 8];
        for i in 0..operator.count {
            gap[i].y = corners.height[usize::from(operator.corner[i])];
        }
        let (shift, turn) = operator.twist(&cancel(&operator, &gap, &[DVec3::Y; 8]));
        state.position += shift;
        if turn != DVec3::ZERO {
            // World turn: q ← exp(turn)∘q. The angular momentum keeps its body components.
            state.rotation = compose(exponential_map(turn), state.rotation);
            state.renormalize();
        }
        corners = Corners::at(floor, body, state);
    }
    corners
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
            let mut side = || random.magnitude(0.1, 1.0);
            let half = DVec3::new(side(), side(), side());
            let body = RigidBox::new(half, 3.0).expect("valid");
            let mut state = BodyState::at(DVec3::ZERO).with_velocity(random.vector(1.0));
            state.set_angular_velocity(&body, random.vector(3.0));
            state.rotation =
                about(DVec3::Y, random.range(0.0, 6.0)) * about(DVec3::Z, random.range(0.2, 1.3));
            let corners = Corners::at(&Floor::default(), &body, &state);
            let operator = DelassusOperator::new(
                &body,
                DMat3::from_quat(state.rotation),
                &corners.lever,
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
            let mut q = cancel_iteratively(&operator, &u, &mask);
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
