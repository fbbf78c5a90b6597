//! Trajectory files with arbitrary contents give an error that names the file, or a case that runs. They
//! never panic or hang.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use box_physics::prelude::*;
use box_scenarios::oracle::{Case, Outcome};
use proptest::prelude::*;

/// Every file must lead to an end: an error, or a case that runs for a few steps.
fn examine(text: &str) -> Result<(), TestCaseError> {
    let file = Path::new("case.json");
    let case = match Case::parse(file, text) {
        Ok(case) => case,
        Err(error) => {
            let message = error.to_string();
            prop_assert!(message.starts_with("case.json: "), "{message}");
            prop_assert!(message.len() < 1000, "{} characters", message.len());
            return Ok(());
        }
    };
    prop_assert!(case.setup.initial.is_finite());
    for dt in [1.0 / 60.0, 1e-300, 1e300] {
        // A hostile file can request steps for years: the case must report that as unsupported.
        let plan = case.plan(dt);
        if case.unsupported(dt).is_some() {
            let measured = case.measure(Integrator::Split, dt);
            prop_assert!(matches!(measured.outcome, Outcome::Unsupported(_)));
        } else if plan.steps() < 2000 {
            for integrator in [Integrator::Split, Integrator::Exact, Integrator::Rk4] {
                let measured = case.measure(integrator, dt);
                let finished = matches!(measured.outcome, Outcome::Ok | Outcome::Lost(_));
                prop_assert_eq!(
                    finished,
                    measured.position.is_finite() && measured.attitude.is_finite()
                );
            }
        }
    }
    Ok(())
}

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/oracle");
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .expect("the reference trajectories")
        .map(|entry| entry.expect("readable").path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    files.sort();
    files
}

/// The first samples of every file: short, so that mutations hit the relevant parts.
fn short_files() -> &'static [String] {
    static FILES: OnceLock<Vec<String>> = OnceLock::new();
    let shorten = |path: &PathBuf| {
        let text = std::fs::read_to_string(path).expect("readable");
        let mut json: serde_json::Value = serde_json::from_str(&text).expect("a good file");
        json["samples"].as_array_mut().expect("a list").truncate(3);
        json.to_string()
    };
    FILES.get_or_init(|| files().iter().map(shorten).collect())
}

/// Replacement text for mutations of a good file.
#[rustfmt::skip]
const SCRAPS: &[&str] = &[
    "", "0", "-1", "1e308", "1e-320", "-1e999", "NaN", "null", "true", "[]", "{}", "[[[[", "}",
    "\"", "\\u0000", "\"\u{1F4E6}\"", "123456789012345678901234567890", ",", ":", " ", "\n",
];

/// Keys of the format and other keys.
#[rustfmt::skip]
const KEYS: &[&str] = &[
    "name", "kind", "body", "half_extents", "mass", "inertia_diag_body", "initial", "position",
    "quaternion_xyzw", "velocity", "angular_velocity_world", "angular_velocity_body", "forces",
    "gravity", "linear_drag_c", "quadratic_drag_k", "angular_damping_rate", "angular_drag_c",
    "constant_body_torque", "dipole", "moment_body", "field_world", "zero_length_spring", "k",
    "body_point", "anchor", "contact", "restitution", "friction", "events", "t", "impulse_world",
    "samples", "energy", "nonsense", "",
];

fn number() -> impl Strategy<Value = serde_json::Value> {
    prop_oneof![
        any::<f64>().prop_map(|x| serde_json::json!(x)),
        (-10.0..10.0f64).prop_map(|x| serde_json::json!(x)),
        any::<i64>().prop_map(|x| serde_json::json!(x)),
        Just(serde_json::json!(0)),
    ]
}

/// Any JSON, with keys of the format.
fn structure() -> impl Strategy<Value = serde_json::Value> {
    let leaf = prop_oneof![
        Just(serde_json::Value::Null),
        any::<bool>().prop_map(serde_json::Value::from),
        number(),
        "[a-z]{0,8}".prop_map(serde_json::Value::from),
        prop::collection::vec(number(), 0..5).prop_map(serde_json::Value::from),
    ];
    leaf.prop_recursive(4, 40, 6, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(serde_json::Value::from),
            prop::collection::vec((prop::sample::select(KEYS), inner), 0..8).prop_map(|pairs| {
                let named = pairs.into_iter().map(|(k, v)| (k.to_owned(), v));
                serde_json::Value::Object(named.collect())
            }),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_text(text in any::<String>()) {
        examine(&text)?;
    }

    /// Arbitrary bytes, text or not.
    #[test]
    fn arbitrary_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        std::fs::write(file.path(), &bytes).expect("writable");
        let error = Case::load(file.path()).expect_err("noise is no case").to_string();
        prop_assert!(error.starts_with(&file.path().display().to_string()), "{error}");
    }

    #[test]
    fn arbitrary_structures(json in structure()) {
        examine(&json.to_string())?;
    }

    /// Good files with parts overwritten, duplicated or removed.
    #[test]
    fn spoiled_files(
        which in any::<prop::sample::Index>(),
        edits in prop::collection::vec(
            (any::<prop::sample::Index>(), 0..30_usize, prop::sample::select(SCRAPS)), 1..6),
    ) {
        let mut text = which.get(short_files()).clone();
        for (at, length, scrap) in edits {
            let mut ends: Vec<usize> = text.char_indices().map(|(i, _)| i).collect();
            ends.push(text.len());
            let start = at.index(ends.len());
            let end = (start + length).min(ends.len() - 1);
            text.replace_range(ends[start]..ends[end], scrap);
        }
        examine(&text)?;
    }

    /// Good files with any one value replaced.
    #[test]
    fn files_with_one_other_value(
        which in any::<prop::sample::Index>(),
        place in any::<prop::sample::Index>(),
        value in prop_oneof![number(), structure()],
    ) {
        fn places(json: &serde_json::Value, here: String, out: &mut Vec<String>) {
            match json {
                serde_json::Value::Array(list) => {
                    for (k, v) in list.iter().enumerate() {
                        places(v, format!("{here}/{k}"), out);
                    }
                }
                serde_json::Value::Object(map) => {
                    for (k, v) in map {
                        places(v, format!("{here}/{k}"), out);
                    }
                }
                _ => {}
            }
            out.push(here);
        }
        let good: &String = which.get(short_files());
        let mut json: serde_json::Value = serde_json::from_str(good).expect("a good file");
        let mut all = Vec::new();
        places(&json, String::new(), &mut all);
        let changed: &String = place.get(&all);
        *json.pointer_mut(changed).expect("a place in it") = value;
        examine(&json.to_string())?;
    }
}

/// Bytes that are not text, unlimited nesting, an empty file, a huge file, a folder.
#[test]
fn files_that_are_no_text() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let deep = "[".repeat(100_000);
    for (name, bytes) in [
        ("bytes.json", &[0xff, 0xfe, 0x00, 0x80][..]),
        ("empty.json", &[][..]),
        ("deep.json", deep.as_bytes()),
    ] {
        std::fs::write(folder.join(name), bytes).expect("written");
        let error = Case::load(&folder.join(name))
            .expect_err("no case")
            .to_string();
        assert!(error.contains(name), "{error}");
    }
    let huge = std::fs::File::create(folder.join("huge.json")).expect("created");
    huge.set_len(1 << 40).expect("a sparse file");
    assert!(Case::load(&folder.join("huge.json")).is_err());
    assert!(Case::load(folder).is_err());
    let all = Case::load_folder(folder).expect("it can be listed");
    assert!(all.len() == 4 && all.iter().all(Result::is_err));
    assert!(Case::load_folder(&folder.join("nowhere")).is_err());
}
