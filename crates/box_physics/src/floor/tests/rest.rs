//! Every drop ends at rest, and rest is permanent.
use super::*;
use crate::integrators::{Rk4, Split};

/// From any attitude, a box comes to rest flat on a face.
#[test]
fn any_drop_ends_flat_and_resting() {
    let mut random = Random(7);
    for i in 0..300 {
        let half = random.half_extents(0.1, 1.0);
        let mut scene = Scene::new(half, random.range(0.0, 0.7), random.range(0.05, 1.0));
        scene.state.position.y = random.range(0.0, 3.0) + scene.body.radius();
        scene.state.rotation = random.attitude();
        scene.spin(random.vector(5.0));
        let mut n = 0;
        while !scene.contact.is_resting(&scene.state) && n < 6000 {
            scene.step::<Split>(SIXTIETH);
            n += 1;
        }
        assert!(
            scene.contact.is_resting(&scene.state),
            "{i} {half} {:?} {:?}",
            scene.state,
            scene.floor
        );
        let corners = Corners::at(&scene.floor, &scene.body, &scene.state);
        assert_eq!(corners.touching(1e-12).count_ones(), 4, "{i}");
    }
}

#[test]
fn the_resting_pose_repeats_bit_for_bit() {
    let half = DVec3::new(0.5, 0.25, 0.375);
    let quarter = 0.5 * core::f64::consts::PI;
    for (axis, angle) in [
        (DVec3::X, 0.0),
        (DVec3::X, quarter),
        (DVec3::X, 2.0 * quarter),
        (DVec3::X, 3.0 * quarter),
        (DVec3::Z, quarter),
        (DVec3::Z, 3.0 * quarter),
    ] {
        let mut scene = Scene::new(half, 0.3, 0.5);
        scene.state.position.y = 1.0;
        scene.state.rotation = about(DVec3::Y, 0.7) * about(axis, angle);
        scene.run::<Rk4>(SIXTIETH, 200);
        assert!(scene.contact.is_resting(&scene.state));
        let pose = scene.state;
        scene.run::<Split>(SIXTIETH, 1_000_000);
        assert_eq!(scene.state, pose);
        // Without the memory, the next step finds the box at rest again.
        scene.contact = ContactState::default();
        scene.run::<Split>(SIXTIETH, 10);
        assert_eq!(scene.state, pose);
    }
}

/// A die that is thrown again is not at rest, even before a step.
#[test]
fn another_state_does_not_rest() {
    let mut scene = Scene::new(DVec3::new(0.5, 0.25, 0.125), 0.3, 0.5);
    scene.state.position.y = 0.3;
    while !scene.contact.is_resting(&scene.state) {
        scene.step::<Split>(SIXTIETH);
    }
    let throws: [fn(&mut BodyState); 4] = [
        |state| state.position.y = 3.0,
        |state| state.rotation = -state.rotation * DQuat::from_xyzw(0.6, 0.0, 0.0, 0.8),
        |state| state.velocity.x = 1e-9,
        |state| state.angular_momentum.z = 1e-9,
    ];
    for throw in throws {
        let mut thrown = scene.state;
        throw(&mut thrown);
        assert!(!scene.contact.is_resting(&thrown), "{thrown:?}");
    }
    assert!(scene.contact.is_resting(&scene.state));
}
