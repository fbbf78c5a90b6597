//! The acceptance checks of the game, by number.

use super::*;

/// Check 1: every row marked M has a test that names it.
#[test]
fn acceptance_1_every_must_has_a_test() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut sources = String::new();
    for folder in [
        "tests",
        "tests/hands",
        "crates/box_game/src/hands",
        "crates/box_game/src",
        "crates/box_game/src/panel/tests",
        "crates/box_game/src/compare",
        "crates/box_game/src/ghosts",
    ] {
        for entry in std::fs::read_dir(root.join(folder))
            .expect("there")
            .flatten()
        {
            if entry.path().extension().is_some_and(|e| e == "rs") {
                sources += &std::fs::read_to_string(entry.path()).expect("text");
            }
        }
    }
    let has = |test: &str| sources.contains(&format!("fn {test}("));
    // The checks that are tests elsewhere; 8 is a step of CI, the others are below.
    for (check, tests) in [
        (
            4,
            &[
                "a_gesture_belongs_to_whoever_it_began_on",
                "what_restarts_waits_for_the_mouse_to_let_go",
            ][..],
        ),
        (5, &["letters_belong_to_a_text_field_that_is_typed_into"]),
        (
            6,
            &[
                "a_diverged_lane_stops_at_its_last_good_state",
                "a_diverging_box_is_frozen_and_the_game_goes_on",
            ],
        ),
        (
            9,
            &[
                "ten_minutes_keep_memory_flat",
                "memory_is_flat_and_extremes_survive",
            ],
        ),
    ] {
        for test in tests {
            assert!(has(test), "check {check}: {test}");
        }
    }
    for (row, what, tests) in [
        (
            1,
            "integrator live",
            &["digits_choose_integrators_while_it_flies"][..],
        ),
        (
            2,
            "keyboard impulses",
            &["keys_push_along_the_box_s_own_axes"],
        ),
        (
            3,
            "poke and grab",
            &[
                "a_poke_is_an_impulse_at_the_point_against_the_normal",
                "a_held_box_follows_the_hand_and_is_let_go",
                "a_click_pokes_with_the_strength_scrolled",
            ],
        ),
        (
            4,
            "several integrators, same inputs",
            &[
                "the_hero_is_its_own_lane_bit_for_bit",
                "equal_evaluations_and_late_inputs",
                "lanes_stand_side_by_side_in_the_picture_alone",
            ],
        ),
        (
            5,
            "live error",
            &[
                "the_reference_takes_every_push",
                "a_push_starts_a_new_closed_form",
            ],
        ),
        (
            6,
            "energy and momentum",
            &[
                "plots_say_what_they_show_and_leave_the_wheel_alone",
                "what_the_law_takes_is_not_drift",
                "what_a_integrator_gets_wrong_is",
                "a_push_is_booked",
            ],
        ),
        (
            7,
            "time per step",
            &["every_integrator_is_timed_whichever_is_in_use"],
        ),
        (
            8,
            "pause, step, restart",
            &["pause_and_single_step_are_exact_to_the_step"],
        ),
        (9, "step size", &["step_and_substeps_change_live"]),
        (
            10,
            "parameters",
            &["parameters_are_live_or_restart_and_bad_ones_are_refused"],
        ),
        (
            11,
            "log",
            &["the_log_has_a_row_per_step_and_says_what_was_done"],
        ),
        (12, "camera", &["a_gesture_belongs_to_whoever_it_began_on"]),
        (13, "scenes and lessons", &["the_lesson_says_what_to_try"]),
        (14, "slow motion", &["slow_motion_is_a_ladder_with_ends"]),
        (
            15,
            "work and precision",
            &["orders_are_found", "it_can_be_canceled_and_dropped"],
        ),
        (
            16,
            "bounding box",
            &["the_aabb_contains_the_box_after_every_step"],
        ),
        (17, "CPU graph", &["the_use_of_the_processor_is_kept"]),
        (
            18,
            "divergence",
            &["a_diverging_box_is_frozen_and_the_game_goes_on"],
        ),
        (19, "one-line plugin", &["parts_can_be_left_out"]),
        (
            20,
            "headless",
            &["acceptance_2_headless_runs_repeat_but_for_times"],
        ),
        (21, "load", &["more_boxes_are_a_load"]),
        (22, "help", &["help_lists_every_key_and_closes"]),
        (
            23,
            "bare machine",
            &["acceptance_7_without_a_display_it_compares"],
        ),
        (24, "colors", &["colors_stand_out_from_the_panel"]),
        (25, "copy", &["the_command_line_brings_the_set_up_back"]),
    ] {
        for test in tests {
            assert!(has(test), "row {row}, {what}: {test}");
        }
    }
}

/// The columns of the log that no two runs share.
const TIMES: [&str; 6] = [
    "wall_t_s",
    "step_ns_min",
    "step_ns_med",
    "cpu_process_pct",
    "cpu_system_pct",
    "frame_ms",
];

#[test]
fn acceptance_2_headless_runs_repeat_but_for_times() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = |name: &str| {
        let path = folder.path().join(name);
        let output = Command::new(env!("CARGO_BIN_EXE_box_game"))
            .args(["dzhanibekov", "--headless", "--duration", "10", "--log"])
            .arg(&path)
            .output()
            .expect("started");
        assert!(output.status.success(), "{output:?}");
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .from_path(&path)
            .expect("a log");
        let columns = reader.headers().expect("a header").clone();
        let kept: Vec<usize> = (0..columns.len())
            .filter(|&k| !TIMES.contains(&&columns[k]))
            .collect();
        assert!(kept.len() >= 12);
        let row = |r: csv::StringRecord| kept.iter().map(|&k| r[k].to_owned()).collect();
        let rows: Vec<Vec<String>> = reader.records().map(|r| row(r.expect("a row"))).collect();
        rows
    };
    let (first, second) = (log("a.csv"), log("b.csv"));
    assert!(first.len() >= 600 * Integrator::ALL.len());
    assert!(first == second);
}

/// Check 3: the step is taken in the frame of the click, exactly one, from any state of the clock.
#[test]
fn acceptance_3_a_step_while_paused_is_one_dt_in_the_same_frame() {
    let mut app = game(&["throw", "--dt", "1/120"]);
    run(&mut app, 7);
    for _ in 0..5 {
        ask(&mut app, Action::Step(1));
        let (steps, time) = (clock(&app).steps(), clock(&app).elapsed());
        app.update();
        assert_eq!(clock(&app).steps(), steps, "and not another in the next");
        ask(&mut app, Action::Step(1));
        assert_eq!(clock(&app).steps(), steps + 1);
        let dt = app.world().resource::<Time<Fixed>>().timestep();
        assert_eq!(clock(&app).elapsed(), time + dt);
    }
}

#[test]
fn acceptance_7_without_a_display_it_compares() {
    let folder = tempfile::tempdir().expect("a folder");
    let start = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_box_game"))
            .args(arguments)
            .current_dir(folder.path())
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .output()
            .expect("started")
    };
    let bare = start(&["--duration", "1"]);
    let said = String::from_utf8_lossy(&bare.stderr).into_owned();
    assert!(
        bare.status.success() && said.contains("no display"),
        "{said}"
    );
    assert!(String::from_utf8_lossy(&bare.stdout).contains("split"));
    let asked = start(&["--screenshot", "a.png"]);
    assert_eq!(asked.status.code(), Some(4));
    let wrong = start(&["--scene", "moon"]);
    assert_eq!(wrong.status.code(), Some(2));
}

/// Check 10 for what the game starts: every scene's trusted answer is there at its start, and the default
/// integrator stays by it for a second.
#[test]
fn acceptance_10_every_scene_starts_on_its_truth() {
    for build in Scenario::ALL {
        let scene = build();
        if scene.id == "dissertation-2012" {
            continue;
        }
        let mut app = game(&[scene.id, "--boxes", "1"]);
        let Some(truth) = session(&app).truth.clone() else {
            panic!("{}: no truth", scene.id);
        };
        run(&mut app, 60);
        let Some(reference) = truth.at(clock(&app).time()) else {
            continue;
        };
        let state = hero(&mut app);
        let size = scene.setup.body.radius();
        let error = (state.position - reference.position).length();
        // Stiff springs at the step of a game are second order at best.
        let bound = if scene.setup.forces.springs.is_empty() {
            1e-2
        } else {
            0.2
        };
        assert!(error < bound * size, "{}: {error:e}", scene.id);
    }
}

#[test]
fn a_diverging_box_is_frozen_and_the_game_goes_on() {
    let mut app = game(&[
        "stiff-drag",
        "--integrator",
        "explicit-euler",
        "--dt",
        "0.5",
    ]);
    let mut updates = 0;
    let frozen = |app: &mut App| {
        app.world_mut()
            .query_filtered::<(), (With<Hero>, With<Quarantined>)>()
            .iter(app.world())
            .next()
            .is_some()
    };
    while !frozen(&mut app) && updates < 5000 {
        app.update();
        updates += 1;
    }
    assert!(frozen(&mut app), "explicit Euler at c·dt/m far above 2");
    let state = hero(&mut app);
    assert!(state.is_finite());
    run(&mut app, 10);
    assert_eq!(hero(&mut app), state);
    assert_eq!(app.should_exit(), None);
    ask(&mut app, Action::SetIntegrator(Integrator::Split));
    ask(&mut app, Action::Restart);
    run(&mut app, 10);
    assert!(!frozen(&mut app) && hero(&mut app).is_valid());
}

#[test]
fn the_use_of_the_processor_is_kept() {
    use bevy::diagnostic::{
        Diagnostic, DiagnosticMeasurement, DiagnosticsStore, SystemInformationDiagnosticsPlugin,
    };
    let mut app = game(&["throw"]);
    let mut store = DiagnosticsStore::default();
    for (path, value) in [
        (SystemInformationDiagnosticsPlugin::PROCESS_CPU_USAGE, 12.5),
        (SystemInformationDiagnosticsPlugin::SYSTEM_CPU_USAGE, 50.0),
    ] {
        let mut diagnostic = Diagnostic::new(path);
        diagnostic.add_measurement(DiagnosticMeasurement {
            time: std::time::Instant::now(),
            value,
        });
        store.add(diagnostic);
    }
    app.insert_resource(store);
    run(&mut app, 61);
    let history = app.world().resource::<box_game::record::history::History>();
    assert!((4..=5).contains(&history.cpu.len()), "four a second");
    assert!(
        history
            .cpu
            .iter()
            .all(|&(_, process, system)| (process, system) == (12.5, 50.0))
    );
}
