//! The reference trajectories: how far each integrator is from them at 60 Hz, that the order shows, that our
//! own references are theirs, and that a bad file is refused by name.

use std::path::{Path, PathBuf};

use box_physics::integrators::{Channel, Integrator, Order};
use box_scenarios::oracle::{Case, Measurement, Status};
use box_scenarios::{ReferenceKind, ReferenceSolution, StateError};
use serde_json::{Value, json};

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

/// What a bound is about, and the channel whose order must show.
#[derive(Clone, Copy)]
enum Of {
    Attitude(Channel),
    Position(Channel),
}

use Channel::{Gravity, LinearDrag, QuadraticDrag, Rotation, Torque};
use Of::{Attitude, Position};

/// Largest errors over the samples at 60 Hz [rad or m].
const BOUNDS: &[(&str, Of, &[(&str, f64)])] = &[
    (
        "pub01",
        Attitude(Rotation),
        &[
            ("split", 1e-12),
            ("split4", 1e-8),
            ("exact", 1e-11),
            ("dmv6", 1e-8),
            ("rk4", 1e-6),
        ],
    ),
    (
        "pub02",
        Attitude(Rotation),
        &[
            ("split", 1e-8),
            ("split4", 1e-7),
            ("exact", 1e-9),
            ("dmv6", 1e-6),
            ("rk4", 1e-4),
        ],
    ),
    (
        "pub03",
        Attitude(Rotation),
        &[("split", 1e-12), ("split4", 1e-10), ("exact", 1e-11)],
    ),
    (
        "pub04",
        Attitude(Rotation),
        &[("split", 1e-12), ("split4", 1e-8), ("exact", 1e-10)],
    ),
    (
        "pub05",
        Attitude(Rotation),
        &[
            ("split", 5e-9),
            ("split4", 1e-6),
            ("exact", 1e-10),
            ("dmv6", 1e-4),
            ("rk4", 3e-2),
        ],
    ),
    (
        "pub06",
        Attitude(Rotation),
        &[("split", 1e-12), ("split4", 1e-10), ("exact", 1e-11)],
    ),
    (
        "pub07",
        Position(Gravity),
        &[
            ("split", 1e-11),
            ("split4", 1e-9),
            ("exact", 1e-11),
            ("dmv6", 1e-9),
        ],
    ),
    (
        "pub08",
        Position(LinearDrag),
        &[
            ("split", 1e-11),
            ("split4", 1e-9),
            ("exact", 1e-11),
            ("dmv6", 1e-9),
        ],
    ),
    (
        "pub09",
        Position(LinearDrag),
        &[
            ("split", 1e-11),
            ("split4", 1e-9),
            ("exact", 1e-11),
            ("dmv6", 1e-9),
        ],
    ),
    (
        "pub10",
        Position(QuadraticDrag),
        &[("split", 1e-7), ("split4", 1e-2), ("rk4", 1e-5)],
    ),
    (
        "pub11",
        Position(QuadraticDrag),
        &[("split", 1e-7), ("split4", 1e-2), ("rk4", 1e-5)],
    ),
    (
        "pub13",
        Attitude(Rotation),
        &[("split", 1e-10), ("split4", 1e-6), ("exact", 1e-11)],
    ),
    (
        "pub19",
        Attitude(Rotation),
        &[("split", 1e-11), ("exact", 1e-11), ("rk4", 1e-3)],
    ),
    (
        "pub15",
        Attitude(Torque),
        &[("split", 1e-6), ("split4", 1e-7), ("rk4", 5e-4)],
    ),
    (
        "pub19",
        Attitude(Rotation),
        &[("split4", 1e-6), ("exact", 1e-11), ("rk4", 5e-4)],
    ),
];

fn integrator(id: &str) -> Integrator {
    id.parse().expect("an integrator")
}

fn error(m: &Measurement, of: Of) -> f64 {
    assert_eq!(m.status, Status::Ok);
    match of {
        Attitude(_) => m.attitude,
        Position(_) => m.position,
    }
}

#[test]
fn errors_at_60_hz_and_the_order_behind_them() {
    let cases = cases();
    for (prefix, of, bounds) in BOUNDS {
        let case = cases
            .iter()
            .find(|c| c.name.starts_with(prefix))
            .expect(prefix);
        for (id, bound) in *bounds {
            let i = integrator(id);
            let (m1, m2) = (case.measure(i, 1.0 / 60.0), case.measure(i, 1.0 / 120.0));
            let (e1, e2) = (error(&m1, *of), error(&m2, *of));
            assert!(e1 <= *bound, "{prefix} {id}: {e1:e} > {bound:e}");
            let (Attitude(channel) | Position(channel)) = *of;
            // The order shows while truncation is far above rounding. Half an order is left for
            // terms of higher order, which weigh at |ω|h ≈ 0.3.
            // pub02 multiplies rounding by 6e3 and steps perturb its distance to the separatrix: a
            // stepper's floor there is 1e-9 to 1e-8 rad.
            let floor = if *prefix == "pub02" { 1e-8 } else { 1e-11 };
            if let Order::Of(p) = i.info().orders.of(channel)
                && e2 > floor
            {
                let slope = (e1 / e2).ln() / (m2.totals.steps as f64 / m1.totals.steps as f64).ln();
                assert!(
                    slope > f64::from(p) - 0.5,
                    "{prefix} {id}: order {slope:.2}, not {p}"
                );
            }
        }
    }
}

/// Formulas and numerical references of our own against the files. Two independent derivations, so
/// rounding is all that may be between them; pub02 multiplies it by 6e3 (`attitude_sensitivity`).
#[test]
fn our_references_are_theirs() {
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

/// Contact: an impact located inside the step keeps the integrator's order, and a constant deceleration is
/// exact. Flat cases to rounding; after a corner impact the tumbling has the integrator's own error.
#[test]
fn contact_cases() {
    for id in ["split", "exact", "split4", "rk4"] {
        for (prefix, position, velocity, attitude) in [
            ("pub16", 1e-9, 1e-8, 1e-12),
            ("pub17", 1e-9, 1e-8, 1e-12),
            ("pub18", 1e-9, 1e-8, 1e-4),
        ] {
            let m = case(prefix).measure(integrator(id), 1.0 / 60.0);
            assert_eq!(m.status, Status::Ok, "{prefix} {id}");
            assert!(m.position < position, "{prefix} {id}: {:e} m", m.position);
            assert!(m.velocity < velocity, "{prefix} {id}: {:e} m/s", m.velocity);
            assert!(m.attitude < attitude, "{prefix} {id}: {:e} rad", m.attitude);
        }
    }
}

#[test]
fn energy_is_judged_only_where_it_is_known() {
    let rk4 = "rk4".parse().expect("there");
    let mut case = case("pub01");
    assert!(
        case.measure(rk4, 1.0 / 60.0)
            .energy
            .is_some_and(|e| e < 1e-8)
    );
    // Conserved although the file does not say it.
    case.samples.iter_mut().for_each(|s| s.energy = None);
    assert!(
        case.measure(rk4, 1.0 / 60.0)
            .energy
            .is_some_and(|e| e < 1e-8)
    );
    // Neither conserved nor prescribed.
    case.setup.forces.angular_damping = 0.1;
    assert_eq!(case.measure(rk4, 1.0 / 60.0).energy, None);
}

#[test]
fn explosions_are_called_by_their_name() {
    let explicit = "explicit-euler".parse().expect("there");
    for prefix in ["pub05", "pub09"] {
        let m = case(prefix).measure(explicit, 1.0 / 60.0);
        assert_eq!(m.status, Status::Diverged, "{prefix}");
        assert_eq!(m.attitude, f64::INFINITY);
    }
}

/// A run that ends is not ok when its result says nothing: explicit Euler ends pub15 with ten times the energy
/// and an attitude error of 3 rad.
#[test]
fn a_run_beyond_the_stated_errors_is_lost() {
    let measure = |prefix, id| case(prefix).measure(integrator(id), 1.0 / 60.0);
    let spun = measure("pub15", "explicit-euler");
    assert_eq!(spun.status, Status::Lost("attitude"));
    assert!(spun.energy.is_some_and(|e| e > 5.0) && spun.attitude.is_finite());
    // A prescribed energy that is never reached, and a body that is elsewhere.
    let mut wrong = case("pub01");
    let lost = |c: &Case| c.measure(integrator("exact"), 1.0 / 60.0).status;
    wrong.samples[3].state.position.x += wrong.setup.body.radius();
    assert_eq!(lost(&wrong), Status::Lost("position"));
    let mut wrong = case("pub01");
    let first = wrong.samples[0].energy.expect("prescribed");
    wrong.samples[3].energy = Some(6.6 * first);
    assert_eq!(lost(&wrong), Status::Lost("energy"));
    assert_eq!(lost(&case("pub01")), Status::Ok);
}

// ---- files that are not ours -------------------------------------------------------------------

fn good() -> Value {
    json!({
        "name": "mine", "kind": "impulse",
        "body": { "half_extents": [0.5, 0.25, 0.125], "mass": 3.0 },
        "initial": {
            "position": [0, 0, 0], "velocity": [1, 0, 0],
            "quaternion_xyzw": [0, 0, 0, 2], "angular_velocity_world": [0, 0, 0]
        },
        "forces": { "gravity": [0, -1, 0] },
        "events": [{ "t": 1.0, "impulse_world": [0, 3, 0], "body_point": [0, 0, 0] }],
        "samples": [
            sample(0.0, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
            sample(1.0, [1.0, -0.5, 0.0], [1.0, -1.0, 0.0]),
            sample(2.0, [2.0, -1.0, 0.0], [1.0, -1.0, 0.0]),
        ]
    })
}

fn sample(t: f64, x: [f64; 3], v: [f64; 3]) -> Value {
    json!({ "t": t, "position": x, "velocity": v,
        "quaternion_xyzw": [0, 0, 0, 1], "angular_velocity_world": [0, 0, 0] })
}

fn parse(v: &Value) -> Result<Case, String> {
    Case::parse(Path::new("mine.json"), &v.to_string()).map_err(|e| e.to_string())
}

#[test]
fn impulses_act_after_the_sample_of_their_time() {
    let case = parse(&good()).expect("good");
    let m = case.measure(Integrator::Split, 0.1);
    assert!(m.position < 1e-14 && m.velocity < 1e-14, "{m:?}");
    assert_eq!(m.totals.steps, 20);
    // A solid box where no inertia is given; another one where it is.
    assert_eq!(case.setup.body.inertia().x, 0.078125);
    let mut v = good();
    v["body"]["inertia_diag_body"] = json!([0.1, 0.2, 0.25]);
    assert_eq!(parse(&v).expect("good").setup.body.inertia().z, 0.25);
}

/// Every force of the format against the numerical reference of our own.
#[test]
fn every_key_of_the_law_acts() {
    let mut v = good();
    v["initial"]["angular_velocity_body"] = json!([1.0, 2.0, -1.0]);
    v["forces"] = json!({
        "gravity": [0, -9.81, 0], "linear_drag_c": 0.3, "quadratic_drag_k": 0.02,
        "angular_damping_rate": 0.1, "angular_drag_c": 0.01, "constant_body_torque": [0.1, 0, -0.2],
        "dipole": { "moment_body": [0, 1, 0.5], "field_world": [0.2, 0.5, 0] },
        "zero_length_spring": { "k": 20, "body_point": [0.5, 0.1, 0], "anchor": [0, 1, 0] }
    });
    let mut case = parse(&v).expect("good");
    let reference = ReferenceSolution::of(&case.setup);
    assert!(
        matches!(reference.kind(), ReferenceKind::Numerical { agreement } if agreement < 1e-11)
    );
    for s in &mut case.samples {
        s.state = reference.at(s.t).expect("in time");
    }
    for &i in Integrator::ALL {
        let coarse = case.measure(i, 1.0 / 480.0);
        let fine = case.measure(i, 1.0 / 1920.0);
        assert_eq!(fine.status, Status::Ok, "{i}");
        assert!(fine.position < 0.02 && fine.attitude < 0.1, "{i}: {fine:?}");
        // It converges to this law and not to another: four times finer is at least three times better.
        assert!(
            fine.attitude < coarse.attitude / 3.0 || fine.attitude < 1e-9,
            "{i}: {coarse:?} {fine:?}"
        );
    }
    // Each key alone changes the motion.
    for key in [
        "linear_drag_c",
        "quadratic_drag_k",
        "angular_damping_rate",
        "angular_drag_c",
        "constant_body_torque",
        "dipole",
        "zero_length_spring",
        "gravity",
    ] {
        let mut without = v.clone();
        without["forces"]
            .as_object_mut()
            .expect("an object")
            .remove(key);
        let other = ReferenceSolution::of(&parse(&without).expect("good").setup);
        let e = StateError::between(
            &other.at(2.0).expect("in time"),
            &reference.at(2.0).expect("in time"),
        );
        assert!(e.position + e.attitude > 1e-4, "{key}");
    }
}

#[test]
fn bad_files_are_refused_by_name() {
    let bad = |pointer: &str, value: Value, words: &[&str]| {
        let mut v = good();
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        let parent = v.pointer_mut(parent).expect("there");
        match parent {
            Value::Array(list) => list[key.parse::<usize>().expect("an index")] = value,
            _ => parent[key] = value,
        }
        let message = parse(&v).expect_err(pointer);
        assert!(message.starts_with("mine.json: "), "{message}");
        for word in words {
            assert!(message.contains(word), "{message} lacks {word}");
        }
    };
    bad(
        "/forces/wind",
        json!(1),
        &["forces.wind", "unknown", "linear_drag_c"],
    );
    bad(
        "/forces/dipole",
        json!({"moment_body": [1, 0, 0], "field_world": [0, 1, 0], "q": 1}),
        &["forces.dipole.q"],
    );
    bad(
        "/forces/zero_length_spring",
        json!({"k": 1, "anchor": [0, 0, 0]}),
        &["forces.zero_length_spring.body_point is missing"],
    );
    bad(
        "/forces/linear_drag_c",
        json!(-1.5),
        &["forces.linear_drag_c", "not negative", "-1.5"],
    );
    bad(
        "/forces/linear_drag_c",
        json!("NaN"),
        &["forces.linear_drag_c", "finite", "\"NaN\""],
    );
    bad(
        "/forces/gravity",
        json!([0, 1]),
        &["forces.gravity", "3", "[0,1]"],
    );
    bad("/forces", json!(3), &["forces must be an object, but is 3"]);
    bad(
        "/events/0/torque",
        json!([0, 0, 1]),
        &["events[0].torque", "unknown"],
    );
    bad("/events/0/t", json!(-1), &["events[0].t", "-1"]);
    bad(
        "/contact",
        json!({"restitution": 0.5, "friction": 0.1, "slop": 1}),
        &["contact.slop"],
    );
    bad(
        "/contact",
        json!({"restitution": 1.5, "friction": 0.1}),
        &["contact.restitution", "1.5"],
    );
    bad(
        "/contact",
        json!({"restitution": 0.5, "friction": -0.1}),
        &["contact.friction", "-0.1"],
    );
    bad("/kind", json!("contact"), &["contact is missing"]);
    bad("/body/mass", json!(-3), &["body.mass", "-3"]);
    bad(
        "/body/half_extents",
        json!([1, 0, 1]),
        &["body.half_extents.y", "0"],
    );
    bad(
        "/body/inertia_diag_body",
        json!([1, 1, 3]),
        &["body.inertia_diag_body", "sum of the other two", "3"],
    );
    bad(
        "/initial/quaternion_xyzw",
        json!([0, 0, 0, 0]),
        &["initial.quaternion_xyzw", "length zero", "[0,0,0,0]"],
    );
    bad(
        "/initial/velocity",
        json!([0, null, 0]),
        &["initial.velocity", "finite"],
    );
    bad(
        "/initial/angular_velocity_world",
        Value::Null,
        &["initial.angular_velocity_world is missing"],
    );
    bad(
        "/samples/2/t",
        json!(0.5),
        &["samples[2].t", "later", "0.5"],
    );
    bad(
        "/samples/1/quaternion_xyzw",
        json!([0, 0, 0, 0]),
        &["samples[1].quaternion_xyzw"],
    );
    bad(
        "/samples/1/energy",
        json!("much"),
        &["samples[1].energy", "much"],
    );
    bad("/samples", json!([]), &["samples", "at least one"]);
    for text in ["", "[]", "{\"mass\": NaN}", "{\"mass\": 1e999}"] {
        let message = Case::parse(Path::new("x/mine.json"), text)
            .expect_err(text)
            .to_string();
        assert!(message.starts_with("x/mine.json: "), "{message}");
    }
}
