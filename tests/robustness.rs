//! Extreme sizes, positions and steps; degenerate shapes; stable ranges as claimed by the metadata.

use box_physics::integrators::Limit;
use box_physics::prelude::*;
use box_scenarios::hard_cases::{HardCase, Verdict};
use box_scenarios::{Driver, ForceSet, Model, Setup, StateError, hard_cases};

const H: f64 = 1.0 / 60.0;

fn tumbling(half: DVec3, mass: f64, omega: DVec3) -> Setup {
    let body = RigidBox::new(half, mass).expect("valid");
    let start = BodyState::default().with_body_angular_velocity(&body, omega);
    Setup::new(body, start, ForceSet::none(), 10.0)
}

fn run(setup: &Setup, i: Integrator, h: f64, n: u64) -> BodyState {
    let mut driver = Driver::new(setup.initial, i);
    driver.run(&Model::of(setup), h, n, u64::MAX);
    driver.state
}

const BRICK: DVec3 = DVec3::new(0.5, 0.25, 0.125);
const SPIN: DVec3 = DVec3::new(1.5, 2.5, 1.0);

/// Mass and size cancel from Euler's equations, so the attitude does not depend on them. Bounds: the
/// roundings of 120 steps, which differ, times the amplification of the motion.
#[test]
fn mass_and_size_do_not_matter() {
    for &i in Integrator::ALL {
        let reference = run(&tumbling(BRICK, 3.0, SPIN), i, H, 120);
        for mass in [1e-9, 1e-3, 1e3, 1e9] {
            for size in [1e-3, 0.1, 10.0, 1e2] {
                let state = run(&tumbling(BRICK * size, mass, SPIN), i, H, 120);
                let error = state.attitude_difference(&reference);
                assert!(
                    error < 1e-12,
                    "{i}: {error:e} rad at {mass:e} kg, size {size:e}"
                );
            }
        }
    }
}

/// At 100 km the motion equals that at the origin: attitude and velocity bit for bit, the position to half a
/// unit in the last place per step.
#[test]
fn far_from_the_origin() {
    for &i in Integrator::ALL {
        let mut near = tumbling(BRICK, 3.0, SPIN);
        near.initial.velocity = DVec3::new(0.1, 3.0, -0.2);
        near.forces = ForceSet {
            linear_drag: 0.5,
            ..ForceSet::gravity(9.81)
        };
        let mut far = near.clone();
        let offset = DVec3::new(1e5, 1e5, -1e5);
        far.initial.position += offset;
        let (a, b) = (run(&near, i, H, 600), run(&far, i, H, 600));
        assert_eq!(
            (a.velocity, a.rotation, a.angular_momentum),
            (b.velocity, b.rotation, b.angular_momentum),
            "{i}"
        );
        assert!(
            (b.position - offset - a.position).length() < 600.0 * 1.5e-11,
            "{i}"
        );
    }
}

/// A gap of 1e-12 between two moments has no visible effect. Zero spin and principal spins give finite
/// numbers.
#[test]
fn degenerate_shapes_are_continuous() {
    let bar = DVec3::new(0.25, 0.5, 0.25);
    let cube = DVec3::splat(0.5);
    for &i in Integrator::ALL {
        for (half, omega) in [
            (bar, DVec3::new(2.0, 6.0, 0.3)),
            (cube, DVec3::new(3.0, -4.0, 5.0)),
        ] {
            let exact = run(&tumbling(half, 6.0, omega), i, H, 300);
            for gap in [1e-15, 1e-12, 1e-10] {
                let near = half * DVec3::new(1.0 + gap, 1.0, 1.0 - gap);
                let state = run(&tumbling(near, 6.0, omega), i, H, 300);
                let error = state.attitude_difference(&exact);
                // 5 s at 6 rad/s times the gap in the moments, plus the effect of first-order growth.
                assert!(
                    error < 1e-12 + 1e3 * gap,
                    "{i}: {error:e} rad for a gap of {gap:e}"
                );
            }
        }
        for omega in [DVec3::ZERO, DVec3::X * 5.0, DVec3::Y * 5.0, DVec3::Z * 5.0] {
            let setup = tumbling(BRICK, 3.0, omega);
            let state = run(&setup, i, H, 300);
            assert!(state.is_finite(), "{i}");
            let tilt = (state.rotation * omega - omega).length();
            assert!(
                tilt < 1e-13,
                "{i}: the axis of a principal spin moved: {tilt:e}"
            );
        }
    }
}

/// Returns `true` if a growth is above `bound` or NaN.
fn exceeds(growth: f64, bound: f64) -> bool {
    growth.is_nan() || growth > bound
}

/// Linear drag or a damper at the center with the coefficient c \[N s/m\].
fn resistance(what: &str, c: f64) -> ForceSet {
    match what {
        "drag" => ForceSet {
            linear_drag: c,
            ..ForceSet::none()
        },
        _ => ForceSet::none().with_spring(DVec3::ZERO, DVec3::ZERO, 0.0, c),
    }
}

#[test]
fn drag_and_damper_limits_as_claimed() {
    for &i in Integrator::ALL {
        let claimed = &i.info().stability;
        for (what, limit) in [("drag", claimed.drag), ("damper", claimed.damper)] {
            // Speed after 400 steps at z = c·h/m, relative to the first.
            let growth = |z: f64| {
                let mut setup = tumbling(BRICK, 1.0, DVec3::ZERO);
                setup.initial.velocity = DVec3::X;
                setup.forces = resistance(what, z / H);
                run(&setup, i, H, 400).velocity.length()
            };
            match limit {
                Limit::None => {
                    for z in [0.1, 1.0, 2.0, 3.0, 10.0, 100.0, 1000.0] {
                        assert!(growth(z) <= 1.0, "{i}: {what} at {z}");
                    }
                }
                Limit::Below(x) => {
                    assert!(growth(0.98 * x) < 1.0, "{i}: {what} below {x}");
                    let beyond = growth(1.02 * x);
                    assert!(exceeds(beyond, 1.0), "{i}: {what} beyond {x}: {beyond:e}");
                }
                Limit::AlwaysGrows => assert!(exceeds(growth(0.1), 1.0), "{i}: {what}"),
            }
        }
    }
}

/// Energy of an oscillator after 4000 steps at √(k/m)·h = z, relative to the first.
fn oscillator_growth(i: Integrator, z: f64) -> f64 {
    let mut setup = tumbling(BRICK, 1.0, DVec3::ZERO);
    setup.initial.position = DVec3::X;
    setup.forces = ForceSet::none().with_spring(DVec3::ZERO, DVec3::ZERO, (z / H).powi(2), 0.0);
    setup.energy(&run(&setup, i, H, 4000)) / setup.energy(&setup.initial)
}

#[test]
fn oscillator_limits_as_claimed() {
    for &i in Integrator::ALL {
        match i.info().stability.oscillator {
            Limit::None => {
                for z in [0.1, 1.0, 3.0, 100.0] {
                    assert!(oscillator_growth(i, z) < 1.0 + 1e-9, "{i} at ω·h = {z}");
                }
            }
            Limit::Below(x) => {
                // Near its limit a kicked oscillator swings 1/√(1 − (z/2)²) higher but does not grow.
                assert!(oscillator_growth(i, 0.95 * x) < 100.0, "{i} below {x}");
                // The first unstable range of a composition may be as narrow as a thousandth.
                let mut beyond =
                    (1..400).map(|k| oscillator_growth(i, (1.0 + 5e-4 * f64::from(k)) * x));
                assert!(
                    beyond.any(|g| exceeds(g, 1e6)),
                    "{i} does not grow beyond {x}"
                );
            }
            Limit::AlwaysGrows => {
                let growth = oscillator_growth(i, 0.3);
                assert!(exceeds(growth, 1.0 + 1e-3), "{i}: {growth:e}");
            }
        }
    }
}

/// Integrators without a limit in |ω|h remain bounded on three bodies up to 1000; the others below their
/// limits.
#[test]
fn rotation_limits_as_claimed() {
    let bodies = [
        (BRICK, SPIN),
        (
            DVec3::new(0.5, 1.0 / 128.0, 0.375),
            DVec3::new(3.0, 0.5, 4.0),
        ),
        (
            DVec3::new(1.0, 1.0 / 64.0, 1.0 / 32.0),
            DVec3::new(20.0, 1.0, 0.5),
        ),
    ];
    for &i in Integrator::ALL {
        let tried: Vec<f64> = match i.info().stability.rotation {
            Limit::None => vec![0.1, 0.5, 1.0, 2.0, 3.0, 10.0, 100.0, 1000.0],
            Limit::Below(x) => vec![0.1 * x, 0.3 * x],
            Limit::AlwaysGrows => continue,
        };
        for (half, omega) in bodies {
            let setup = tumbling(half, 3.0, omega);
            let (body, l) = (&setup.body, setup.initial.angular_momentum.length());
            for x in &tried {
                let state = run(&setup, i, x / omega.length(), 500);
                let grown = state.angular_momentum.length() / l;
                assert!(
                    state.is_finite() && grown < 1.01,
                    "{i} at |ω|h = {x}: |L| × {grown}"
                );
                let most = 0.5 * l * l * body.inverse_inertia().max_element();
                assert!(
                    state.rotational_energy(body) < 1.01 * most,
                    "{i} at |ω|h = {x}"
                );
            }
        }
    }
}

/// Integrators without limits give valid states on every hard case.
#[test]
fn unlimited_integrators_survive_every_hard_case() {
    let cases = hard_cases();
    let unlimited = |i: &&Integrator| {
        let s = i.info().stability;
        s.rotation == Limit::None && s.drag == Limit::None
    };
    for &i in Integrator::ALL.iter().filter(unlimited) {
        for c in &cases {
            // Limited by the kicks of a spring, not by these ranges; another test takes the million steps.
            if matches!(c.id, "corner-spring" | "long-run") {
                continue;
            }
            for f in HardCase::examine(c, i) {
                assert_ne!(
                    f.verdict(),
                    Verdict::Diverged,
                    "{i}, {} at {}: {} {:e}",
                    c.id,
                    f.h,
                    f.quantity,
                    f.value
                );
            }
        }
    }
}

/// Zero and tiny steps.
#[test]
fn steps_of_no_length_change_nothing() {
    let mut setup = tumbling(BRICK, 3.0, SPIN);
    setup.initial.velocity = DVec3::new(1.0, 2.0, 3.0);
    setup.forces = ForceSet {
        quadratic_drag: 0.1,
        angular_drag: 0.1,
        ..ForceSet::gravity(9.81)
    };
    for &i in Integrator::ALL {
        assert_eq!(run(&setup, i, 0.0, 3), setup.initial, "{i}");
        let e = StateError::between(&run(&setup, i, 1e-9, 1), &setup.initial);
        assert!(
            e.position < 1e-8 && e.attitude < 1e-8 && e.velocity < 1e-7,
            "{i}"
        );
    }
}
