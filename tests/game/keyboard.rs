//! Keys.

use bevy::input::ButtonState;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_game::input::UiFocus;
use box_physics::force::Gravity;
use box_physics::prelude::*;

use super::playing::{SHIFT, clock, game, integrator, key, main_box, play, press, session};

const D: (KeyCode, &str) = (KeyCode::KeyD, "d");
const P: (KeyCode, &str) = (KeyCode::KeyP, "p");
const SPACE: (KeyCode, &str) = (KeyCode::Space, " ");
const PERIOD: (KeyCode, &str) = (KeyCode::Period, ".");

#[test]
fn keys_push_along_the_box_s_own_axes() {
    for (key, direction) in [
        (D, DVec3::X),
        ((KeyCode::KeyA, "a"), DVec3::NEG_X),
        ((KeyCode::KeyE, "e"), DVec3::Y),
        ((KeyCode::KeyQ, "q"), DVec3::NEG_Y),
        ((KeyCode::KeyS, "s"), DVec3::Z),
        ((KeyCode::KeyW, "w"), DVec3::NEG_Z),
    ] {
        let mut app = game("dzhanibekov --integrator rk4");
        let before = main_box(&mut app);
        press(&mut app, &[key]);
        let after = main_box(&mut app);
        // The scene's push changes the velocity by 1 m/s along the box's axis at that moment.
        let expected = before.rotation * direction;
        let change = after.velocity - before.velocity;
        assert!((change - expected).length() < 1e-12, "{key:?}");
        assert!((after.angular_momentum_world() - before.angular_momentum_world()).length() < 1e-6);
    }
}

#[test]
fn shift_pushes_off_center_and_alt_along_the_world() {
    let mut app = game("dzhanibekov");
    let before = main_box(&mut app);
    press(&mut app, &[SHIFT, D]);
    let spun = main_box(&mut app);
    assert!((spun.angular_momentum_world() - before.angular_momentum_world()).length() > 0.1);
    let mut app = game("dzhanibekov");
    play(&mut app, 100);
    let before = main_box(&mut app);
    press(&mut app, &[(KeyCode::AltLeft, ""), D]);
    assert!((main_box(&mut app).velocity - before.velocity - DVec3::X).length() < 1e-12);
}

#[test]
fn a_chord_within_one_slow_frame_counts() {
    for control in [KeyCode::ControlLeft, KeyCode::SuperRight] {
        let mut app = game("throw");
        for state in [ButtonState::Pressed, ButtonState::Released] {
            key(&mut app, control, "", state);
            key(&mut app, KeyCode::KeyQ, "q", state);
        }
        app.update();
        assert_eq!(app.should_exit(), Some(AppExit::Success), "{control:?}");
    }
}

#[test]
fn a_held_key_repeats_ten_times_a_second() {
    let mut app = game("dzhanibekov");
    let frame = std::time::Duration::from_millis(20);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    app.update();
    app.world_mut().resource_mut::<PhysicsClock>().paused = true;
    key(&mut app, KeyCode::KeyD, "d", ButtonState::Pressed);
    // 1.01 s of frames: a push at once, and then every tenth of a second.
    play(&mut app, 51);
    let events = session(&app).events.iter();
    let pushes = events.filter(|e| e.starts_with("push")).count();
    assert!((10..=11).contains(&pushes), "{pushes}");
}

#[test]
fn letters_go_to_the_focused_text_field() {
    let mut app = game("dzhanibekov");
    let focus = |text| UiFocus {
        text,
        widget: true,
        pointer: false,
    };
    app.insert_resource(focus(true));
    let before = main_box(&mut app);
    press(&mut app, &[D]);
    press(&mut app, &[P]);
    assert!((main_box(&mut app).velocity - before.velocity).length() < 1e-12);
    assert!(!clock(&app).paused);
    // With a focused slider P still pauses, but the slider receives Space.
    app.insert_resource(focus(false));
    press(&mut app, &[SPACE]);
    assert!(!clock(&app).paused);
    press(&mut app, &[P]);
    assert!(clock(&app).paused);
}

#[test]
fn digits_switch_integrators_in_flight() {
    let mut app = game("throw");
    for (code, digit) in [
        KeyCode::Digit1,
        KeyCode::Digit2,
        KeyCode::Digit3,
        KeyCode::Digit4,
        KeyCode::Digit5,
    ]
    .into_iter()
    .zip(1..)
    {
        press(&mut app, &[(code, &digit.to_string())]);
        let expected = box_scenarios::style::integrator_of_key(digit);
        assert_eq!(integrator(&app), expected.expect("has a key"));
    }
}

#[test]
fn pause_and_single_step_are_exact_to_the_step() {
    let mut app = game("throw");
    press(&mut app, &[SPACE]);
    let (state, steps) = (main_box(&mut app), clock(&app).steps());
    play(&mut app, 5);
    assert_eq!(main_box(&mut app), state);
    // In the same frame, exactly one step.
    press(&mut app, &[PERIOD]);
    assert_eq!(clock(&app).steps(), steps + 1);
    let mut expected = state;
    let setup = session(&app).setup();
    let h = Time::<Fixed>::from_hz(60.0).timestep().as_secs_f64();
    let (law, mut memory) = (Gravity(setup.forces.gravity), IntegratorMemory::default());
    Integrator::Split.step(&setup.body, &mut expected, &law, h, &mut memory);
    assert_eq!(main_box(&mut app), expected);
    press(&mut app, &[SHIFT, PERIOD]);
    assert_eq!(clock(&app).steps(), steps + 11);
}
