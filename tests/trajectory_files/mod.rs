//! Trajectory files of users: their meaning, and their errors.

use std::path::Path;

use box_physics::integrators::Integrator;
use box_scenarios::oracle::{Case, Outcome};
use box_scenarios::{ReferenceKind, ReferenceSolution, StateError};
use serde_json::{Value, json};

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
    // A solid box without an inertia in the file; otherwise the given inertia.
    assert_eq!(case.setup.body.inertia().x, 0.078125);
    let mut v = good();
    v["body"]["inertia_diag_body"] = json!([0.1, 0.2, 0.25]);
    assert_eq!(parse(&v).expect("good").setup.body.inertia().z, 0.25);
}

/// Every force of the format compared with our own numerical reference.
#[test]
fn every_key_of_the_force_model_has_an_effect() {
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
        assert_eq!(fine.outcome, Outcome::Ok, "{i}");
        assert!(fine.position < 0.02 && fine.attitude < 0.1, "{i}: {fine:?}");
        // It converges to this force model and to no other: four times finer is at least three times better.
        assert!(
            fine.attitude < coarse.attitude / 3.0 || fine.attitude < 1e-9,
            "{i}: {coarse:?} {fine:?}"
        );
    }
    // Each key alone changes the motion.
    for key in v["forces"].as_object().expect("an object").keys() {
        let mut without = v.clone();
        let forces = without["forces"].as_object_mut();
        forces.expect("an object").remove(key);
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
    #[rustfmt::skip]
    let spoiled = [
        ("/forces/wind", json!(1), "forces.wind | unknown | linear_drag_c"),
        ("/forces/dipole", json!({"moment_body": [1, 0, 0], "field_world": [0, 1, 0], "q": 1}), "forces.dipole.q"),
        ("/forces/zero_length_spring", json!({"k": 1, "anchor": [0, 0, 0]}),
            "forces.zero_length_spring.body_point is missing"),
        ("/forces/linear_drag_c", json!(-1.5), "forces.linear_drag_c | not negative | -1.5"),
        ("/forces/linear_drag_c", json!("NaN"), "forces.linear_drag_c | finite | \"NaN\""),
        ("/forces/gravity", json!([0, 1]), "forces.gravity | 3 | [0,1]"),
        ("/forces", json!(3), "forces must be an object, but is 3"),
        ("/events/0/torque", json!([0, 0, 1]), "events[0].torque | unknown"),
        ("/events/0/t", json!(-1), "events[0].t | -1"),
        ("/contact", json!({"restitution": 0.5, "friction": 0.1, "slop": 1}), "contact.slop"),
        ("/contact", json!({"restitution": 1.5, "friction": 0.1}), "contact.restitution | 1.5"),
        ("/contact", json!({"restitution": 0.5, "friction": -0.1}), "contact.friction | -0.1"),
        ("/kind", json!("contact"), "contact is missing"),
        ("/body/mass", json!(-3), "body.mass | -3"),
        ("/body/half_extents", json!([1, 0, 1]), "body.half_extents.y | 0"),
        ("/body/inertia_diag_body", json!([1, 1, 3]), "body.inertia_diag_body | sum of the other two | 3"),
        ("/initial/quaternion_xyzw", json!([0, 0, 0, 0]), "initial.quaternion_xyzw | nonzero | [0,0,0,0]"),
        ("/initial/velocity", json!([0, null, 0]), "initial.velocity | finite"),
        ("/initial/angular_velocity_world", Value::Null, "initial.angular_velocity_world is missing"),
        ("/samples/2/t", json!(0.5), "samples[2].t | later | 0.5"),
        ("/samples/1/quaternion_xyzw", json!([0, 0, 0, 0]), "samples[1].quaternion_xyzw"),
        ("/samples/1/energy", json!("much"), "samples[1].energy | much"),
        ("/samples", json!([]), "samples | at least one"),
    ];
    for (pointer, value, words) in spoiled {
        let mut v = good();
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        match v.pointer_mut(parent).expect("there") {
            Value::Array(list) => list[key.parse::<usize>().expect("an index")] = value,
            parent => parent[key] = value,
        }
        let message = parse(&v).expect_err(pointer);
        assert!(message.starts_with("mine.json: "), "{message}");
        for word in words.split(" | ") {
            assert!(message.contains(word), "{message} lacks {word}");
        }
    }
    for text in ["", "[]", "{\"mass\": NaN}", "{\"mass\": 1e999}"] {
        let message = Case::parse(Path::new("x/mine.json"), text)
            .expect_err(text)
            .to_string();
        assert!(message.starts_with("x/mine.json: "), "{message}");
    }
}
