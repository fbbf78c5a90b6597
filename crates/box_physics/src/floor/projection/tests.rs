use super::*;
use crate::floor::tests::{Random, about};
use crate::state::BodyState;

/// For a corner, an edge or a face on the floor, both methods agree and cancel the selected velocities.
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
        let mut whole = [false; 8];
        if i % 4 < 2 {
            whole[0] = i / 4 % 2 == 0;
            whole[1] = i / 8 % 2 == 0;
        }
        let mask = whole.map(|whole| if whole { DVec3::ONE } else { DVec3::Y });
        let p = cancel(&operator, &u, &whole);
        let mut q = cancel_iteratively(&operator, &u, |i, v| v * mask[i]);
        // Of least norm to rounding, unlike conjugate gradients. Equal loads on one diagonal against the other, and
        // opposite impulses along an edge, have no effect.
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
