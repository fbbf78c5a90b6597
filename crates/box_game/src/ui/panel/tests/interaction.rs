//! Hints, the scene search, the strip of 2012, scene errors, confirmation of the full reset.

use std::path::Path;

use bevy_egui::egui::{Event, Key, accesskit::Role};
use box_scenarios::dissertation::Stepper;
use box_scenarios::{Scenario, scene_file};

use super::{Person, TALL, demo, id_of, sample_view, with};
use crate::action::compare::CompareAction;
use crate::action::{Action, Plot};
use crate::compare::{TrajectoryView, default_comparisons};
use crate::parameters::Parameters;
use crate::platform::SHIPPED;
use crate::ui::panel::PanelMemory;

#[test]
fn the_lesson_says_what_to_try() {
    let hints = ["Press [Push +x] or [Overlaid].", "Drop [it]."];
    let mut person = with(|view| view.scenario.hints = hints);
    // A control's name does not wrap.
    assert!(person.sees("Try: Press Push\u{a0}+x or Overlaid.  ·  Drop it."));
    let push = person.click("push +x");
    assert_eq!((person.click("hint Push +x"), push.len()), (push, 1));
    assert_eq!(person.click("hint Overlaid"), [], "already so");
    assert!(!person.has("hint it"), "no control");
    assert!(!with(|_| {}).sees_part("Try:"));
}

/// Every hint of every scene names a control in brackets, and requests the action of that control. A control of that
/// name must be on the panel. The name of a number shows it, or sets it to the value after the name. While the scene
/// has its initial comparisons and another tab is open, every button has an effect.
#[test]
fn every_hint_does_what_it_names() {
    let built_in = Scenario::ALL.iter().map(|build| (build(), true));
    let files = SHIPPED.iter().filter(|(path, _)| path.contains("/scenes/"));
    let files = files.map(|(path, text)| {
        let scene = scene_file::parse(Path::new(path), text);
        (scene.expect("a scene"), false)
    });
    for (scene, built_in) in built_in.chain(files) {
        let mut person = with(|view| {
            view.parameters = Parameters::of(&scene);
            view.plot = Plot::Table;
            view.demo = (scene.id == crate::demo_2012::SCENE).then(demo);
            let trajectories = &mut view.compare.trajectories;
            trajectories.truncate(1);
            let main_box = trajectories[0].clone();
            let others = default_comparisons(&scene, main_box.integrator);
            trajectories.extend(others.map(|integrator| TrajectoryView {
                integrator,
                main_box: false,
                ..main_box.clone()
            }));
        });
        let mut count = 0;
        for hint in scene.hints {
            person.view().scenario.hints = [hint, ""];
            person.look();
            let names: Vec<&str> = hint.split(['[', ']']).skip(1).step_by(2).collect();
            assert!(!built_in || !names.is_empty(), "{}: '{hint}'", scene.id);
            for name in names {
                count += 1;
                let at = format!("{}: '{hint}': '{name}'", scene.id);
                assert!(person.has(&format!("hint {name}")), "{at}");
                let asked = person.click(&format!("hint {name}"));
                let marked = person.harness.state_mut().memory.marked.take();
                if let Some((marked, _)) = marked {
                    assert_eq!((marked, asked), (name, vec![]), "{at}");
                    continue;
                }
                assert!(!asked.is_empty(), "{at}: already so when the scene opens");
                let compare = person.control(&format!("Compare {name}"));
                match compare.or_else(|| person.control(name)) {
                    Some(control) => assert_eq!(asked, person.click(&control), "{at}"),
                    None => match &asked[..] {
                        [Action::Set(parameter, _)] => {
                            assert!(name.starts_with(parameter.info().label), "{at}");
                        }
                        [Action::SelectScene(id)] => {
                            let title = Scenario::find(id).expect("a scene").title;
                            assert_eq!(title, name);
                        }
                        sweep => {
                            let tab = Action::SelectPlot(Plot::WorkPrecision);
                            assert_eq!(sweep, [tab, CompareAction::StartSweep.into()], "{at}");
                        }
                    },
                }
            }
        }
        assert!(count > 0, "{} names no control", scene.id);
    }
}

/// A number in a closed section is shown, and highlighted for a while.
#[test]
fn a_hint_opens_the_section_of_its_number() {
    let mut view = sample_view();
    view.scenario.hints = ["Read [Speed |v|].", "Raise [Mass]."];
    let mut person = Person::remembering(PanelMemory::default(), view, TALL);
    let figure = |person: &Person| {
        let mut nodes = person.nodes().into_iter();
        nodes.any(|(role, name, _)| role == Role::Label && name == "Speed |v|")
    };
    assert!(!figure(&person) && !person.has("mass"));
    assert_eq!(person.click("hint Speed |v|"), []);
    assert!(figure(&person));
    assert_eq!(person.click("hint Mass"), []);
    assert!(person.has("mass"));
    (0..5).for_each(|_| person.look());
    assert_eq!(person.harness.state().memory.marked, None);
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

    // Another scene has another lesson, and a repeated notice is shown again.
    person.view().scenario.id = "throw";
    person.view().notices.push(failed.into());
    person.look();
    assert!(person.sees(lesson) && person.sees(failed));
}
