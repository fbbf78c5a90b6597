//! Sliders and typed values: units, limits, resets.

use bevy_egui::egui::Key;
use box_physics::prelude::DVec3;
use egui_kittest::kittest::NodeT;

use super::{Person, along, id_of, with};
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

/// Shows a view in which no value is at a limit or at its default.
fn off_default() -> Person {
    with(|view| {
        let p = &mut view.parameters;
        (p.step, p.substeps) = (0.02, 3.0);
        (p.gravity, p.restitution, p.friction, p.mass) = (5.0, Some(0.3), Some(0.2), 7.0);
        (p.linear_drag, p.angular_damping, p.impulse, p.boxes) = (0.4, 0.7, 3.0, 9.0);
        p.half_extents = DVec3::new(0.7, 0.8, 0.9);
    })
}

#[test]
fn sliders_reach_their_ends() {
    for parameter in sliders() {
        let ends = parameter.info().slider;
        let mut person = off_default();
        let [slider, _] = ids(parameter);
        let rect = person.find(&slider).rect();
        for (share, end) in [(0.0, ends.0), (1.0, ends.1)] {
            let at = along(rect, share);
            let mut asked = person.drag(at, at);
            asked.extend(person.release(at));
            assert!(!asked.is_empty());
            for (set, value) in asked.iter().map(number_of) {
                let there = set == parameter && (value - end).abs() < 1e-9;
                assert!(there, "{slider}: {value}");
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
            let asked = off_default().type_into(&name, text);
            assert_eq!(asked, [Action::Set(parameter, expected)], "{text}");
        }
        for text in ["NaN", "inf", "", "box", "1/0"] {
            assert_eq!(off_default().type_into(&name, text), [], "{name} {text}");
        }
    }
    let mut person = off_default();
    for (name, text, set) in [
        ("gravity value", "274", Some((Parameter::Gravity, 274.0))),
        ("dt value", "50 Hz", None),
        ("dt value", "1/64", Some((Parameter::Step, 1.0 / 64.0))),
        ("half-z value", "0,25", Some((Parameter::HalfZ, 0.25))),
    ] {
        let asked = person.type_into(name, text);
        let set: Vec<_> = set.map(|(p, v)| Action::Set(p, v)).into_iter().collect();
        assert_eq!(asked, set, "{name} {text}");
    }
}

/// The shown text has four digits; opening and leaving it must not round the value.
#[test]
fn looking_is_not_touching() {
    let mut person = with(|_| {});
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
            let mut person = off_default();
            person.find(&name).click_secondary();
            let asked: Vec<_> = person.asked().iter().map(number_of).collect();
            let mut person = with(|_| {});
            let default = person.find(&name).accesskit_node().numeric_value();
            let default = default.expect("a number");
            assert!(
                matches!(asked[..], [(p, v)] if p == parameter && (v - default).abs() < 1e-12),
                "{name}: {asked:?} {default:?}"
            );
            // Nothing to reset, so nothing is requested.
            person.find(&name).click_secondary();
            assert_eq!(person.asked(), []);
        }
    }
}

#[test]
fn sections_reset_to_the_scene() {
    let mut person = off_default();
    for (section, actions) in [
        ("step", "Set(Step,0.016666666666666666) Set(Substeps,1.0)"),
        (
            "world",
            "Set(Gravity,9.81) Set(Restitution,0.5) Set(RestitutionLaw,0.0) Set(Friction,0.6) \
             Set(LinearDrag,0.0) Set(AngularDamping,0.0)",
        ),
        (
            "box",
            "Set(HalfX,0.5) Set(HalfY,0.25) Set(HalfZ,0.125) Set(Mass,2.0)",
        ),
        ("push", "Set(Impulse,1.0)"),
        ("load", "Set(Boxes,1.0)"),
    ] {
        let asked = person.click(&format!("Reset {section}"));
        let asked: Vec<_> = asked.iter().map(id_of).collect();
        assert_eq!(asked.join(" "), actions);
    }
}

/// A drag must not cause a restart per frame. A parameter without restart follows the mouse.
#[test]
fn what_restarts_waits_for_the_mouse_to_let_go() {
    for (label, restarts) in [
        ("mass", true),
        ("boxes", true),
        ("half-y", true),
        ("gravity", false),
    ] {
        let mut person = off_default();
        let rect = person.find(label).rect();
        let (from, to) = (along(rect, 0.5), along(rect, 0.8));
        assert_eq!(person.drag(from, to).is_empty(), restarts, "{label}");
        if restarts {
            assert_eq!(person.release(to).len(), 1, "{label}");
            assert_eq!(person.asked(), [], "{label}");
        }
    }
}

#[test]
fn tooltips_give_unit_default_and_range() {
    for parameter in sliders() {
        let (label, unit) = (parameter.info().label, parameter.info().unit);
        let mut person = off_default();
        person.find(&ids(parameter)[0]).hover();
        person.look();
        assert!(person.sees_part("Allowed: "), "{label}");
        let mut texts = person.nodes().into_iter().map(|(_, text, _)| text);
        let text = texts.find(|text| text.contains("right-click resets)"));
        let text = text.expect(label);
        let units = text.matches(unit).count();
        assert!(text.starts_with(label) && units >= 2, "{text}");
    }
    let mut person = with(|_| {});
    person.find("gravity").hover();
    person.look();
    assert!(person.sees("Gravity 9.81 m/s² (default 9.81 m/s² · right-click resets)"));
}

#[test]
fn without_a_floor_its_rows_are_absent() {
    let mut person = with(|view| {
        (view.parameters.restitution, view.parameters.friction) = (None, None);
    });
    assert!(!person.sees_part("Restitution") && !person.sees_part("Friction"));
    let asked = person.click("Reset world");
    let floor = [Parameter::Restitution, Parameter::Friction];
    assert!(!asked.iter().any(|a| floor.contains(&number_of(a).0)));
}
