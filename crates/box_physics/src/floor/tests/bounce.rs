//! The order of an integrator across bounces, and flat landings to the bit. (Cases 25 and 30 stand among the
//! contact cases of `box_scenarios`.)
use super::*;
use crate::integrators::{ExplicitEuler, Rk4, Split, SymmetricTop};

/// Richardson: the observed order over halved steps with a fine reference, for the whole state.
fn order<S: Integrate>(half: DVec3, start: BodyState, e: f64, time: f64, impacts: u32) -> f64 {
    let run = |n: u32| {
        let mut scene = Scene::new(half, e, 0.0).with_state(start);
        scene.run::<S>(time / f64::from(n), n);
        assert_eq!(scene.total.impacts, impacts, "{} {n}", S::INFO.id);
        scene.state
    };
    let distance = |a: &BodyState, b: &BodyState| {
        (a.position - b.position).length() + a.attitude_difference(b)
    };
    // Fine enough for every run to make the same bounces: they magnify errors.
    let base = if S::INFO.id == "explicit-euler" {
        131_072
    } else {
        256
    };
    let exact = {
        let mut scene = Scene::new(half, e, 0.0).with_state(start);
        scene.run::<Rk4>(time / 8192.0, 8192);
        scene.state
    };
    let (a, b) = (
        distance(&run(base), &exact),
        distance(&run(2 * base), &exact),
    );
    libm::log2(a / b)
}

#[test]
fn order_survives_bounces() {
    let half = DVec3::new(0.5, 0.25, 0.375);
    let body = RigidBox::new(half, 3.0).expect("valid");
    let start = BodyState::at_pose(DVec3::Y * 1.5, about(DVec3::new(0.6, 0.0, 0.8), 0.6))
        .with_velocity(DVec3::X)
        .with_angular_velocity(&body, DVec3::new(0.5, 1.0, 0.3));
    for (time, impacts) in [(0.48, 1), (0.9, 2)] {
        assert!((order::<ExplicitEuler>(half, start, 1.0, time, impacts) - 1.0).abs() < 0.15);
        assert!((order::<SymmetricTop>(half, start, 1.0, time, impacts) - 2.0).abs() < 0.15);
        assert!(order::<Rk4>(half, start, 1.0, time, impacts) > 3.7);
    }
    // Five tumbling bounces magnify any error ten-thousandfold: too much for order 1.
    assert!((order::<SymmetricTop>(half, start, 1.0, 2.8, 5) - 2.0).abs() < 0.15);
    assert!(order::<Rk4>(half, start, 1.0, 2.8, 5) > 3.7);
}

/// A flat drop starts no spin and no sideways motion, whatever the yaw: to the bit.
#[test]
fn flat_landing_is_symmetric_to_the_bit() {
    for i in 0..200 {
        let mut scene = Scene::new(DVec3::new(0.7, 0.2, 0.3), 0.4, 0.6);
        scene.state.position = DVec3::new(0.3, 1.0, -5.0);
        scene.state.rotation = about(DVec3::Y, 0.1 + 0.173 * f64::from(i));
        let start = scene.state;
        for _ in 0..120 {
            scene.step::<Split>(SIXTIETH);
            let s = &scene.state;
            // The integrator's renormalization may move the last bit of the yaw, nothing else moves.
            assert_eq!((s.rotation.x, s.rotation.z), (0.0, 0.0));
            assert!(s.attitude_difference(&start) < 1e-15);
            assert_eq!(s.angular_momentum, DVec3::ZERO);
            assert_eq!((s.velocity.x, s.velocity.z), (0.0, 0.0));
            assert_eq!((s.position.x, s.position.z), (0.3, -5.0));
        }
        assert!(scene.contact.is_resting(&scene.state));
        assert!((scene.state.position.y - 0.2).abs() < 1e-16);
    }
}
