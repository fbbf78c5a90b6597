use super::super::tests::{G, SIXTIETH, Scene};
use super::*;
use crate::integrators::Split;
use glam::DVec3;

#[test]
fn coefficients_combine_by_the_rule_of_the_body() {
    use CoefficientCombine::{Average, GeometricMean, Max, Min, Multiply};
    let floor = Floor::new(0.0, 0.2, 0.5).expect("valid");
    for (rule, mu, e) in [
        (Average, 0.65, 0.5),
        (GeometricMean, 0.4_f64.sqrt(), 0.4),
        (Min, 0.5, 0.2),
        (Multiply, 0.4, 0.16),
        (Max, 0.8, 0.8),
    ] {
        let friction = Friction::new(0.8).expect("valid").with_combine_rule(rule);
        let restitution = Restitution::new(0.8)
            .expect("valid")
            .with_combine_rule(rule);
        let both = floor.against(Some(&friction), Some(&restitution));
        assert!((both.friction - mu).abs() < 1e-15 && (both.restitution - e).abs() < 1e-15);
        assert!(both.static_friction.is_none() && both.validate().is_ok());
    }
    assert_eq!(floor.against(None, None), floor);
    // A value out of range counts as absent.
    let wrong = Friction {
        static_coefficient: f64::NAN,
        ..Friction::default()
    };
    let bouncy = Restitution {
        coefficient: 1.5,
        ..Restitution::default()
    };
    assert_eq!(floor.against(Some(&wrong), Some(&bouncy)), floor);
    assert!(Friction::new(-0.1).is_err() && Restitution::new(1.1).is_err());
}

/// On a slope between the two angles of friction, a resting box stays at rest, and a sliding box continues to slide.
#[test]
fn static_friction_holds_what_kinetic_friction_does_not_stop() {
    let (kinetic, holds) = (0.3, 0.6);
    let own = Friction::new(kinetic)
        .expect("valid")
        .with_combine_rule(CoefficientCombine::Min);
    let own = own.with_static_coefficient(holds).expect("valid");
    let floor = Floor::new(0.0, 0.0, 1.0).expect("valid");
    for (slope, stays) in [(0.59_f64, true), (0.31, true), (0.61, false)] {
        let theta = libm::atan(slope);
        let mut scene = Scene::new(DVec3::new(0.5, 0.1, 0.5), 0.0, 0.0).on_slope(theta);
        scene.floor = floor.against(Some(&own), None);
        let start = scene.state;
        scene.run::<Split>(SIXTIETH, 60);
        assert_eq!(scene.state == start, stays, "{slope}");
        let (s, c) = crate::math::sin_cos(theta);
        let a = G * (s - kinetic * c);
        if !stays {
            assert!((scene.state.position.x - 0.5 * a).abs() < 1e-9);
            continue;
        }
        assert!(scene.contact.is_resting(&scene.state));
        scene.state.velocity.x = 0.1;
        scene.run::<Split>(SIXTIETH, 60);
        let way = scene.state.position.x - start.position.x;
        assert!((way - 0.1 - 0.5 * a).abs() < 1e-9, "{slope}: {way}");
    }
}

/// Kinetic friction stops a sliding box, and static friction then holds it.
#[test]
fn a_box_that_stops_is_held() {
    let mut scene = Scene::new(DVec3::new(0.5, 0.1, 0.5), 0.0, 0.3).on_slope(0.2);
    scene.floor.static_friction = Some(0.6);
    scene.state.velocity.x = 1.0;
    let (s, c) = crate::math::sin_cos(0.2);
    let a = G * (0.3 * c - s);
    scene.run::<Split>(SIXTIETH, 120);
    assert!(scene.contact.is_resting(&scene.state));
    assert!((scene.state.position.x - 0.5 / a).abs() < 1e-9);
    scene = scene.on_slope(0.5);
    let held = scene.state;
    scene.run::<Split>(SIXTIETH, 10);
    assert!(scene.state == held && scene.contact.is_resting(&scene.state));
}
