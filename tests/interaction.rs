//! Interaction, scene files, scripts, the 2012 scene and settings in the game without a window, and the
//! acceptance checks of the game by name.

use std::path::Path;
use std::process::{Command, Stdio};

use bevy::prelude::*;
use box_game::action::compare::CompareAction;
use box_game::action::{Action, Hold, Plot, Poke};
use box_game::cli::command_line;
use box_game::compare::Comparison;
use box_game::compare::sweep::SweepLine;
use box_game::demo_2012::Demo2012;
use box_game::interaction::grab::Grip;
use box_game::interaction::rewind::{MAX_TICKS, Rewind};
use box_game::interaction::undo::UndoStack;
use box_game::parameters::Parameter;
use box_game::preferences::{self, Preferences};
use box_game::scene::library::SceneLibrary;
use box_game::scene::session::MainBox;
use box_physics::force::Gravity;
use box_physics::prelude::*;
use box_scenarios::Scenario;
use box_scenarios::dissertation::{Demo, State, Stepper};

#[path = "interaction/acceptance.rs"]
mod acceptance;
#[path = "interaction/demo.rs"]
mod demo;
#[path = "interaction/files.rs"]
mod files;
mod playing;
#[path = "interaction/settings.rs"]
mod settings;

use playing::{
    CONTROL, SHIFT, ask, cli, clock, game, game_with_file, integrator, main_box, notice,
    of_main_box, play, play_to_the_end, press, push, request, session,
};

#[test]
fn a_poke_is_an_impulse_at_the_point_against_the_normal() {
    let mut app = game("dzhanibekov");
    play(&mut app, 20);
    ask(&mut app, Action::TogglePause);
    let before = main_box(&mut app);
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
    let (h, mut memory) = (clock(&app).step(), IntegratorMemory::default());
    Integrator::Split.step(&body, &mut expected, &Gravity(DVec3::ZERO), h, &mut memory);
    assert_eq!(main_box(&mut app), expected);
    let truth = &session(&app).truth;
    assert!(truth.is_none(), "the scene's answer knows no poke");
    // An invalid position only causes a message.
    let normal = DVec3::NAN;
    ask(&mut app, Action::Poke(Poke { normal, ..poke }));
    assert!(notice(&app).contains("must be finite"));
}

#[test]
fn a_grabbed_box_follows_the_pointer_until_released() {
    for (scene, integrator) in [
        ("playground", Integrator::Split),
        ("dzhanibekov", Integrator::Rk4),
        ("playground", Integrator::BackwardEuler),
    ] {
        let mut app = game(&format!("{scene} --integrator {integrator}"));
        let anchor = DVec3::new(0.5, 2.5, -0.5);
        let hold = Hold {
            body_point: DVec3::ZERO,
            anchor,
        };
        ask(&mut app, Action::Grab(Some(hold)));
        play(&mut app, 90);
        let state = main_box(&mut app);
        let near = (state.position - anchor).length() < 0.02;
        let slow = state.velocity.length() < 0.2;
        assert!(near && slow, "{scene} {integrator}: {state:?}");
        ask(&mut app, Action::Grab(None));
        assert_eq!(app.world().resource::<Grip>().0, None);
        if scene == "playground" {
            play(&mut app, 120);
            assert!(main_box(&mut app).position.y < 0.8, "it falls again");
        }
        // A restart releases the grab.
        ask(&mut app, Action::Grab(Some(hold)));
        ask(&mut app, Action::Restart);
        assert_eq!(app.world().resource::<Grip>().0, None);
    }
}

#[test]
fn stepping_back_returns_every_state_and_the_future_repeats() {
    for (scene, integrator) in [
        ("contact", "split"),
        ("dzhanibekov", "exact"),
        ("tumble-storm", "rk4"),
        ("dissertation-2012", "split"),
    ] {
        let mut app = game(&format!("{scene} --integrator {integrator}"));
        let mut past = vec![main_box(&mut app)];
        while past.len() <= 80 {
            app.update();
            past.push(main_box(&mut app));
        }
        let (steps, time) = (clock(&app).steps(), clock(&app).elapsed());
        for back in 1..=30 {
            ask(&mut app, Action::StepBack(1));
            assert_eq!(main_box(&mut app), past[80 - back], "{scene}: {back} back");
            assert_eq!(clock(&app).steps(), steps - back as u64);
        }
        assert!(clock(&app).paused);
        ask(&mut app, Action::StepBack(10));
        assert_eq!(main_box(&mut app), past[40], "{scene}: ten at once");
        for (k, expected) in past.iter().enumerate().skip(41) {
            ask(&mut app, Action::Step(1));
            assert_eq!(main_box(&mut app), *expected, "{scene}: step {k}");
        }
        assert_eq!((clock(&app).steps(), clock(&app).elapsed()), (steps, time));
        // The displayed transform shows the state without a teleport.
        let shown = of_main_box::<Transform>(&mut app).translation;
        assert_eq!(shown, past[80].position.as_vec3());
    }
}

#[test]
fn the_past_is_bounded_and_ends_at_the_start() {
    let mut app = game("dzhanibekov");
    play(&mut app, MAX_TICKS + 50);
    assert_eq!(app.world().resource::<Rewind>().kept(), MAX_TICKS);
    ask(&mut app, Action::Restart);
    play(&mut app, 5);
    let start = session(&app).scenario.setup.initial;
    ask(&mut app, Action::StepBack(1000));
    assert_eq!(main_box(&mut app), start);
    assert_eq!(clock(&app).steps(), 0);
    ask(&mut app, Action::StepBack(1));
    assert!(notice(&app).contains("No earlier step is stored"));
    // Too many boxes to store: reported, not slow.
    let mut app = game("load --boxes 1500");
    play(&mut app, 3);
    assert_eq!(app.world().resource::<Rewind>().kept(), 0);
}

#[test]
fn parameters_and_resets_are_undone_and_redone() {
    let mut app = game("playground");
    let gravity = |app: &App| session(app).parameters.gravity;
    let undoes = |app: &App| app.world().resource::<UndoStack>().undoes();
    ask(&mut app, Action::Set(Parameter::Gravity, 1.0));
    ask(&mut app, Action::Set(Parameter::Friction, 0.25));
    ask(&mut app, Action::Set(Parameter::Gravity, 2.0));
    assert_eq!(undoes(&app), Some("Gravity"));
    press(&mut app, &[CONTROL, (KeyCode::KeyZ, "z")]);
    assert_eq!(gravity(&app), 1.0);
    let acts = app.world().resource::<WorldGravity>().0.y;
    assert_eq!(acts, -1.0, "at once");
    ask(&mut app, Action::Undo);
    let friction = app.world().resource::<Floor>().friction;
    assert_eq!(session(&app).defaults.friction, Some(friction));
    ask(&mut app, Action::Undo);
    assert_eq!(gravity(&app), 9.81);
    ask(&mut app, Action::Undo);
    for wanted in [1.0, 1.0, 2.0] {
        press(&mut app, &[CONTROL, SHIFT, (KeyCode::KeyZ, "Z")]);
        assert_eq!(gravity(&app), wanted);
    }
    // Dragging a slider is one change.
    for k in 0..20 {
        ask(&mut app, Action::Set(Parameter::LinearDrag, f64::from(k)));
    }
    ask(&mut app, Action::Undo);
    assert_eq!(session(&app).parameters.linear_drag, 0.0);
    // A new change clears the redo history.
    ask(&mut app, Action::Set(Parameter::Substeps, 4.0));
    assert_eq!(app.world().resource::<UndoStack>().redoes(), None);
    ask(&mut app, Action::Undo);
    assert_eq!(clock(&app).substeps, 1);
    ask(&mut app, Action::Set(Parameter::Mass, 7.0));
    ask(&mut app, Action::ResetParameters);
    ask(&mut app, Action::Undo);
    assert_eq!(session(&app).parameters.mass, 7.0);
    // Another scene clears the undo history of this one.
    ask(&mut app, Action::NextScene);
    assert_eq!(undoes(&app), None);
}

#[test]
fn an_undone_restart_continues() {
    let mut app = game("throw");
    play(&mut app, 40);
    ask(&mut app, Action::TogglePause);
    let (before, steps) = (main_box(&mut app), clock(&app).steps());
    ask(&mut app, Action::Restart);
    assert_ne!(main_box(&mut app), before);
    ask(&mut app, Action::Undo);
    assert_eq!(main_box(&mut app), before);
    assert_eq!(clock(&app).steps(), steps);
}

/// Switching to the integrator of a comparison swaps the two trajectories; undo swaps them back.
#[test]
fn an_undone_switch_of_the_integrator_keeps_every_comparison() {
    let mut app = game("throw --integrator split,rk4");
    play(&mut app, 20);
    ask(&mut app, Action::TogglePause);
    let before = main_box(&mut app);
    let compared = |app: &App| {
        let comparison = app.world().resource::<Comparison>();
        let run = comparison.run.as_ref().expect("a run");
        (run.main_box.integrator(), comparison.chosen().to_vec())
    };
    assert_eq!(compared(&app), (Integrator::Split, vec![Integrator::Rk4]));
    ask(&mut app, Action::SetIntegrator(Integrator::Rk4));
    assert_eq!(compared(&app), (Integrator::Rk4, vec![Integrator::Split]));
    assert_ne!(main_box(&mut app), before, "the other trajectory");
    ask(&mut app, Action::Undo);
    assert_eq!(compared(&app), (Integrator::Split, vec![Integrator::Rk4]));
    assert_eq!(main_box(&mut app), before);
}

/// A digit key acts by its position on layouts where it types another character. With AltGr it acts by its character.
#[test]
fn digits_and_symbols_do_not_collide_on_other_keyboards() {
    let mut app = game("throw --integrator split");
    let scene = session(&app).scenario.id;
    // AZERTY: the 6 key types a minus sign.
    press(&mut app, &[(KeyCode::Digit6, "-")]);
    let by_key = integrator(&app);
    assert_eq!(box_scenarios::style::integrator_of_key(6), Some(by_key));
    assert_eq!(session(&app).speed, 1.0);
    // German: AltGr + 8 types an opening bracket.
    press(&mut app, &[(KeyCode::AltRight, ""), (KeyCode::Digit8, "[")]);
    assert_eq!(integrator(&app), by_key);
    assert_ne!(session(&app).scenario.id, scene);
}

#[test]
fn the_reset_ladder_ends_with_everything() {
    let mut app = game("bounce --dt 1/120 --substeps 3 --integrator rk4");
    ask(&mut app, Action::Set(Parameter::Gravity, 1.0));
    ask(&mut app, Action::SetSpeed(0.25));
    ask(&mut app, Action::ToggleAabb);
    ask(&mut app, Action::SetUiScale(1.5));
    ask(&mut app, Action::ResetEverything);
    let now = session(&app);
    assert_eq!(now.scenario.id, Scenario::default().id);
    assert_eq!(now.parameters, now.defaults);
    assert_eq!(now.speed, 1.0);
    assert_eq!(integrator(&app), Integrator::default());
    assert_eq!(clock(&app).substeps, 1);
    let preferences = *app.world().resource::<Preferences>();
    assert_eq!(preferences, Preferences::default());
    let step = app.world().resource::<Time<Fixed>>().timestep();
    assert_eq!(step, Time::<Fixed>::from_hz(60.0).timestep());
}

#[test]
fn slow_motion_is_a_ladder_with_ends() {
    let mut app = game("throw --speed 0.5");
    let speed = app.world().resource::<Time<Virtual>>().relative_speed_f64();
    assert_eq!(speed, 0.5);
    for (times, action, speed) in [
        (1, Action::Slower, 0.25),
        (20, Action::Slower, 0.01),
        (20, Action::Faster, 4.0),
    ] {
        (0..times).for_each(|_| ask(&mut app, action.clone()));
        assert_eq!(session(&app).speed, speed);
    }
}
