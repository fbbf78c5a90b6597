//! Hands, scene files, scripts, the 2012 scene and settings, in the game without a window; and the
//! acceptance checks of the game by name.

use std::path::Path;
use std::process::{Command, Stdio};

use bevy::input::ButtonState;
use bevy::input::InputPlugin;
use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_game::action::{Action, Plot, Poke, Push};
use box_game::app::{GamePlugin, open_log};
use box_game::apply::{Asked, command_line_of};
use box_game::cli::Cli;
use box_game::demo::Demo2012;
use box_game::hands::grab::{Grip, Hold};
use box_game::hands::rewind::{LONGEST, Rewind};
use box_game::hands::undo::UndoStack;
use box_game::library::SceneLibrary;
use box_game::preferences::{Preferences, PreferencesPlugin};
use box_game::session::{Hero, Session};
use box_physics::prelude::*;
use box_scenarios::Scenario;
use box_scenarios::dissertation::{Demo, State, Stepper};
use clap::Parser;

fn cli(arguments: &[&str]) -> Cli {
    Cli::try_parse_from([&["box_game"], arguments].concat()).expect("valid")
}

fn game(arguments: &[&str]) -> App {
    let cli = cli(arguments);
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, InputPlugin, GamePlugin { cli: cli.clone() }))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    // The fixed clock does not run on the first update.
    app.update();
    open_log(&mut app, &cli).expect("readable");
    app
}

fn ask(app: &mut App, action: Action) {
    app.world_mut().resource_mut::<Asked>().0.push(action);
    app.update();
}

fn hero(app: &mut App) -> BodyState {
    *app.world_mut()
        .query_filtered::<&BodyState, With<Hero>>()
        .single(app.world())
        .expect("one hero")
}

fn session(app: &App) -> &Session {
    app.world().resource::<Session>()
}

fn clock(app: &App) -> PhysicsClock {
    *app.world().resource::<PhysicsClock>()
}

fn run(app: &mut App, updates: u32) {
    (0..updates).for_each(|_| app.update());
}

fn press(app: &mut App, codes: &[(KeyCode, &str)]) {
    for state in [ButtonState::Pressed, ButtonState::Released] {
        for &(key_code, text) in codes {
            app.world_mut().write_message(KeyboardInput {
                key_code,
                logical_key: if text.is_empty() {
                    Key::Control
                } else {
                    Key::Character(text.into())
                },
                state,
                text: None,
                repeat: false,
                window: Entity::PLACEHOLDER,
            });
        }
        app.update();
    }
}

const CONTROL: (KeyCode, &str) = (KeyCode::ControlLeft, "");
const SHIFT: (KeyCode, &str) = (KeyCode::ShiftLeft, "");

// --- hands ---

#[test]
fn a_poke_is_an_impulse_at_the_point_against_the_normal() {
    let mut app = game(&["dzhanibekov"]);
    run(&mut app, 20);
    ask(&mut app, Action::TogglePause);
    let before = hero(&mut app);
    let poke = Poke {
        body_point: DVec3::new(0.4, 0.2, 0.125),
        normal: DVec3::Z,
        strength: 2.0,
    };
    ask(&mut app, Action::Poke(poke));
    ask(&mut app, Action::Step(1));
    let (body, mut expected) = (session(&app).setup().body, before);
    let impulse = before.rotation * DVec3::NEG_Z * (2.0 * session(&app).parameters.impulse);
    expected.apply_impulse_at_body_point(&body, impulse, poke.body_point);
    let h = clock(&app).step();
    let law = Gravity(DVec3::ZERO);
    Integrator::Split.step(&body, &mut expected, &law, h, &mut SchemeMemory::default());
    assert_eq!(hero(&mut app), expected);
    assert!(
        session(&app).truth.is_none(),
        "the scene's answer knows no poke"
    );
    // One that names no place does nothing but say so.
    let nowhere = Poke {
        normal: DVec3::NAN,
        ..poke
    };
    ask(&mut app, Action::Poke(nowhere));
    let said = session(&app).notices.back().cloned().unwrap_or_default();
    assert!(said.contains("not possible"), "{said}");
}

#[test]
fn a_held_box_follows_the_hand_and_is_let_go() {
    for (scene, scheme) in [
        ("playground", Integrator::Split),
        ("dzhanibekov", Integrator::Rk4),
        ("playground", Integrator::BackwardEuler),
    ] {
        let mut app = game(&[scene, "--integrator", scheme.id()]);
        let anchor = DVec3::new(0.5, 2.5, -0.5);
        let hold = Hold {
            body_point: DVec3::ZERO,
            anchor,
        };
        ask(&mut app, Action::Grab(Some(hold)));
        run(&mut app, 90);
        let state = hero(&mut app);
        assert!(
            (state.position - anchor).length() < 0.02,
            "{scene} {scheme}: {state:?}"
        );
        assert!(state.velocity.length() < 0.2, "{scene} {scheme}");
        ask(&mut app, Action::Grab(None));
        assert_eq!(app.world().resource::<Grip>().0, None);
        if scene == "playground" {
            run(&mut app, 120);
            assert!(hero(&mut app).position.y < 0.8, "it falls again");
        }
        // A restart lets go.
        ask(&mut app, Action::Grab(Some(hold)));
        ask(&mut app, Action::Restart);
        assert_eq!(app.world().resource::<Grip>().0, None);
    }
}

#[test]
fn stepping_back_returns_every_state_and_the_future_repeats() {
    for (scene, scheme) in [
        ("contact", "split"),
        ("dzhanibekov", "exact"),
        ("tumble-storm", "rk4"),
        ("dissertation-2012", "split"),
    ] {
        let mut app = game(&[scene, "--integrator", scheme]);
        let mut past = vec![hero(&mut app)];
        for _ in 0..80 {
            app.update();
            past.push(hero(&mut app));
        }
        let (steps, time) = (clock(&app).steps(), clock(&app).elapsed());
        for back in 1..=30 {
            ask(&mut app, Action::StepBack(1));
            assert_eq!(hero(&mut app), past[80 - back], "{scene}: {back} back");
            assert_eq!(clock(&app).steps(), steps - back as u64);
        }
        assert!(clock(&app).paused);
        ask(&mut app, Action::StepBack(10));
        assert_eq!(hero(&mut app), past[40], "{scene}: ten at once");
        for (k, expected) in past.iter().enumerate().skip(41) {
            ask(&mut app, Action::Step(1));
            assert_eq!(hero(&mut app), *expected, "{scene}: step {k}");
        }
        assert_eq!((clock(&app).steps(), clock(&app).elapsed()), (steps, time));
        // The picture shows the state, not a teleport.
        let transform = *app
            .world_mut()
            .query_filtered::<&Transform, With<Hero>>()
            .single(app.world())
            .expect("one hero");
        assert_eq!(transform.translation, past[80].position.as_vec3());
    }
}

#[test]
fn the_past_is_bounded_and_ends_at_the_start() {
    let mut app = game(&["dzhanibekov"]);
    run(&mut app, LONGEST as u32 + 50);
    assert_eq!(app.world().resource::<Rewind>().len(), LONGEST);
    ask(&mut app, Action::Restart);
    run(&mut app, 5);
    let start = session(&app).scenario.setup.initial;
    ask(&mut app, Action::StepBack(1000));
    assert_eq!(hero(&mut app), start);
    assert_eq!(clock(&app).steps(), 0);
    ask(&mut app, Action::StepBack(1));
    let said = session(&app).notices.back().cloned().unwrap_or_default();
    assert!(said.contains("nothing to go back to"), "{said}");
    // Too many boxes to keep: said, not slow.
    let mut app = game(&["load", "--boxes", "1500"]);
    run(&mut app, 3);
    assert!(app.world().resource::<Rewind>().is_empty());
}

#[test]
fn parameters_and_resets_are_undone_and_redone() {
    let mut app = game(&["playground"]);
    let gravity = |app: &App| session(app).parameters.gravity;
    ask(&mut app, Action::SetGravity(1.0));
    ask(&mut app, Action::SetFriction(0.25));
    ask(&mut app, Action::SetGravity(2.0));
    assert_eq!(
        app.world().resource::<UndoStack>().undoes(),
        Some("gravity")
    );
    press(&mut app, &[CONTROL, (KeyCode::KeyZ, "z")]);
    assert_eq!(gravity(&app), 1.0);
    assert_eq!(
        app.world().resource::<WorldGravity>().0.y,
        -1.0,
        "acts at once"
    );
    ask(&mut app, Action::Undo);
    assert_eq!(
        app.world().resource::<Floor>().friction,
        session(&app).defaults.friction.unwrap_or_default()
    );
    ask(&mut app, Action::Undo);
    assert_eq!(gravity(&app), 9.81);
    ask(&mut app, Action::Undo);
    for wanted in [1.0, 1.0, 2.0] {
        press(&mut app, &[CONTROL, SHIFT, (KeyCode::KeyZ, "Z")]);
        assert_eq!(gravity(&app), wanted);
    }
    // A drag of a slider is one change.
    for k in 0..20 {
        ask(&mut app, Action::SetLinearDrag(f64::from(k)));
    }
    ask(&mut app, Action::Undo);
    assert_eq!(session(&app).parameters.linear_drag, 0.0);
    // A new change forgets what could be redone.
    ask(&mut app, Action::SetSubsteps(4));
    assert_eq!(app.world().resource::<UndoStack>().redoes(), None);
    ask(&mut app, Action::Undo);
    assert_eq!(clock(&app).substeps, 1);
    ask(&mut app, Action::SetMass(7.0));
    ask(&mut app, Action::ResetParameters);
    ask(&mut app, Action::Undo);
    assert_eq!(session(&app).parameters.mass, 7.0);
    // Another scene: nothing of this one is left to take back.
    ask(&mut app, Action::NextScene);
    assert_eq!(app.world().resource::<UndoStack>().undoes(), None);
}

#[test]
fn an_undone_restart_goes_on_where_it_was() {
    let mut app = game(&["throw"]);
    run(&mut app, 40);
    ask(&mut app, Action::TogglePause);
    let (before, steps) = (hero(&mut app), clock(&app).steps());
    ask(&mut app, Action::Restart);
    assert_ne!(hero(&mut app), before);
    ask(&mut app, Action::Undo);
    assert_eq!(hero(&mut app), before);
    assert_eq!(clock(&app).steps(), steps);
}

#[test]
fn the_reset_ladder_ends_with_everything() {
    let mut app = game(&[
        "bounce",
        "--dt",
        "1/120",
        "--substeps",
        "3",
        "--integrator",
        "rk4",
    ]);
    ask(&mut app, Action::SetGravity(1.0));
    ask(&mut app, Action::SetSpeed(0.25));
    ask(&mut app, Action::ToggleAabb);
    ask(&mut app, Action::SetUiScale(1.5));
    ask(&mut app, Action::ResetEverything);
    let now = session(&app);
    assert_eq!(now.scenario.id, Scenario::default().id);
    assert_eq!(now.parameters, now.defaults);
    assert!(!now.show_aabb && now.speed == 1.0);
    assert_eq!(
        app.world().resource::<GlobalIntegrator>().0,
        Integrator::default()
    );
    assert_eq!(clock(&app).substeps, 1);
    assert_eq!(app.world().resource::<Preferences>().ui_scale, 1.0);
    let step = app.world().resource::<Time<Fixed>>().timestep();
    assert_eq!(step, Time::<Fixed>::from_hz(60.0).timestep());
}

#[test]
fn the_hitch_button_drops_time_and_counts_it() {
    let mut app = game(&["throw"]);
    app.insert_resource(TimeUpdateStrategy::Automatic);
    app.update();
    let steps = clock(&app).steps();
    ask(&mut app, Action::Hitch);
    app.update();
    let taken = clock(&app).steps() - steps;
    assert!(taken <= 16 + 1, "{taken} steps");
    let dropped = session(&app).dropped;
    assert!(dropped >= 0.49, "{dropped}");
}

#[test]
fn slow_motion_is_a_ladder_with_ends() {
    let mut app = game(&["throw", "--speed", "0.5"]);
    assert_eq!(
        app.world().resource::<Time<Virtual>>().relative_speed_f64(),
        0.5
    );
    ask(&mut app, Action::Slower);
    assert_eq!(session(&app).speed, 0.25);
    for _ in 0..20 {
        ask(&mut app, Action::Slower);
    }
    assert_eq!(session(&app).speed, 0.01);
    for _ in 0..20 {
        ask(&mut app, Action::Faster);
    }
    assert_eq!(session(&app).speed, 4.0);
}

// --- scenes from files ---

const MINE: &str = r#"(
    id: "mine",
    title: "Mine",
    lesson: "A scene of my own.",
    duration: 5,
    body: (half_extents: (0.5, 0.5, 0.5), mass: 4),
    start: (position: (0, 3, 0)),
    forces: (gravity: (0, -1.62, 0)),
    floor: (height: 0, restitution: 0.5, friction: 0.5),
    view: (yaw: 10, pitch: 5, plot: timing),
)"#;

#[test]
fn a_scene_file_is_played_watched_and_kept_when_it_breaks() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.ron");
    std::fs::write(&path, MINE).expect("writable");
    let mut app = game(&[path.to_str().expect("utf-8")]);
    assert_eq!(session(&app).scenario.id, "mine");
    assert_eq!(session(&app).plot, Plot::Timing);
    assert_eq!(
        app.world().resource::<WorldGravity>().0,
        DVec3::NEG_Y * 1.62
    );
    assert!(session(&app).truth.is_some());
    // A change of the file is read within a second, and the scene starts anew.
    std::fs::write(&path, MINE.replace("mass: 4", "mass: 5.5")).expect("writable");
    run(&mut app, 60);
    assert_eq!(session(&app).parameters.mass, 5.5);
    // Broken: said with its place, and the last good one goes on.
    std::fs::write(&path, MINE.replace("mass: 4", "mass: -4")).expect("writable");
    run(&mut app, 60);
    let errors = app.world().resource::<SceneLibrary>().errors();
    assert!(
        errors[0].contains("mine.ron:6:") && errors[0].contains("body.mass"),
        "{errors:?}"
    );
    assert_eq!(session(&app).parameters.mass, 5.5);
    assert!(hero(&mut app).is_sound());
    std::fs::write(&path, MINE).expect("writable");
    run(&mut app, 60);
    assert!(app.world().resource::<SceneLibrary>().errors().is_empty());
    assert_eq!(session(&app).parameters.mass, 4.0);
    // It stands in the menu, and the list goes round through it.
    let scenes = app.world().resource::<SceneLibrary>().scenes();
    assert!(scenes.contains(&("mine".to_owned(), "Mine".to_owned())));
    ask(&mut app, Action::NextScene);
    assert_ne!(session(&app).scenario.id, "mine");
    ask(&mut app, Action::SelectScene("mine".to_owned()));
    assert_eq!(session(&app).scenario.id, "mine");
    // Gone: what plays goes on.
    std::fs::remove_file(&path).expect("there");
    run(&mut app, 60);
    assert!(hero(&mut app).is_sound());
}

#[test]
fn the_shipped_scene_files_are_in_the_menu_and_play() {
    let mut app = game(&[]);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes");
    app.insert_resource(SceneLibrary::new(root, None));
    let scenes = app.world().resource::<SceneLibrary>().scenes().to_vec();
    assert!(scenes.len() >= Scenario::ALL.len() + 3);
    for (id, _) in scenes.into_iter().skip(Scenario::ALL.len()) {
        ask(&mut app, Action::SelectScene(id.clone()));
        run(&mut app, 30);
        assert_eq!(session(&app).scenario.id, id);
        assert!(hero(&mut app).is_sound(), "{id}");
    }
}

#[test]
fn a_bad_scene_file_on_the_command_line_is_an_error_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bad.ron");
    std::fs::write(&path, MINE.replace("duration: 5", "duration: 0")).expect("writable");
    let error = Cli::try_parse_from(["box_game", path.to_str().expect("utf-8")])
        .expect_err("bad")
        .to_string();
    assert!(
        error.contains("bad.ron:5:") && error.contains("duration"),
        "{error}"
    );
}

// --- proof ---

#[test]
fn the_command_line_brings_the_set_up_back() {
    let mut app = game(&["bounce"]);
    for action in [
        Action::SetIntegrator(Integrator::Dmv6),
        Action::SetStep(1.0 / 240.0),
        Action::SetSubsteps(2),
        Action::SetGravity(3.7),
        Action::SetRestitution(0.25),
        Action::SetMass(1.5),
        Action::SetHalfExtents(DVec3::new(0.25, 0.5, 0.75)),
        Action::SetBoxes(9),
        Action::SetImpulse(0.5),
        Action::SetSpeed(0.25),
    ] {
        ask(&mut app, action);
    }
    let line = command_line_of(app.world());
    let words: Vec<&str> = line.split(' ').skip(1).collect();
    let again = game(&words);
    assert_eq!(session(&again).parameters, session(&app).parameters);
    assert_eq!(session(&again).scenario.id, "bounce");
    assert_eq!(session(&again).speed, 0.25);
    assert_eq!(
        again.world().resource::<GlobalIntegrator>().0,
        Integrator::Dmv6
    );
    assert_eq!(clock(&again).substeps, 2);
    let step = |app: &App| app.world().resource::<Time<Fixed>>().timestep();
    assert_eq!(step(&again), step(&app));
    assert_eq!(command_line_of(again.world()), line);
}

#[test]
fn a_script_does_what_it_says_when_it_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ron");
    let script = r#"[
        (at: 0.1, actions: [SelectScene("playground"), SetIntegrator("rk4")]),
        (at: 0.5, actions: [Push((direction: (1, 0, 0))), ToggleAabb]),
        (at: 1.0, actions: [Quit]),
    ]"#;
    std::fs::write(&path, script).expect("writable");
    let mut app = game(&["--script", path.to_str().expect("utf-8")]);
    run(&mut app, 5);
    assert_eq!(session(&app).scenario.id, "dzhanibekov", "not yet");
    run(&mut app, 5);
    assert_eq!(session(&app).scenario.id, "playground");
    assert_eq!(
        app.world().resource::<GlobalIntegrator>().0,
        Integrator::Rk4
    );
    assert_eq!(hero(&mut app).velocity, DVec3::ZERO);
    run(&mut app, 24);
    assert!(hero(&mut app).velocity.x > 0.0 && session(&app).show_aabb);
    assert_eq!(app.should_exit(), None);
    let mut updates = 0;
    while app.should_exit().is_none() && updates < 60 {
        app.update();
        updates += 1;
    }
    assert_eq!(app.should_exit(), Some(AppExit::Success));
}

#[test]
fn the_shipped_scripts_are_scripts() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scripts");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("shipped") {
        let path = entry.expect("readable").path();
        let beats = box_game::script::load(&path).unwrap_or_else(|e| panic!("{e}"));
        let last = beats.last().and_then(|b| b.actions.last());
        assert_eq!(last, Some(&Action::Quit), "{}", path.display());
        for action in beats.iter().flat_map(|b| &b.actions) {
            if let Action::SelectScene(id) = action {
                assert!(Scenario::find(id).is_ok(), "{id}");
            }
        }
        count += 1;
    }
    assert!(count >= 1);
}

// --- the demo of 2012 ---

#[test]
fn the_2012_scene_moves_as_its_own_steppers_have_it() {
    for stepper in Stepper::ALL {
        let mut app = game(&["dissertation-2012"]);
        ask(&mut app, Action::SetDemo(Some(stepper)));
        ask(&mut app, Action::Restart);
        let setup = session(&app).setup();
        assert_eq!(setup.body.mass(), 10.0);
        let demo = Demo::of(&setup.body, Some(0.0));
        let mut expected = State::new(&setup.body, &setup.initial);
        // The restart's own frame took a step.
        let h = clock(&app).step();
        demo.cycle(stepper, &mut expected, h);
        for k in 0..120 {
            if k == 70 {
                let push = Push {
                    direction: DVec3::X,
                    world: true,
                    off_centre: false,
                };
                app.world_mut()
                    .resource_mut::<Asked>()
                    .0
                    .push(Action::Push(push));
                let force = Demo::force_for(DVec3::X * session(&app).parameters.impulse);
                demo.push(&mut expected, force, DVec3::ZERO);
            }
            app.update();
            demo.cycle(stepper, &mut expected, h);
            assert_eq!(
                hero(&mut app),
                expected.body_state(&setup.body),
                "{stepper:?} {k}"
            );
        }
    }
}

#[test]
fn a_button_switches_to_ours_and_back_in_flight() {
    let mut app = game(&["dissertation-2012"]);
    run(&mut app, 10);
    let fall = hero(&mut app);
    assert_eq!(fall.velocity.y, 0.0, "it falls without a speed");
    assert!((fall.position.y - (4.5 - 9.81 * clock(&app).time())).abs() < 1e-6);
    ask(&mut app, Action::SetDemo(None));
    let ours = hero(&mut app);
    assert!(
        (ours.velocity.y + 9.81 / 60.0).abs() < 1e-3,
        "now it has one"
    );
    run(&mut app, 5);
    let before = hero(&mut app);
    ask(&mut app, Action::SetDemo(Some(Stepper::Rk4)));
    let after = hero(&mut app);
    let gone = (before.velocity.y - 9.81) * clock(&app).step();
    assert!(
        (after.position.y - before.position.y - gone).abs() < 1e-6,
        "goes on from there"
    );
    // Only in its own scene.
    ask(&mut app, Action::SelectScene("throw".to_owned()));
    let demo = app.world().resource::<Demo2012>();
    assert_eq!(demo.active(session(&app)), None);
}

// --- settings ---

/// Runs in a process of its own, with the settings folder of the test.
#[test]
#[ignore = "run by the test below, in a process of its own"]
fn settings_child() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, InputPlugin, PreferencesPlugin));
    app.add_plugins(GamePlugin {
        cli: cli(&["throw"]),
    });
    app.update();
    let kept = *app.world().resource::<Preferences>();
    println!(
        "found {} {} {}",
        kept.ui_scale,
        kept.show_plots,
        session(&app).show_aabb
    );
    ask(&mut app, Action::SetUiScale(1.25));
    ask(&mut app, Action::TogglePlots);
    ask(&mut app, Action::ToggleAabb);
    ask(&mut app, Action::Quit);
    app.update();
}

#[test]
fn settings_are_found_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let start = || {
        let output = Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", "settings_child", "--ignored", "--nocapture"])
            .env("XDG_CONFIG_HOME", folder.path())
            .env("HOME", folder.path())
            .stdin(Stdio::null())
            .output()
            .expect("started");
        assert!(output.status.success(), "{output:?}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let first = start();
    assert!(first.contains("found 1 true false"), "{first}");
    let second = start();
    assert!(second.contains("found 1.25 false true"), "{second}");
    let third = start();
    assert!(
        third.contains("found 1.25 true false"),
        "toggled again: {third}"
    );
    // A file that says nonsense is no reason not to start.
    let file = walk(folder.path()).expect("a settings file");
    std::fs::write(&file, "[box_game]\nui_scale = 1e30\nshow_plots = true\n").expect("writable");
    assert!(start().contains("found 2 true"));
    std::fs::write(&file, "}{ nonsense").expect("writable");
    assert!(start().contains("found 1 true false"));
}

/// The settings file somewhere below `folder`.
fn walk(folder: &Path) -> Option<std::path::PathBuf> {
    std::fs::read_dir(folder).ok()?.flatten().find_map(|entry| {
        let path = entry.path();
        if path.is_dir() {
            walk(&path)
        } else {
            path.extension()
                .is_some_and(|e| e == "toml")
                .then_some(path)
        }
    })
}

// --- acceptance (experience, 5.7) ---

/// Check 1: every row marked M has a test that names it. The rows about several schemes side by side
/// (4, 5, 6 in part, 15) are in `tests/compare.rs`, where there is one.
#[test]
fn acceptance_1_every_must_has_a_test() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut sources = String::new();
    for folder in [
        "tests",
        "crates/box_game/src/hands",
        "crates/box_game/src",
        "crates/box_game/src/panel/tests",
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
    for (row, what, tests) in [
        (
            1,
            "integrator live",
            &["digits_choose_schemes_while_it_flies"][..],
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
            6,
            "energy and momentum",
            &["plots_say_what_they_show_and_leave_the_wheel_alone"],
        ),
        (
            7,
            "time per step",
            &["every_scheme_is_timed_whichever_is_in_use"],
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
        (24, "colours", &["colours_stand_out_from_the_panel"]),
        (25, "copy", &["the_command_line_brings_the_set_up_back"]),
    ] {
        for test in tests {
            assert!(
                sources.contains(&format!("fn {test}(")),
                "row {row}, {what}: {test}"
            );
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
/// scheme stays by it for a second.
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
    assert!(!frozen(&mut app) && hero(&mut app).is_sound());
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
    let history = app.world().resource::<box_game::history::History>();
    assert!((4..=5).contains(&history.cpu.len()), "four a second");
    assert!(
        history
            .cpu
            .iter()
            .all(|&(_, process, system)| (process, system) == (12.5, 50.0))
    );
}
