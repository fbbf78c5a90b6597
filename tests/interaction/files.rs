//! Scenes from files, scripts, and the command line that reproduces a setup.

use super::*;
use box_game::action::compare::Layout;
use box_game::cli::Cli;
use clap::Parser;

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
    let (mut app, folder) = game_with_file("", "mine.ron", MINE);
    let path = folder.path().join("mine.ron");
    assert_eq!(session(&app).scenario.id, "mine");
    assert_eq!(session(&app).plot, Plot::Timing);
    let gravity = app.world().resource::<WorldGravity>().0;
    assert_eq!(gravity, DVec3::NEG_Y * 1.62);
    assert!(session(&app).truth.is_some());
    for (mass, played, error) in [
        // A change of the file is read within a second, and the scene restarts.
        ("mass: 5.5", 5.5, ""),
        // An invalid file is reported with its location, and the last valid scene continues.
        ("mass: -4", 5.5, "mine.ron:6:"),
        ("mass: 4", 4.0, ""),
    ] {
        std::fs::write(&path, MINE.replace("mass: 4", mass)).expect("writable");
        play(&mut app, 60);
        let errors = app.world().resource::<SceneLibrary>().errors().concat();
        assert_eq!(errors.is_empty(), error.is_empty(), "{errors}");
        assert!(errors.contains(error), "{errors}");
        assert_eq!(errors.contains("body.mass"), !error.is_empty(), "{errors}");
        assert_eq!(session(&app).parameters.mass, played);
        assert!(main_box(&mut app).is_valid());
    }
    // The scene is in the menu, and cycling through the list includes it.
    let scenes = app.world().resource::<SceneLibrary>().scenes();
    assert!(scenes.iter().any(|s| s.id == "mine" && s.title == "Mine"));
    ask(&mut app, Action::NextScene);
    assert_ne!(session(&app).scenario.id, "mine");
    ask(&mut app, Action::SelectScene("mine".to_owned()));
    assert_eq!(session(&app).scenario.id, "mine");
    // The file is deleted; the running scene continues.
    std::fs::remove_file(&path).expect("there");
    play(&mut app, 60);
    assert!(main_box(&mut app).is_valid());
}

#[test]
fn the_shipped_scene_files_are_in_the_menu_and_play() {
    let mut app = game("");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes");
    app.insert_resource(SceneLibrary::new(root, None));
    let scenes = app.world().resource::<SceneLibrary>().scenes().to_vec();
    assert!(scenes.len() >= Scenario::ALL.len() + 3);
    for Scenario { id, .. } in scenes.into_iter().skip(Scenario::ALL.len()) {
        ask(&mut app, Action::SelectScene(id.to_owned()));
        play(&mut app, 30);
        assert_eq!(session(&app).scenario.id, id);
        assert!(main_box(&mut app).is_valid(), "{id}");
    }
}

#[test]
fn a_bad_scene_file_on_the_command_line_is_an_error_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bad.ron");
    std::fs::write(&path, MINE.replace("duration: 5", "duration: 0")).expect("writable");
    let arguments = ["box_game", path.to_str().expect("utf-8")];
    let error = Cli::try_parse_from(arguments).expect_err("bad").to_string();
    assert!(error.contains("bad.ron:5:"), "{error}");
    assert!(error.contains("duration"), "{error}");
}

#[test]
fn the_command_line_reproduces_the_setup() {
    let mut app = game("bounce");
    for (parameter, value) in [
        (Parameter::Step, 1.0 / 240.0),
        (Parameter::Substeps, 2.0),
        (Parameter::Gravity, 3.7),
        (Parameter::Restitution, 0.25),
        (Parameter::Mass, 1.5),
        (Parameter::HalfX, 0.25),
        (Parameter::HalfY, 0.5),
        (Parameter::HalfZ, 0.75),
        (Parameter::Boxes, 9.0),
        (Parameter::Impulse, 0.5),
    ] {
        ask(&mut app, Action::Set(parameter, value));
    }
    ask(&mut app, Action::SetIntegrator(Integrator::Dmv6));
    ask(&mut app, Action::SetSpeed(0.25));
    let layout = CompareAction::SetLayout(Layout::SideBySide);
    ask(&mut app, layout.into());
    ask(&mut app, Action::SelectPlot(Plot::Cpu));
    let line = command_line::of(app.world()).expect("a command line");
    let again = game(line.strip_prefix("box_game").expect("the program"));
    assert_eq!(session(&again).parameters, session(&app).parameters);
    assert_eq!(session(&again).scenario.id, "bounce");
    assert_eq!(session(&again).speed, 0.25);
    assert_eq!(integrator(&again), Integrator::Dmv6);
    assert_eq!(session(&again).plot, Plot::Cpu);
    assert_eq!(clock(&again).substeps, 2);
    let layout = again.world().resource::<Comparison>().settings.layout;
    assert_eq!(layout, Layout::SideBySide);
    let step = |app: &App| app.world().resource::<Time<Fixed>>().timestep();
    assert_eq!(step(&again), step(&app));
    assert_eq!(command_line::of(again.world()).as_ref(), Ok(&line));
}

#[test]
fn a_script_acts_at_its_times() {
    let script = r#"[
        (at: 0.1, actions: [SelectScene("playground"), SetIntegrator("rk4")]),
        (at: 0.5, actions: [Push((direction: (1, 0, 0))), ToggleAabb]),
        (at: 1.0, actions: [Quit]),
    ]"#;
    let (mut app, _folder) = game_with_file("--script", "a.ron", script);
    play(&mut app, 5);
    assert_eq!(session(&app).scenario.id, "dzhanibekov", "not yet");
    play(&mut app, 5);
    assert_eq!(session(&app).scenario.id, "playground");
    assert_eq!(integrator(&app), Integrator::Rk4);
    assert_eq!(main_box(&mut app).velocity, DVec3::ZERO);
    play(&mut app, 24);
    assert!(main_box(&mut app).velocity.x > 0.0 && app.world().resource::<Preferences>().show_aabb);
    assert_eq!(app.should_exit(), None);
    assert_eq!(play_to_the_end(&mut app, 60), Some(AppExit::Success));
}

/// The sweep waits for the scene, whose start ends the sweep of the one before.
#[test]
fn a_sweep_asked_for_with_a_scene_is_of_that_scene() {
    let mut app = game("");
    play(&mut app, 5);
    let sweep = Action::Compare(CompareAction::StartSweep);
    request(&mut app, Action::SelectScene("heavy-top".to_owned()));
    request(&mut app, sweep);
    play(&mut app, 3);
    assert_eq!(session(&app).scenario.id, "heavy-top");
    let mut comparison = app.world_mut().resource_mut::<Comparison>();
    let measured = |line: &SweepLine| !line.points.is_empty();
    assert!(comparison.is_sweeping() || comparison.sweep.lines().iter().any(measured));
    comparison.sweep.cancel();
}

#[test]
fn the_shipped_scripts_are_scripts() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scripts");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("shipped") {
        let path = entry.expect("readable").path();
        let beats = box_game::input::script::load(&path).unwrap_or_else(|e| panic!("{e}"));
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
