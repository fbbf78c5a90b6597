//! Cases 28, 29 and 31: sliding, tipping, spinning down.

use box_physics::force::{Frame, PointForce};
use box_physics::integrators::Integrator;
use glam::DVec3;

use super::trial::heading;
use super::{G, STEP, Trial};

/// pub17: 4 m/s with µ = 0.5; the box stops after v/µg = 0.8155 s.
const SPEED: f64 = 4.0;
const MU: f64 = 0.5;

fn slide(integrator: Integrator) -> Trial {
    let mut trial = Trial::new(integrator, DVec3::new(0.5, 0.25, 0.5), 0.0, MU);
    trial.state.velocity = DVec3::X * SPEED;
    trial
}

pub(super) fn position_error(integrator: Integrator) -> f64 {
    let mut trial = slide(integrator);
    let mut worst = 0.0_f64;
    for n in 1..=78 {
        trial.run(STEP, 1);
        let t = (f64::from(n) * STEP).min(SPEED / (MU * G));
        let x = SPEED * t - 0.5 * MU * G * t * t;
        worst = worst.max((trial.state.position - DVec3::new(x, 0.25, 0.0)).length());
    }
    worst
}

pub(super) fn stopping_time(integrator: Integrator) -> f64 {
    let mut trial = slide(integrator);
    for n in 1..=78 {
        trial.run(STEP, 1);
        if trial.state.velocity == DVec3::ZERO {
            return (f64::from(n) - SPEED / (MU * G) / STEP).abs();
        }
    }
    f64::INFINITY
}

pub(super) fn diagonals(integrator: Integrator) -> f64 {
    let mut worst = 0.0_f64;
    for i in 0..12 {
        let direction = heading(0.3 * f64::from(i));
        let mut trial = Trial::new(integrator, DVec3::new(0.5, 0.25, 0.3), 0.0, 0.4);
        trial.state.velocity = direction * 3.0;
        trial.run(STEP, 90);
        let expected = direction * (9.0 / (2.0 * 0.4 * G)) + DVec3::Y * 0.25;
        worst = worst.max((trial.state.position - expected).length());
    }
    worst
}

const TALL: DVec3 = DVec3::new(0.3, 0.6, 0.4);

/// Relative deviation of the measured threshold from the predicted one, by bisection of its factor between 0.5 and 2;
/// infinite if there is no threshold in that range.
fn threshold(tips: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.5, 2.0);
    if tips(low) || !tips(high) {
        return f64::INFINITY;
    }
    while high - low > 1e-4 {
        let middle = 0.5 * (low + high);
        if tips(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    (0.5 * (low + high) - 1.0_f64).abs()
}

pub(super) fn tipping_by_friction(integrator: Integrator) -> f64 {
    threshold(|factor| {
        let mut trial = Trial::new(integrator, TALL, 0.0, TALL.x / TALL.y * factor);
        trial.state.velocity = DVec3::X * 3.0;
        (0..60).any(|_| {
            trial.run(STEP, 1);
            trial.state.rotation.z.abs() > 1e-9
        })
    })
}

pub(super) fn tipping_by_push(integrator: Integrator) -> f64 {
    let arm = 0.2;
    threshold(|factor| {
        let mut trial = Trial::new(integrator, TALL, 0.0, 3.0);
        let force = 3.0 * G * TALL.x / (TALL.y + arm) * factor;
        trial.push = Some(PointForce {
            body_point: DVec3::Y * arm,
            force: DVec3::X * force,
            frame: Frame::World,
        });
        trial.run(STEP, 30);
        trial.state.rotation.z.abs() > 1e-9
    })
}

/// Spins a plate down. Returns the deviation of the stopping time from the closed form with four loaded corners
/// \[steps\], and the displacement of the center \[m\].
fn plate(integrator: Integrator, omega: f64) -> (f64, f64) {
    let half = DVec3::new(0.4, 0.02, 0.4);
    let mut trial = Trial::new(integrator, half, 0.0, MU);
    trial
        .state
        .set_angular_velocity(&trial.body, DVec3::Y * omega);
    // Moment of inertia m r²/3 and torque µ m g r of a load on the corners of a square.
    let radius = libm::hypot(half.x, half.z);
    let law = radius * omega / (3.0 * MU * G);
    let mut t = 0.0;
    while !trial.rests() && t < 10.0 {
        trial.run(STEP, 1);
        t += STEP;
    }
    let off = (t - law).abs();
    let walk = libm::hypot(trial.state.position.x, trial.state.position.z);
    (off / STEP, walk)
}

pub(super) fn spin_down(integrator: Integrator) -> f64 {
    plate(integrator, 3.0).0.max(plate(integrator, 20.0).0)
}

pub(super) fn walk(integrator: Integrator) -> f64 {
    plate(integrator, 3.0).1.max(plate(integrator, 20.0).1)
}
