//! The game without a window: keys, actions, scenes and log run through the same systems as with a window.

use bevy::prelude::*;
use box_game::action::Action;
use box_game::compare::sampling::IntegratorSamples;
use box_game::parameters::Parameter;
use box_game::scene::library::SceneLibrary;
use box_physics::prelude::*;

#[path = "game/keyboard.rs"]
mod keyboard;
mod playing;

use playing::{
    ask, clock, game, logged_game, main_box, notice, of_main_box, play, play_to_the_end, press,
    push, session,
};

fn count<C: Component>(app: &mut App) -> usize {
    app.world_mut().query::<&C>().iter(app.world()).count()
}

#[test]
fn restart_repeats_the_motion_bit_for_bit() {
    let mut app = game("throw");
    let [first, second] = [(); 2].map(|()| {
        ask(&mut app, Action::Restart);
        let mut next = || {
            app.update();
            main_box(&mut app)
        };
        [(); 50].map(|()| next())
    });
    assert_eq!(first, second);
}

#[test]
fn parameters_are_live_or_restart_and_bad_ones_are_refused() {
    let mut app = game("playground");
    ask(&mut app, Action::Set(Parameter::Gravity, 1.5));
    assert_eq!(app.world().resource::<WorldGravity>().0, DVec3::NEG_Y * 1.5);
    ask(&mut app, Action::Set(Parameter::Restitution, 0.75));
    ask(&mut app, Action::Set(Parameter::Friction, 0.1));
    let floor = *app.world().resource::<Floor>();
    assert_eq!((floor.restitution, floor.friction), (0.75, 0.1));
    ask(&mut app, Action::Set(Parameter::LinearDrag, 0.5));
    assert_eq!(of_main_box::<LinearDrag>(&mut app).0, 0.5);
    ask(&mut app, Action::Set(Parameter::LinearDrag, 0.0));
    assert_eq!(count::<LinearDrag>(&mut app), 0, "no drag, no drag work");
    ask(&mut app, Action::Set(Parameter::Mass, 2.5));
    assert_eq!(of_main_box::<RigidBox>(&mut app).mass(), 2.5);
    for (parameter, bad) in [
        (Parameter::Mass, -1.0),
        (Parameter::Restitution, 2.0),
        (Parameter::Gravity, f64::NAN),
        (Parameter::HalfX, 0.0),
    ] {
        ask(&mut app, Action::Set(parameter, bad));
        let said = notice(&app);
        assert!(said.contains("allowed:"), "{parameter:?} {bad}: {said}");
    }
    ask(&mut app, Action::ResetParameters);
    let session = session(&app);
    assert_eq!(session.parameters, session.defaults);
}

#[test]
fn step_and_substeps_change_live() {
    let mut app = game("throw");
    let step = app.world().resource::<Time<Fixed>>().timestep();
    assert_eq!(step, Time::<Fixed>::from_hz(60.0).timestep(), "at first");
    ask(&mut app, Action::Set(Parameter::Step, 1.0 / 120.0));
    ask(&mut app, Action::Set(Parameter::Substeps, 3.0));
    let steps = clock(&app).steps();
    app.update();
    let clock = clock(&app);
    assert_eq!(clock.steps(), steps + 3);
    assert!((clock.step() - 1.0 / 360.0).abs() < 1e-9);
}

#[test]
fn every_scene_starts_and_runs_with_every_integrator() {
    let mut app = game("");
    // Built-in scenes and scenes from files.
    let scenes = app.world().resource::<SceneLibrary>().scenes().len();
    for _ in 0..scenes {
        press(&mut app, &[(KeyCode::BracketRight, "]")]);
        for &integrator in Integrator::ALL {
            ask(&mut app, Action::SetIntegrator(integrator));
            app.update();
        }
        let valid = main_box(&mut app).is_valid();
        assert!(valid, "{}", session(&app).scenario.id);
    }
    assert_eq!(session(&app).scenario.id, "dzhanibekov", "once round");
}

#[test]
fn more_boxes_can_be_loaded() {
    let mut app = game("load --boxes 250");
    app.update();
    assert_eq!(count::<RigidBox>(&mut app), 250);
    ask(&mut app, Action::Set(Parameter::Boxes, 3.0));
    assert_eq!(count::<RigidBox>(&mut app), 3);
}

#[test]
fn every_integrator_is_timed() {
    let mut app = game("throw");
    // Each integrator needs two samples, of which the first is dropped; a frame has time for at least one.
    play(&mut app, 2 * Integrator::ALL.len());
    let samples = app.world().resource::<IntegratorSamples>();
    for &i in Integrator::ALL {
        let cost = samples.cost(i).expect("sampled");
        let ordered = cost.min <= cost.median && cost.median <= cost.p95;
        assert!(0.0 < cost.min && ordered, "{i}");
        assert!(samples.history(i).count() >= 1);
    }
}

#[test]
fn the_log_has_a_row_per_step_with_its_inputs() {
    let (mut app, log) = logged_game("throw");
    app.update();
    ask(&mut app, Action::SetIntegrator(Integrator::Rk4));
    ask(&mut app, push(DVec3::Y, false));
    app.update();
    // The rows of the main box; the comparisons have separate rows.
    let mut rows = log.rows(&mut app);
    rows.retain(|r| r["trajectory"] == "0");
    assert_eq!(rows.len(), 4);
    assert!(rows[1]["event"].contains("integrator rk4"));
    assert!(rows[2]["event"].contains("push 0.000 "));
    let number = |k: usize, column| rows[k][column].parse::<f64>().expect("a number");
    let h = Time::<Fixed>::from_hz(60.0).timestep().as_secs_f64();
    assert!((number(1, "sim_t_s") - number(0, "sim_t_s") - h).abs() < 1e-12);
    // The reference is known before and after the push, because it also receives the push.
    assert!((0..4).all(|k| number(k, "pos_err_m") < 1e-9));
}

#[test]
fn it_ends_after_the_given_duration() {
    let mut app = game("throw --duration 0.1");
    assert_eq!(play_to_the_end(&mut app, 100), Some(AppExit::Success));
    let t = clock(&app).elapsed().as_secs_f64();
    assert!((0.099..0.12).contains(&t), "{t}");
}

#[test]
fn the_log_stays_right_across_a_change_of_the_step() {
    let (mut app, log) = logged_game("throw");
    play(&mut app, 30);
    ask(&mut app, Action::Set(Parameter::Step, 1.0 / 120.0));
    ask(&mut app, Action::Set(Parameter::Substeps, 3.0));
    play(&mut app, 30);
    let mut last = 0.0;
    let mut rows = log.rows(&mut app);
    rows.retain(|row| row["trajectory"] == "0");
    for row in &rows {
        let number = |name| row[name].parse::<f64>().expect("a number");
        assert!(number("sim_t_s") > last, "time goes on");
        last = number("sim_t_s");
        assert!(number("pos_err_m") < 1e-9, "at {last}");
        assert!(number("angmom_rel") < 1e-12);
    }
    assert!(rows.len() >= 30 + 90);
    assert!((clock(&app).time() - last).abs() < 1e-12);
}

#[test]
fn a_restart_while_paused_shows_the_start() {
    let mut app = game("drop");
    play(&mut app, 20);
    ask(&mut app, Action::TogglePause);
    ask(&mut app, Action::Set(Parameter::Mass, 2.0));
    app.update();
    let position = main_box(&mut app).position;
    let shown = of_main_box::<Transform>(&mut app).translation;
    assert_eq!(shown, position.as_vec3());
    assert!(shown.y > 0.5);
    let aabb = of_main_box::<WorldAabb>(&mut app).0;
    assert!(aabb.min.y > 0.0 && f64::from(aabb.max.y) > position.y);
    let run = session(&app).run_id();
    ask(&mut app, Action::Restart);
    assert_ne!(session(&app).run_id(), run);
}

#[test]
fn the_reference_includes_parameters_unless_changed_in_flight() {
    let mut app = game("throw --boxes 5");
    assert!(session(&app).truth.is_some(), "load does not disturb it");
    ask(&mut app, Action::Set(Parameter::Gravity, 3.0));
    assert!(session(&app).truth.is_none(), "changed in flight");
    ask(&mut app, Action::Restart);
    app.update();
    let truth = session(&app).truth.as_ref().expect("from the start");
    let reference = truth.at(clock(&app).time()).expect("closed form");
    let now = main_box(&mut app);
    assert!((now.position - reference.position).length() < 1e-9);
}

/// The exit code of the window includes a diverged comparison or main box, not only quarantined bodies.
#[test]
fn fail_on_divergence_sees_every_trajectory() {
    for (integrators, expected) in [
        ("split,semi-implicit-euler", AppExit::from_code(3)),
        ("semi-implicit-euler,split", AppExit::from_code(3)),
        ("split,exact", AppExit::Success),
    ] {
        let line = format!("needle --integrator {integrators} --fail-on-divergence --duration 3");
        let exit = play_to_the_end(&mut game(&line), 1000);
        assert_eq!(exit, Some(expected), "{integrators}");
    }
}

/// The restitution law reaches the plugin and every comparison, live.
#[test]
fn the_law_of_restitution_is_a_parameter() {
    let mut app = game("bounce --set restitution-law=newton");
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
