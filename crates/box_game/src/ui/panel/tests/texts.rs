//! Texts, tables and plots.

use bevy_egui::egui::{
    Event, Key, Modifiers, MouseWheelUnit, TouchPhase, Vec2, accesskit::Role, pos2,
};
use box_physics::prelude::Integrator;
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT, Queryable};

use super::super::KEYS;
use super::{Person, USUAL, sample_view, with};
use crate::action::{Action, Plot};
use crate::compare::TrajectoryView;
use crate::parameters::Parameter;
use crate::view::style;

/// Description of the energy plot of the sample view.
const ENERGY: &str =
    "energy drift [%] over simulated time, now Split 1e-4, RK4 0.01, Semi-implicit Euler 1";

#[test]
fn clock_speed_and_log_in_words() {
    let mut person = with(|view| {
        (view.paused, view.steps, view.software_rendering) = (true, 1741, true);
        view.log = Some(("/home/me/run-07.csv".into(), 1482));
    });
    for text in [
        "PAUSED",
        "t = 12.35 s",
        "⚠ no GPU",
        "/home/me/run-07.csv",
        "● REC 1\u{a0}482",
        "1\u{a0}482 rows",
    ] {
        assert!(person.sees(text), "{text}");
    }
    person.asks_for([Action::TogglePause, Action::ToggleLog]);
    assert!(with(|view| (view.speed, view.actual_speed) = (2.0, Some(1.25))).sees("only 1.25×"));
    let person = with(|_| {});
    assert!(!person.sees_part("REC") && !person.sees_part("only"));
}

/// The panel names what a browser cannot measure, and the resolution of its clock.
#[test]
fn a_browser_says_what_it_cannot_measure() {
    let reason = "CPU usage is not available in a browser";
    let person = with(|view| (view.plot, view.no_cpu) = (Plot::Cpu, Some(reason)));
    assert!(person.sees(reason));
    let timing = |grain| {
        let person = with(|view| (view.plot, view.grain) = (Plot::Timing, grain));
        person.sees_part("clock resolution 100 µs, samples ±0.82 %")
    };
    assert!(!timing(None) && timing(Some((100.0, 0.0082))));
    assert!(!with(|view| view.plot = Plot::Timing).sees_part("clock resolution"));
    let step = |boxes, stages| {
        with(|view| {
            (view.grain, view.stages_us) = (Some((100.0, 0.0082)), Some(stages));
            view.parameters.set(Parameter::Boxes, boxes).expect("valid");
        })
    };
    assert!(step(1.0, [0.0; 4]).sees("Step in the plugin: below 100 µs for 1 box"));
    let many = step(1000.0, [0.0, 10.0, 20.0, 30.0]);
    assert!(many.sees("Step in the plugin: below 100 µs for 1000 boxes, below 100 ns each"));
    assert!(many.sees_part("contact below 100 µs"));
    let slow = step(1000.0, [150.0, 10.0, 0.0, 0.0]);
    assert!(slow.sees("Step in the plugin: 160 µs for 1000 boxes, 160 ns each"));
    assert!(slow.sees_part("integrate 150 µs, contact below 100 µs"));
}

#[test]
fn read_outs_carry_units() {
    let person = with(|_| {});
    person.sees_all(&[
        "1.500 J",
        "0.2500 J",
        "6.650 J",
        "0.1250 kg m²/s",
        "1.220 m/s",
        "3.000 rad/s",
        "-0.3000 m",
        "Step by stage: integrate 0.50 µs, contact 0.10 µs",
    ]);
    assert!(person.sees("ok") && person.sees("Step in the plugin: 0.8 µs for 1 box"));
}

#[test]
fn help_lists_every_key_and_closes() {
    let mut view = sample_view();
    view.show_help = true;
    let mut person = Person::before(view, USUAL);
    for (key, what) in KEYS {
        assert!(person.sees(key) && person.sees(what), "{key}");
    }
    // Esc belongs to the game's keys.
    person.harness.key_press(Key::Escape);
    assert_eq!(person.asked(), []);
    person.asks_for([Action::ResetParameters]);
    assert_eq!(person.click("Close help"), [Action::ToggleHelp]);
}

#[test]
fn hidden_leaves_one_line_and_the_whole_picture() {
    let mut view = sample_view();
    (view.hidden, view.paused) = (true, true);
    let mut person = Person::before(view, USUAL);
    let name = style::marked_name(Integrator::default());
    let line = format!("Playground · {name} · PAUSED · t = 12.35 s · 0.8 µs/step");
    assert!(person.sees(&line));
    assert!(!person.has("Restart") && !person.has("gravity"));
    // The harness keeps a margin of 8 points.
    assert_eq!(person.layout().central.size(), Vec2::new(1264.0, 704.0));
    person.asks_for([Action::TogglePanel]);
}

#[test]
fn the_table_has_a_row_for_every_integrator() {
    let mut person = with(|view| {
        view.plot = Plot::Table;
        view.timings[1].0 = None;
    });
    let words = "min [ns], median [ns], p95 [ns], force evals, position error [m], attitude error [°], ΔE/E₀, Δ|L|/|L₀|, \
                 order, state, …, 1.0e-6";
    for words in words.split(", ") {
        assert!(person.sees(words), "{words}");
    }
    let trajectories = person.view().compare.trajectories.clone();
    for &integrator in Integrator::ALL {
        let main_box = |t: &TrajectoryView| t.integrator == integrator && t.main_box;
        let main_box = trajectories.iter().any(main_box);
        let suffix = if main_box { " · main box" } else { "" };
        let cell = format!("{}{suffix}", integrator.name());
        let mut cells = person.harness.query_all_by_label(&cell);
        let label = |node: Node<'_>| node.accesskit_node().role() == Role::Label;
        assert!(cells.any(label), "{cell}");
    }
}

#[test]
fn plots_say_what_they_show_and_leave_the_wheel_alone() {
    for (plot, words) in [
        (
            Plot::Error,
            "attitude error [°] over simulated time, now Split 1e-6, RK4 1e-4, Semi-implicit Euler 0.01",
        ),
        (Plot::Energy, ENERGY),
        (
            Plot::Timing,
            "Minimum nanoseconds per box and step of every integrator over wall time, logarithmic",
        ),
        (
            Plot::Cpu,
            "CPU usage over wall time, now 12 % this process, 30 % whole system",
        ),
    ] {
        let mut view = sample_view();
        view.plot = plot;
        let mut person = Person::before(view, USUAL);
        assert!(person.sees(words), "{words}");
        let legend = |&i: &Integrator| person.sees(&style::marked_name(i));
        assert!(plot != Plot::Timing || Integrator::ALL.iter().all(legend));
        let middle = person.harness.get_by_label(words).rect().center();
        person.harness.hover_at(middle);
        assert_eq!(person.asked(), []);
    }
    // In a narrow drawer the plots stand one above the other, and the wheel scrolls through them.
    let mut person = Person::before(sample_view(), Vec2::new(600.0, 500.0));
    let place = |person: &Person| person.harness.get_by_label(ENERGY).rect();
    let before = place(&person);
    let inside = before.center_top() + Vec2::new(0.0, 20.0);
    person.harness.hover_at(inside);
    person.harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        delta: Vec2::new(0.0, -30.0),
        phase: TouchPhase::Move,
        modifiers: Modifiers::NONE,
    });
    person.look();
    let after = place(&person);
    assert!(after.top() < before.top() - 5.0, "{before:?} {after:?}");
}

/// Plots under the pointer are frozen, while the game continues.
#[test]
fn a_plot_under_the_pointer_is_frozen() {
    let mut person = Person::before(sample_view(), USUAL);
    let words = |person: &Person| {
        let mut nodes = person.nodes().into_iter();
        let plot = nodes.find(|(_, name, _)| name.starts_with("energy drift"));
        plot.expect("a plot")
    };
    let (_, before, place) = words(&person);
    person.harness.hover_at(place.center());
    person.look();
    assert!(person.sees("⏸ frozen"));
    for trajectory in &mut person.view().compare.trajectories {
        trajectory.now = [0.5; 7];
    }
    person.look();
    assert_eq!(words(&person).1, before);
    person.harness.hover_at(pos2(5.0, 5.0));
    person.look();
    assert!(!person.sees("⏸ frozen"));
    assert!(words(&person).1.contains("Split 50"));
}
