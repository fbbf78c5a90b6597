//! The order of an integrator across bounces, and flat landings to the bit. (Cases 25 and 30 are in the contact cases
//! of `box_scenarios`.)
use super::*;
use crate::floor::RestitutionLaw;
use crate::force::{Dissipation, Forces};
use crate::integrators::{ExplicitEuler, Rk4, Split, SymmetricTop};

/// The observed order for the whole state (Richardson): halved steps and a fine reference.
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
    // Fine enough for every run to have the same bounces, which amplify errors.
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
    // Five tumbling bounces amplify any error ten-thousandfold: too much for order 1.
    assert!((order::<SymmetricTop>(half, start, 1.0, 2.8, 5) - 2.0).abs() < 0.15);
    assert!(order::<Rk4>(half, start, 1.0, 2.8, 5) > 3.7);
}

/// Five flat bounces of a spinning box in thick air, where every integrator has its usual order.
#[test]
fn order_survives_five_bounces_in_air() {
    fn run<S: Integrate>(n: u32) -> BodyState {
        let mut scene = Scene::new(DVec3::new(0.5, 0.25, 0.375), 0.9, 0.0);
        scene.state.position.y = 1.0;
        scene.state.velocity.x = 2.0;
        scene.spin(DVec3::Y * 3.0);
        let law = Forces {
            acceleration: scene.gravity.0,
            dissipation: Dissipation {
                quadratic_drag: 0.3,
                angular_drag: 0.2,
                ..Dissipation::NONE
            },
            ..Default::default()
        };
        for _ in 0..n {
            // It ends between the fifth impact and the sixth.
            scene.step_under::<S>(&law, 2.75 / f64::from(n), None);
        }
        assert_eq!(scene.total.impacts, 5, "{}", S::INFO.id);
        scene.state
    }
    fn order<S: Integrate>(exact: &BodyState, n: u32) -> f64 {
        let error = |n| {
            let end = run::<S>(n);
            (end.position - exact.position).length() + end.attitude_difference(exact)
        };
        libm::log2(error(n) / error(2 * n))
    }
    let exact = run::<Rk4>(4096);
    assert!((order::<ExplicitEuler>(&exact, 1024) - 1.0).abs() < 0.3);
    assert!((order::<SymmetricTop>(&exact, 64) - 2.0).abs() < 0.3);
    assert!((order::<Rk4>(&exact, 64) - 4.0).abs() < 0.3);
}

/// A flat drop starts no spin and no sideways motion at any yaw, to the bit.
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

/// After several events in a step, a slide covers all of the remaining time, to the last bit.
#[test]
fn flat_landings_reach_no_cap() {
    let mut random = Random(29);
    for i in 0..500 {
        let mut scene = Scene::new(DVec3::new(0.3, 0.2, 0.4), 0.3, 0.0);
        scene.state.position.y += random.range(0.01, 1.0);
        scene.state.velocity.x = 0.1;
        scene.run::<Split>(SIXTIETH, 60);
        assert_eq!(scene.total.solves_capped, 0, "{i}");
    }
}

/// Random impacts of one corner, an edge or a face return at most e² of the energy lost in a plastic impact. Newton's
/// law exceeds this. For one corner without friction both laws are equal.
#[test]
fn an_impact_returns_at_most_its_part_of_the_energy() {
    let mut random = Random(23);
    let mut excess = 0.0_f64;
    for i in 0..3000 {
        let half = random.half_extents(0.1, 1.0);
        let (e, mu) = (random.range(0.05, 1.0), random.magnitude(0.05, 5.0));
        let mut scene = Scene::new(half, e, if i % 4 == 0 { 0.0 } else { mu });
        scene.gravity.0 = DVec3::ZERO;
        scene.settings.max_impacts = 1;
        scene.state.rotation = match i % 3 {
            0 => random.attitude(),
            1 => about(DVec3::Y, random.range(0.0, 6.0)) * about(DVec3::Z, random.range(0.2, 1.3)),
            _ => about(DVec3::Y, random.range(0.0, 6.0)),
        };
        scene.state.position.y -= scene.lowest();
        scene.state.velocity = random.vector(2.0) - DVec3::Y * 2.0;
        scene.spin(random.vector(3.0));
        let before = scene.energy();
        let after = |e: f64, law: RestitutionLaw| {
            let mut scene = scene.clone();
            (scene.floor.restitution, scene.settings.restitution) = (e, law);
            scene.step::<Split>(1e-12);
            scene
        };
        let plastic = after(0.0, RestitutionLaw::Energetic).energy();
        let energetic = after(e, RestitutionLaw::Energetic);
        let newton = after(e, RestitutionLaw::Newton);
        if [&energetic, &newton].map(|s| (s.total.impacts, s.total.impacts_capped)) != [(1, 0); 2] {
            continue;
        }
        let allowed = plastic + e * e * (before - plastic);
        assert!(energetic.energy() <= allowed + 1e-10 * before, "{i}");
        excess = excess.max((newton.energy() - allowed) / before);
        if i % 12 == 0 {
            let apart = energetic.state.velocity - newton.state.velocity;
            assert!(apart.length() < 1e-9, "{i}");
        }
    }
    assert!(excess > 0.05, "{excess}");
}
