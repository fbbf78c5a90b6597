use super::*;

fn at_rest() -> State {
    State::new(&RigidBox::default(), &BodyState::at(DVec3::Y * 50.0))
}

fn floorless() -> Demo {
    Demo {
        floor: None,
        ..Demo::default()
    }
}

/// With r = 1 − 5h: v_n = v∞ (1 − rⁿ), v∞ = r h a/(1 − r); x_n = Σ h (v_k + h a) for the new-velocity integrators, Σ h
/// v_k for explicit Euler. The box always falls by exactly 9.81 n h.
#[test]
fn a_pushed_box_follows_the_discrete_closed_form() {
    let (h, n, demo) = (1.0 / 60.0, 90, floorless());
    for stepper in Stepper::ALL {
        let mut s = at_rest();
        demo.push(&mut s, DVec3::X * 50.0, DVec3::ZERO);
        for _ in 0..n {
            demo.cycle(stepper, &mut s, h);
        }
        let (a, r) = (5.0, 1.0 - 5.0 * h);
        let limit = r * h * a / (1.0 - r);
        let power = r.powi(n);
        let sum = f64::from(n) * limit - limit * (1.0 - power) / (1.0 - r);
        let ahead = if stepper == Stepper::ExplicitEuler {
            0.0
        } else {
            h * a
        };
        let x = h * (sum + f64::from(n) * ahead);
        assert!((s.velocity.x - limit * (1.0 - power)).abs() < 1e-13);
        assert!((s.position.x - x).abs() < 1e-12, "{stepper:?}");
        assert!((s.position.y - (50.0 - 9.81 * f64::from(n) * h)).abs() < 1e-12);
        assert_eq!(s.velocity.y, 0.0, "it falls without having a speed");
    }
}

/// R(z) = 1 + z, 1 + z + z²/2, and the exponential's first five terms.
#[test]
fn the_steppers_amplify_as_the_analysis_says() {
    let (h, c) = (0.1, 7.0);
    let z: f64 = -c * h;
    for (stepper, factor) in [
        (Stepper::ExplicitEuler, 1.0 + z),
        (Stepper::Heun, 1.0 + z + z * z / 2.0),
        (
            Stepper::Rk4,
            1.0 + z + z * z / 2.0 + z.powi(3) / 6.0 + z.powi(4) / 24.0,
        ),
    ] {
        let (v, dx) = stepper.advance(DVec3::X, h, |v| -c * v);
        assert!((v.x - factor).abs() < 1e-15, "{stepper:?}");
        let by = if stepper == Stepper::ExplicitEuler {
            1.0
        } else {
            v.x
        };
        assert!((dx.x - h * by).abs() < 1e-16);
    }
}

/// ω grows by α/60 per cycle: four times as fast at 240 Hz as at 60 Hz.
#[test]
fn the_spin_depends_on_the_number_of_cycles_not_on_time() {
    let demo = floorless();
    let alpha = 25.0 / demo.inertia().z;
    assert!((demo.inertia() - DVec3::splat(4.15)).length() < 1e-14);
    for h in [1.0 / 60.0, 1.0 / 240.0] {
        let mut s = at_rest();
        demo.push(&mut s, DVec3::Y * 50.0, DVec3::X * 0.5);
        let mut spin = 0.0;
        for _ in 0..40 {
            demo.cycle(Stepper::Heun, &mut s, h);
            spin = (spin + alpha / 60.0) * (1.0 - 5.0 * h);
        }
        assert!((s.spin - DVec3::Z * spin).length() < 1e-13);
    }
}

#[test]
fn a_push_replaces_the_one_before() {
    let demo = floorless();
    let (mut twice, mut once) = (at_rest(), at_rest());
    demo.push(&mut twice, DVec3::X * 80.0, DVec3::Y);
    demo.push(&mut twice, DVec3::Z * 20.0, DVec3::ZERO);
    demo.push(&mut once, DVec3::Z * 20.0, DVec3::ZERO);
    assert_eq!(twice, once);
    // With short cycles and damping, it ends in the velocity that an impulse of 4 N s would give to 10 kg.
    demo.push(&mut once, Demo::force_for(DVec3::Z * 4.0), DVec3::ZERO);
    for _ in 0..40_000 {
        demo.cycle(Stepper::Rk4, &mut once, 1e-4);
    }
    assert!((once.velocity.z - 0.4).abs() < 1e-3);
}

/// Rx Ry Rz is not the rotation by the vector ω h: for 0.1 rad about each axis they differ by
/// half the commutators, |(−1, 1, −1)| θ²/2 to the leading order.
#[test]
fn three_turns_are_not_one() {
    let angle = 0.1;
    let turned = three_turns(DVec3::splat(angle));
    let one = box_physics::rotation::exponential_map(DVec3::splat(angle));
    let d = turned.inverse() * one;
    let between = 2.0 * libm::asin(d.xyz().length());
    let leading = 3.0_f64.sqrt() * angle * angle / 2.0;
    assert!((between / leading - 1.0).abs() < 0.1, "{between} {leading}");
}

#[test]
fn at_rest_it_stands_in_the_floor_and_a_tilted_cube_on_its_corner() {
    let (demo, h) = (Demo::default(), 1.0 / 60.0);
    let mut s = State::new(&RigidBox::default(), &BodyState::at(DVec3::Y * 2.0));
    for _ in 0..200 {
        demo.cycle(Stepper::Heun, &mut s, h);
    }
    assert!((0.5 - s.position.y - 9.81 * h).abs() < 1e-12);
    let tilt = 0.5;
    s.rotation = three_turns(DVec3::Z * tilt);
    for _ in 0..200 {
        demo.cycle(Stepper::Heun, &mut s, h);
    }
    let half_height = 0.5 * (libm::sin(tilt) + libm::cos(tilt));
    assert!((half_height - s.position.y - 9.81 * h).abs() < 1e-12);
    assert_eq!(s.spin, DVec3::ZERO, "nothing turns it over");
}

#[test]
fn damping_turns_round_above_a_fifth_of_a_second() {
    assert!((damping(1.0 / 60.0) - 11.0 / 12.0).abs() < 1e-15);
    assert!(damping(0.25) < 0.0 && damping(0.41) < -1.0);
}
