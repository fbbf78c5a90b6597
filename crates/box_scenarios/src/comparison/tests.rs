use super::*;
use crate::scenario::Scenario;
use crate::scene_file;
use box_physics::integrators::{EnergyBehavior, Limit, Order};

const H: f64 = 1.0 / 60.0;
/// Duration for several impacts, or for the motion that the scene demonstrates \[s\].
const SECONDS: f64 = 6.0;

/// Every built-in scene and every shipped scene file.
fn scenes() -> Vec<(String, Setup)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes");
    let files = std::fs::read_dir(folder).expect("shipped").map(|entry| {
        let path = entry.expect("readable").path();
        let scene = scene_file::load(&path).unwrap_or_else(|e| panic!("{e}"));
        (scene.id.to_owned(), scene.setup)
    });
    let built_in = Scenario::ALL.iter().map(|build| build());
    built_in
        .map(|s| (s.id.to_owned(), s.setup))
        .chain(files)
        .map(|(id, mut setup)| {
            setup.duration = setup.duration.min(SECONDS);
            (id, setup)
        })
        .collect()
}

fn table(setup: &Setup, dt: f64) -> ComparisonResult {
    let comparison = IntegratorComparison {
        setup: setup.clone(),
        integrators: Integrator::ALL.to_vec(),
        dt,
        substeps: 1,
    };
    comparison
        .run(|_| Ok::<(), ()>(()))
        .expect("nobody stops it")
}

/// The dimensionless steps of a scene at `dt`: |ω|h, c₁h/m, √(k/m)h.
fn steps(setup: &Setup, dt: f64) -> [f64; 3] {
    let (body, f) = (&setup.body, &setup.forces);
    let spin = setup.initial.body_angular_velocity(body).length();
    let stiffness: f64 = f.springs.iter().map(|s| s.stiffness).sum();
    [
        spin * dt,
        f.linear_drag * dt * body.inverse_mass(),
        (stiffness * body.inverse_mass()).sqrt() * dt,
    ]
}

/// Returns `true` if the integrator's stated properties allow it to diverge in a scene: a step beyond its stable range,
/// or growing energy.
fn may_diverge(integrator: Integrator, setup: &Setup, dt: f64) -> bool {
    let stable = integrator.info().stability;
    let limits = [stable.rotation, stable.drag, stable.oscillator];
    limits.into_iter().zip(steps(setup, dt)).any(|(limit, step)| match limit {
        Limit::None => false,
        Limit::Below(most) => step >= most,
        Limit::AlwaysGrows => step > 0.0,
    })
    // With explicit Euler a bouncing box gains energy in every flight.
    || (setup.floor.is_some() && integrator.info().orders.gravity == Order::Of(1))
}

/// For every scene and integrator, the status agrees with the integrator's stated limits, and every column has a value.
#[test]
fn nothing_is_called_diverged_that_is_not() {
    for (id, setup) in scenes() {
        let result = table(&setup, H);
        assert!(
            result.horizon.is_none(),
            "{id}: chaotic after {:?}",
            result.horizon
        );
        for r in &result.integrators {
            let name = format!("{} on {id}: {r:?}", r.integrator);
            if let Status::Diverged(d) = r.status {
                assert!(may_diverge(r.integrator, &setup, H), "{name}");
                assert_diverges(r.integrator, &setup, d.t, &name);
                assert_eq!(
                    (r.position, r.attitude, r.energy, r.momentum),
                    (None, None, None, None),
                    "{name}"
                );
            } else {
                let known = [r.position, r.attitude, r.energy, r.momentum];
                assert!(
                    known.into_iter().all(|x| x.is_some_and(f64::is_finite)),
                    "{name}"
                );
                let energy = r.energy.expect("known");
                assert!(energy <= 2.0, "{name}");
            }
        }
    }
}

/// Asserts divergence without the balance, by the motion alone: when the run was stopped, the box was faster than the
/// reference ever was.
fn assert_diverges(integrator: Integrator, setup: &Setup, t: f64, name: &str) {
    let model = Model::of(setup);
    let mut reference = LiveReference::of(setup, H);
    let mut runner = Runner::new(
        integrator,
        &Arc::new(model),
        setup.initial,
        0.0,
        &setup.impulses,
    );
    let kinetic = |s: &BodyState| s.kinetic_energy(&setup.body);
    let mut most = kinetic(&setup.initial);
    let n = (t / H).round() as u64;
    for k in 0..n {
        runner.take_impulses(&setup.impulses, k as f64 * H + DUE * H);
        most = most.max(reference.at(k as f64 * H).map_or(0.0, |r| kinetic(&r)));
        runner.driver.step(&runner.model, H);
    }
    let now = kinetic(&runner.driver.state);
    assert!(now > 1.3 * most, "{name}: {now:e} J against {most:e} J");
}

/// Conserved quantities and exact motions, checked in the scenes that test only them.
#[test]
fn errors_are_those_that_the_integrator_claims() {
    for (id, setup) in scenes() {
        let result = table(&setup, H);
        let free = setup.conserves_angular_momentum() && setup.forces.linear_drag == 0.0;
        let spins = setup.initial.angular_momentum.length() > 0.0;
        for r in result
            .integrators
            .iter()
            .filter(|r| !r.status.is_diverged())
        {
            let info = r.integrator.info();
            let name = format!("{} on {id}: {r:?}", r.integrator);
            let [position, attitude, energy, momentum] =
                [r.position, r.attitude, r.energy, r.momentum].map(|x| x.expect("known"));
            // For gravity alone in flight the motion is a parabola: exact from second order on, with an error of g h t
            // / 2 for first order.
            if free && setup.forces.quadratic_drag == 0.0 {
                let g = setup.forces.acceleration(&setup.body).length();
                match info.orders.gravity {
                    Order::Exact => assert!(position < 1e-11 * (1.0 + g * 36.0), "{name}"),
                    // A multistep method starts with an Euler step, which lags by g h²/2.
                    Order::Of(p) => {
                        let time = if p == 1 { setup.duration } else { H };
                        let expected = 0.5 * g * H * time;
                        assert!(
                            (position - expected).abs() <= 1e-9 + 0.02 * expected,
                            "{name}"
                        );
                    }
                }
                if info.orders.rotation == Order::Exact {
                    // Near the separatrix every rounding error is amplified (by 6e3 for pub02).
                    let amplified = matches!(id.as_str(), "dzhanibekov" | "separatrix");
                    assert!(attitude < if amplified { 1e-8 } else { 1e-11 }, "{name}");
                }
                if info.conserved.momentum {
                    assert!(momentum < 1e-12, "{name}");
                }
                if info.conserved.energy == EnergyBehavior::Exact
                    && (g == 0.0 || info.orders.gravity == Order::Exact)
                {
                    assert!(energy < 1e-12, "{name}");
                }
                if info.conserved.energy == EnergyBehavior::Gains && spins && id == "thin-plate" {
                    assert!(energy > 1e-6, "{name}");
                }
            }
            // At the floor, an integrator with an accurate fall has an accurate energy.
            if setup.floor.is_some()
                && info.orders.gravity == Order::Exact
                && matches!(info.orders.rotation, Order::Exact | Order::Of(4..))
            {
                assert!(energy < 1e-3, "{name}");
            }
        }
    }
}

/// In the scenes that end at rest, every integrator comes to rest.
#[test]
fn what_lies_is_called_resting() {
    for id in [
        "playground",
        "drop",
        "slide",
        "contact",
        "dissertation-2012",
    ] {
        let mut setup = Scenario::find(id).expect("a scene").setup;
        setup.duration = setup.duration.min(12.0);
        for r in table(&setup, H).integrators {
            // With explicit Euler each bounce gains what restitution removes. Adams–Bashforth 2 starts with its step.
            let gains = matches!(
                r.integrator,
                Integrator::ExplicitEuler | Integrator::AdamsBashforth2
            );
            let bounces = gains && matches!(id, "drop" | "dissertation-2012");
            assert_eq!(
                r.status == Status::Resting,
                !bounces,
                "{} on {id}: {}",
                r.integrator,
                r.status
            );
        }
    }
}

/// Halving the step reduces the error by the power of the order, measured in the table's columns.
#[test]
fn errors_fall_with_the_order() {
    for id in ["dzhanibekov", "thin-plate", "throw"] {
        let mut setup = Scenario::find(id).expect("a scene").setup;
        setup.duration = 2.0;
        let (coarse, fine) = (table(&setup, H / 4.0), table(&setup, H / 8.0));
        for (a, b) in coarse.integrators.iter().zip(&fine.integrators) {
            let Order::Of(p) = a.integrator.info().orders.rotation else {
                continue;
            };
            let (x, y) = (a.attitude.expect("known"), b.attitude.expect("known"));
            if y > 1e-11 && x < 0.1 {
                let order = libm::log2(x / y);
                assert!(
                    order > f64::from(p) - 0.25,
                    "{} on {id}: {order:.2}",
                    a.integrator
                );
            }
        }
    }
}
