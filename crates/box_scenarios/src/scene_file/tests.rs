use super::*;
use crate::run::{End, Plan, run_plan};
use box_physics::floor::RestitutionLaw;
use box_physics::integrators::Integrator;
use proptest::prelude::*;

const EXAMPLE: &str = include_str!("../../../../assets/scenes/example.ron");

fn read(text: &str) -> Result<Scenario, SceneFileError> {
    parse(Path::new("a.ron"), text)
}

#[test]
fn every_built_in_scene_survives_a_file_bit_for_bit() {
    for build in Scenario::ALL {
        let scene = build();
        let text = to_ron(&scene);
        let back = read(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(back, scene, "{text}");
    }
}

#[test]
fn another_inertia_survives_too() {
    let mut scene = Scenario::default();
    scene.setup.body = (scene.setup.body.with_inertia([0.3, 0.4, 0.5])).expect("possible");
    assert_eq!(read(&to_ron(&scene)).expect("own text"), scene);
}

#[test]
fn the_files_that_are_shipped_are_scenes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes");
    let mut ids = Scenario::ids();
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("shipped") {
        let path = entry.expect("readable").path();
        let scene = load(&path).unwrap_or_else(|e| panic!("{e}"));
        assert!(!ids.contains(&scene.id), "{} twice", scene.id);
        assert!(!scene.lesson.is_empty() && !scene.recommended().is_empty());
        ids.push(scene.id);
        count += 1;
    }
    assert!(count >= 3);
}

/// The example contains every field of a scene, because it documents the format.
#[test]
fn the_example_shows_every_field() {
    let mut scene = Scenario::find("heavy-top").expect("known");
    scene.setup.body = (scene.setup.body.with_inertia([0.3, 0.4, 0.5])).expect("possible");
    scene.setup.forces =
        scene
            .setup
            .forces
            .with_spring(glam::DVec3::ZERO, glam::DVec3::ONE, 1.0, 1.0);
    scene.setup.floor = Some(crate::FloorSpec {
        restitution_law: RestitutionLaw::Newton,
        ..crate::FloorSpec::at_zero(0.5, 0.5).in_tray(2.0)
    });
    scene.setup.impulses = vec![crate::TimedImpulse {
        t: 1.0,
        impulse: glam::DVec3::X,
        body_point: glam::DVec3::ZERO,
    }];
    for line in to_ron(&scene).lines() {
        let Some((name, _)) = line.trim().split_once(':') else {
            continue;
        };
        let name = name.trim_start_matches('(');
        if name.chars().all(|c| c.is_ascii_lowercase() || c == '_') {
            assert!(EXAMPLE.contains(&format!("{name}:")), "{name}");
        }
    }
}

/// The restitution law is optional, is written only if it is not the default, and reaches the driver.
#[test]
fn the_law_of_restitution() {
    let law = |text: &str| {
        let scene = read(text).expect("valid");
        let again = read(&to_ron(&scene)).expect("valid");
        assert_eq!(again.setup.floor, scene.setup.floor);
        (
            crate::Model::of(&scene.setup).settings.restitution,
            to_ron(&scene).contains("restitution_law"),
        )
    };
    let line = "restitution_law: Energetic,";
    assert!(EXAMPLE.contains(line));
    assert_eq!(law(EXAMPLE), (RestitutionLaw::Energetic, false));
    assert_eq!(
        law(&EXAMPLE.replace(line, "")),
        (RestitutionLaw::Energetic, false)
    );
    let newton = EXAMPLE.replace(line, "restitution_law: Newton,");
    assert_eq!(law(&newton), (RestitutionLaw::Newton, true));
}

/// The spin may be given in world axes, as in the API, or in body axes, with different names. The older name refers to
/// body axes.
#[test]
fn the_axes_of_the_spin_are_named() {
    let momentum = "angular_momentum: (0.08, 1.6, 0.16)";
    let spin = glam::DVec3::new(1.0, 6.0, 0.5);
    for name in [
        "world_angular_velocity",
        "body_angular_velocity",
        "angular_velocity",
    ] {
        let given = format!("{name}: (1.0, 6.0, 0.5)");
        let setup = read(&EXAMPLE.replace(momentum, &given))
            .expect("a scene")
            .setup;
        let is = match name {
            "world_angular_velocity" => setup.initial.angular_velocity(&setup.body),
            _ => setup.initial.body_angular_velocity(&setup.body),
        };
        assert!((is - spin).length() < 1e-12, "{name}: {is}");
        let twice = EXAMPLE.replace(momentum, &format!("{given}, {momentum}"));
        assert!(
            read(&twice)
                .expect_err("twice")
                .to_string()
                .contains("given twice")
        );
    }
}

/// A die of half a gram and 5 mm is a valid box.
#[test]
fn dice_are_boxes() {
    let die = EXAMPLE.replace("mass: 3.0", "mass: 0.0005");
    let (before, rest) = die.split_once("half_extents: (").expect("there");
    let (_, after) = rest.split_once(')').expect("there");
    let die = read(&format!(
        "{before}half_extents: (0.0025, 0.0025, 0.0025){after}"
    ));
    let die = die.expect("a scene");
    assert_eq!(
        (die.setup.body.mass(), die.setup.body.half_extents().x),
        (0.0005, 0.0025)
    );
    plays(&die);
}

/// Walls between which the box does not fit are rejected.
#[test]
fn a_tray_leaves_room_for_the_box() {
    let tray = |half: &str| read(&EXAMPLE.replace("tray: 0.0", &format!("tray: {half}")));
    let said = tray("0.12").expect_err("too narrow").to_string();
    assert!(
        said.contains("floor.tray") && said.contains("0.12"),
        "{said}"
    );
    assert!(tray("0.125").is_ok());
}

#[test]
fn complaints_name_file_line_column_and_field() {
    for (from, to, expected) in [
        ("mass: 3.0", "mass: -3.0", ":body.mass: must be between"),
        ("mass: 3.0", "mass: heavy", ":body.mass: "),
        ("mass: 3.0", "weight: 3.0", ":body.weight: "),
        (
            "restitution: 0.5",
            "restitution: 1.5",
            ":floor.restitution: must be between 0 and 1, but is 1.5",
        ),
        ("restitution: 0.5,", "", ":floor.restitution: "),
        (
            "duration: 10.0",
            "duration: 1e9",
            ":duration: must be above 0 and at most 600 s",
        ),
        ("\"rk4\"", "\"leapfrog\"", ":recommended[1]: "),
        (
            "stiffness: 20.0",
            "stiffness: -1.0",
            ":forces.springs[0].stiffness: must be between 0 and 1e6, but is -1",
        ),
        (
            "stiffness: 20.0",
            "stiffness: inf",
            ":forces.springs[0].stiffness: ",
        ),
        (
            "id: \"example\"",
            "id: \"../Example\"",
            ":id: must be 1 to 40",
        ),
        (
            "pitch: 15.0",
            "pitch: 95.0",
            ":view.pitch: must be between -85 and 85",
        ),
    ] {
        assert!(EXAMPLE.contains(from), "{from}");
        let text = EXAMPLE.replacen(from, to, 1);
        let error = read(&text).expect_err(to);
        let said = error.to_string();
        let (_, what) = said.split_once("a.ron:").expect("the file");
        let place: Vec<&str> = what.splitn(3, ':').collect();
        let rest = format!(":{}", place[2].trim_start());
        assert!(rest.starts_with(expected), "{to}: {said}");
        // The error is on the modified line, or on a later one if a field is missing.
        let before = &text[..EXAMPLE.find(from).expect("there")];
        let spoiled = before.matches('\n').count() + 1;
        assert!(
            (spoiled..=spoiled + 12).contains(&error.line),
            "{to}: {said} {spoiled}"
        );
        if !to.is_empty() {
            assert_eq!(error.line, spoiled, "{to}: {said}");
        }
        assert!(error.column > 0);
    }
    // At the line of the value, also within a list.
    let lines = EXAMPLE.replace("stiffness: 20.0", "\nstiffness: -1.0\n");
    let before = &lines[..lines.find("stiffness: -1.0").expect("there")];
    let line = before.matches('\n').count() + 1;
    let error = read(&lines).expect_err("negative");
    assert_eq!(
        (error.line, &*error.field),
        (line, "forces.springs[0].stiffness")
    );
    let said = load(Path::new("/nowhere/x.ron"))
        .expect_err("none")
        .to_string();
    assert!(said.contains("x.ron"), "{said}");
    let said = from_bytes(Path::new("b.ron"), b"(\n id\xff").expect_err("bytes");
    assert_eq!((said.line, said.column), (2, 4));
    assert!(from_bytes(Path::new("b.ron"), &vec![b' '; 300_000]).is_err());
}

/// Asserts that an accepted scene can be played: it has a reference soon, and steps stay finite.
fn plays(scene: &Scenario) {
    let reference = scene.reference();
    let start = reference.at(0.0);
    assert!(start.is_none_or(|s| s.is_finite()));
    assert!(scene.setup.initial.is_valid());
    // Ten steps with all forces, floor and impulses. (Extreme values in a file may exceed the range of f64; the game
    // then quarantines the body.)
    let dt = 1.0 / 60.0;
    let plan = Plan::new(&[dt, 10.0 * dt], &scene.setup.impulses, dt);
    let mut looks = 0;
    let (_, end) = run_plan(&scene.setup, Integrator::Split, &plan, |_, state| {
        assert!(state.is_valid());
        looks += 1;
        true
    });
    match end {
        End::Complete => assert_eq!(looks, 2),
        _ => assert!(matches!(end, End::Failed { .. }), "{end:?}"),
    }
}

fn hostile() -> impl Strategy<Value = String> {
    prop_oneof![
        Just("NaN".to_owned()),
        Just("inf".to_owned()),
        Just("-1".to_owned()),
        Just("1e308".to_owned()),
        Just("1e-308".to_owned()),
        Just("0".to_owned()),
        Just("(((((".to_owned()),
        Just("\"".to_owned()),
        (-9.0..9.0_f64).prop_map(|e| format!("{:e}", libm::pow(10.0, e))),
        (-1e7..1e7_f64).prop_map(|x| format!("{x}")),
    ]
}

/// Field names of the example.
fn names() -> Vec<&'static str> {
    let lines = EXAMPLE
        .lines()
        .map(|l| l.split("//").next().unwrap_or_default());
    let pieces = lines.flat_map(|l| l.split(['(', ',', ' ']));
    pieces
        .filter_map(|p| p.strip_suffix(':'))
        .filter(|n| !n.is_empty())
        .collect()
}

/// Any nesting of fields, tuples and lists with meaningful names, as a user guessing the format or a faulty program
/// would write.
fn structure() -> impl Strategy<Value = String> {
    let name = prop::sample::select(names());
    let leaf = prop_oneof![
        4 => hostile(),
        1 => Just("()".to_owned()),
        1 => Just("\"split\"".to_owned()),
        1 => Just("Some(1.0)".to_owned()),
        1 => Just("true".to_owned()),
        2 => Just("(0.5, 0.25, 0.125)".to_owned()),
    ];
    leaf.prop_recursive(5, 60, 8, move |inner| {
        let field = (name.clone(), inner.clone()).prop_map(|(n, v)| format!("{n}: {v}"));
        prop_oneof![
            4 => prop::collection::vec(field, 0..8).prop_map(|f| format!("({})", f.join(", "))),
            1 => prop::collection::vec(inner.clone(), 0..4).prop_map(|v| format!("({})", v.join(", "))),
            1 => prop::collection::vec(inner, 0..4).prop_map(|v| format!("[{}]", v.join(", "))),
        ]
    })
}

/// Byte ranges of the numbers in the example.
fn numbers() -> Vec<core::ops::Range<usize>> {
    let mut found = Vec::new();
    let mut offset = 0;
    for line in EXAMPLE.split_inclusive('\n') {
        let code = line.split("//").next().unwrap_or_default();
        let mut rest = code;
        let mut at = offset;
        while let Some(start) = rest.find(|c: char| c.is_ascii_digit() || c == '-') {
            let number = &rest[start..];
            let end = number
                .find(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c)))
                .unwrap_or(number.len());
            found.push(at + start..at + start + end);
            at += start + end;
            rest = &number[end..];
        }
        offset += line.len();
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn arbitrary_bytes_are_an_error(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
        prop_assert!(from_bytes(Path::new("x.ron"), &bytes).is_err());
    }

    #[test]
    fn brackets_and_names_are_an_error(text in "[a-c:(){}\\[\\],\"/*#r0-9 \n]{0,300}") {
        prop_assert!(read(&text).is_err());
    }

    #[test]
    fn any_structure_is_refused_or_plays(text in structure()) {
        match read(&text) {
            Ok(scene) => plays(&scene),
            Err(error) => prop_assert!(error.line > 0 && !error.message.is_empty(), "{error}"),
        }
    }

    /// A field of the example with a different value is either rejected with a location or playable.
    #[test]
    fn a_field_that_is_something_else(at in any::<prop::sample::Index>(), with in structure()) {
        let places = numbers();
        let mut text = EXAMPLE.to_owned();
        text.replace_range(at.get(&places).clone(), &with);
        match read(&text) {
            Ok(scene) => plays(&scene),
            Err(error) => prop_assert!(error.line > 0 && !error.message.is_empty(), "{error}"),
        }
    }

    /// The example with up to four numbers replaced is either rejected with a location or playable.
    #[test]
    fn a_spoiled_example_is_refused_or_plays(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), hostile()), 1..4)
    ) {
        let places = numbers();
        let mut text = EXAMPLE.to_owned();
        let mut chosen: Vec<_> = changes.iter().map(|(k, with)| (k.get(&places).clone(), with)).collect();
        chosen.sort_by_key(|(range, _)| core::cmp::Reverse(range.start));
        chosen.dedup_by_key(|(range, _)| range.start);
        for (range, with) in chosen {
            text.replace_range(range, with);
        }
        match read(&text) {
            Ok(scene) => plays(&scene),
            Err(error) => prop_assert!(error.line > 0 && !error.message.is_empty(), "{error}"),
        }
    }

    /// The example truncated anywhere, or with any byte changed, never causes a panic.
    #[test]
    fn a_damaged_example_never_panics(at in 0..EXAMPLE.len(), byte in any::<u8>()) {
        let bytes = EXAMPLE.as_bytes();
        let _ = from_bytes(Path::new("x.ron"), &bytes[..at]);
        let mut changed = bytes.to_vec();
        changed[at] = byte;
        if let Ok(scene) = from_bytes(Path::new("x.ron"), &changed) {
            plays(&scene);
        }
    }
}

#[test]
fn deep_nesting_ends() {
    for open in ["(", "[", "a:("] {
        assert!(read(&open.repeat(40_000)).is_err());
    }
}
