//! The reference trajectories. Tests of each integrator's errors at 60 Hz and its order, of our own
//! references, and of the error messages for bad files.

use std::path::{Path, PathBuf};

use box_physics::integrators::{Channel, EnergyBehavior, Integrator, Limit, Order};
use box_scenarios::oracle::{Case, Measurement, Outcome};
use box_scenarios::{ReferenceKind, ReferenceSolution, Setup, StateError};

mod trajectory_files;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/oracle")
}

fn cases() -> Vec<Case> {
    let files = Case::load_folder(&folder()).expect("the folder is there");
    files
        .into_iter()
        .map(|c| c.expect("every file is good"))
        .collect()
}

fn case(prefix: &str) -> Case {
    let mut all = cases();
    all.retain(|c| c.name.starts_with(prefix));
    assert_eq!(all.len(), 1, "{prefix}");
    all.remove(0)
}

/// The channel that each case tests: its order must show in the attitude \[rad\] or the position \[m\]. The
/// last number is the amplification of an error by the motion: pub02 passes the separatrix
/// (`attitude_sensitivity`).
const ABOUT: &[(&str, Channel, f64)] = &[
    ("pub01", Channel::Rotation, 1.0),
    ("pub02", Channel::Rotation, 6e3),
    ("pub03", Channel::Rotation, 1.0),
    ("pub04", Channel::Rotation, 1.0),
    ("pub05", Channel::Rotation, 1.0),
    ("pub06", Channel::Rotation, 1.0),
    ("pub07", Channel::Gravity, 1.0),
    ("pub08", Channel::LinearDrag, 1.0),
    ("pub09", Channel::LinearDrag, 1.0),
    ("pub10", Channel::QuadraticDrag, 1.0),
    ("pub11", Channel::QuadraticDrag, 1.0),
    ("pub13", Channel::AngularDamping, 1.0),
    ("pub15", Channel::Torque, 1.0),
    ("pub19", Channel::Rotation, 1.0),
];

fn integrator(id: &str) -> Integrator {
    id.parse().expect("an integrator")
}

/// The fastest rate of the motion in `channel` [1/s], and the size of the measured quantity \[rad or m\]. A
/// method of order p has an error of about size × (rate × h)ᵖ, at most twice that. A method that does not
/// conserve energy has the same relative error in the angular velocity, so its attitude error grows with the
/// square of the time.
fn scales(case: &Case, channel: Channel, i: Integrator) -> (f64, f64) {
    let Setup {
        body,
        initial,
        forces,
        duration,
        ..
    } = &case.setup;
    let speed = initial.velocity.length() + 9.81 * duration;
    let spin = initial.body_angular_velocity(body).length();
    let steady = matches!(
        i.info().conserved.energy,
        EnergyBehavior::Exact | EnergyBehavior::Bounded
    );
    match channel {
        Channel::Gravity => (1.0 / duration, 0.5 * 9.81 * duration * duration),
        Channel::LinearDrag => (forces.linear_drag / body.mass(), speed * duration),
        Channel::QuadraticDrag => (
            forces.quadratic_drag * speed / body.mass(),
            speed * duration,
        ),
        _ if steady => (spin, spin * duration),
        _ => (spin, (spin * duration).powi(2)),
    }
}

/// Every integrator on every case at 60 Hz: accurate to rounding where it claims to be exact, otherwise
/// within the bound of its order, and better by that order at 120 Hz.
#[test]
fn errors_at_60_hz_and_the_order_behind_them() {
    let cases = cases();
    let mut wrong = Vec::new();
    for &(prefix, channel, sensitivity) in ABOUT {
        let case = cases.iter().find(|c| c.name.starts_with(prefix));
        let case = case.expect(prefix);
        let error = |m: &Measurement| match channel {
            Channel::Gravity | Channel::LinearDrag | Channel::QuadraticDrag => m.position,
            _ => m.attitude,
        };
        for &i in Integrator::ALL {
            let (m1, m2) = (case.measure(i, 1.0 / 60.0), case.measure(i, 1.0 / 120.0));
            let (e1, e2) = (error(&m1), error(&m2));
            let (rate, size) = scales(case, channel, i);
            // 600 steps with a few roundings each.
            let rounding = 1e-11 * sensitivity.sqrt() * size.max(1.0).sqrt();
            let orders = &i.info().orders;
            let (claim, other) = (
                orders.of(channel),
                match channel {
                    Channel::Torque | Channel::AngularDamping => orders.rotation,
                    Channel::LinearDrag | Channel::QuadraticDrag => orders.gravity,
                    _ => orders.of(channel),
                },
            );
            let p = match (claim, other) {
                (Order::Of(p), Order::Of(q)) => p.min(q),
                (Order::Of(p), Order::Exact) | (Order::Exact, Order::Of(p)) => p,
                (Order::Exact, Order::Exact) => {
                    if e1.is_nan() || e1 > rounding {
                        wrong.push(format!("{i}, {prefix}: claims to be exact in {}; measured: off by {e1:.1e}, allowed: {rounding:.1e}", channel.name()));
                    }
                    continue;
                }
            };
            let bound = 2.0 * sensitivity * size * (rate / 60.0).powi(i32::from(p)) + rounding;
            let stable = match (channel, i.info().stability) {
                (Channel::LinearDrag | Channel::QuadraticDrag, s) => s.drag,
                (Channel::Gravity, _) => Limit::None,
                (_, s) => s.rotation,
            };
            let may_diverge = match stable {
                Limit::None => false,
                Limit::Below(x) => rate / 60.0 >= x,
                Limit::AlwaysGrows => true,
            };
            if may_diverge && m1.outcome == Outcome::Diverged {
                continue;
            }
            if e1.is_nan() || e1 > bound {
                wrong.push(format!("{i}, {prefix}: claims order {p} in {}; measured: {e1:.1e}, allowed: {bound:.1e}", channel.name()));
            }
            // Half an order is left for terms of higher order. No order shows in long steps, or beyond a
            // tenth of a radian or of the distance.
            let slope = libm::log2(e1 / e2);
            let shows = e2 > rounding && e1 < 0.1 * size.min(1.0) && rate / 60.0 < 0.5;
            if shows && slope.is_nan() | (slope < f64::from(p) - 0.5) {
                wrong.push(format!("{i}, {prefix}: claims order {p} in {}; measured: {slope:.2} ({e1:.1e}, {e2:.1e})", channel.name()));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "\n{}\nClaim what is measured in the INFO, or mend the step",
        wrong.join("\n")
    );
}

/// Claims of the default under forces at 60 Hz over the whole duration, in position \[m\] or attitude \[rad\].
#[test]
fn the_default_is_of_fourth_order_under_forces() {
    let measure = |prefix| case(prefix).measure(Integrator::Split, 1.0 / 60.0);
    for (prefix, error, bound) in [
        ("pub10", measure("pub10").position, 1e-7),
        ("pub11", measure("pub11").position, 1e-7),
        ("pub15", measure("pub15").attitude, 1e-6),
    ] {
        assert!(error <= bound, "{prefix}: {error:e}, promised: {bound:e}");
    }
}

/// Our own formulas and numerical references compared with the files. They are two independent derivations,
/// so only rounding may separate them; pub02 multiplies it by 6e3 (`attitude_sensitivity`).
#[test]
fn our_references_match_the_files() {
    let mut kinds = (0, 0);
    for case in cases() {
        let reference = ReferenceSolution::of(&case.setup);
        match reference.kind() {
            ReferenceKind::None => continue,
            ReferenceKind::ClosedForm => kinds.0 += 1,
            ReferenceKind::Numerical { .. } => kinds.1 += 1,
        }
        for s in &case.samples {
            let e = StateError::between(&reference.at(s.t).expect("in time"), &s.state);
            let size = s.state.position.length().max(1.0);
            let l = s.state.angular_momentum.length().max(1e-3);
            let worst = (e.position / size)
                .max(e.velocity / size)
                .max(e.attitude)
                .max(e.angular_momentum / l);
            assert!(worst < 1e-11, "{} at {} s: {worst:e}", case.name, s.t);
        }
    }
    assert!(kinds.0 >= 15 && kinds.1 >= 2, "{kinds:?}");
}

/// Contact: an impact located within the step preserves the integrator's order, and a constant deceleration
/// is exact. Flat cases are accurate to rounding. After a corner impact the tumbling has the error of the
/// integrator.
#[test]
fn contact_cases() {
    for id in ["split", "exact", "split4", "rk4"] {
        for (prefix, position, velocity, attitude) in [
            ("pub16", 1e-9, 1e-8, 1e-12),
            ("pub17", 1e-9, 1e-8, 1e-12),
            ("pub18", 1e-9, 1e-8, 1e-4),
        ] {
            let m = case(prefix).measure(integrator(id), 1.0 / 60.0);
            assert_eq!(m.outcome, Outcome::Ok, "{prefix} {id}");
            assert!(m.position < position, "{prefix} {id}: {:e} m", m.position);
            assert!(m.velocity < velocity, "{prefix} {id}: {:e} m/s", m.velocity);
            assert!(m.attitude < attitude, "{prefix} {id}: {:e} rad", m.attitude);
        }
    }
}

#[test]
fn energy_is_judged_only_where_it_is_known() {
    let energy = |case: &Case| case.measure(Integrator::Rk4, 1.0 / 60.0).energy;
    let mut case = case("pub01");
    assert!(energy(&case).is_some_and(|e| e < 1e-8));
    // Conserved, although the file has no energies.
    case.samples.iter_mut().for_each(|s| s.energy = None);
    assert!(energy(&case).is_some_and(|e| e < 1e-8));
    // Neither conserved nor prescribed.
    case.setup.forces.angular_damping = 0.1;
    assert_eq!(energy(&case), None);
}

#[test]
fn diverging_runs_are_reported_as_diverged() {
    for prefix in ["pub05", "pub09"] {
        let m = case(prefix).measure(Integrator::ExplicitEuler, 1.0 / 60.0);
        assert_eq!(m.outcome, Outcome::Diverged, "{prefix}");
        assert_eq!(m.attitude, f64::INFINITY);
    }
}

/// A run that ends with a meaningless result is not ok: explicit Euler ends pub15 with ten times the energy
/// and an attitude error of 3 rad.
#[test]
fn a_run_beyond_the_stated_errors_is_lost() {
    let measure = |prefix, id| case(prefix).measure(integrator(id), 1.0 / 60.0);
    let spun = measure("pub15", "explicit-euler");
    assert_eq!(spun.outcome, Outcome::Lost("attitude"));
    assert!(spun.energy.is_some_and(|e| e > 5.0) && spun.attitude.is_finite());
    // A prescribed energy that is never reached, and a body in the wrong place.
    let mut wrong = case("pub01");
    let lost = |c: &Case| c.measure(integrator("exact"), 1.0 / 60.0).outcome;
    wrong.samples[3].state.position.x += wrong.setup.body.radius();
    assert_eq!(lost(&wrong), Outcome::Lost("position"));
    let mut wrong = case("pub01");
    let first = wrong.samples[0].energy.expect("prescribed");
    wrong.samples[3].energy = Some(6.6 * first);
    assert_eq!(lost(&wrong), Outcome::Lost("energy"));
    assert_eq!(lost(&case("pub01")), Outcome::Ok);
}
