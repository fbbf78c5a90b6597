//! Buttons, lists and tabs.

use bevy_egui::egui::{Modifiers, accesskit::Role};
use box_physics::prelude::{DVec3, Integrator};
use egui_kittest::kittest::NodeT;

use super::{Person, TALL, sample_view};
use crate::action::compare::{CompareAction, Fairness, Layout, Window};
use crate::action::{Action, Plot, Push};
use crate::parameters::Parameter;

#[test]
fn every_button_asks_for_its_action() {
    let mut person = Person::before(sample_view(), TALL);
    for (name, action) in [
        ("Previous scene", Action::PreviousScene),
        ("Next scene", Action::NextScene),
        ("Pause", Action::TogglePause),
        ("Step", Action::Step(1)),
        ("Restart", Action::Restart),
        ("Slower", Action::Slower),
        ("Faster", Action::Faster),
        ("Plots", Action::TogglePlots),
        ("Close plots", Action::TogglePlots),
        ("Hide panel", Action::TogglePanel),
        ("Help", Action::ToggleHelp),
        ("Bounding box (B)", Action::ToggleAabb),
        ("Contacts (C)", Action::ToggleContacts),
        ("Axes and velocity (X)", Action::ToggleAxes),
        ("Frame", Action::FrameCamera),
        ("Home", Action::HomeCamera),
        ("Screenshot", Action::Screenshot),
        ("Start log", Action::ToggleLog),
        ("Newton", Action::Set(Parameter::RestitutionLaw, 1.0)),
        ("30 Hz", Action::Set(Parameter::Step, 1.0 / 30.0)),
        ("120 Hz", Action::Set(Parameter::Step, 1.0 / 120.0)),
        ("240 Hz", Action::Set(Parameter::Step, 1.0 / 240.0)),
        ("Error tab", Action::SelectPlot(Plot::Error)),
        ("Timing tab", Action::SelectPlot(Plot::Timing)),
        ("CPU tab", Action::SelectPlot(Plot::Cpu)),
        (
            "Work–precision tab",
            Action::SelectPlot(Plot::WorkPrecision),
        ),
        ("Table tab", Action::SelectPlot(Plot::Table)),
        ("Solo", compare(CompareAction::SetLayout(Layout::Solo))),
        (
            "Side by side",
            compare(CompareAction::SetLayout(Layout::SideBySide)),
        ),
        (
            "equal evaluations",
            compare(CompareAction::SetFairness(Fairness::Evaluations)),
        ),
        (
            "equal cost",
            compare(CompareAction::SetFairness(Fairness::Cost)),
        ),
        ("Compare all", compare(CompareAction::CompareAll)),
        ("Compare none", compare(CompareAction::CompareNone)),
        ("Re-sync", compare(CompareAction::Resync)),
        ("log", compare(CompareAction::ToggleLogarithmicEnergy)),
        ("10 s", compare(CompareAction::SetWindow(Window::Ten))),
        ("Copy CSV", compare(CompareAction::Copy)),
    ] {
        assert_eq!(person.click(name), [action], "{name}");
    }
    assert_eq!(person.click("60 Hz"), [], "already so");
    assert_eq!(person.click("Energy tab"), [], "already so");
    assert_eq!(person.click("Overlaid"), [], "already so");
}

fn compare(action: CompareAction) -> Action {
    Action::Compare(action)
}

#[test]
fn every_integrator_can_be_ticked_but_the_main_box_s_own() {
    let mut person = Person::before(sample_view(), TALL);
    for &integrator in Integrator::ALL {
        let name = format!("Compare {}", integrator.name());
        let main_box = integrator == Integrator::default();
        let node = person.find(&name).accesskit_node().is_disabled();
        assert_eq!(node, main_box);
        let toggle = compare(CompareAction::ToggleComparison(integrator));
        let expected = if main_box { vec![] } else { vec![toggle] };
        assert_eq!(person.click(&name), expected, "{name}");
    }
}

#[test]
fn tools_of_the_tabs() {
    let mut view = sample_view();
    view.plot = Plot::Error;
    let mut person = Person::before(view.clone(), TALL);
    for (name, action) in [
        ("log", CompareAction::ToggleLogarithmic),
        ("per step", CompareAction::ToggleLocal),
        ("all", CompareAction::SetWindow(Window::All)),
    ] {
        assert_eq!(person.click(name), [compare(action)], "{name}");
    }
    view.plot = Plot::WorkPrecision;
    let mut person = Person::before(view.clone(), TALL);
    assert_eq!(person.click("Sweep"), [compare(CompareAction::StartSweep)]);
    assert_eq!(person.click("position error"), [], "the panel's own");
    assert_eq!(person.harness.state().memory.sweep_position, Some(true));
    view.compare.sweep.running = true;
    view.compare.sweep.progress = (3, 24);
    let mut person = Person::before(view.clone(), TALL);
    let cancel = compare(CompareAction::CancelSweep);
    assert_eq!(person.click("Cancel sweep"), [cancel]);
    view.plot = Plot::Table;
    let mut person = Person::before(view, TALL);
    assert_eq!(
        person.click("Compare the main box with RK4"),
        [compare(CompareAction::Select(Integrator::Rk4))]
    );
}

#[test]
fn shift_steps_ten() {
    let mut person = Person::before(sample_view(), TALL);
    person.find("Step").click_modifiers(Modifiers::SHIFT);
    assert_eq!(person.asked(), [Action::Step(10)]);
}

#[test]
fn lists_of_scenes_and_speeds() {
    let mut person = Person::before(sample_view(), TALL);
    assert_eq!(person.click("Scene"), []);
    assert_eq!(
        person.click("Dzhanibekov flip"),
        [Action::SelectScene("flip".into())]
    );
    assert_eq!(person.click("Speed"), []);
    assert_eq!(person.click("0.25×"), [Action::SetSpeed(0.25)]);
}

#[test]
fn every_integrator_can_be_chosen_and_shows_its_cost() {
    let mut person = Person::before(sample_view(), TALL);
    for &integrator in Integrator::ALL {
        let node = person.find(integrator.name());
        assert_eq!(node.accesskit_node().role(), Role::RadioButton);
        let value = node.value().expect("its cost");
        assert!(value.contains("ns"), "{value}");
        let active = integrator == Integrator::default();
        assert_eq!(value.contains("active"), active);
        let expected: &[Action] = if active {
            &[]
        } else {
            &[Action::SetIntegrator(integrator)]
        };
        person.find(integrator.name()).hover();
        person.look();
        let info = integrator.info();
        assert!(person.sees(info.summary));
        assert!(person.sees_part(&format!("rotation {}", info.orders.rotation)));
        assert!(person.sees_part(&format!("{} in free flight", info.evaluations.free)));
        assert!(person.sees_part("ns per body-step on this scene's bodies: min"));
        assert_eq!(person.click(integrator.name()), expected);
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
        ("Push +x", DVec3::X),
        ("Push −x", DVec3::NEG_X),
        ("Push +y", DVec3::Y),
        ("Push −y", DVec3::NEG_Y),
        ("Push +z", DVec3::Z),
        ("Push −z", DVec3::NEG_Z),
    ] {
        assert_eq!(person.click(name), push(direction, false, false));
    }
    person.find("Push +x").hover();
    person.look();
    assert!(person.sees("1 N s along +x of the box."));
    person.find("Push +x").click_modifiers(Modifiers::SHIFT);
    assert_eq!(person.asked(), push(DVec3::X, false, true));
    person.find("Push +x").click_modifiers(Modifiers::ALT);
    assert_eq!(person.asked(), push(DVec3::X, true, false));
    assert_eq!(person.click("off-center (Shift)"), []);
    assert_eq!(person.click("world axes (Alt)"), []);
    assert_eq!(person.click("Push +y"), push(DVec3::Y, true, true));
}

#[test]
fn sections_fold() {
    let mut person = Person::before(sample_view(), TALL);
    assert!(person.sees("Gravity [m/s²]"));
    assert_eq!(person.click("WORLD"), []);
    assert!(!person.sees("Gravity [m/s²]"));
    person.click("WORLD");
    assert!(person.sees("Gravity [m/s²]"));
}
