//! The game without a window: keys, actions, scenes and log run through the same systems as with a window.

use bevy::input::ButtonState;
use bevy::input::keyboard::{Key, KeyboardInput, NativeKey};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_game::action::{Action, Push};
use box_game::compare::sampling::IntegratorSamples;
use box_game::input::focus::UiFocus;
use box_game::parameters::Parameter;
use box_game::scene::library::SceneLibrary;
use box_game::scene::session::{MainBox, Session};
use box_physics::force::Gravity;
use box_physics::prelude::*;

mod playing;

use playing::{ask, game, log_rows, main_box};

fn key(app: &mut App, key_code: KeyCode, state: ButtonState) {
    let window = Entity::PLACEHOLDER;
    app.world_mut().write_message(KeyboardInput {
        key_code,
        logical_key: logical(key_code),
        state,
        text: None,
        repeat: false,
        window,
    });
}

/// The character of the key on a US keyboard.
fn logical(code: KeyCode) -> Key {
    let name = format!("{code:?}");
    let character = match code {
        KeyCode::Period => ".".to_owned(),
        KeyCode::BracketLeft => "[".to_owned(),
        KeyCode::BracketRight => "]".to_owned(),
        KeyCode::Minus => "-".to_owned(),
        KeyCode::Equal => "=".to_owned(),
        _ => match name.strip_prefix("Key").or(name.strip_prefix("Digit")) {
            Some(character) => character.to_lowercase(),
            None => return Key::Unidentified(NativeKey::Unidentified),
        },
    };
    Key::Character(character.into())
}

/// Presses and releases a key, with one update.
fn tap(app: &mut App, code: KeyCode) {
    key(app, code, ButtonState::Pressed);
    app.update();
    key(app, code, ButtonState::Released);
}

fn with(app: &mut App, modifier: KeyCode, code: KeyCode) {
    key(app, modifier, ButtonState::Pressed);
    tap(app, code);
    key(app, modifier, ButtonState::Released);
    app.update();
}

#[test]
fn the_clock_is_60_hz_by_default() {
    let app = game(&[]);
    let step = app.world().resource::<Time<Fixed>>().timestep();
    assert_eq!(step, Time::<Fixed>::from_hz(60.0).timestep());
}

#[test]
fn keys_push_along_the_box_s_own_axes() {
    for (code, direction) in [
        (KeyCode::KeyD, DVec3::X),
        (KeyCode::KeyA, DVec3::NEG_X),
        (KeyCode::KeyE, DVec3::Y),
        (KeyCode::KeyQ, DVec3::NEG_Y),
        (KeyCode::KeyS, DVec3::Z),
        (KeyCode::KeyW, DVec3::NEG_Z),
    ] {
        let mut app = game(&["dzhanibekov"]);
        app.insert_resource(GlobalIntegrator(Integrator::Rk4));
        let before = main_box(&mut app);
        tap(&mut app, code);
        let after = main_box(&mut app);
        // The scene's push changes the velocity by 1 m/s along the box's axis at that moment.
        let expected = before.rotation * direction;
        assert!(
            (after.velocity - before.velocity - expected).length() < 1e-12,
            "{code:?}"
        );
        assert!((after.angular_momentum_world() - before.angular_momentum_world()).length() < 1e-6);
    }
}

#[test]
fn shift_pushes_off_center_and_alt_along_the_world() {
    let mut app = game(&["dzhanibekov"]);
    let before = main_box(&mut app);
    with(&mut app, KeyCode::ShiftLeft, KeyCode::KeyD);
    let spun = main_box(&mut app);
    assert!((spun.angular_momentum_world() - before.angular_momentum_world()).length() > 0.1);
    let mut app = game(&["dzhanibekov"]);
    for _ in 0..100 {
        app.update();
    }
    let before = main_box(&mut app);
    with(&mut app, KeyCode::AltLeft, KeyCode::KeyD);
    assert!((main_box(&mut app).velocity - before.velocity - DVec3::X).length() < 1e-12);
}

#[test]
fn a_chord_within_one_slow_frame_counts() {
    let mut app = game(&["throw"]);
    for state in [ButtonState::Pressed, ButtonState::Released] {
        key(&mut app, KeyCode::ControlLeft, state);
        key(&mut app, KeyCode::KeyQ, state);
    }
    app.update();
    assert_eq!(app.should_exit(), Some(AppExit::Success));
}

#[test]
fn a_held_key_repeats_ten_times_a_second() {
    let mut app = game(&["dzhanibekov"]);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(
        std::time::Duration::from_millis(20),
    ));
    app.update();
    app.world_mut().resource_mut::<PhysicsClock>().paused = true;
    key(&mut app, KeyCode::KeyD, ButtonState::Pressed);
    // 1.01 s of frames: a push at once, and then every tenth of a second.
    for _ in 0..51 {
        app.update();
    }
    let events = app.world().resource::<Session>().events.clone();
    let pushes = events.iter().filter(|e| e.starts_with("push")).count();
    assert!((10..=11).contains(&pushes), "{pushes}");
}

#[test]
fn letters_go_to_the_focused_text_field() {
    let mut app = game(&["dzhanibekov"]);
    app.insert_resource(UiFocus {
        text: true,
        widget: true,
        pointer: false,
    });
    let before = main_box(&mut app);
    tap(&mut app, KeyCode::KeyD);
    tap(&mut app, KeyCode::KeyP);
    assert!((main_box(&mut app).velocity - before.velocity).length() < 1e-12);
    assert!(!app.world().resource::<PhysicsClock>().paused);
    // With a focused slider P still pauses, but the slider receives Space.
    app.insert_resource(UiFocus {
        text: false,
        widget: true,
        pointer: false,
    });
    tap(&mut app, KeyCode::Space);
    assert!(!app.world().resource::<PhysicsClock>().paused);
    tap(&mut app, KeyCode::KeyP);
    assert!(app.world().resource::<PhysicsClock>().paused);
}

#[test]
fn digits_switch_integrators_in_flight() {
    let mut app = game(&["throw"]);
    let digits = [
        KeyCode::Digit1,
        KeyCode::Digit2,
        KeyCode::Digit3,
        KeyCode::Digit4,
        KeyCode::Digit5,
    ];
    for (k, code) in digits.into_iter().enumerate() {
        tap(&mut app, code);
        assert_eq!(
            app.world().resource::<GlobalIntegrator>().0,
            box_scenarios::style::integrator_of_key(k as u8 + 1).expect("has a key")
        );
    }
}

#[test]
fn pause_and_single_step_are_exact_to_the_step() {
    let mut app = game(&["throw"]);
    tap(&mut app, KeyCode::Space);
    let (state, steps) = (
        main_box(&mut app),
        app.world().resource::<PhysicsClock>().steps(),
    );
    for _ in 0..5 {
        app.update();
    }
    assert_eq!(main_box(&mut app), state);
    // In the same frame, exactly one step.
    tap(&mut app, KeyCode::Period);
    assert_eq!(app.world().resource::<PhysicsClock>().steps(), steps + 1);
    let mut expected = state;
    let session = app.world().resource::<Session>();
    let setup = session.setup();
    let h = Time::<Fixed>::from_hz(60.0).timestep().as_secs_f64();
    let law = Gravity(setup.forces.gravity);
    Integrator::Split.step(
        &setup.body,
        &mut expected,
        &law,
        h,
        &mut IntegratorMemory::default(),
    );
    assert_eq!(main_box(&mut app), expected);
    with(&mut app, KeyCode::ShiftLeft, KeyCode::Period);
    assert_eq!(app.world().resource::<PhysicsClock>().steps(), steps + 11);
}

#[test]
fn restart_repeats_the_motion_bit_for_bit() {
    let mut app = game(&["throw"]);
    ask(&mut app, Action::Restart);
    let mut first = Vec::new();
    for _ in 0..50 {
        app.update();
        first.push(main_box(&mut app));
    }
    ask(&mut app, Action::Restart);
    for expected in first {
        app.update();
        assert_eq!(main_box(&mut app), expected);
    }
}

#[test]
fn parameters_are_live_or_restart_and_bad_ones_are_refused() {
    let mut app = game(&["playground"]);
    ask(&mut app, Action::Set(Parameter::Gravity, 1.5));
    assert_eq!(app.world().resource::<WorldGravity>().0, DVec3::NEG_Y * 1.5);
    ask(&mut app, Action::Set(Parameter::Restitution, 0.75));
    ask(&mut app, Action::Set(Parameter::Friction, 0.1));
    let floor = *app.world().resource::<Floor>();
    assert_eq!((floor.restitution, floor.friction), (0.75, 0.1));
    ask(&mut app, Action::Set(Parameter::LinearDrag, 0.5));
    let drag = app
        .world_mut()
        .query_filtered::<&LinearDrag, With<MainBox>>()
        .single(app.world())
        .map(|d| d.0);
    assert_eq!(drag.ok(), Some(0.5));
    ask(&mut app, Action::Set(Parameter::LinearDrag, 0.0));
    assert!(
        app.world_mut()
            .query::<&LinearDrag>()
            .iter(app.world())
            .next()
            .is_none(),
        "no drag, no drag work"
    );
    ask(&mut app, Action::Set(Parameter::Mass, 2.5));
    let mass = app
        .world_mut()
        .query_filtered::<&RigidBox, With<MainBox>>()
        .single(app.world())
        .map(RigidBox::mass);
    assert_eq!(mass.ok(), Some(2.5));
    for bad in [
        Action::Set(Parameter::Mass, -1.0),
        Action::Set(Parameter::Restitution, 2.0),
        Action::Set(Parameter::Gravity, f64::NAN),
        Action::Set(Parameter::HalfX, 0.0),
    ] {
        ask(&mut app, bad.clone());
        let said = app
            .world()
            .resource::<Session>()
            .notices
            .back()
            .cloned()
            .unwrap_or_default();
        assert!(said.contains("allowed:"), "{bad:?}: {said}");
    }
    ask(&mut app, Action::ResetParameters);
    let session = app.world().resource::<Session>();
    assert_eq!(session.parameters, session.defaults);
}

#[test]
fn step_and_substeps_change_live() {
    let mut app = game(&["throw"]);
    ask(&mut app, Action::Set(Parameter::Step, 1.0 / 120.0));
    ask(&mut app, Action::Set(Parameter::Substeps, 3.0));
    let steps = app.world().resource::<PhysicsClock>().steps();
    app.update();
    let clock = app.world().resource::<PhysicsClock>();
    assert_eq!(clock.steps(), steps + 3);
    assert!((clock.step() - 1.0 / 360.0).abs() < 1e-9);
}

#[test]
fn every_scene_starts_and_runs_with_every_integrator() {
    let mut app = game(&[]);
    // Built-in scenes and scenes from files.
    let scenes = app.world().resource::<SceneLibrary>().scenes().len();
    for _ in 0..scenes {
        tap(&mut app, KeyCode::BracketRight);
        for &integrator in Integrator::ALL {
            ask(&mut app, Action::SetIntegrator(integrator));
            app.update();
        }
        assert!(
            main_box(&mut app).is_valid(),
            "{}",
            app.world().resource::<Session>().scenario.id
        );
    }
    assert_eq!(
        app.world().resource::<Session>().scenario.id,
        "dzhanibekov",
        "once round"
    );
}

#[test]
fn more_boxes_can_be_loaded() {
    let mut app = game(&["load", "--boxes", "250"]);
    app.update();
    let boxes = app
        .world_mut()
        .query::<&RigidBox>()
        .iter(app.world())
        .count();
    assert_eq!(boxes, 250);
    ask(&mut app, Action::Set(Parameter::Boxes, 3.0));
    assert_eq!(
        app.world_mut()
            .query::<&RigidBox>()
            .iter(app.world())
            .count(),
        3
    );
}

#[test]
fn every_integrator_is_timed() {
    let mut app = game(&["throw"]);
    for _ in 0..2 * Integrator::ALL.len() {
        app.update();
    }
    let samples = app.world().resource::<IntegratorSamples>();
    for &i in Integrator::ALL {
        let (min, median, p95) = samples.statistics(i).expect("sampled");
        assert!(0.0 < min && min <= median && median <= p95, "{i}");
        assert!(samples.history(i).count() >= 1);
    }
}

#[test]
fn the_log_has_a_row_per_step_with_its_inputs() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("log.csv");
    let mut app = game(&["throw", "--log", path.to_str().expect("utf-8")]);
    app.update();
    ask(&mut app, Action::SetIntegrator(Integrator::Rk4));
    let push = Push {
        direction: DVec3::Y,
        world: true,
        off_center: false,
    };
    ask(&mut app, Action::Push(push));
    app.update();
    // The main box's rows; the comparisons have their own.
    let mut rows = log_rows(&mut app, &path);
    rows.retain(|r| r["trajectory"] == "0");
    assert_eq!(rows.len(), 4);
    let (time, event, error) = ("sim_t_s", "event", "pos_err_m");
    assert!(rows[1][event].contains("integrator rk4"));
    assert!(rows[2][event].contains("push 0.000 "));
    let h = Time::<Fixed>::from_hz(60.0).timestep().as_secs_f64();
    let first: f64 = rows[0][time].parse().expect("a number");
    let second: f64 = rows[1][time].parse().expect("a number");
    assert!((second - first - h).abs() < 1e-12);
    // The reference is known before and after the push, because it also receives the push.
    for row in &rows {
        assert!(row[error].parse::<f64>().expect("known") < 1e-9);
    }
}

#[test]
fn a_hitch_drops_time_and_reports_it() {
    let mut app = game(&["throw"]);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(
        std::time::Duration::from_millis(1250),
    ));
    let steps = app.world().resource::<PhysicsClock>().steps();
    app.update();
    let taken = app.world().resource::<PhysicsClock>().steps() - steps;
    assert!(
        taken <= 16,
        "{taken} steps of a sixtieth in a frame of a quarter second"
    );
    let dropped = app.world().resource::<Session>().dropped;
    assert!((dropped - 1.0).abs() < 1e-9, "{dropped}");
}

#[test]
fn it_ends_after_the_given_duration() {
    let mut app = game(&["throw", "--duration", "0.1"]);
    let mut updates = 0;
    while app.should_exit().is_none() && updates < 100 {
        app.update();
        updates += 1;
    }
    assert_eq!(app.should_exit(), Some(AppExit::Success));
    let t = app
        .world()
        .resource::<PhysicsClock>()
        .elapsed()
        .as_secs_f64();
    assert!((0.099..0.12).contains(&t), "{t}");
}

#[test]
fn the_log_stays_right_across_a_change_of_the_step() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("log.csv");
    let mut app = game(&["throw", "--log", path.to_str().expect("utf-8")]);
    for _ in 0..30 {
        app.update();
    }
    ask(&mut app, Action::Set(Parameter::Step, 1.0 / 120.0));
    ask(&mut app, Action::Set(Parameter::Substeps, 3.0));
    for _ in 0..30 {
        app.update();
    }
    let mut last = 0.0;
    let mut rows = 0;
    for row in log_rows(&mut app, &path) {
        if row["trajectory"] != "0" {
            continue;
        }
        let number = |name| row[name].parse::<f64>().expect("a number");
        assert!(number("sim_t_s") > last, "time goes on");
        last = number("sim_t_s");
        assert!(number("pos_err_m") < 1e-9, "at {last}");
        assert!(number("angmom_rel") < 1e-12);
        rows += 1;
    }
    assert!(rows >= 30 + 90);
    let clock = app.world().resource::<PhysicsClock>();
    assert!((clock.time() - last).abs() < 1e-12);
}

#[test]
fn a_restart_while_paused_shows_the_start() {
    let mut app = game(&["drop"]);
    for _ in 0..20 {
        app.update();
    }
    tap(&mut app, KeyCode::KeyP);
    ask(&mut app, Action::Set(Parameter::Mass, 2.0));
    app.update();
    let (transform, state, aabb) = app
        .world_mut()
        .query_filtered::<(&Transform, &BodyState, &WorldAabb), With<MainBox>>()
        .single(app.world())
        .expect("one main box");
    assert_eq!(transform.translation, state.position.as_vec3());
    assert!(transform.translation.y > 0.5);
    assert!(f64::from(aabb.0.min.y) > 0.0 && f64::from(aabb.0.max.y) > state.position.y);
    let run = app.world().resource::<Session>().run_id();
    ask(&mut app, Action::Restart);
    assert_ne!(app.world().resource::<Session>().run_id(), run);
}

#[test]
fn the_reference_includes_parameters_unless_changed_in_flight() {
    let mut app = game(&["throw", "--boxes", "5"]);
    assert!(
        app.world().resource::<Session>().truth.is_some(),
        "load does not disturb it"
    );
    ask(&mut app, Action::Set(Parameter::Gravity, 3.0));
    assert!(
        app.world().resource::<Session>().truth.is_none(),
        "changed in flight"
    );
    ask(&mut app, Action::Restart);
    app.update();
    let session = app.world().resource::<Session>();
    let clock = app.world().resource::<PhysicsClock>();
    let truth = session.truth.as_ref().expect("from the start");
    let reference = truth.at(clock.time()).expect("closed form");
    let now = main_box(&mut app);
    assert!((now.position - reference.position).length() < 1e-9);
}

/// The window's exit code sees a comparison that diverges, and the main box, not the quarantined alone.
#[test]
fn fail_on_divergence_sees_every_trajectory() {
    for integrators in [
        "split,semi-implicit-euler",
        "semi-implicit-euler,split",
        "split,exact",
    ] {
        let mut app = game(&[
            "needle",
            "--integrator",
            integrators,
            "--fail-on-divergence",
            "--duration",
            "3",
        ]);
        let mut updates = 0;
        while app.should_exit().is_none() && updates < 1000 {
            app.update();
            updates += 1;
        }
        let expected = if integrators == "split,exact" {
            AppExit::Success
        } else {
            AppExit::from_code(3)
        };
        assert_eq!(app.should_exit(), Some(expected), "{integrators}");
    }
}

/// The law of restitution reaches the plugin and every comparison, live.
#[test]
fn the_law_of_restitution_is_a_parameter() {
    let mut app = game(&["bounce", "--set", "restitution-law=newton"]);
    let law = |app: &App| app.world().resource::<ContactSettings>().restitution;
    assert_eq!(law(&app), RestitutionLaw::Newton);
    ask(&mut app, Action::Set(Parameter::RestitutionLaw, 0.0));
    app.update();
    assert_eq!(law(&app), RestitutionLaw::Energetic);
    ask(&mut app, Action::Set(Parameter::RestitutionLaw, 1.0));
    app.update();
    let comparison = app.world().resource::<box_game::compare::Comparison>();
    let run = comparison.run.as_ref().expect("a run");
    assert_eq!(run.law.settings.restitution, RestitutionLaw::Newton);
}
