//! The acceptance checks of the game, by number.

use super::*;

/// Columns of the log that differ between runs.
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
        let untimed = |&k: &usize| !TIMES.contains(&&columns[k]);
        let kept: Vec<usize> = (0..columns.len()).filter(untimed).collect();
        assert!(kept.len() >= 12);
        let row =
            |r: csv::StringRecord| -> Vec<_> { kept.iter().map(|&k| r[k].to_owned()).collect() };
        let rows = reader.records().map(|r| row(r.expect("a row")));
        rows.collect::<Vec<_>>()
    };
    let (first, second) = (log("a.csv"), log("b.csv"));
    assert_eq!(first.len(), 601 * Integrator::ALL.len());
    assert!(first == second);
}

/// Check 3: a step while paused is exactly one, in the frame of the click, from any state of the clock.
#[test]
fn acceptance_3_a_step_while_paused_is_one_dt_in_the_same_frame() {
    let mut app = game("throw --dt 1/120");
    play(&mut app, 7);
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
    assert!(bare.status.success(), "{said}");
    assert!(said.contains("no display"), "{said}");
    assert!(String::from_utf8_lossy(&bare.stdout).contains("split"));
    for flags in [["--screenshot", "a.png"], ["--script", "a.ron"]] {
        assert_eq!(start(&flags).status.code(), Some(4), "{flags:?}");
    }
    let wrong = start(&["--scene", "moon"]);
    assert_eq!(wrong.status.code(), Some(2));
}

/// Check 10 for the scenes of the game: each has a reference at its start, and the default integrator stays
/// close to it for a second.
#[test]
fn acceptance_10_every_scene_starts_on_its_reference() {
    for build in Scenario::ALL {
        let scene = build();
        if scene.id == "dissertation-2012" {
            continue;
        }
        let mut app = game(&format!("{} --boxes 1", scene.id));
        let truth = session(&app).truth.clone().expect(scene.id);
        play(&mut app, 60);
        let Some(reference) = truth.at(clock(&app).time()) else {
            continue;
        };
        let state = main_box(&mut app);
        let error = (state.position - reference.position).length() / scene.setup.body.radius();
        // Stiff springs at the step of a game have at best order 2.
        let stiff = !scene.setup.forces.springs.is_empty();
        assert!(
            error < if stiff { 0.2 } else { 1e-2 },
            "{}: {error:e}",
            scene.id
        );
    }
}

#[test]
fn a_diverging_box_is_frozen_and_the_game_goes_on() {
    let mut app = game("stiff-drag --integrator explicit-euler --dt 0.5");
    let frozen = |app: &mut App| {
        let world = app.world_mut();
        let mut frozen = world.query_filtered::<(), (With<MainBox>, With<Quarantined>)>();
        frozen.iter(world).next().is_some()
    };
    let mut updates = 0..5000;
    while !frozen(&mut app) && updates.next().is_some() {
        app.update();
    }
    assert!(frozen(&mut app), "explicit Euler at c·dt/m far above 2");
    let state = main_box(&mut app);
    assert!(state.is_finite());
    play(&mut app, 10);
    assert_eq!(main_box(&mut app), state);
    assert_eq!(app.should_exit(), None);
    ask(&mut app, Action::SetIntegrator(Integrator::Split));
    ask(&mut app, Action::Restart);
    play(&mut app, 10);
    assert!(!frozen(&mut app) && main_box(&mut app).is_valid());
}

#[test]
fn the_use_of_the_processor_is_kept() {
    use bevy::diagnostic::{
        Diagnostic, DiagnosticMeasurement, DiagnosticsStore, SystemInformationDiagnosticsPlugin,
    };
    let mut app = game("throw");
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
    play(&mut app, 61);
    let history = app.world().resource::<box_game::record::history::History>();
    assert!((4..=5).contains(&history.cpu.len()), "four a second");
    let mut usage = history.cpu.iter().map(|u| (u.1, u.2));
    assert!(usage.all(|usage| usage == (12.5, 50.0)));
}
