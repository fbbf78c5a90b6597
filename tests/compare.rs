//! The comparison in the whole game without a window: main box, comparisons, reference, inputs, fairness,
//! log, memory.

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_game::action::{Action, Plot};
use box_game::compare::runner::Runner;
use box_game::compare::{CompareAction, Comparison, Fairness, Layout, MarkKind, Quantity, Run};
use box_game::parameters::Parameter;
use box_game::record::csv_log::CsvLog;
use box_game::scene::session::MainBox;
use box_physics::prelude::*;

#[path = "compare/back.rs"]
mod back;
mod playing;

use playing::{
    SHIFT, ask, clock, game, logged_game, main_box, of_main_box, play, press, push, request,
    session,
};

fn compare(app: &mut App, action: CompareAction) {
    ask(app, Action::Compare(action));
}

fn run(app: &App) -> &Run {
    let comparison = app.world().resource::<Comparison>();
    comparison.run.as_ref().expect("a main box")
}

/// The comparison that runs `integrator`.
fn comparison(app: &App, integrator: Integrator) -> &Runner {
    let mut comparisons = run(app).comparisons.iter();
    let found = comparisons.find(|r| r.integrator() == integrator);
    found.expect("a comparison")
}

fn main_entity(app: &mut App) -> Entity {
    let world = app.world_mut();
    let mut main_box = world.query_filtered::<Entity, With<MainBox>>();
    main_box.single(world).expect("a main box")
}

/// Current value of `quantity` of the main box.
fn measured(app: &App, quantity: Quantity) -> f64 {
    run(app).main_box.track.now.sample.get(quantity)
}

/// Current value of `quantity` of the comparison that runs `integrator`.
fn measured_of(app: &App, integrator: Integrator, quantity: Quantity) -> f64 {
    comparison(app, integrator).track.now.sample.get(quantity)
}

/// The state of the comparison that runs `integrator`.
fn compared(app: &App, integrator: Integrator) -> BodyState {
    comparison(app, integrator).simulation.driver.state
}

/// The main box (a body of the plugin) and a comparison under the same integrator agree bit for bit, through
/// pushes, changed parameters and contact.
#[test]
fn the_main_box_is_its_own_comparison_bit_for_bit() {
    for (scene, integrator) in [
        "dzhanibekov",
        "bounce",
        "contact",
        "heavy-top",
        "quadratic-drag",
    ]
    .into_iter()
    .flat_map(|scene| ["split", "rk4", "semi-implicit-euler"].map(|i| (scene, i)))
    {
        // A comparison of `integrator` from the start, and a main box under it.
        let [mut app, mut twin] = [format!("midpoint,{integrator}"), integrator.to_owned()]
            .map(|list| game(&format!("{scene} --integrator {list}")));
        let integrator: Integrator = integrator.parse().expect("an id");
        for k in 0..90 {
            for app in [&mut app, &mut twin] {
                if k == 40 {
                    // The same impulse for both, independent of the main boxes.
                    let entity = main_entity(app);
                    app.world_mut().write_message(ApplyImpulse::at_body_point(
                        entity,
                        DVec3::new(0.4, 1.5, -0.3),
                        DVec3::new(0.2, 0.0, 0.1),
                    ));
                }
                if k == 50 {
                    request(app, Action::Set(Parameter::Gravity, 3.0));
                }
                app.update();
            }
            let driver = &comparison(&app, integrator).simulation.driver;
            let own = main_box(&mut twin);
            assert_eq!(driver.state, own, "{scene} {integrator} {k}");
            assert_eq!(driver.time, run(&app).clock);
        }
    }
}

/// A pushed run is still measured: the reference receives the same push at the same time.
#[test]
fn the_reference_takes_every_push() {
    let mut app = game("throw --integrator exact,split,explicit-euler");
    play(&mut app, 20);
    ask(&mut app, push(DVec3::Y, true));
    play(&mut app, 60);
    assert!(measured(&app, Quantity::Position) < 1e-9);
    assert!(measured(&app, Quantity::Attitude) < 1e-6);
    assert!(measured(&app, Quantity::LocalPosition) < 1e-12);
    assert!(measured(&app, Quantity::Energy).abs() < 1e-12);
    assert!(run(&app).reference.is_trusted());
    let euler = Integrator::ExplicitEuler;
    assert!(measured_of(&app, euler, Quantity::Position) > 0.05);
    assert!(measured_of(&app, euler, Quantity::Energy).abs() > 1e-4);
    assert!(run(&app).marks.iter().any(|m| m.kind == MarkKind::Input));
    // A changed parameter, too.
    ask(&mut app, Action::Set(Parameter::Gravity, 1.5));
    play(&mut app, 30);
    assert!(measured(&app, Quantity::Position) < 1e-9);
    assert!(measured(&app, Quantity::Energy).abs() < 1e-12);
}

/// A teleport of the main box moves every comparison.
#[test]
fn a_teleport_takes_the_comparisons_along() {
    let mut app = game("throw --integrator split,explicit-euler");
    play(&mut app, 20);
    let entity = main_entity(&mut app);
    let pose = app.world_mut().get_mut::<Transform>(entity);
    pose.expect("a pose").translation.y = 30.0;
    app.update();
    let euler = compared(&app, Integrator::ExplicitEuler);
    assert!((euler.position.y - 30.0).abs() < 0.5, "{}", euler.position);
    assert!(measured(&app, Quantity::Position) < 1e-9);
}

/// A comparison that is added in flight is simulated from the start with all inputs so far.
#[test]
fn a_late_comparison_catches_up_with_all_inputs() {
    let mut early = game("throw --integrator split,rk4");
    let mut late = game("throw --integrator split");
    for app in [&mut early, &mut late] {
        play(app, 15);
        ask(app, push(DVec3::X, true));
        play(app, 15);
    }
    compare(&mut late, CompareAction::ToggleComparison(Integrator::Rk4));
    early.update();
    play(&mut early, 20);
    play(&mut late, 20);
    let [a, b] = [&early, &late].map(|app| &comparison(app, Integrator::Rk4).simulation.driver);
    assert_eq!(a.time, b.time);
    // The step boundaries are sums of steps, so the push may be off by rounding.
    assert!((a.state.position - b.state.position).length() < 1e-9);
    compare(&mut late, CompareAction::ToggleComparison(Integrator::Rk4));
    assert!(run(&late).comparisons.is_empty());
    compare(&mut late, CompareAction::CompareAll);
    assert_eq!(run(&late).comparisons.len(), Integrator::ALL.len() - 1);
}

/// 5.7 no. 6: a comparison that diverges stops and reports it; nothing else is affected.
#[test]
fn a_diverged_comparison_stops_at_its_last_good_state() {
    let mut app = game("needle --integrator split,semi-implicit-euler");
    play(&mut app, 200);
    let lost = &comparison(&app, Integrator::SemiImplicitEuler).simulation;
    let diverged = lost.diverged.expect("it diverges within three seconds");
    assert!(diverged.t < 3.0 && lost.driver.state.is_valid());
    assert!(run(&app).main_box.simulation.diverged.is_none());
    assert!(run(&app).clock > 3.0);
    compare(&mut app, CompareAction::Resync);
    let back = Integrator::SemiImplicitEuler;
    assert!(comparison(&app, back).simulation.diverged.is_none());
    assert!(measured_of(&app, back, Quantity::Position) < 1e-9);
}

/// Making a comparison's integrator the main one swaps the two. Each trajectory stays that of one integrator.
#[test]
fn main_box_and_comparison_change_places() {
    let mut app = game("dzhanibekov --integrator split,explicit-euler");
    let mut euler = game("dzhanibekov --integrator explicit-euler");
    for app in [&mut app, &mut euler] {
        play(app, 40);
    }
    let before = main_box(&mut app);
    ask(&mut app, Action::SetIntegrator(Integrator::ExplicitEuler));
    euler.update();
    assert_eq!(main_box(&mut app), main_box(&mut euler));
    let split = compared(&app, Integrator::Split);
    assert!((split.position - before.position).length() < 1e-12);
    assert!(measured_of(&app, Integrator::Split, Quantity::Attitude) < 0.1);
    assert!(measured(&app, Quantity::Attitude) > 0.1);
    play(&mut app, 10);
    play(&mut euler, 10);
    assert_eq!(main_box(&mut app), main_box(&mut euler));
    // While the clock is paused, the displayed pose follows at once and does not count as a teleport.
    ask(&mut app, Action::TogglePause);
    ask(&mut app, Action::SetIntegrator(Integrator::Split));
    let state = main_box(&mut app);
    let pose = of_main_box::<Transform>(&mut app);
    assert_eq!(pose.translation, state.position.as_vec3());
    assert_eq!(pose.rotation, state.rotation.as_quat());
    let marks = run(&app).marks.len();
    ask(&mut app, Action::Step(1));
    let inputs = run(&app).marks.iter().skip(marks);
    assert_eq!(inputs.filter(|m| m.kind == MarkKind::Input).count(), 0);
}

/// With equal evaluations, the comparison's step is longer in proportion to its evaluations. Inputs take
/// effect at its next step boundary, less than one step late, and the log records the delay.
#[test]
fn equal_evaluations_and_late_inputs() {
    let (mut app, log) = logged_game("throw --integrator split,rk4");
    // Long enough to sample every integrator.
    play(&mut app, 30);
    compare(&mut app, CompareAction::SetFairness(Fairness::Evaluations));
    play(&mut app, 3);
    assert_eq!(comparison(&app, Integrator::Rk4).factor, 4.0);
    let mut late = Vec::new();
    for _ in 0..4 {
        ask(&mut app, push(DVec3::Y, false));
        play(&mut app, 6);
        let driver = &comparison(&app, Integrator::Rk4).simulation.driver;
        assert!(run(&app).clock - driver.time < 4.0 / 60.0 + 1e-9);
        assert!(measured_of(&app, Integrator::Rk4, Quantity::LocalPosition) < 1e-6);
    }
    let mut rows = [0, 0];
    for row in log.rows(&mut app) {
        let number = |text: &str| text.parse::<f64>().expect("measured");
        rows[row["trajectory"].parse::<usize>().expect("0 or 1")] += 1;
        if row["event"].contains(" s late") {
            late.push(number(row["event"].split(' ').nth(1).expect("a number")));
        }
        assert!(number(&row["pos_err_m"]) < 0.6);
        assert!(number(&row["energy_rel"]).abs() < 1e-6);
    }
    assert!(late.iter().all(|s| *s > 0.0 && *s < 4.0 / 60.0), "{late:?}");
    assert!(!late.is_empty());
    assert!(
        rows[0] > 60 && rows[1] > 30 && rows[1] < rows[0],
        "{rows:?}"
    );
    compare(&mut app, CompareAction::SetFairness(Fairness::Step));
    app.update();
    assert_eq!(comparison(&app, Integrator::Rk4).factor, 1.0);
    compare(&mut app, CompareAction::SetFairness(Fairness::Cost));
    play(&mut app, 2);
    assert!(comparison(&app, Integrator::Rk4).factor > 0.5);
}

/// The log has the local error of every comparison, which stays meaningful after chaos.
#[test]
fn the_log_has_a_row_for_every_comparison() {
    let (mut app, log) = logged_game("contact --integrator split,rk4,explicit-euler");
    play(&mut app, 120);
    let rows = log.rows(&mut app);
    assert_eq!(rows.len(), 3 * 120);
    for (k, row) in rows.iter().enumerate() {
        assert_eq!(row["trajectory"], (k % 3).to_string());
        let local: f64 = row["local_pos_err_m"].parse().expect("measured");
        assert!(local < 0.2, "{local}");
    }
    assert!(rows.iter().any(|r| r["state"] == "contact"));
    assert!(run(&app).marks.iter().any(|m| m.kind == MarkKind::Contact));
}

/// 5.7 no. 9: ten minutes at 60 Hz with five comparisons stay within a fixed budget of memory and points.
#[test]
fn ten_minutes_keep_memory_flat() {
    let mut app = game(
        "tumble-storm --integrator split,rk4,engine-newton,semi-implicit-euler,explicit-euler",
    );
    // Ten steps per frame.
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(10));
    let mut kept = Vec::new();
    for minute in 0..10 {
        play(&mut app, 360);
        if minute % 3 == 0 {
            ask(&mut app, push(DVec3::Y, true));
        }
        kept.push(run(&app).kept());
        for track in [&run(&app).main_box.track, &run(&app).comparisons[0].track] {
            for window in [None, Some(60.0)] {
                let points = track.series.points(Quantity::Energy, window).len();
                assert!(points <= 3700, "{points}");
            }
        }
    }
    assert!(run(&app).clock > 599.0);
    // 5 tracks of 3700 samples and 1024 stretches, plus lines and checkpoints.
    let most = 5 * (3700 + 1024) + 512 + 240;
    assert!(kept.iter().all(|k| *k <= most), "{kept:?}");
}

/// In the scene of 2012 its integrator moves the main box alone. The comparisons are independent of it and
/// receive the same pushes. Its error appears only in the main box.
#[test]
fn the_integrator_of_2012_moves_only_the_main_box() {
    let mut app = game("dissertation-2012 --integrator split,rk4,exact");
    play(&mut app, 20);
    ask(&mut app, push(DVec3::X, false));
    play(&mut app, 20);
    let mass = session(&app).setup().body.mass();
    let [rk4, exact] = [Integrator::Rk4, Integrator::Exact].map(|i| compared(&app, i));
    // A parabola with the push, as the closed form has it.
    assert!((rk4.position - exact.position).length() < 1e-9);
    let strength = session(&app).parameters.impulse;
    assert!((rk4.velocity.x - strength / mass).abs() < 1e-9);
    let fallen = -9.81 * run(&app).clock;
    assert!((rk4.velocity.y - fallen).abs() < 1e-6, "{}", rk4.velocity.y);
    for r in &run(&app).comparisons {
        assert!(r.track.now.worst.0 < 1e-9, "{}", r.integrator());
    }
    // It falls at 9.81 m/s from the start, so the difference is three meters by now.
    assert!(run(&app).main_box.track.now.worst.0 > 1.0);
    // The library's integrator continues from the current state of the box. The comparisons follow, and all
    // values are correct again.
    ask(&mut app, Action::SetDemo(None));
    compare(&mut app, CompareAction::Resync);
    play(&mut app, 10);
    let apart = main_box(&mut app).position - compared(&app, Integrator::Rk4).position;
    assert!(apart.length() < 1e-9, "{apart}");
}

/// The first run: `dzhanibekov`, the main box, two comparisons and the drawer on Energy. Within five seconds
/// at 60 Hz a visible error appears.
#[test]
fn the_first_run_shows_something_in_five_seconds() {
    let mut app = game("");
    app.update();
    assert_eq!(run(&app).comparisons.len(), 2);
    assert_eq!(session(&app).scenario.id, "dzhanibekov");
    assert_eq!(session(&app).plot, Plot::Energy);
    let comparison = app.world().resource::<Comparison>();
    assert_eq!(comparison.settings.layout, Layout::Overlaid);
    play(&mut app, 300);
    let worst = run(&app).main_box.track.now.worst;
    assert!(worst.1 < 1.0, "the main box is right");
    for r in &run(&app).comparisons {
        assert!(r.track.now.worst.1 > 45.0, "{}", r.integrator());
    }
    let drift = |r: &Runner| r.track.now.sample.get(Quantity::Energy).abs();
    assert!(run(&app).comparisons.iter().any(|r| drift(r) > 0.1));
}

/// Keys: Shift + digit toggles a comparison; V and G cycle through the layouts.
#[test]
fn keys_of_the_comparison() {
    let mut app = game("throw --integrator split");
    press(&mut app, &[SHIFT]);
    // A key that types nothing triggers nothing.
    assert!(!app.world().contains_resource::<CsvLog>());
    assert!(!clock(&app).paused);
    press(&mut app, &[SHIFT, (KeyCode::Digit5, "%")]);
    let chosen = |app: &App| app.world().resource::<Comparison>().chosen().to_vec();
    assert!(chosen(&app).contains(&Integrator::Rk4));
    let layout = |app: &App| app.world().resource::<Comparison>().settings.layout;
    for (code, typed, expected) in [
        (KeyCode::KeyV, "v", Layout::SideBySide),
        (KeyCode::KeyV, "v", Layout::Views),
        (KeyCode::KeyG, "g", Layout::Solo),
        (KeyCode::KeyG, "g", Layout::Overlaid),
    ] {
        press(&mut app, &[(code, typed)]);
        assert_eq!(layout(&app), expected);
    }
}
