//! External changes, extremes, and reports.
use super::super::may_touch;
use super::*;
use crate::force::{Forces, PointForce, Spring};
use crate::integrators::{Rk4, Split};

fn resting() -> Scene {
    let mut scene = Scene::new(DVec3::new(0.5, 0.25, 0.375), 0.3, 0.5);
    scene.state.rotation = about(DVec3::Y, 0.4);
    scene.run::<Split>(SIXTIETH, 3);
    assert!(scene.contact.is_resting(&scene.state));
    scene
}

#[test]
fn a_teleport_into_the_floor_is_lifted_out_not_fired() {
    let mut random = Random(5);
    for depth in [1e-9, 1e-3, 0.2, 5.0, 1000.0] {
        for h in [1e-4, SIXTIETH, 0.5] {
            let mut scene = resting();
            scene.state.position.y -= depth;
            scene.step::<Split>(h);
            assert!(
                scene.lowest() >= 0.0 && scene.state.velocity.length() < 1e-9,
                "{depth}"
            );
            let mut scene = resting();
            scene.state.rotation = random.attitude();
            scene.state.position.y = -depth;
            scene.step::<Split>(h);
            assert!(scene.lowest() >= 0.0);
            // The gain is the fall of at most one step.
            assert!(scene.state.velocity.length() <= G * h * 1.5, "{depth} {h}");
        }
    }
}

#[test]
fn a_resting_box_reacts_to_what_changes() {
    let settled = resting();
    let mut scene = settled.clone();
    scene.floor.height = 0.1;
    scene.step::<Split>(SIXTIETH);
    assert!((scene.state.position.y - 0.35).abs() < 1e-12);
    assert!(scene.state.velocity.length() < 1e-9);

    scene = settled.clone();
    scene.floor.height = -1.0;
    scene.step::<Split>(SIXTIETH);
    assert!(
        (scene.state.velocity.y + G * SIXTIETH).abs() < 1e-12
            && !scene.contact.is_resting(&scene.state)
    );
    scene.run::<Split>(SIXTIETH, 200);
    assert!(scene.contact.is_resting(&scene.state) && (scene.lowest()).abs() < 1e-12);

    // Gravity reversed: the box falls up. Switched off: it stays. Tilted: it slides.
    scene = settled.clone();
    scene.gravity.0 = DVec3::Y * G;
    scene.run::<Split>(SIXTIETH, 30);
    assert!((scene.state.position.y - 0.25 - 0.5 * G * 0.25).abs() < 1e-9);
    scene = settled.clone();
    scene.gravity.0 = DVec3::ZERO;
    let pose = scene.state;
    scene.run::<Split>(SIXTIETH, 30);
    assert_eq!(scene.state, pose);
    scene = settled.clone().on_slope(0.6);
    scene.step::<Split>(SIXTIETH);
    assert!(scene.state.velocity.x > 0.01);
    scene = settled.clone().on_slope(0.3);
    scene.run::<Split>(SIXTIETH, 30);
    assert_eq!(scene.state, pose);
    scene.floor.friction = 0.1;
    scene.step::<Split>(SIXTIETH);
    assert!(scene.state.velocity.x > 0.01);

    // An impulse, including a tiny one.
    for push in [1.0, 1e-6] {
        scene = settled.clone();
        scene.state.velocity.y = push;
        scene.step::<Split>(1e-8);
        assert!(scene.state.position.y > 0.25 && !scene.contact.is_resting(&scene.state));
    }
}

/// Removing a wrench is a change like any other. A box held down by a spring rises. A box pressed by a force stays at
/// rest with a smaller load.
#[test]
fn rest_under_a_force_ends_with_the_force() {
    let spring = [Spring {
        anchor: DVec3::NEG_Y,
        stiffness: 50.0,
        damping: 5.0,
        ..Spring::default()
    }];
    let press = [PointForce {
        force: DVec3::NEG_Y * 20.0,
        ..PointForce::default()
    }];
    let rising = Forces {
        acceleration: DVec3::Y,
        ..Forces::default()
    };
    let falling = Forces {
        acceleration: DVec3::NEG_Y * G,
        ..Forces::default()
    };
    let held = Forces {
        springs: &spring,
        ..rising
    };
    let pressed = Forces {
        point_forces: &press,
        ..falling
    };
    for (under, after, load, rises) in [
        (held, rising, 50.0 * 1.25 - 3.0, true),
        (pressed, falling, 3.0 * G + 20.0, false),
    ] {
        let mut scene = Scene::new(DVec3::new(0.5, 0.25, 0.375), 0.3, 0.5);
        let mut step = |law: &Forces<'_>, times: u32| {
            let mut force = 0.0;
            for _ in 0..times {
                let mut report = ContactReport::default();
                scene.step_under::<Split>(law, SIXTIETH, Some(&mut report));
                force = report.normal_impulse() / SIXTIETH;
            }
            (scene.contact.is_resting(&scene.state), scene.state, force)
        };
        let (resting, pose, force) = step(&under, 4);
        assert!(resting && (force - load).abs() < 1e-9, "{force} {load}");
        let (resting, end, force) = step(&after, 2);
        let load = if rises { 0.0 } else { 3.0 * G };
        assert!(resting != rises && (force - load).abs() < 1e-9, "{force}");
        assert!(if rises {
            end.position.y > 0.25
        } else {
            end == pose
        });
    }
}

/// Rest is detected and maintained at any step size and far from the origin.
#[test]
fn rest_at_any_step_and_place() {
    for h in [1e-5, 1e-3, SIXTIETH, 0.5] {
        for x in [0.0, 1e5, -1e6] {
            for slope in [0.0, 0.2] {
                let mut scene = Scene::new(DVec3::new(0.5, 0.25, 0.375), 0.3, 0.5).on_slope(slope);
                scene.state.position.x = x;
                scene.state.rotation = about(DVec3::Y, 0.4);
                let start = scene.state;
                scene.run::<Split>(h, 20);
                assert!(scene.contact.is_resting(&scene.state), "{h} {x} {slope}");
                assert_eq!(scene.state, start);
            }
        }
    }
}

#[test]
fn may_touch_is_conservative() {
    let mut random = Random(9);
    let mut cleared = 0;
    for _ in 0..20_000 {
        let half = random.half_extents(0.01, 1.0);
        let mut scene = Scene::new(half, 1.0, 0.0);
        scene.state.position.y = scene.body.radius() * random.range(0.2, 2.0);
        scene.throw(&mut random, 3.0, 10.0);
        scene.gravity.0 = random.vector(10.0);
        let h = random.magnitude(1e-4, 0.2);
        if may_touch(&scene.floor, &scene.body, &scene.state, &scene.gravity, h) {
            continue;
        }
        cleared += 1;
        for k in 1..=8 {
            let mut s = scene.state;
            let t = h * f64::from(k) / 8.0;
            Rk4::step(&scene.body, &mut s, &scene.gravity, t, &mut scene.memory);
            let c = Corners::at(&scene.floor, &scene.body, &s);
            assert!(c.lowest() > 0.0);
        }
    }
    assert!(cleared > 5000, "{cleared}");
}

/// Impulses add up to the momentum, in every direction, and the approach speed is that of the fall.
#[test]
fn a_report_tells_what_the_floor_did() {
    let mut scene = Scene::new(DVec3::new(0.5, 0.25, 0.5), 0.5, 0.5);
    scene.state.position.y = 0.6;
    scene.state.velocity.x = 1.0;
    let (mut impacts, mut held) = (0, 0);
    for _ in 0..120 {
        let before = scene.state.velocity;
        let mut report = ContactReport::default();
        let gravity = scene.gravity;
        scene.step_under::<Split>(&gravity, SIXTIETH, Some(&mut report));
        assert!(report.normal_impulses.iter().all(|&j| j >= 0.0));
        let impulse = report.tangential_impulse + DVec3::Y * report.normal_impulse();
        let change = 3.0 * (scene.state.velocity - before + DVec3::Y * G * SIXTIETH);
        assert!((impulse - change).length() < 1e-9, "{impulse} {change}");
        if report.corners != 0 {
            assert!(report.point().y.abs() < 1e-9 && report.point().x < 2.0);
        }
        if report.approach_speed > 0.0 && impacts == 0 {
            let fall = (2.0 * G * 0.35_f64).sqrt();
            assert!((report.approach_speed - fall).abs() < 1e-9);
            assert!(report.impact_time > 0.0 && report.impact_time < SIXTIETH);
        }
        impacts += u32::from(report.approach_speed > 0.0);
        held += u32::from(report.corners == scene.contact.touching() && report.corners != 0);
    }
    assert!(impacts > 2 && held > 60, "{impacts} {held}");
    assert_eq!(scene.contact.touching().count_ones(), 4);
}

/// A report that the caller reuses does not keep the contact of an earlier step.
#[test]
fn a_flight_reports_no_contact() {
    let mut report = ContactReport {
        corners: 15,
        approach_speed: 1.0,
        ..ContactReport::default()
    };
    let mut over = Scene::new(DVec3::splat(0.5), 0.3, 0.5);
    over.state.position.y = 3.0;
    let mut among = over.clone();
    among.planes = vec![Plane::from(Floor::default())];
    for mut scene in [over, among] {
        let gravity = scene.gravity;
        scene.step_under::<Split>(&gravity, SIXTIETH, Some(&mut report));
        assert_eq!(report, ContactReport::default());
        report.corners = 15;
    }
}

#[test]
fn nothing_happens_in_no_time() {
    let mut scene = resting();
    scene.state.velocity = DVec3::NEG_Y;
    let before = scene.state;
    scene.step::<Split>(0.0);
    assert_eq!(scene.state, before);
    scene.state.velocity.y = f64::NAN;
    scene.step::<Split>(SIXTIETH); // left to the quarantine; must not hang or panic
}

#[test]
fn settings_that_forbid_every_impact_or_iteration_are_refused() {
    let bad = |change: fn(&mut ContactSettings)| {
        let mut settings = ContactSettings::DEFAULT;
        change(&mut settings);
        settings.validate().map_err(|e| e.to_string())
    };
    assert_eq!(bad(|_| ()), Ok(()));
    let wanted = |field: &str| Err(format!("{field} must be at least 1, but is 0"));
    assert_eq!(bad(|s| s.max_impacts = 0), wanted("max_impacts"));
    assert_eq!(bad(|s| s.max_iterations = 0), wanted("max_iterations"));
}
