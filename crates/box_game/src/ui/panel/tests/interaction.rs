//! Hints, undo, the search for a scene, the strip of 2012, scene errors, the last rung of the reset ladder.

use bevy_egui::egui::{Event, Key};
use box_scenarios::dissertation::Stepper;

use super::super::{DemoView, PanelView};
use super::{Person, TALL, id_of, sample_view};
use crate::action::{Action, Plot};
use crate::parameters::Parameters;
use box_scenarios::Scenario;

fn with(change: impl FnOnce(&mut PanelView)) -> Person {
    let mut view = sample_view();
    change(&mut view);
    Person::before(view, TALL)
}

#[test]
fn the_lesson_says_what_to_try() {
    let hints = ["Press [Push +x].".to_owned(), "Drop it.".to_owned()];
    let person = with(|view| view.hints = hints);
    assert!(person.sees("Try: Press Push +x.  ·  Drop it."));
    assert!(!with(|_| {}).sees_part("Try:"));
}

/// Every hint of every scene names a control, in brackets, that is on the panel under this name: a widget, a slider
/// with its unit, or a figure to read.
#[test]
fn every_hint_names_a_control() {
    for scene in Scenario::ALL.iter().map(|build| build()) {
        let mut names: Vec<String> = Vec::new();
        for plot in [Plot::Error, Plot::WorkPrecision] {
            let person = with(|view| {
                view.parameters = Parameters::of(&scene);
                view.plot = plot;
                view.demo = (scene.id == crate::demo_2012::SCENE).then_some(DemoView {
                    stepper: Some(Stepper::Heun),
                    cycle_us: 1.0,
                    log: None,
                });
            });
            names.extend(person.nodes().into_iter().map(|(_, name, _)| name));
        }
        for hint in scene.hints {
            let controls: Vec<&str> = hint.split(['[', ']']).skip(1).step_by(2).collect();
            assert!(
                !controls.is_empty(),
                "{}: '{hint}' names no control",
                scene.id
            );
            for control in controls {
                let with_unit = format!("{control} [");
                assert!(
                    names
                        .iter()
                        .any(|n| n == control || n.starts_with(&with_unit)),
                    "{}: '{hint}': no control is called '{control}'",
                    scene.id
                );
            }
        }
    }
}

#[test]
fn back_undo_and_redo_are_buttons() {
    let mut person = with(|view| view.undoes = Some("Gravity"));
    for action in [Action::Undo, Action::StepBack(1), Action::CopyCommandLine] {
        assert_eq!(person.click_on(action.clone()), [action]);
    }
    assert_eq!(
        person.click_on(Action::Redo),
        [],
        "there is nothing to redo"
    );
}

#[test]
fn words_and_enter_choose_a_scene() {
    let mut person = with(|view| view.show_picker = true);
    person.harness.event(Event::Text("dzh".to_owned()));
    person.look();
    let card = |id: &str| id_of(&Action::SelectScene(id.into()));
    assert!(person.has(&card("dzhanibekov")) && !person.has(&card("playground")));
    assert!(person.sees_part("turns over every few seconds."));
    person.harness.key_press(Key::Enter);
    let asked = person.asked();
    assert_eq!(
        asked.first(),
        Some(&Action::SelectScene("dzhanibekov".into())),
        "{asked:?}"
    );
}

#[test]
fn the_arrows_go_through_the_scenes_found() {
    let mut person = with(|view| view.show_picker = true);
    person.harness.key_press(Key::ArrowDown);
    person.look();
    person.harness.key_press(Key::Enter);
    let asked = person.asked();
    assert_eq!(
        asked.first(),
        Some(&Action::SelectScene("throw".into())),
        "{asked:?}"
    );
}

#[test]
fn the_strip_of_2012_chooses_a_stepper_and_says_what_is_wrong() {
    let mut demo = DemoView {
        stepper: Some(Stepper::Heun),
        cycle_us: 1.25,
        log: None,
    };
    let mut person = with(|view| view.demo = Some(demo.clone()));
    assert!(person.sees_part(Stepper::Heun.fault()) && person.sees_part("9.81 m/s"));
    for action in [
        Action::SetDemo(Some(Stepper::Rk4)),
        Action::ToggleDemoLog,
        Action::SetDemo(None),
    ] {
        assert_eq!(person.click_on(action.clone()), [action]);
    }
    let chosen = Action::SetDemo(Some(Stepper::Heun));
    assert_eq!(person.click_on(chosen), [], "it is chosen");
    demo.stepper = None;
    let person = with(|view| view.demo = Some(demo));
    assert!(person.sees_part("pushes add up") && !person.sees_part("9.81 m/s,"));
}

#[test]
fn errors_of_scene_files_stay_in_the_window() {
    let error = "assets/scenes/a.ron:6:9: body.mass: must be positive";
    let person = with(|view| view.scene_errors = vec![error.into()]);
    assert!(person.sees_part(error));
}

#[test]
fn everything_is_reset_only_when_sure() {
    let mut view = sample_view();
    view.show_help = true;
    let mut person = Person::before(view, TALL);
    assert_eq!(person.click("reset everything"), []);
    assert_eq!(person.click("no"), []);
    assert_eq!(person.click("reset everything"), []);
    for action in [Action::ResetEverything, Action::SetUiScale(1.5)] {
        assert_eq!(person.click_on(action.clone()), [action]);
    }
}

#[test]
fn a_notice_goes_by_itself_and_the_lesson_stays() {
    let mut view = sample_view();
    view.notices = vec!["picture: a.png".into()];
    let mut person = Person::before(view, TALL);
    assert!(person.sees("picture: a.png"));
    // Steps of a quarter of a second or less, for half a minute.
    let mut steps = 0;
    while person.sees("picture: a.png") && steps < 200 {
        person.look();
        steps += 1;
    }
    assert!((3..200).contains(&steps), "{steps}");
    assert!(person.sees_part("Press D to push it"));
}
