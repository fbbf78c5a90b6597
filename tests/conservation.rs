//! Each integrator conserves the quantities of a freely tumbling body that it claims to conserve, and no
//! others.

use box_physics::integrators::EnergyBehavior;
use box_physics::prelude::*;
use box_scenarios::trend::energy_trend;
use box_scenarios::{Driver, ForceSet, Model, Setup};

const H: f64 = 1.0 / 60.0;

fn tumbling(half: DVec3, omega: DVec3) -> Setup {
    let body = RigidBox::new(half, 3.0).expect("valid");
    let start = BodyState::default().with_body_angular_velocity(&body, omega);
    Setup::new(body, start, ForceSet::none(), 10.0)
}

fn brick() -> Setup {
    tumbling(DVec3::new(0.5, 0.25, 0.125), DVec3::new(1.5, 2.5, 1.0))
}

fn plate() -> Setup {
    tumbling(
        DVec3::new(0.5, 1.0 / 128.0, 0.375),
        DVec3::new(3.0, 0.5, 4.0),
    )
}

/// Largest relative errors of (L vector, |L|, energy) over `n` steps.
fn drift(setup: &Setup, i: Integrator, n: u64) -> (f64, f64, f64) {
    let (body, start) = (&setup.body, setup.initial);
    let (model, mut driver) = (Model::of(setup), Driver::new(start, i));
    let (l, e) = (
        start.angular_momentum_world(),
        start.rotational_energy(body),
    );
    let mut worst = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..n {
        driver.step(&model, H).expect("600 steps stay valid");
        let state = driver.state;
        let now = state.angular_momentum_world();
        worst.0 = worst.0.max((now - l).length() / l.length());
        worst.1 = worst
            .1
            .max((state.angular_momentum.length() / l.length() - 1.0).abs());
        worst.2 = worst.2.max((state.rotational_energy(body) / e - 1.0).abs());
    }
    worst
}

/// Largest relative error of a conserved quantity: 600 steps cause at most a few hundred roundings.
const MAX_CONSERVED_ERROR: f64 = 1e-12;
/// Smallest relative error of any other quantity.
const MIN_VIOLATION: f64 = 1e-9;

#[test]
fn angular_momentum_as_claimed() {
    for &i in Integrator::ALL {
        let conserved = i.info().conserved;
        let (a, b) = (drift(&brick(), i, 600), drift(&plate(), i, 600));
        let (vector, magnitude) = (a.0.max(b.0), a.1.max(b.1));
        let check = |what, claimed, value: f64| {
            if claimed {
                assert!(
                    value < MAX_CONSERVED_ERROR,
                    "{i} claims to conserve {what}, but: {value:e}"
                );
            } else {
                assert!(
                    value > MIN_VIOLATION,
                    "{i} conserves {what} and does not say so: {value:e}"
                );
            }
        };
        check("L", conserved.momentum, vector);
        check("|L|", conserved.momentum_magnitude, magnitude);
    }
}

#[test]
fn energy_as_claimed() {
    for &i in Integrator::ALL {
        let worst = drift(&brick(), i, 600).2.max(drift(&plate(), i, 600).2);
        // 17 minutes of tumbling.
        let trend = energy_trend(&brick(), i, H, 60_000);
        let claim = i.info().conserved.energy;
        // Each claim excludes the others.
        let ok = match (claim, trend) {
            (EnergyBehavior::Exact, Some(t)) => worst < 1e-11 && t.abs() < 1e-9,
            (EnergyBehavior::Bounded, Some(t)) => worst > 1e-11 && t.abs() < 1e-9,
            (EnergyBehavior::Dissipates, Some(t)) => (-1.0..-1e-9).contains(&t),
            (EnergyBehavior::Gains, Some(t)) => t > 1e-9,
            // Unbounded growth is a gain.
            (EnergyBehavior::Gains, None) => true,
            (EnergyBehavior::Drifts, Some(t)) => (1e-9..1.0).contains(&t.abs()),
            (_, None) => false,
        };
        assert!(
            ok,
            "{i} claims: {claim}; oscillation {worst:e}, trend {trend:?}"
        );
    }
}

/// Bounded energy errors shrink with the order of the rotation.
#[test]
fn integrators_rank_by_energy() {
    let rank: Vec<Integrator> = ["split", "rk4", "heun-2012", "semi-implicit-euler"]
        .iter()
        .map(|id| id.parse().expect("there"))
        .collect();
    let trends: Vec<f64> = rank
        .iter()
        .map(|&i| energy_trend(&brick(), i, H, 60_000).map_or(f64::INFINITY, f64::abs))
        .collect();
    assert!(trends.is_sorted(), "{rank:?}: {trends:?}");
}

/// A million steps without a trend.
#[test]
fn no_trend_in_a_million_steps() {
    for id in ["split", "exact", "dmv6", "implicit-midpoint"] {
        let i: Integrator = id.parse().expect("an integrator");
        let trend = energy_trend(&brick(), i, H, 1_000_000).expect("valid");
        assert!(trend.abs() < 1e-9, "{id}: {trend:e}");
    }
}

/// Over a million steps the default conserves energy, |L| and L in the world to 1e-12. 600 steps forward and
/// back return to 1e-12.
#[test]
fn the_default_keeps_everything_to_rounding() {
    for setup in [brick(), plate()] {
        let (vector, magnitude, energy) = drift(&setup, Integrator::Split, 1_000_000);
        assert!(
            vector < 1e-12 && magnitude < 1e-12 && energy < 1e-12,
            "{vector:e} {magnitude:e} {energy:e}"
        );
        let (model, mut driver) = (
            Model::of(&setup),
            Driver::new(setup.initial, Integrator::Split),
        );
        for h in [H, -H] {
            assert!(driver.run(&model, h, 600, u64::MAX));
        }
        assert!(driver.state.attitude_difference(&setup.initial) < 1e-12);
    }
}

/// The brick under a torque that depends on its attitude, with linear damping.
fn forced() -> Setup {
    let mut setup = brick();
    setup.forces = ForceSet {
        linear_drag: 0.6,
        angular_damping: 0.2,
        ..ForceSet::gravity(9.81)
    }
    .with_dipole(DVec3::new(0.0, 1.5, 0.5), DVec3::new(0.0, 1.0, 0.5));
    setup
}

/// 600 steps forward and 600 back: a free body for the claim; forces and damping too for integrators without the claim.
#[test]
fn reversible_as_claimed() {
    for &i in Integrator::ALL {
        let back = |setup: &Setup| {
            let (model, mut driver) = (Model::of(setup), Driver::new(setup.initial, i));
            for h in [H, -H] {
                assert!(driver.run(&model, h, 600, u64::MAX), "{i}");
            }
            driver.state.attitude_difference(&setup.initial)
        };
        // The claim is about a free body.
        let mut worst = back(&brick()).max(back(&plate()));
        if i.info().conserved.reversible {
            assert!(worst < 1e-11, "{i} claims to be reversible: {worst:e}");
        } else {
            worst = worst.max(back(&forced()));
            assert!(
                worst > MIN_VIOLATION,
                "{i} is reversible and does not say so: {worst:e}"
            );
        }
    }
}
