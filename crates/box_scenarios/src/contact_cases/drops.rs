//! Random drops with a fixed seed: energy gains (case 30) and penetration depth (case 32).

use box_physics::floor::RestitutionLaw;
use box_physics::integrators::Integrator;
use box_physics::state::BodyState;
use glam::{DQuat, DVec3};

use super::Trial;
use crate::random::Random;

/// Largest relative energy gain in a step.
pub(super) fn gain(integrator: Integrator) -> f64 {
    cubes(integrator).gain
}

/// Largest part of the energy that an impact returns in excess of e² times the loss of a plastic impact, under the
/// default restitution law.
pub(super) fn energetic_excess(integrator: Integrator) -> f64 {
    excess(integrator, RestitutionLaw::Energetic)
}

/// The same as [`energetic_excess`] under Newton's law.
pub(super) fn newton_excess(integrator: Integrator) -> f64 {
    excess(integrator, RestitutionLaw::Newton)
}

/// The excess over a thousand single impacts of boxes without gravity, each repeated with e = 0.
fn excess(integrator: Integrator, law: RestitutionLaw) -> f64 {
    let mut random = Random::new(4);
    let mut worst = 0.0_f64;
    for _ in 0..1000 {
        let half = DVec3::from_array(core::array::from_fn(|_| random.magnitude(0.1, 1.0)));
        let mut trial = drop(&mut random, integrator, half, 10.0);
        trial.gravity = DVec3::ZERO;
        trial.state.position.y -= trial.lowest();
        trial.state.velocity.y = -10.0;
        let after = |e: f64| {
            let mut trial = trial.clone();
            (trial.floor.restitution, trial.settings.restitution) = (e, law);
            let outcome = trial.run(1e-12, 1);
            (outcome.impacts == 1).then(|| trial.energy())
        };
        let (before, e) = (trial.energy(), trial.floor.restitution);
        if let (Some(plastic), Some(end)) = (after(0.0), after(e)) {
            worst = worst.max((end - plastic - e * e * (before - plastic)) / before);
        }
    }
    worst
}

/// Largest energy gain by integration and projection errors that was removed in a step without impacts, relative to the
/// energy before it.
pub(super) fn repaired_segments(integrator: Integrator) -> f64 {
    cubes(integrator).repaired_segments
}

/// Largest values over all drops.
struct Worst {
    gain: f64,
    repaired_segments: f64,
}

/// Drops cubes. Every integrator except the Euler methods rotates them exactly, so that energy changes are due to
/// contact.
fn cubes(integrator: Integrator) -> Worst {
    let mut random = Random::new(1);
    let mut worst = Worst {
        gain: 0.0,
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
            if outcome.impacts == 0 {
                let repaired = outcome.energy_repaired / before;
                worst.repaired_segments = worst.repaired_segments.max(repaired);
            }
            before = after;
        }
        if !trial.state.is_finite() {
            worst.gain = f64::INFINITY;
        }
    }
    worst
}

/// Largest penetration depth of a corner for thin plates, divided by the circumradius.
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

/// A box above the floor with random attitude, velocity and spin, on a floor with random surface properties.
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
