//! Hints, the search for a scene, the strip of 2012, scene errors, the last rung of the reset ladder.

use bevy_egui::egui::{Event, Key};
use box_scenarios::Scenario;
use box_scenarios::dissertation::Stepper;

use super::{Person, TALL, demo, id_of, sample_view, with};
use crate::action::{Action, Plot};
use crate::parameters::Parameters;
use crate::ui::panel::PanelMemory;

#[test]
fn the_lesson_says_what_to_try() {
    let person = with(|view| view.scenario.hints = ["Press [Push +x].", "Drop it."]);
    assert!(person.sees("Try: Press Push +x.  ·  Drop it."));
    assert!(!with(|_| {}).sees_part("Try:"));
}

/// Every hint of every scene names a control, in brackets, that is on the panel under this name: a widget, a slider
/// with its unit, or a figure to read. One that is in a closed section comes after the section's name.
#[test]
fn every_hint_names_a_control() {
    for scene in Scenario::ALL.iter().map(|build| build()) {
        let names = |all_open| {
            let names = [Plot::Error, Plot::WorkPrecision].map(|plot| {
                let mut view = sample_view();
                view.parameters = Parameters::of(&scene);
                view.plot = plot;
                view.demo = (scene.id == crate::demo_2012::SCENE).then(demo);
                let memory = PanelMemory {
                    all_open,
                    ..PanelMemory::default()
                };
                let person = Person::remembering(memory, view, TALL);
                let names = person.nodes().into_iter().map(|(_, name, _)| name);
                names.collect::<Vec<_>>()
            });
            names.concat()
        };
        let (at_first, opened) = (names(false), names(true));
        for hint in scene.hints {
            let named = format!("{}: '{hint}'", scene.id);
            let controls: Vec<&str> = hint.split(['[', ']']).skip(1).step_by(2).collect();
            assert!(!controls.is_empty(), "{named} names no control");
            let mut section = false;
            for control in controls {
                let with_unit = format!("{control} [");
                let is_it = |n: &String| n == control || n.starts_with(&with_unit);
                let seen = at_first.iter().any(is_it);
                let there = seen || section && opened.iter().any(is_it);
                assert!(there, "{named}: no control '{control}'");
                section |= ["Add or switch", "NOW", "LOAD"].contains(&control);
            }
        }
    }
}

#[test]
fn words_arrows_and_enter_choose_a_scene() {
    for (words, scene) in [(Some("dzh"), "dzhanibekov"), (None, "throw")] {
        let mut person = with(|view| view.show_picker = true);
        if let Some(words) = words {
            person.harness.event(Event::Text(words.to_owned()));
            person.look();
            let card = |id: &str| id_of(&Action::SelectScene(id.into()));
            assert!(person.has(&card("dzhanibekov")) && !person.has(&card("playground")));
            assert!(person.sees_part("flips every few seconds."));
        } else {
            person.harness.key_press(Key::ArrowDown);
            person.look();
        }
        person.harness.key_press(Key::Enter);
        let asked = person.asked();
        let wanted = Action::SelectScene(scene.into());
        assert_eq!(asked.first(), Some(&wanted), "{asked:?}");
    }
}

#[test]
fn the_strip_of_2012_chooses_a_stepper_and_says_what_is_wrong() {
    let mut person = with(|view| view.demo = Some(demo()));
    person.sees_all(&[Stepper::Heun.fault(), "Now: gravity sets", "9.81 m/s"]);
    person.asks_for([
        Action::SetDemo(Some(Stepper::Rk4)),
        Action::ToggleDemoLog,
        Action::SetDemo(None),
    ]);
    let chosen = Action::SetDemo(Some(Stepper::Heun));
    assert_eq!(person.click_on(chosen), [], "it is chosen");
    let mut demo = demo();
    demo.stepper = None;
    let person = with(|view| view.demo = Some(demo));
    assert!(person.sees_part("pushes add up") && !person.sees_part("9.81 m/s"));
}

#[test]
fn errors_of_scene_files_stay_in_the_window() {
    let error = "assets/scenes/a.ron:6:9: body.mass: must be positive";
    let person = with(|view| view.scene_errors = vec![error.into()]);
    assert!(person.sees_part(error));
}

#[test]
fn everything_is_reset_only_when_sure() {
    let mut person = with(|view| view.show_help = true);
    for own in ["reset everything", "no", "reset everything"] {
        assert_eq!(person.click(own), []);
    }
    person.asks_for([Action::ResetEverything, Action::SetUiScale(1.5)]);
}

#[test]
fn a_notice_goes_by_itself_and_the_lesson_stays() {
    let mut person = with(|view| view.notices = vec!["screenshot: a.png".into()]);
    assert!(person.sees("screenshot: a.png"));
    // Steps of a quarter of a second or less, for half a minute.
    let mut steps = 0;
    while person.sees("screenshot: a.png") && steps < 200 {
        person.look();
        steps += 1;
    }
    assert!((3..200).contains(&steps), "{steps}");
    assert!(person.sees_part("Press D to push it"));
}

#[test]
fn lesson_and_notice_stay_until_dismissed() {
    let notices = ["saved a.png", "cannot write b.csv"].map(str::to_owned);
    let mut person = with(|view| view.notices = notices.into());
    let lesson = person.view().scenario.lesson;
    let (saved, failed) = ("saved a.png", "cannot write b.csv");
    assert!(person.sees(lesson) && person.sees(failed) && !person.sees(saved));
    assert_eq!(person.click("Dismiss lesson"), []);
    assert_eq!(person.click("Dismiss notice"), []);
    assert!(!person.sees(lesson) && !person.sees(failed));

    // Another scene has another lesson; the same notice again is news.
    person.view().scenario.id = "throw";
    person.view().notices.push(failed.into());
    person.look();
    assert!(person.sees(lesson) && person.sees(failed));
}
