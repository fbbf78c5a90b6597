//! Cases 26 and 27: rest and balance.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use box_physics::integrators::Integrator;
use box_physics::state::BodyState;
use glam::DVec3;

use super::trial::about;
use super::{G, STEP, Trial};
use crate::metrics::differing_numbers;

pub(super) fn changed_components(integrator: Integrator) -> f64 {
    let mut changed = 0;
    for (axis, turns) in [
        (DVec3::X, 0.0),
        (DVec3::X, 1.0),
        (DVec3::X, 2.0),
        (DVec3::X, 3.0),
        (DVec3::Z, 1.0),
        (DVec3::Z, 3.0),
    ] {
        let mut trial = Trial::new(integrator, DVec3::new(0.5, 0.25, 0.375), 0.3, 0.5)
            .turned(about(DVec3::Y, 0.7) * about(axis, turns * FRAC_PI_2));
        trial.state.position.y += 0.5;
        trial.run(STEP, 300);
        let before = trial.state;
        trial.run(STEP, 100_000);
        changed += differing_numbers(&before, &trial.state);
    }
    changed as f64
}

/// Tilt at which the fall is timed \[rad\].
const FALLEN: f64 = 0.7;

pub(super) fn edge_fall_sticking(integrator: Integrator) -> f64 {
    // Pivoting about the edge: θ̇² = (3g/2d)(cos θ₀ − cos θ).
    edge_falls(integrator, 1e3, |_, d, drop| (1.5 * G / d * drop).sqrt())
}

pub(super) fn edge_fall_frictionless(integrator: Integrator) -> f64 {
    // The center falls straight: θ̇² = 2g(cos θ₀ − cos θ)/(d(1/3 + sin²θ)).
    edge_falls(integrator, 0.0, |angle, d, drop| {
        let s = libm::sin(angle);
        (2.0 * G * drop / (d * (1.0 / 3.0 + s * s))).sqrt()
    })
}

/// Largest relative error of the time in which a cube falls from its initial tilt to [`FALLEN`].
fn edge_falls(integrator: Integrator, mu: f64, rate: impl Fn(f64, f64, f64) -> f64) -> f64 {
    let half = DVec3::splat(0.5);
    let d = 0.5_f64.sqrt();
    let mut worst = 0.0_f64;
    for tilt in [1e-1, 1e-2, 1e-4, 1e-8] {
        let mut trial =
            Trial::new(integrator, half, 0.0, mu).turned(about(DVec3::Z, FRAC_PI_4 + tilt));
        let angle = |s: &BodyState| 2.0 * libm::atan2(s.rotation.z, s.rotation.w) - FRAC_PI_4;
        let (mut t, mut before) = (0.0, tilt);
        while angle(&trial.state) < FALLEN && t < 20.0 {
            before = angle(&trial.state);
            trial.run(STEP, 1);
            t += STEP;
        }
        let after = angle(&trial.state);
        t -= STEP * (after - FALLEN) / (after - before);
        // cos θ₀ − cos θ without cancellation.
        let drop = |a: f64| 2.0 * libm::sin(0.5 * (a + tilt)) * libm::sin(0.5 * (a - tilt));
        let expected = time_to_fall(|a| rate(a, d, drop(a)), tilt);
        worst = worst.max((t / expected - 1.0).abs());
    }
    worst
}

/// ∫ dθ/θ̇ from `tilt` to [`FALLEN`] by the midpoint rule, with θ = tilt + s² to remove the square-root singularity at
/// the start.
fn time_to_fall(rate: impl Fn(f64) -> f64, tilt: f64) -> f64 {
    let n = 20_000;
    let ds = (FALLEN - tilt).sqrt() / f64::from(n);
    (0..n)
        .map(|i| {
            let s = (f64::from(i) + 0.5) * ds;
            2.0 * s * ds / rate(tilt + s * s)
        })
        .sum()
}

/// A cube of 1 m balanced on an edge and on a corner, as accurately as f64 allows.
fn balanced(integrator: Integrator) -> [Trial; 2] {
    // The diagonal upright: a rotation about (−1, 0, 1)/√2 by the angle whose cosine is 1/√3.
    let axis = DVec3::new(-1.0, 0.0, 1.0) / 2.0_f64.sqrt();
    let corner = about(axis, libm::acos(1.0 / 3.0_f64.sqrt()));
    [about(DVec3::Z, FRAC_PI_4), corner]
        .map(|rotation| Trial::new(integrator, DVec3::splat(0.5), 0.0, 10.0).turned(rotation))
}

/// The longer of the times for which the cubes stay balanced \[s\]. Infinite if a cube never falls, or if it falls
/// earlier than rounding errors can explain.
pub(super) fn balance(integrator: Integrator) -> f64 {
    let mut longest = 0.0_f64;
    for mut trial in balanced(integrator) {
        let height = trial.state.position.y;
        let mut seconds = 0.0;
        while trial.state.position.y > height - 0.05 {
            trial.run(STEP, 6);
            seconds += 0.1;
            if seconds > 100.0 {
                return f64::INFINITY;
            }
        }
        // Growth by e^{λt}, λ = 3.2/s, from 1e-16 takes at least 3 s.
        if seconds < 3.0 {
            return f64::INFINITY;
        }
        longest = longest.max(seconds);
    }
    longest
}

/// Larger relative error of the time in which the spin of a balanced cube grows from 1e-9 to 1e-3 rad/s, compared with
/// ln(1e6)/λ.
pub(super) fn balance_growth(integrator: Integrator) -> f64 {
    let mut worst = 0.0_f64;
    for mut trial in balanced(integrator) {
        // λ² = m g d/I, I = m (d² + a²/6) about the edge or corner.
        let d = trial.state.position.y;
        let rate = (G * d / (d * d + 1.0 / 6.0)).sqrt();
        let (mut steps, mut before, mut now) = (0_u32, 0.0_f64, 0.0_f64);
        let mut passes = |spin: f64| {
            while now < spin {
                if steps > 3600 {
                    return f64::INFINITY;
                }
                trial.run(STEP, 1);
                steps += 1;
                before = now;
                now = trial.state.body_angular_velocity(&trial.body).length();
            }
            STEP * (f64::from(steps) - libm::log(now / spin) / libm::log(now / before))
        };
        let (from, to) = (passes(1e-9), passes(1e-3));
        if !to.is_finite() {
            return f64::INFINITY;
        }
        let time = to - from;
        worst = worst.max((time * rate / libm::log(1e6) - 1.0).abs());
    }
    worst
}
