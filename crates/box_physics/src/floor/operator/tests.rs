use super::*;
use crate::floor::Floor;
use crate::floor::geometry::Corners;
use crate::floor::tests::tilted;
use glam::DQuat;

/// The operator's response equals the change of the corners' velocities after the impulse is applied.
#[test]
fn response_is_what_an_impulse_does() {
    let (body, state) = tilted();
    let attitude = DMat3::from_quat(state.rotation);
    let operator = DelassusOperator::new(&body, attitude, 0b1011_0010);
    assert_eq!(operator.count, 4);
    let mut p = [DVec3::ZERO; 8];
    for (i, q) in p.iter_mut().enumerate().take(4) {
        let i = i as f64;
        *q = DVec3::new(0.3 - i, 0.7 * i, 1.1 - 0.2 * i);
    }
    let mut after = state;
    operator.apply(&mut after, &p);
    let change = operator.response(&p);
    let twist = |s: &BodyState| operator.velocities((s.velocity, s.angular_velocity(&body)));
    let (before, after) = (twist(&state), twist(&after));
    for i in 0..4 {
        assert!((after[i] - before[i] - change[i]).length() < 1e-13);
    }
    // A Rayleigh quotient never exceeds the bound.
    let quotient = operator.dot(&p, &change) / operator.dot(&p, &p);
    assert!(quotient > 0.0 && quotient <= operator.norm_bound());
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
        let operator = DelassusOperator::new(&body, attitude, bottom as u8);
        let mut p = [DVec3::ZERO; 8];
        p[..4].fill(DVec3::Y * 0.3);
        assert_eq!(operator.resultant(&p).1, DVec3::ZERO);
    }
}
