//! Random drops: what energy does (case 30), and how deep a corner gets (case 32). The seed is fixed.

use box_physics::integrators::Integrator;
use box_physics::state::BodyState;
use glam::{DQuat, DVec3};

use super::Trial;
use crate::random::Random;

/// Largest gain of energy in a step, relative to it.
pub(super) fn gain(integrator: Integrator) -> f64 {
    cubes(integrator).gain
}

/// What Newton's restitution would have gained, and was not let, in a step with impacts, relative to the
/// energy before.
pub(super) fn repaired_impacts(integrator: Integrator) -> f64 {
    cubes(integrator).repaired_impacts
}

/// What the errors of integrator and projection had gained, and was taken back, in a step without impacts,
/// relative to the energy before.
pub(super) fn repaired_segments(integrator: Integrator) -> f64 {
    cubes(integrator).repaired_segments
}

/// The worst of the drops.
struct Worst {
    gain: f64,
    repaired_impacts: f64,
    repaired_segments: f64,
}

/// Cubes, whose free rotation every integrator but the Euler methods does exactly, so that what the energy
/// does is the contact's doing.
fn cubes(integrator: Integrator) -> Worst {
    let mut random = Random::new(1);
    let mut worst = Worst {
        gain: 0.0,
        repaired_impacts: 0.0,
        repaired_segments: 0.0,
    };
    for _ in 0..1000 {
        let half = DVec3::splat(random.magnitude(0.005, 5.0));
        let mut trial = drop(&mut random, integrator, half, 300.0);
        let h = random.magnitude(1e-5, 0.5);
        let mut before = trial.energy();
        for _ in 0..30 {
            let outcome = trial.run(h, 1);
            let after = trial.energy();
            worst.gain = worst.gain.max((after - before) / before);
            let repaired = if outcome.impacts > 0 {
                &mut worst.repaired_impacts
            } else {
                &mut worst.repaired_segments
            };
            *repaired = repaired.max(outcome.energy_repaired / before);
            before = after;
        }
        if !trial.state.is_finite() {
            worst.gain = f64::INFINITY;
        }
    }
    worst
}

/// Thin plates.
pub(super) fn depth(integrator: Integrator) -> f64 {
    let mut random = Random::new(2);
    let mut worst = 0.0_f64;
    for _ in 0..1000 {
        let half = DVec3::new(random.range(0.1, 1.0), 0.0025, random.range(0.1, 1.0));
        let mut trial = drop(&mut random, integrator, half, 300.0);
        let h = random.magnitude(1e-5, 0.5);
        for _ in 0..30 {
            trial.run(h, 1);
            worst = worst.max(-trial.lowest() / trial.body.radius());
        }
    }
    worst
}

/// A box above the floor, at any attitude, falling and spinning, on any floor.
fn drop(random: &mut Random, integrator: Integrator, half: DVec3, speed: f64) -> Trial {
    let e = random.range(0.0, 1.0);
    let mu = random.magnitude(0.01, 5.0);
    let mut trial = Trial::new(integrator, half, e, mu);
    let axis = random.vector(1.0);
    let w = random.range(-1.0, 1.0);
    let turn = DQuat::from_xyzw(axis.x, axis.y, axis.z, w + 0.01);
    trial.state = BodyState::at_pose(trial.state.position, turn);
    trial.state.position.y = trial.body.radius() * random.range(1.0, 2.0);
    let fast = random.magnitude(0.01, speed);
    trial.state.velocity = random.vector(fast);
    let spin = random.magnitude(0.01, 1000.0 / 3.0_f64.sqrt());
    let omega = random.vector(spin);
    trial.state.set_angular_velocity(&trial.body, omega);
    trial
}
