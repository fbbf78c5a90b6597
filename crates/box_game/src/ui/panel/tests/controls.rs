//! Buttons, lists and tabs.

use bevy_egui::egui::{Modifiers, accesskit::Role};
use box_physics::prelude::{DVec3, Integrator};
use egui_kittest::kittest::NodeT;

use super::{id_of, sample_view, with};
use crate::action::compare::{CompareAction, Layout, Window};
use crate::action::{Action, Plot, Push};
use crate::compare::verdict::short;
use crate::parameters::Parameter;

/// Requests by one click on the sample, in the notation of a script.
const BUTTONS: &str = "TogglePicker PreviousScene NextScene TogglePause Step(1) StepBack(1) Restart Slower Faster \
    TogglePlots TogglePanel ToggleHelp ToggleAabb ToggleContacts ToggleAxes FrameCamera HomeCamera Screenshot \
    ToggleLog CopyCommandLine SavePlot(None) Set(RestitutionLaw,1.0) SelectPlot(error) SelectPlot(timing) \
    SelectPlot(cpu) SelectPlot(work_precision) SelectPlot(table) Compare(SetLayout(solo)) \
    Compare(SetLayout(side_by_side)) Compare(SetFairness(evaluations)) Compare(SetFairness(cost)) \
    Compare(CompareAll) Compare(CompareNone) Compare(Resync) Compare(ToggleLogarithmicEnergy) \
    Compare(SetWindow(ten)) Compare(Copy)";

#[test]
fn every_button_asks_for_its_action() {
    let mut person = with(|_| {});
    let buttons = BUTTONS.split(' ').map(ron::from_str::<Action>);
    person.asks_for(buttons.map(|action| action.expect("an action")));
    person.asks_for([30.0, 120.0, 240.0].map(|hertz| Action::Set(Parameter::Step, 1.0 / hertz)));
    for chosen in [
        Action::Set(Parameter::Step, 1.0 / 60.0),
        Action::SelectPlot(Plot::Energy),
        CompareAction::SetLayout(Layout::Overlaid).into(),
    ] {
        assert_eq!(person.click_on(chosen), [], "already so");
    }
}

#[test]
fn tools_of_the_tabs() {
    with(|view| view.plot = Plot::Error).asks_for([
        CompareAction::ToggleLogarithmic,
        CompareAction::ToggleLocal,
        CompareAction::SetWindow(Window::All),
    ]);
    let mut person = with(|view| view.plot = Plot::WorkPrecision);
    person.asks_for([CompareAction::StartSweep]);
    assert_eq!(person.click("position error"), [], "the panel's own");
    assert_eq!(person.harness.state().memory.sweep_position, Some(true));
    person.view().compare.sweeping = Some((3, 24));
    person.look();
    person.asks_for([CompareAction::CancelSweep]);
}

#[test]
fn undo_and_redo_are_buttons_where_there_is_something() {
    let mut person = with(|view| view.undoes = Some("Gravity"));
    person.asks_for([Action::Undo]);
    assert_eq!(person.click_on(Action::Redo), [], "nothing to redo");
}

#[test]
fn shift_steps_ten_and_a_list_has_the_speeds() {
    let mut person = with(|_| {});
    person.find("Step(1)").click_modifiers(Modifiers::SHIFT);
    assert_eq!(person.asked(), [Action::Step(10)]);
    assert_eq!(person.click("speed"), []);
    person.asks_for([Action::SetSpeed(0.25)]);
}

#[test]
fn every_integrator_can_be_chosen_and_compared_and_shows_its_cost() {
    let mut person = with(|_| {});
    for &integrator in Integrator::ALL {
        let active = integrator == Integrator::default();
        let compare = Action::from(CompareAction::ToggleComparison(integrator));
        let disabled = person.find(&id_of(&compare)).accesskit_node().is_disabled();
        assert_eq!(disabled, active);
        let chosen = Action::SetIntegrator(integrator);
        let id = id_of(&chosen);
        let node = person.find(&id);
        assert_eq!(node.accesskit_node().role(), Role::RadioButton);
        let value = node.value().expect("its cost");
        // The minimum, as in sweep and report.
        let cost = sample_view().timings[integrator.index()].0;
        let cost = format!("{} ns", short(cost.expect("timed").min));
        assert!(value.ends_with(&cost), "{value}");
        assert_eq!(value.contains("active"), active);
        person.find(&id).hover();
        person.look();
        let info = integrator.info();
        assert!(person.sees(info.summary));
        person.sees_all(&[
            &format!("rotation {}", info.orders.rotation),
            &format!("{} in free flight", info.evaluations.free),
            "ns per box and step in this scene: min",
        ]);
        for action in [chosen, compare] {
            let expected = if active { vec![] } else { vec![action.clone()] };
            assert_eq!(person.click_on(action), expected);
        }
    }
}

#[test]
fn six_pushes_plain_off_center_and_world() {
    let mut person = with(|_| {});
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
    assert!(person.sees("1 N s along +x (body axes)."));
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
    let mut person = with(|_| {});
    for open in [false, true] {
        assert_eq!(person.click("section WORLD"), []);
        assert_eq!(person.has("gravity"), open);
    }
}
