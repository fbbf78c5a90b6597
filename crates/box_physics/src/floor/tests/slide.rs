//! Sliding, spinning, tipping: cases 28, 29, 31, pub17, slopes.
use super::*;
use crate::schemes::{ExplicitEuler, Rk4, SemiImplicitEuler, Split};

fn pub17<S: Scheme>(h: f64, bound: f64) {
    let mut scene = Scene::new(DVec3::new(0.5, 0.25, 0.5), 0.0, 0.5);
    scene.state.velocity = DVec3::X * 4.0;
    let (stop, mut worst, mut stopped) = (0.8154943934760448, 0.0_f64, None);
    let n = (1.3 / h) as u32;
    for i in 1..=n {
        scene.step::<S>(h);
        let t = f64::from(i) * h;
        let s = t.min(stop);
        let x = 4.0 * s - 0.25 * G * s * s;
        worst = worst.max((scene.state.position - DVec3::new(x, 0.25, 0.0)).length());
        if scene.state.velocity == DVec3::ZERO && stopped.is_none() {
            stopped = Some(t);
        }
    }
    let stopped = stopped.expect("stops");
    println!(
        "pub17 {} h={h:.4}: {worst:.2e}, stopped {stopped:.4}, resting {}",
        S::INFO.id,
        scene.contact.is_resting()
    );
    assert!(worst <= bound, "{worst:e}");
    assert!((stopped - stop).abs() <= h * 1.0001, "{stopped}");
    assert!(scene.contact.is_resting());
}

#[test]
fn pub17_slides_to_a_stop() {
    for (h, bound) in [
        (1.0 / 240.0, 1e-13),
        (SIXTIETH, 1e-13),
        (0.05, 1e-9),
        (0.5, 1e-8),
    ] {
        pub17::<Split>(h, bound);
        pub17::<Rk4>(h, bound);
    }
    // Half an acceleration step off: ½ µg h t, their own law.
    pub17::<ExplicitEuler>(SIXTIETH, 0.05);
    pub17::<SemiImplicitEuler>(SIXTIETH, 0.05);
}

/// The round cone: a diagonal slide stops on its line, as far as any other.
#[test]
fn diagonal_slide_stops_on_its_line() {
    for i in 0..12 {
        let (s, c) = sin_cos(0.3 * f64::from(i));
        let mut scene = Scene::new(DVec3::new(0.5, 0.25, 0.3), 0.0, 0.4);
        let direction = DVec3::new(c, 0.0, s);
        scene.state.velocity = direction * 3.0;
        scene.run::<Split>(SIXTIETH, 90);
        let expected = direction * (9.0 / (2.0 * 0.4 * G)) + DVec3::Y * 0.25;
        let error = (scene.state.position - expected).length();
        assert!(error < 1e-9 && scene.contact.is_resting(), "{i}: {error:e}");
    }
}

#[test]
fn slope_holds_below_the_friction_angle_and_slides_above() {
    for mu in [0.1_f64, 0.5, 1.0] {
        for factor in [0.5, 0.9, 0.99, 1.01, 1.1, 1.5] {
            let theta = libm::atan(mu) * factor;
            let mut scene = Scene::new(DVec3::new(0.5, 0.2, 0.5), 0.0, mu).on_slope(theta);
            scene.state.rotation = about(DVec3::Y, 0.3);
            let start = scene.state;
            scene.run::<Split>(SIXTIETH, 60);
            let (s, c) = sin_cos(theta);
            let a = G * (s - mu * c);
            if factor < 1.0 {
                assert_eq!(scene.state, start, "mu {mu} factor {factor}");
                assert!(scene.contact.is_resting());
            } else {
                let x = scene.state.position.x - start.position.x;
                assert!(
                    (x - 0.5 * a).abs() < 1e-9,
                    "mu {mu} factor {factor}: {x} {a}"
                );
                assert!((scene.state.position.z).abs() < 1e-9);
            }
        }
    }
}

/// Case 31: between the four-corner law and the uniform pressure's, and the centre stays.
#[test]
fn plate_spins_down() {
    for (omega, h) in [(3.0, SIXTIETH), (20.0, SIXTIETH), (20.0, 1.0 / 240.0)] {
        let half = DVec3::new(0.4, 0.02, 0.4);
        let mut scene = Scene::new(half, 0.0, 0.5);
        scene
            .state
            .set_angular_velocity(&scene.body, DVec3::Y * omega);
        let radius = (half.x * half.x + half.z * half.z).sqrt();
        let slow = radius * omega / (3.0 * 0.5 * G);
        let quick = radius * radius * omega / (3.0 * 0.5 * G * 0.765 * half.x);
        let mut t = 0.0;
        while !scene.contact.is_resting() && t < 10.0 {
            scene.step::<Split>(h);
            t += h;
        }
        println!(
            "plate {omega}: {t:.4} in {slow:.4}..{quick:.4}, walk {:.1e}",
            scene.state.position.x.hypot(scene.state.position.z)
        );
        assert!(t >= slow - h && t <= quick + 2.0 * h);
        assert!(scene.state.position.x.hypot(scene.state.position.z) < 1e-3);
    }
}

/// Case 28: a sliding box tips over its leading edge if µ h_y > h_x, to 2 %.
#[test]
fn sliding_tips_at_the_threshold() {
    let half = DVec3::new(0.3, 0.6, 0.4);
    for (factor, tips) in [(0.98, false), (1.02, true)] {
        let mut scene = Scene::new(half, 0.0, half.x / half.y * factor);
        scene.state.velocity = DVec3::X * 3.0;
        let mut tilt = 0.0_f64;
        for _ in 0..60 {
            scene.step::<Split>(SIXTIETH);
            tilt = tilt.max(scene.state.rotation.z.abs());
        }
        assert_eq!(tilt > 1e-6, tips, "{factor}: {tilt:e}");
        assert!(tips || tilt == 0.0 || tilt < 1e-12);
    }
}

/// Case 29: pushed at height H over the floor it tips iff F H > m g h_x while F < µ m g.
#[test]
fn a_push_tips_at_the_threshold() {
    let half = DVec3::new(0.3, 0.6, 0.4);
    for (factor, tips) in [(0.98, false), (1.02, true)] {
        let mut scene = Scene::new(half, 0.0, 2.0);
        let start = scene.state;
        let force = 3.0 * G * half.x / (half.y + 0.2) * factor;
        let push = [crate::force::PointForce {
            body_point: DVec3::Y * 0.2,
            force: DVec3::X * force,
            frame: crate::force::Frame::World,
        }];
        let law = crate::force::Forces {
            acceleration: scene.gravity.0,
            point_forces: &push,
            ..Default::default()
        };
        for _ in 0..30 {
            step_on_floor::<Split, _>(
                &scene.floor,
                &scene.settings,
                &scene.body,
                &mut scene.state,
                &law,
                SIXTIETH,
                &mut scene.memory,
                &mut scene.contact,
                None,
            );
        }
        assert_eq!(scene.state != start, tips, "{factor}");
        assert_eq!(scene.contact.is_resting(), !tips);
        assert!(!tips || scene.state.rotation.z < -1e-4);
    }
}
