//! Buttons, lists and tabs.

use bevy_egui::egui::{Modifiers, accesskit::Role};
use box_physics::prelude::{DVec3, Integrator};
use egui_kittest::kittest::NodeT;

use super::{Person, TALL, id_of, sample_view};
use crate::action::compare::{CompareAction, Fairness, Layout, Window};
use crate::action::{Action, Plot, Push};
use crate::compare::verdict::short;
use crate::parameters::Parameter;

#[test]
fn every_button_asks_for_its_action() {
    let mut person = Person::before(sample_view(), TALL);
    for action in [
        Action::TogglePicker,
        Action::PreviousScene,
        Action::NextScene,
        Action::TogglePause,
        Action::Step(1),
        Action::Restart,
        Action::Slower,
        Action::Faster,
        Action::TogglePlots,
        Action::TogglePanel,
        Action::ToggleHelp,
        Action::ToggleAabb,
        Action::ToggleContacts,
        Action::ToggleAxes,
        Action::FrameCamera,
        Action::HomeCamera,
        Action::Screenshot,
        Action::ToggleLog,
        Action::SavePlot(None),
        Action::Set(Parameter::RestitutionLaw, 1.0),
        Action::Set(Parameter::Step, 1.0 / 30.0),
        Action::Set(Parameter::Step, 1.0 / 120.0),
        Action::Set(Parameter::Step, 1.0 / 240.0),
        Action::SelectPlot(Plot::Error),
        Action::SelectPlot(Plot::Timing),
        Action::SelectPlot(Plot::Cpu),
        Action::SelectPlot(Plot::WorkPrecision),
        Action::SelectPlot(Plot::Table),
        CompareAction::SetLayout(Layout::Solo).into(),
        CompareAction::SetLayout(Layout::SideBySide).into(),
        CompareAction::SetFairness(Fairness::Evaluations).into(),
        CompareAction::SetFairness(Fairness::Cost).into(),
        CompareAction::CompareAll.into(),
        CompareAction::CompareNone.into(),
        CompareAction::Resync.into(),
        CompareAction::ToggleLogarithmicEnergy.into(),
        CompareAction::SetWindow(Window::Ten).into(),
        CompareAction::Copy.into(),
    ] {
        assert_eq!(person.click_on(action.clone()), [action]);
    }
    for chosen in [
        Action::Set(Parameter::Step, 1.0 / 60.0),
        Action::SelectPlot(Plot::Energy),
        CompareAction::SetLayout(Layout::Overlaid).into(),
    ] {
        assert_eq!(person.click_on(chosen), [], "already so");
    }
}

#[test]
fn every_integrator_can_be_ticked_but_the_main_box_s_own() {
    let mut person = Person::before(sample_view(), TALL);
    for &integrator in Integrator::ALL {
        let main_box = integrator == Integrator::default();
        let toggle = Action::from(CompareAction::ToggleComparison(integrator));
        let disabled = person.find(&id_of(&toggle)).accesskit_node().is_disabled();
        assert_eq!(disabled, main_box);
        let expected = if main_box {
            vec![]
        } else {
            vec![toggle.clone()]
        };
        assert_eq!(person.click_on(toggle), expected);
    }
}

#[test]
fn tools_of_the_tabs() {
    let mut view = sample_view();
    view.plot = Plot::Error;
    let mut person = Person::before(view.clone(), TALL);
    for action in [
        CompareAction::ToggleLogarithmic,
        CompareAction::ToggleLocal,
        CompareAction::SetWindow(Window::All),
    ] {
        assert_eq!(person.click_on(action.clone()), [action.into()]);
    }
    view.plot = Plot::WorkPrecision;
    let mut person = Person::before(view.clone(), TALL);
    let start = Action::from(CompareAction::StartSweep);
    assert_eq!(person.click_on(start.clone()), [start]);
    assert_eq!(person.click("position error"), [], "the panel's own");
    assert_eq!(person.harness.state().memory.sweep_position, Some(true));
    view.compare.sweep.running = true;
    view.compare.sweep.progress = (3, 24);
    let mut person = Person::before(view.clone(), TALL);
    let cancel = Action::from(CompareAction::CancelSweep);
    assert_eq!(person.click_on(cancel.clone()), [cancel]);
}

#[test]
fn shift_steps_ten() {
    let mut person = Person::before(sample_view(), TALL);
    person.find("Step(1)").click_modifiers(Modifiers::SHIFT);
    assert_eq!(person.asked(), [Action::Step(10)]);
}

#[test]
fn the_list_of_speeds() {
    let mut person = Person::before(sample_view(), TALL);
    assert_eq!(person.click("speed"), []);
    let slow = Action::SetSpeed(0.25);
    assert_eq!(person.click_on(slow.clone()), [slow]);
}

#[test]
fn every_integrator_can_be_chosen_and_shows_its_cost() {
    let mut person = Person::before(sample_view(), TALL);
    for &integrator in Integrator::ALL {
        let id = id_of(&Action::SetIntegrator(integrator));
        let node = person.find(&id);
        assert_eq!(node.accesskit_node().role(), Role::RadioButton);
        let value = node.value().expect("its cost");
        // The minimum, as in sweep and report.
        let cost = sample_view().timings[integrator.index()]
            .cost
            .expect("timed");
        assert!(
            value.ends_with(&format!("{} ns", short(cost.min))),
            "{value}"
        );
        let active = integrator == Integrator::default();
        assert_eq!(value.contains("active"), active);
        let expected: &[Action] = if active {
            &[]
        } else {
            &[Action::SetIntegrator(integrator)]
        };
        person.find(&id).hover();
        person.look();
        let info = integrator.info();
        assert!(person.sees(info.summary));
        assert!(person.sees_part(&format!("rotation {}", info.orders.rotation)));
        assert!(person.sees_part(&format!("{} in free flight", info.evaluations.free)));
        assert!(person.sees_part("ns per step of a box in this scene: min"));
        assert_eq!(person.click(&id), expected);
    }
}

#[test]
fn six_pushes_plain_off_center_and_world() {
    let mut person = Person::before(sample_view(), TALL);
    let push = |direction, world, off_center| {
        [Action::Push(Push {
            direction,
            world,
            off_center,
        })]
    };
    for (name, direction) in [
        ("push +x", DVec3::X),
        ("push −x", DVec3::NEG_X),
        ("push +y", DVec3::Y),
        ("push −y", DVec3::NEG_Y),
        ("push +z", DVec3::Z),
        ("push −z", DVec3::NEG_Z),
    ] {
        assert_eq!(person.click(name), push(direction, false, false));
    }
    person.find("push +x").hover();
    person.look();
    assert!(person.sees("1 N s along +x of the box."));
    person.find("push +x").click_modifiers(Modifiers::SHIFT);
    assert_eq!(person.asked(), push(DVec3::X, false, true));
    person.find("push +x").click_modifiers(Modifiers::ALT);
    assert_eq!(person.asked(), push(DVec3::X, true, false));
    assert_eq!(person.click("off-center"), []);
    assert_eq!(person.click("world axes"), []);
    assert_eq!(person.click("push +y"), push(DVec3::Y, true, true));
}

#[test]
fn sections_fold() {
    let mut person = Person::before(sample_view(), TALL);
    assert!(person.has("gravity"));
    assert_eq!(person.click("section WORLD"), []);
    assert!(!person.has("gravity"));
    person.click("section WORLD");
    assert!(person.has("gravity"));
}
