//! Mapping of keys to actions.
//!
//! Keys whose position matters (WASDQE, digits 1 to 9) are read by their position on the keyboard. All others are read
//! by the character that they type, so they match the labels of any layout.

use bevy::input::keyboard::{Key, KeyCode};
use bevy::prelude::*;
use box_physics::prelude::DVec3;
use box_scenarios::style::integrator_of_key;

use super::UiFocus;
use crate::action::compare::CompareAction;
use crate::action::{Action, Actions, Push};
use crate::interaction::grab::Grip;
use crate::platform;
use crate::scene::session::Session;

/// Interval at which a held push repeats \[s\].
const REPEAT: f32 = 0.1;

const PUSHES: [(KeyCode, DVec3); 6] = [
    (KeyCode::KeyD, DVec3::X),
    (KeyCode::KeyA, DVec3::NEG_X),
    (KeyCode::KeyE, DVec3::Y),
    (KeyCode::KeyQ, DVec3::NEG_Y),
    (KeyCode::KeyS, DVec3::Z),
    (KeyCode::KeyW, DVec3::NEG_Z),
];

const DIGITS: [KeyCode; 9] = [
    KeyCode::Digit1,
    KeyCode::Digit2,
    KeyCode::Digit3,
    KeyCode::Digit4,
    KeyCode::Digit5,
    KeyCode::Digit6,
    KeyCode::Digit7,
    KeyCode::Digit8,
    KeyCode::Digit9,
];

pub(super) fn read_keys(
    (keys, characters): (Res<ButtonInput<KeyCode>>, Res<ButtonInput<Key>>),
    focus: Res<UiFocus>,
    time: Res<Time<Real>>,
    session: Res<Session>,
    grip: Res<Grip>,
    mut actions: ResMut<Actions>,
    mut held: Local<[f32; 6]>,
) {
    let actions = &mut actions.0;
    // A whole chord may begin and end within one slow frame.
    let held_down = |any: &[KeyCode]| {
        let mut any = any.iter().copied();
        any.any(|key| keys.pressed(key) || keys.just_pressed(key))
    };
    let shift = held_down(&[KeyCode::ShiftLeft, KeyCode::ShiftRight]);
    // Command on a Mac.
    let command = held_down(&[KeyCode::SuperLeft, KeyCode::SuperRight]);
    let control = command || held_down(&[KeyCode::ControlLeft, KeyCode::ControlRight]);
    let alt = held_down(&[KeyCode::AltLeft, KeyCode::AltRight]);
    // Any of these characters was typed (a letter in either case).
    let typed = |wanted: &str| {
        characters.get_just_pressed().any(|key| match key {
            // Every text contains the empty one, which some keys type.
            Key::Character(c) => !c.is_empty() && wanted.contains(c.to_lowercase().as_str()),
            _ => false,
        })
    };

    let steps = if shift { 10 } else { 1 };
    let free = !control && !focus.text;
    // A focused widget receives the keys that move within it.
    let moves = free && !focus.widget;
    let named = [
        (KeyCode::F1, Action::ToggleHelp, true),
        (KeyCode::KeyQ, Action::Quit, control),
        (KeyCode::KeyO, Action::TogglePicker, control),
        (KeyCode::Backspace, Action::Restart, free),
        (KeyCode::Home, Action::HomeCamera, free),
        (KeyCode::Space, Action::TogglePause, moves),
        (KeyCode::ArrowRight, Action::Step(steps), moves),
        (KeyCode::ArrowLeft, Action::StepBack(steps), moves),
    ];
    let screenshot = platform::SCREENSHOT_KEY.map(|key| (key, Action::Screenshot, true));
    for (key, action, on) in named.into_iter().chain(screenshot) {
        if on && keys.just_pressed(key) {
            actions.push(action);
        }
    }
    if control {
        // A text field has a separate undo.
        if !focus.text && typed("yz") {
            let redo = shift || typed("y");
            actions.push(if redo { Action::Redo } else { Action::Undo });
        }
        return;
    }
    if keys.just_pressed(KeyCode::Escape) {
        // Closes the topmost overlay.
        if session.show_picker {
            actions.push(Action::TogglePicker);
        } else if session.show_help {
            actions.push(Action::ToggleHelp);
        } else if grip.0.is_some() {
            actions.push(Action::Grab(None));
        }
    }
    if focus.text {
        return;
    }
    for (k, (key, direction)) in PUSHES.into_iter().enumerate() {
        if keys.just_pressed(key) {
            held[k] = 0.0;
        } else if keys.pressed(key) {
            held[k] += time.delta_secs();
            if held[k] < REPEAT {
                continue;
            }
            // At most one per frame, even after a slow frame.
            held[k] = (held[k] - REPEAT).min(REPEAT);
        } else {
            continue;
        }
        actions.push(Action::Push(Push {
            direction,
            world: alt,
            off_center: shift,
        }));
    }
    // A digit key is read by its position, except with AltGr: [ is AltGr + 8 on a German keyboard.
    let alt_gr = held_down(&[KeyCode::AltRight]);
    let digit = DIGITS.iter().position(|key| keys.just_pressed(*key));
    let digit = digit.filter(|_| !alt_gr).map(|k| k as u8 + 1);
    if let Some(integrator) = digit.and_then(integrator_of_key) {
        actions.push(if shift {
            Action::Compare(CompareAction::ToggleComparison(integrator))
        } else {
            Action::SetIntegrator(integrator)
        });
    }
    for (characters, action) in [
        ("p", Action::TogglePause),
        // With Shift the key types another character: > on a US keyboard, : on a German one.
        (if shift { ".>:" } else { "." }, Action::Step(steps)),
        (if shift { ",<;" } else { "," }, Action::StepBack(steps)),
        ("r", Action::Restart),
        ("-", Action::Slower),
        ("=", Action::Faster),
        ("0", Action::SetSpeed(1.0)),
        ("[", Action::PreviousScene),
        ("]", Action::NextScene),
        ("b", Action::ToggleAabb),
        ("c", Action::ToggleContacts),
        ("x", Action::ToggleAxes),
        ("l", Action::ToggleLog),
        ("m", Action::TogglePlots),
        ("`", Action::TogglePanel),
        ("g", Action::Compare(CompareAction::ToggleComparisons)),
        ("v", Action::Compare(CompareAction::NextLayout)),
        ("f", Action::FrameCamera),
        ("?", Action::ToggleHelp),
    ] {
        if digit.is_none() && typed(characters) {
            actions.push(action);
        }
    }
}
