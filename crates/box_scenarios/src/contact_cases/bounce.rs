//! Cases 25 and 30: bounces.

use box_physics::integrators::Integrator;
use glam::{DQuat, DVec3};

use super::{G, STEP, Trial};

const DROP: f64 = 2.0;
/// Time of the eighth bounce with e = 0.5 from 2 m: √(2h/g)(1 + 2Σeⁿ, n = 1 … 7) \[s\].
const EIGHTH: f64 = 1.9056;

fn drop_flat(integrator: Integrator, e: f64) -> Trial {
    let mut trial = Trial::new(integrator, DVec3::new(0.5, 0.25, 0.5), e, 0.0);
    trial.state.position.y += DROP;
    trial
}

/// Height above the rest position \[m\] after `t` \[s\]: parabolas between the impacts.
fn height(e: f64, t: f64) -> f64 {
    let mut speed = (2.0 * G * DROP).sqrt();
    let mut at = speed / G;
    if t < at {
        return DROP - 0.5 * G * t * t;
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

/// Largest error before the eighth bounce and over the run \[m\], and the settling time \[s\].
fn settle(integrator: Integrator) -> (f64, f64, f64) {
    let mut trial = drop_flat(integrator, 0.5);
    let (mut early, mut all, mut settled) = (0.0_f64, 0.0_f64, f64::INFINITY);
    for n in 1..=180 {
        let outcome = trial.run(STEP, 1);
        let t = f64::from(n) * STEP;
        let error = (trial.state.position.y - 0.25 - height(0.5, t)).abs();
        all = all.max(error);
        if t < EIGHTH {
            early = early.max(error);
        }
        if outcome.resting {
            settled = settled.min(t);
        }
    }
    (early, all, settled)
}

pub(super) fn position_error(integrator: Integrator) -> f64 {
    settle(integrator).1
}

pub(super) fn position_error_early(integrator: Integrator) -> f64 {
    settle(integrator).0
}

pub(super) fn settling_time(integrator: Integrator) -> f64 {
    let expected = (2.0 * DROP / G).sqrt() * 3.0;
    (settle(integrator).2 / expected - 1.0).abs()
}

pub(super) fn apexes(integrator: Integrator) -> f64 {
    let mut worst = 0.0_f64;
    for (e, bounces) in [(0.9_f64, 10), (0.5, 10), (0.1, 10), (1.0, 100)] {
        let mut trial = drop_flat(integrator, e);
        let (mut n, mut steps) = (0, 0);
        while n < bounces && !trial.rests() && steps < 20_000 {
            steps += 1;
            let impacts = trial.run(STEP, 1).impacts;
            if impacts > 0 {
                n += impacts as i32;
                // The apex of the current flight: y + v²/2g.
                let v = trial.state.velocity.y;
                let apex = trial.state.position.y - 0.25 + v * v / (2.0 * G);
                worst = worst.max((apex - DROP * e.powi(2 * n)).abs());
            }
        }
        if n < bounces && !trial.rests() {
            return f64::INFINITY;
        }
    }
    worst
}

/// Time of the impact of pub18 \[s\], and the velocities after it.
const IMPACT: f64 = 0.4407012274769385;
const VELOCITY_AFTER: DVec3 = DVec3::new(1.0, -1.9195478803605666, 0.0);
const SPIN_AFTER: DVec3 = DVec3::new(-8.16491612612218, -0.7425554530552235, -6.810797764281198);
/// Time of its last sample \[s\] and the position there \[m\].
const END: f64 = 0.513_745_715_825_506_2;
const POSITION_AT_END: DVec3 = DVec3::new(0.5137457158255062, 0.38097980290145256, 0.0);

fn corner_drop(integrator: Integrator) -> Trial {
    let mut trial = Trial::new(integrator, DVec3::new(0.5, 0.25, 0.375), 0.5, 0.0);
    trial.state.position.y = 1.5;
    trial.state.rotation = DQuat::from_xyzw(
        0.2246798574924469,
        0.06740395724773407,
        0.17974388599395752,
        0.9553365111351013,
    );
    trial.state.velocity = DVec3::X;
    trial
}

/// 26 steps at 60 Hz end 7 ms before the impact. A further step ends a nanosecond after it.
fn after_impact(integrator: Integrator) -> Trial {
    let mut trial = corner_drop(integrator);
    trial.run(STEP, 26);
    trial.run(IMPACT + 1e-9 - 26.0 * STEP, 1);
    trial
}

pub(super) fn corner_velocity(integrator: Integrator) -> f64 {
    let v = after_impact(integrator).state.velocity;
    (v - VELOCITY_AFTER).length() / VELOCITY_AFTER.length()
}

pub(super) fn corner_spin(integrator: Integrator) -> f64 {
    let trial = after_impact(integrator);
    let w = trial.state.angular_velocity(&trial.body);
    (w - SPIN_AFTER).length() / SPIN_AFTER.length()
}

pub(super) fn corner_position(integrator: Integrator) -> f64 {
    let mut trial = corner_drop(integrator);
    let n = (END / STEP).ceil();
    trial.run(END / n, n as u32);
    (trial.state.position - POSITION_AT_END).length()
}
