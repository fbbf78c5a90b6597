//! Sliders and typed values: units, limits, resets.

use bevy_egui::egui::{Key, accesskit::Role};
use box_physics::prelude::DVec3;

use super::super::{PanelMemory, PanelView};
use super::{Person, TALL, along, sample_view};
use crate::action::Action;
use crate::parameters::Parameter;

/// The parameter that an action sets, and its value.
fn number_of(action: &Action) -> (Parameter, f64) {
    match *action {
        Action::Set(parameter, value) => (parameter, value),
        ref other => panic!("not a number: {other:?}"),
    }
}

/// The ids of a parameter's slider and typed value.
fn ids(parameter: Parameter) -> [String; 2] {
    let id = parameter.info().id;
    [id.to_owned(), format!("{id} value")]
}

/// The parameters that are numbers, not choices.
fn sliders() -> impl Iterator<Item = Parameter> {
    let number = |p: &Parameter| p.info().choices.is_empty();
    Parameter::ALL.into_iter().filter(number)
}

/// A view in which nothing stands at an end or its default.
fn off_default() -> PanelView {
    let mut view = sample_view();
    let p = &mut view.parameters;
    (p.step, p.substeps) = (0.02, 3.0);
    (p.gravity, p.restitution, p.friction, p.mass) = (5.0, Some(0.3), Some(0.2), 7.0);
    (p.linear_drag, p.angular_damping, p.impulse, p.boxes) = (0.4, 0.7, 3.0, 9.0);
    p.half_extents = DVec3::new(0.7, 0.8, 0.9);
    view
}

#[test]
fn sliders_reach_their_ends() {
    for parameter in sliders() {
        let ends = parameter.info().slider;
        let mut person = Person::before(off_default(), TALL);
        let [slider, _] = ids(parameter);
        let rect = person.find(&slider).rect();
        for (share, end) in [(0.0, ends.0), (1.0, ends.1)] {
            let at = along(rect, share);
            let mut asked = person.drag(at, at);
            asked.extend(person.release(at));
            assert!(!asked.is_empty());
            for (set, value) in asked.iter().map(number_of) {
                assert!(
                    set == parameter && (value - end).abs() < 1e-9,
                    "{slider}: {value}"
                );
            }
        }
    }
}

#[test]
fn typed_values_may_leave_the_slider_but_not_the_limits() {
    for parameter in sliders() {
        let [_, name] = ids(parameter);
        let (low, high) = parameter.info().range;
        for (text, expected) in [("1e300", high), ("-1e300", low)] {
            let mut person = Person::before(off_default(), TALL);
            let asked: Vec<_> = person
                .type_into(&name, text)
                .iter()
                .map(number_of)
                .collect();
            assert_eq!(asked, [(parameter, expected)], "{text}");
        }
        for text in ["NaN", "inf", "", "box", "1/0"] {
            let mut person = Person::before(off_default(), TALL);
            assert_eq!(person.type_into(&name, text), [], "{name} {text}");
        }
    }
    let mut person = Person::before(off_default(), TALL);
    assert_eq!(
        person.type_into("gravity value", "274"),
        [Action::Set(Parameter::Gravity, 274.0)]
    );
    assert_eq!(person.type_into("dt value", "50 Hz"), [], "as it is");
    assert_eq!(
        person.type_into("dt value", "1/64"),
        [Action::Set(Parameter::Step, 1.0 / 64.0)]
    );
    let grown = Action::Set(Parameter::HalfZ, 0.25);
    assert_eq!(person.type_into("half-z value", "0,25"), [grown]);
}

/// The shown text has four digits; opening and leaving it must not round the value.
#[test]
fn looking_is_not_touching() {
    let mut person = Person::before(sample_view(), TALL);
    for parameter in sliders() {
        let [_, name] = ids(parameter);
        assert_eq!(person.click(&name), []);
        person.harness.key_press(Key::Enter);
        assert_eq!(person.asked(), [], "{name}");
    }
}

#[test]
fn a_right_click_resets_one_and_moves_nothing_on_its_way() {
    for parameter in sliders() {
        for name in ids(parameter) {
            let mut person = Person::before(off_default(), TALL);
            person.find(&name).click_secondary();
            let asked: Vec<_> = person.asked().iter().map(number_of).collect();
            let defaults = Person::before(sample_view(), TALL);
            let default = defaults.find(&name);
            assert_eq!(asked.len(), 1, "{name}: {asked:?}");
            assert_eq!(asked[0].0, parameter);
            let shown = egui_kittest::kittest::NodeT::accesskit_node(&default).numeric_value();
            assert!(
                shown.is_some_and(|v| (v - asked[0].1).abs() < 1e-12),
                "{name}: {asked:?} {shown:?}"
            );
            // Nothing to reset, nothing asked.
            let mut person = Person::before(sample_view(), TALL);
            person.find(&name).click_secondary();
            assert_eq!(person.asked(), []);
        }
    }
}

#[test]
fn sections_reset_to_the_scene() {
    let mut person = Person::before(off_default(), TALL);
    for (name, actions) in [
        (
            "Reset step",
            vec![
                Action::Set(Parameter::Step, 1.0 / 60.0),
                Action::Set(Parameter::Substeps, 1.0),
            ],
        ),
        (
            "Reset world",
            vec![
                Action::Set(Parameter::Gravity, 9.81),
                Action::Set(Parameter::Restitution, 0.5),
                Action::Set(Parameter::RestitutionLaw, 0.0),
                Action::Set(Parameter::Friction, 0.6),
                Action::Set(Parameter::LinearDrag, 0.0),
                Action::Set(Parameter::AngularDamping, 0.0),
            ],
        ),
        (
            "Reset box",
            vec![
                Action::Set(Parameter::HalfX, 0.5),
                Action::Set(Parameter::HalfY, 0.25),
                Action::Set(Parameter::HalfZ, 0.125),
                Action::Set(Parameter::Mass, 2.0),
            ],
        ),
        ("Reset push", vec![Action::Set(Parameter::Impulse, 1.0)]),
        ("Reset load", vec![Action::Set(Parameter::Boxes, 1.0)]),
    ] {
        assert_eq!(person.click(name), actions, "{name}");
    }
}

/// A restart per frame of a drag would be a storm.
#[test]
fn what_restarts_waits_for_the_mouse_to_let_go() {
    for label in ["mass", "boxes", "half-y"] {
        let mut person = Person::before(off_default(), TALL);
        let rect = person.find(label).rect();
        assert_eq!(
            person.drag(along(rect, 0.5), along(rect, 0.8)),
            [],
            "{label}"
        );
        let at = along(rect, 0.8);
        assert_eq!(person.release(at).len(), 1, "{label}");
        assert_eq!(person.asked(), [], "{label}");
    }
    // What does not restart follows the mouse.
    let mut person = Person::before(off_default(), TALL);
    let rect = person.find("gravity").rect();
    assert!(!person.drag(along(rect, 0.5), along(rect, 0.8)).is_empty());
}

#[test]
fn dragging_a_number_moves_it() {
    let mut person = Person::before(off_default(), TALL);
    let rect = person.find("gravity value").rect();
    let (from, to) = (
        rect.center(),
        rect.center() + bevy_egui::egui::vec2(40.0, 0.0),
    );
    let asked = person.drag(from, to);
    assert!(
        matches!(asked.last(), Some(Action::Set(Parameter::Gravity, g)) if *g > 5.0),
        "{asked:?}"
    );
}

#[test]
fn tooltips_give_unit_default_and_range() {
    for parameter in sliders() {
        let (label, unit) = (parameter.info().label, parameter.info().unit);
        let mut person = Person::before(off_default(), TALL);
        person.find(&ids(parameter)[0]).hover();
        person.look();
        assert!(
            person.sees_part("right-click resets)") && person.sees_part("Allowed: "),
            "{label}"
        );
        let (_, text, _) = person
            .nodes()
            .into_iter()
            .find(|(_, text, _)| text.contains("right-click resets)"))
            .expect("just seen");
        assert!(
            text.starts_with(label) && text.matches(unit).count() >= 2,
            "{text}"
        );
    }
    let mut person = Person::before(sample_view(), TALL);
    person.find("gravity").hover();
    person.look();
    assert!(person.sees("Gravity 9.81 m/s² (default 9.81 m/s² · right-click resets)"));
}

#[test]
fn without_a_floor_its_rows_are_absent() {
    let mut view = sample_view();
    (view.parameters.restitution, view.parameters.friction) = (None, None);
    let mut person = Person::before(view, TALL);
    assert!(!person.sees_part("Restitution") && !person.sees_part("Friction"));
    let asked = person.click("Reset world");
    assert!(!asked.iter().any(|a| matches!(
        a,
        Action::Set(Parameter::Restitution, _) | Action::Set(Parameter::Friction, _)
    )));
}

/// A slider or number without a unit is a pure number, and known as such.
#[test]
fn every_number_names_its_unit() {
    let person = Person::with(sample_view(), PanelMemory::all_open(), TALL);
    let mut rows = 0;
    for (role, name, _) in person.nodes() {
        if role == Role::Slider || role == Role::SpinButton {
            rows += 1;
            let pure = ["Substeps", "Restitution", "Friction", "Boxes"];
            assert!(
                name.contains('[') || pure.iter().any(|pure| name.starts_with(pure)),
                "{name}"
            );
        }
    }
    assert_eq!(rows, 2 * 13);
}
