//! Measurements of the claims of the text of 2012.

use box_physics::body::RigidBox;
use box_physics::force::Dissipation;
use box_physics::force::Forces;
use box_physics::integrators::{Integrator, IntegratorMemory};
use box_physics::state::BodyState;
use box_scenarios::dissertation::{Demo, State, Stepper};
use box_scenarios::{Driver, Family, ForceSet, Model, StateError};
use glam::DVec3;

/// Gravity of the falls [m/s²].
const G: f64 = 9.81;

/// |v₁/v₀| after one step of `integrator` under drag with c·dt/m = `z`.
pub(super) fn amplification(integrator: Integrator, z: f64) -> f64 {
    let body = RigidBox::default();
    let forces = Forces {
        dissipation: Dissipation {
            linear_drag: z * body.mass(),
            ..Dissipation::NONE
        },
        ..Forces::default()
    };
    let mut state = BodyState::at(DVec3::ZERO).with_velocity(DVec3::X);
    integrator.step(
        &body,
        &mut state,
        &forces,
        1.0,
        &mut IntegratorMemory::default(),
    );
    state.velocity.x.abs()
}

/// The amplification of a stepper of the dissertation, as in [`amplification`].
pub(super) fn amplification_2012(stepper: Stepper, z: f64) -> f64 {
    let (v, _) = stepper.advance(DVec3::X, 1.0, |v| -z * v);
    v.x.abs()
}

/// Distance from ½·g·t² after one second of free fall with `integrator` and steps of `h` \[m\].
pub(super) fn fall_error(integrator: Integrator, h: f64) -> f64 {
    let model = Model::without_floor(RigidBox::default(), ForceSet::gravity(G));
    let mut driver = Driver::new(BodyState::default(), integrator);
    let n = (1.0 / h).round() as u64;
    driver.run(&model, h, n, u64::MAX);
    (driver.state.position.y + 0.5 * G * (n as f64 * h).powi(2)).abs()
}

/// The same for a stepper of the dissertation: with its position rule, without its other errors.
pub(super) fn fall_error_2012(stepper: Stepper, h: f64) -> f64 {
    let n = (1.0 / h).round() as u64;
    let (mut x, mut v) = (0.0, DVec3::ZERO);
    for _ in 0..n {
        let (new, dx) = stepper.advance(v, h, |_| DVec3::NEG_Y * G);
        v = new;
        x += dx.y;
    }
    (x + 0.5 * G * (n as f64 * h).powi(2)).abs()
}

/// The same for the complete demo of the dissertation, which adds gravity to the position \[m\].
pub(super) fn demo_fall_error(h: f64) -> f64 {
    let demo = Demo {
        floor: None,
        ..Demo::default()
    };
    let body = RigidBox::default();
    let mut state = State::new(&body, &BodyState::at(DVec3::ZERO));
    let n = (1.0 / h).round() as u64;
    for _ in 0..n {
        demo.cycle(Stepper::Heun, &mut state, h);
    }
    (state.position.y + 0.5 * G * (n as f64 * h).powi(2)).abs()
}

/// Attitude error \[rad\] and relative energy of a freely tumbling box, over time.
pub(super) struct Tumble {
    /// Time, attitude error and energy divided by the initial energy.
    pub(super) points: Vec<(f64, f64, f64)>,
}

/// The free tumble with `integrator` in steps of `h`.
pub(super) fn tumble(integrator: Integrator, h: f64) -> Result<Tumble, String> {
    let family = &Family::all()[0];
    let model = Model::of(&family.setup);
    let mut driver = Driver::new(family.setup.initial, integrator);
    follow(h, |_| {
        driver.step(&model, h);
        driver.state
    })
}

/// The free tumble in the dissertation's demo: three rotations per cycle and no gyroscopic term, with or without its
/// damping.
pub(super) fn tumble_2012(h: f64, damped: bool) -> Result<Tumble, String> {
    let family = &Family::all()[0];
    let body = family.setup.body;
    let demo = Demo::of(&body, None);
    let mut state = State::new(&body, &family.setup.initial);
    let spin = state.spin;
    follow(h, |_| {
        demo.cycle(Stepper::Heun, &mut state, h);
        if !damped {
            state.spin = spin;
        }
        state.body_state(&body)
    })
}

/// Compares the states from `next` with the reference over the ten seconds of the free tumble.
fn follow(h: f64, mut next: impl FnMut(u64) -> BodyState) -> Result<Tumble, String> {
    let family = &Family::all()[0];
    let body = &family.setup.body;
    let reference = family.reference(h, family.setup.duration)?;
    let start = family.setup.initial.rotational_energy(body);
    let points = reference.states().iter().enumerate().map(|(k, reference)| {
        let state = next(k as u64);
        let error = StateError::between(&state, reference).attitude;
        let t = (k + 1) as f64 * h;
        (t, error, state.rotational_energy(body) / start)
    });
    Ok(Tumble {
        points: points.collect(),
    })
}

impl Tumble {
    /// The largest attitude error \[rad\].
    pub(super) fn worst(&self) -> f64 {
        self.points.iter().map(|p| p.1).fold(0.0, f64::max)
    }

    /// Relative change of energy from start to end.
    pub(super) fn energy_change(&self) -> f64 {
        self.points.last().map_or(0.0, |p| p.2 - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_claims_are_those_of_theory() {
        // R(z) = 1 − z + z²/2; ½·g·h·t; 1/(1 + z).
        assert!((amplification(Integrator::Heun2012, 3.0) - 2.5).abs() < 1e-12);
        assert!((amplification_2012(Stepper::Heun, 3.0) - 2.5).abs() < 1e-12);
        assert!((amplification(Integrator::BackwardEuler, 3.0) - 0.25).abs() < 1e-12);
        for h in [0.005, 0.01] {
            let expected = 0.5 * G * h;
            for e in [
                fall_error(Integrator::Heun2012, h),
                fall_error_2012(Stepper::Heun, h),
                fall_error_2012(Stepper::Rk4, h),
            ] {
                assert!((e - expected).abs() < 1e-9, "{e}");
            }
            assert!(fall_error(Integrator::Rk4, h) < 1e-12);
            assert!((demo_fall_error(h) - 0.5 * G).abs() < 1e-9);
        }
        let lossy = tumble(Integrator::BackwardEuler, 1.0 / 60.0).expect("free motion");
        assert!((-0.3..-0.15).contains(&lossy.energy_change()));
        assert!(tumble_2012(1.0 / 60.0, false).expect("free motion").worst() > 1.0);
    }
}
