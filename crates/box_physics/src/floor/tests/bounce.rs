//! Bounces: cases 25 and 30, pub16, pub18, the order across bounces.
use super::*;
use crate::force::{Dissipation, Forces};
use crate::schemes::{ExplicitEuler, Rk4, Split};

fn drop_flat(e: f64) -> Scene {
    let half = DVec3::new(0.5, 0.25, 0.5);
    Scene::new(half, e, 0.0).with_state(BodyState::at(DVec3::Y * 2.25))
}

/// Height over rest of the closed form: parabolas between the impacts.
fn bounce_height(e: f64, t: f64) -> f64 {
    let mut speed = (2.0_f64 * G * 2.0).sqrt();
    let mut at = speed / G;
    if t < at {
        return 2.0 - 0.5 * G * t * t;
    }
    for _ in 0..60 {
        speed *= e;
        let s = t - at;
        if s < 2.0 * speed / G {
            return speed * s - 0.5 * G * s * s;
        }
        at += 2.0 * speed / G;
    }
    0.0
}

fn pub16<S: Scheme>() {
    let mut scene = drop_flat(0.5);
    let (mut worst, mut early, mut settled) = (0.0_f64, 0.0_f64, None);
    // The eighth bounce of the oracle is at 1.9057 s.
    for n in 1..=180 {
        let outcome = scene.step::<S>(SIXTIETH);
        let t = f64::from(n) * SIXTIETH;
        let error = (scene.state.position.y - 0.25 - bounce_height(0.5, t)).abs();
        worst = worst.max(error);
        if t < 1.9056 {
            early = early.max(error);
        }
        if outcome.resting && settled.is_none() {
            settled = Some(t);
        }
    }
    println!(
        "pub16 {}: worst {worst:.2e} early {early:.2e} settled {settled:?} impacts {}",
        S::INFO.id,
        scene.total.impacts
    );
    assert!(worst <= 2e-4 && early <= 1e-6, "{worst:e} {early:e}");
    let settled = settled.expect("settles");
    assert!((settled - 1.91565).abs() < 0.01916, "{settled}");
    assert_eq!(scene.state.position, DVec3::Y * 0.25);
}

#[test]
fn pub16_bounces_to_rest() {
    pub16::<Split>();
    pub16::<Rk4>();
}

/// Restitution alone decides the apexes: e^{2n}h.
#[test]
fn apexes() {
    for (e, bounces) in [(0.9_f64, 10), (0.5, 10), (0.1, 10), (1.0, 100)] {
        let mut scene = drop_flat(e);
        let (mut n, mut worst) = (0, 0.0_f64);
        let mut before = 0.0;
        for _ in 0..20_000 {
            let impacts = scene.step::<Split>(SIXTIETH).impacts;
            if impacts > 0 {
                n += impacts;
                // The apex that the present flight has: y + v²/2g.
                let v = scene.state.velocity.y;
                let apex = scene.state.position.y - 0.25 + v * v / (2.0 * G);
                let bounces_now = i32::try_from(n).expect("few");
                let expected = 2.0 * e.powi(2 * bounces_now);
                worst = worst.max((apex - expected).abs());
                before = apex;
            }
            if n >= bounces || scene.contact.is_resting() {
                break;
            }
        }
        println!("apexes e={e}: {n} impacts, worst {worst:.2e}, last {before:.3e}");
        assert!(worst < 1e-6, "e={e}: {worst:e}");
    }
}

#[test]
fn pub18_corner_impact() {
    fn check<S: Scheme>() {
        let half = DVec3::new(0.5, 0.25, 0.375);
        let q = DQuat::from_xyzw(
            0.2246798574924469,
            0.06740395724773407,
            0.17974388599395752,
            0.9553365111351013,
        );
        let start = BodyState::at(DVec3::Y * 1.5)
            .with_rotation(q)
            .with_velocity(DVec3::X);
        // Just past the impact, in one step: the jump itself.
        let mut scene = Scene::new(half, 0.5, 0.0).with_state(start);
        scene.step::<S>(0.4407012274769385 + 1e-9);
        let w = DVec3::new(-8.16491612612218, -0.7425554530552235, -6.810797764281198);
        let v = DVec3::new(1.0, -1.9195478803605666, 0.0);
        let dw = (scene.state.angular_velocity(&scene.body) - w).length() / w.length();
        let dv = (scene.state.velocity - v).length() / v.length();
        println!("pub18 {}: jump {dv:.2e} {dw:.2e}", S::INFO.id);
        assert!(dv < 2e-8 && dw < 2e-8);
        let mut scene = Scene::new(half, 0.5, 0.0).with_state(start);
        // 30 samples of 0.017124857… s: the impact at 0.4407 lies in the 26th.
        let h = 0.513_745_715_825_506_2 / 30.0;
        scene.run::<S>(h, 26);
        assert_eq!(scene.total.impacts, 1);
        let v = DVec3::new(1.0, -1.9195478803605666, 0.0);
        let at_impact = scene.state.velocity + DVec3::Y * (G * (26.0 * h - 0.4407012274769385));
        assert!((at_impact - v).length() < 1e-6 * v.length());
        scene.run::<S>(h, 4);
        let x = DVec3::new(0.5137457158255062, 0.38097980290145256, 0.0);
        let w = DVec3::new(-8.175649310020518, 0.4318634745387921, -6.8022344597248905);
        let (dx, dw) = (
            (scene.state.position - x).length(),
            (scene.state.angular_velocity(&scene.body) - w).length() / w.length(),
        );
        println!("pub18 {}: position {dx:.2e}, omega {dw:.2e}", S::INFO.id);
        assert!(dx < 1e-6, "{dx:e}");
        // After 0.073 s of tumbling at 10 rad/s the scheme's own error; see the fine run below.
        assert!(dw < 3e-6, "{dw:e}");
        let mut fine = Scene::new(half, 0.5, 0.0).with_state(start);
        fine.run::<S>(h / 64.0, 30 * 64);
        let dw = (fine.state.angular_velocity(&fine.body) - w).length() / w.length();
        println!("pub18 {} fine: omega {dw:.2e}", S::INFO.id);
        assert!(dw < 1e-9, "{dw:e}");
    }
    check::<Split>();
    check::<Rk4>();
}

/// Richardson: the observed order over halved steps with a fine reference, for the whole state.
fn order<S: Scheme>(half: DVec3, start: BodyState, e: f64, time: f64, impacts: u32) -> f64 {
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
    let p = (a / b).log2();
    println!(
        "{} across {impacts}: {a:.2e} {b:.2e} order {p:.2}",
        S::INFO.id
    );
    p
}

#[test]
fn order_survives_bounces() {
    let half = DVec3::new(0.5, 0.25, 0.375);
    let body = RigidBox::new(half, 3.0).expect("valid");
    let start = BodyState::at(DVec3::Y * 1.5)
        .with_rotation(about(DVec3::new(0.6, 0.0, 0.8), 0.6))
        .with_velocity(DVec3::X)
        .with_angular_velocity(&body, DVec3::new(0.5, 1.0, 0.3));
    for (time, impacts) in [(0.48, 1), (0.9, 2)] {
        assert!((order::<ExplicitEuler>(half, start, 1.0, time, impacts) - 1.0).abs() < 0.15);
        assert!((order::<Split>(half, start, 1.0, time, impacts) - 2.0).abs() < 0.15);
        assert!(order::<Rk4>(half, start, 1.0, time, impacts) > 3.7);
    }
    // Five tumbling bounces magnify any error ten-thousandfold: too much for order 1.
    assert!((order::<Split>(half, start, 1.0, 2.8, 5) - 2.0).abs() < 0.15);
    assert!(order::<Rk4>(half, start, 1.0, 2.8, 5) > 3.7);
}

/// Five flat bounces of a spinning box in thick air, where every scheme has its plain order.
#[test]
fn order_survives_five_bounces_in_air() {
    // Between the fifth impact and the sixth.
    let time = 2.75;
    fn run<S: Scheme>(time: f64, n: u32) -> BodyState {
        let mut scene = Scene::new(DVec3::new(0.5, 0.25, 0.375), 0.9, 0.0);
        scene.state.position.y = 1.0;
        scene.state.velocity.x = 2.0;
        scene
            .state
            .set_angular_velocity(&scene.body, DVec3::Y * 3.0);
        let law = Forces {
            acceleration: scene.gravity.0,
            dissipation: Dissipation {
                quadratic_drag: 0.3,
                angular_drag: 0.2,
                ..Dissipation::NONE
            },
            ..Default::default()
        };
        let mut impacts = 0;
        for _ in 0..n {
            impacts += step_on_floor::<S, _>(
                &scene.floor,
                &scene.settings,
                &scene.body,
                &mut scene.state,
                &law,
                time / f64::from(n),
                &mut scene.memory,
                &mut scene.contact,
                None,
            )
            .impacts;
        }
        assert_eq!(impacts, 5, "{}", S::INFO.id);
        scene.state
    }
    let exact = run::<Rk4>(time, 4096);
    let order = |a: BodyState, b: BodyState| {
        let distance =
            |s: &BodyState| (s.position - exact.position).length() + s.attitude_difference(&exact);
        (distance(&a) / distance(&b)).log2()
    };
    let orders = [
        order(
            run::<ExplicitEuler>(time, 1024),
            run::<ExplicitEuler>(time, 2048),
        ),
        order(run::<Split>(time, 64), run::<Split>(time, 128)),
        order(run::<Rk4>(time, 64), run::<Rk4>(time, 128)),
    ];
    println!("across 5 in air: {orders:.2?}");
    for (observed, claimed) in orders.into_iter().zip([1.0, 2.0, 4.0]) {
        assert!((observed - claimed).abs() < 0.3, "{orders:?}");
    }
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
            // The scheme's renormalisation may move the last bit of the yaw, nothing else moves.
            assert_eq!((s.rotation.x, s.rotation.z), (0.0, 0.0));
            assert!(s.attitude_difference(&start) < 1e-15);
            assert_eq!(s.angular_momentum, DVec3::ZERO);
            assert_eq!((s.velocity.x, s.velocity.z), (0.0, 0.0));
            assert_eq!((s.position.x, s.position.z), (0.3, -5.0));
        }
        assert!(scene.contact.is_resting());
        assert!((scene.state.position.y - 0.2).abs() < 1e-16);
    }
}
