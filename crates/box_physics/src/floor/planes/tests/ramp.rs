//! One tilted plane is equivalent to the floor under tilted gravity.

use super::*;
use crate::math::sin_cos;

/// A ramp through a point off the origin, down along +x of the ramp's axes, which are turned relative to the world's.
struct Ramp {
    turn: DQuat,
    scene: Scene,
    /// The same scene over a floor.
    level: Scene,
}

impl Ramp {
    /// Creates a ramp with a box in `state`, in the axes of the ramp.
    fn new(half: DVec3, state: BodyState, theta: f64, turn: DQuat, (e, mu): (f64, f64)) -> Self {
        let mut level = Scene::new(half, e, mu).on_slope(theta).with_state(state);
        let point = turn * DVec3::new(0.3, 0.0, -0.2);
        let plane = wall(point, turn * DVec3::Y, &level.floor);
        let mut scene = level.turned(turn);
        scene.planes.push(plane);
        level.gravity.0 = turn.inverse() * scene.gravity.0;
        Self { turn, scene, level }
    }

    fn step(&mut self) {
        self.scene.step::<Split>(SIXTIETH);
        self.level.step::<Split>(SIXTIETH);
    }

    /// Difference between the poses of the two scenes, at the radius of the box \[m\].
    fn apart(&self) -> f64 {
        let (a, b) = (&self.scene.state, &self.level.state);
        let turned = self.turn * b.rotation;
        let angle = (a.rotation * turned.dot(a.rotation).signum() - turned).length();
        (a.position - self.turn * b.position).length() + angle * self.scene.body.radius()
    }
}

#[test]
fn a_ramp_is_a_floor_under_tilted_gravity() {
    let mut random = Random(11);
    let half = DVec3::new(0.5, 0.25, 0.4);
    let (mut sliding, mut thrown) = (0.0_f64, 0.0_f64);
    for _ in 0..100 {
        let turn = random.attitude();
        let lying = BodyState::at(DVec3::Y * 0.25).with_velocity(DVec3::new(0.7, 0.0, 0.4));
        let mut ramp = Ramp::new(half, lying, 0.4, turn, (0.3, 0.3));
        for _ in 0..60 {
            ramp.step();
        }
        sliding = sliding.max(ramp.apart());
        // Every impact amplifies rounding errors.
        let state =
            BodyState::at_pose(DVec3::Y * 1.2, random.attitude()).with_velocity(random.vector(2.0));
        let mut ramp = Ramp::new(half, state, 0.4, turn, (0.5, 0.3));
        for _ in 0..24 {
            ramp.step();
        }
        thrown = thrown.max(ramp.apart());
    }
    println!("a ramp: apart by {sliding:.1e} m sliding, {thrown:.1e} m thrown");
    assert!(sliding < 1e-12 && thrown < 1e-8);
}

/// A box rests bit for bit below the angle of friction, and slides above it.
#[test]
fn the_angle_of_friction() {
    let mut random = Random(12);
    for (mu, holds) in [(0.51, true), (0.49, false), (0.0, false)] {
        for _ in 0..20 {
            let lying = BodyState::at(DVec3::Y * 0.25);
            let theta = libm::atan(0.5);
            let (turn, half) = (random.attitude(), DVec3::new(0.5, 0.25, 0.5));
            let mut ramp = Ramp::new(half, lying, theta, turn, (0.0, mu));
            ramp.step();
            let first = ramp.scene.state;
            assert_eq!(ramp.scene.contact.is_resting(&first), holds);
            for _ in 0..59 {
                ramp.step();
            }
            let (s, c) = sin_cos(theta);
            let way = if holds { 0.0 } else { 0.5 * G * (s - mu * c) };
            let moved = turn.inverse() * ramp.scene.state.position;
            assert!((moved.x - way).abs() < 1e-13 && ramp.apart() < 1e-13);
            assert!(!holds || ramp.scene.state == first);
        }
    }
}

/// The reported impulses equal the change of momentum, in world axes.
#[test]
fn the_report_balances_the_momentum() {
    let mut random = Random(13);
    let mut impacts = 0;
    for i in 0..200 {
        let turn = random.attitude();
        let state =
            BodyState::at_pose(DVec3::Y * 0.7, random.attitude()).with_velocity(random.vector(3.0));
        let mut scene = Ramp::new(DVec3::new(0.5, 0.25, 0.4), state, 0.4, turn, (0.5, 0.3)).scene;
        if i % 2 == 0 {
            // A second plane across, for which only the sum of both is known.
            let across = turn * DVec3::new(-1.0, 0.2, 0.0);
            let surface = scene.planes[0].surface;
            scene.planes.push(wall(turn * DVec3::X, across, &surface));
        }
        for _ in 0..30 {
            let before = scene.state.velocity;
            let mut report = ContactReport::default();
            let gravity = scene.gravity;
            let outcome = scene.step_under::<Split>(&gravity, SIXTIETH, Some(&mut report));
            impacts += outcome.impacts;
            // Removing energy that errors had added changes the velocity.
            if outcome.impacts == 0 || i % 2 == 0 || outcome.energy_repairs > 0 {
                continue;
            }
            let change = scene.state.velocity - before - scene.gravity.0 * SIXTIETH;
            let pushed = report.normal * report.normal_impulse() + report.tangential_impulse;
            let error = (pushed - scene.body.mass() * change).length();
            assert!(error < 1e-9 * scene.body.mass() && report.approach_speed > 0.0);
            let far = (report.point() - scene.state.position).length();
            assert!(far < scene.body.radius() + 0.2);
        }
    }
    assert!(impacts > 200);
}
