//! Texts, tables and plots.

use bevy_egui::egui::{Event, Key, Modifiers, MouseWheelUnit, TouchPhase, Vec2, accesskit::Role};
use box_physics::prelude::Integrator;
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT, Queryable};

use super::super::{KEYS, LogView};
use super::{Person, TALL, sample_view};
use crate::action::{Action, Plot};
use crate::view::style;

/// What the plot of the sample's energy says.
const ENERGY: &str =
    "energy drift [%] over simulated time, now Split 1e-4, RK4 0.01, Semi-implicit Euler 1";

#[test]
fn clock_speed_and_log_in_words() {
    let mut view = sample_view();
    view.paused = true;
    view.steps = 1741;
    view.software_rendering = true;
    view.log = Some(LogView {
        path: "/home/me/run-07.csv".into(),
        rows: 1482,
        bytes: 4096,
    });
    let mut person = Person::before(view, TALL);
    for text in ["PAUSED", "t = 12.35 s", "⚠ no GPU", "/home/me/run-07.csv"] {
        assert!(person.sees(text), "{text}");
    }
    assert!(person.sees("● REC 1\u{a0}482"));
    assert!(person.sees("1\u{a0}482 rows · 4.0 KiB"));
    assert!(!Person::before(sample_view(), TALL).sees_part("REC"));
    for action in [Action::TogglePause, Action::ToggleLog] {
        assert_eq!(person.click_on(action.clone()), [action]);
    }

    let mut view = sample_view();
    view.speed = 2.0;
    view.actual_speed = Some(1.25);
    assert!(Person::before(view, TALL).sees("only 1.25×"));
    assert!(!Person::before(sample_view(), TALL).sees_part("only"));
}

/// What a browser cannot measure, and how well it measures the rest.
#[test]
fn a_browser_says_what_it_cannot_measure() {
    let mut view = sample_view();
    view.plot = Plot::Cpu;
    view.history.no_cpu = Some("CPU usage is not available in a browser");
    let person = Person::before(view.clone(), TALL);
    assert!(person.sees("CPU usage is not available in a browser"));
    view.plot = Plot::Timing;
    assert!(!Person::before(view.clone(), TALL).sees_part("clock: steps"));
    view.history.grain = Some((100.0, 0.0082));
    assert!(Person::before(view, TALL).sees_part("clock: steps of 100 µs, samples ±0.82 %"));
}

#[test]
fn read_outs_carry_units() {
    let person = Person::before(sample_view(), TALL);
    for part in [
        "1.500 J",
        "0.2500 J",
        "6.650 J",
        "0.1250 kg m²/s",
        "1.220 m/s",
        "3.000 rad/s",
        "-0.3000 m",
    ] {
        assert!(person.sees_part(part), "{part}");
    }
    assert!(person.sees("ok") && person.sees("Step in the plugin: 0.8 µs for 1 box"));
    assert!(person.sees_part("Step by stage: integrate 0.50 µs, contact 0.10 µs"));
}

#[test]
fn lesson_and_notice_stay_until_dismissed() {
    let mut view = sample_view();
    view.notices = vec!["saved a.png".into(), "cannot write b.csv".into()];
    let lesson = view.lesson.clone();
    let mut person = Person::before(view, TALL);
    assert!(
        person.sees(&lesson) && person.sees("cannot write b.csv") && !person.sees("saved a.png")
    );
    assert_eq!(person.click("Dismiss lesson"), []);
    assert_eq!(person.click("Dismiss notice"), []);
    assert!(!person.sees(&lesson) && !person.sees("cannot write b.csv"));

    // Another scene has another lesson; the same notice again is news.
    person.harness.state_mut().view.scene = "throw".into();
    person
        .harness
        .state_mut()
        .view
        .notices
        .push("cannot write b.csv".into());
    person.look();
    assert!(person.sees(&lesson) && person.sees("cannot write b.csv"));
}

#[test]
fn help_lists_every_key_and_closes() {
    let mut view = sample_view();
    view.show_help = true;
    let mut person = Person::before(view, Vec2::new(1280.0, 720.0));
    for (key, what) in KEYS {
        assert!(person.sees(key) && person.sees(what), "{key}");
    }
    // Esc belongs to the game's keys.
    person.harness.key_press(Key::Escape);
    assert_eq!(person.asked(), []);
    assert_eq!(
        person.click_on(Action::ResetParameters),
        [Action::ResetParameters]
    );
    assert_eq!(person.click("Close help"), [Action::ToggleHelp]);
}

#[test]
fn hidden_leaves_one_line_and_the_whole_picture() {
    let mut view = sample_view();
    view.hidden = true;
    view.paused = true;
    let mut person = Person::before(view, Vec2::new(1280.0, 720.0));
    let line = "Playground · ✚ Split · PAUSED · t = 12.35 s · 0.8 µs/step";
    let name = style::marked_name(Integrator::default());
    assert!(person.sees(&line.replace("✚ Split", &name)));
    assert!(!person.has("Restart") && !person.has("gravity"));
    // The harness keeps a margin of 8 points.
    let central = person.harness.state().layout.expect("drawn").central;
    assert_eq!(central.size(), Vec2::new(1264.0, 704.0));
    assert_eq!(person.click_on(Action::TogglePanel), [Action::TogglePanel]);
}

#[test]
fn the_table_has_a_row_for_every_integrator() {
    let mut view = sample_view();
    view.plot = Plot::Table;
    view.timings[1].cost = None;
    let person = Person::before(view.clone(), TALL);
    for heading in [
        "min [ns]",
        "median [ns]",
        "p95 [ns]",
        "force evals",
        "position error [m]",
        "attitude error [°]",
        "ΔE/E₀",
        "Δ|L|/|L₀|",
        "order",
        "state",
    ] {
        assert!(person.sees(heading), "{heading}");
    }
    for &integrator in Integrator::ALL {
        let trajectory = view
            .compare
            .trajectories
            .iter()
            .find(|l| l.integrator == integrator);
        let main_box = trajectory.is_some_and(|t| t.main_box);
        let cell = format!(
            "{}{}",
            integrator.name(),
            if main_box { " · main box" } else { "" }
        );
        let mut cells = person.harness.query_all_by_label(&cell);
        let label = |node: Node<'_>| node.accesskit_node().role() == Role::Label;
        assert!(cells.any(label), "{cell}");
    }
    assert!(person.sees("…") && person.sees("1.0e-6"));
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
            "Minimum of nanoseconds per step of a box under every integrator over wall time, logarithmic",
        ),
        (
            Plot::Cpu,
            "CPU use over wall time, now 12 % this process, 30 % whole system",
        ),
    ] {
        let mut view = sample_view();
        view.plot = plot;
        let mut person = Person::before(view, Vec2::new(1280.0, 720.0));
        assert!(person.sees(words), "{words}");
        if plot == Plot::Timing {
            for &integrator in Integrator::ALL {
                assert!(
                    person.sees(&style::marked_name(integrator)),
                    "legend of {integrator}"
                );
            }
        }
        let middle = person.harness.get_by_label(words).rect().center();
        person.harness.hover_at(middle);
        assert_eq!(person.asked(), []);
    }
    // In a narrow drawer the plots stand one above the other, and the wheel scrolls through them.
    let mut person = Person::before(sample_view(), Vec2::new(600.0, 500.0));
    let place = |person: &Person| person.harness.get_by_label(ENERGY).rect();
    let before = place(&person);
    person
        .harness
        .hover_at(before.center_top() + Vec2::new(0.0, 20.0));
    person.harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        delta: Vec2::new(0.0, -30.0),
        phase: TouchPhase::Move,
        modifiers: Modifiers::NONE,
    });
    person.look();
    assert!(
        place(&person).top() < before.top() - 5.0,
        "{before:?} {:?}",
        place(&person)
    );
}

/// Plots stand still while they are looked at; the game does not.
#[test]
fn a_plot_under_the_pointer_is_frozen() {
    let mut person = Person::before(sample_view(), Vec2::new(1280.0, 720.0));
    let words = |person: &Person| {
        person
            .nodes()
            .into_iter()
            .find(|(_, name, _)| name.starts_with("energy drift"))
            .expect("a plot")
    };
    let (_, before, place) = words(&person);
    person.harness.hover_at(place.center());
    person.look();
    assert!(person.sees("⏸ frozen"));
    for trajectory in &mut person.harness.state_mut().view.compare.trajectories {
        trajectory.now = [0.5; 7];
    }
    person.look();
    assert_eq!(words(&person).1, before);
    person.harness.hover_at(bevy_egui::egui::pos2(5.0, 5.0));
    person.look();
    assert!(!person.sees("⏸ frozen"));
    assert!(words(&person).1.contains("Split 50"));
}

/// Best of twenty, so that a busy machine does not fail it; about 2 ms alone.
#[test]
fn a_frame_is_cheap_with_full_histories() {
    let mut view = sample_view();
    view.plot = Plot::Timing;
    for history in &mut view.history.timing {
        *history = (0..10_000)
            .map(|k| (f64::from(k), 100.0 + f64::from(k % 13)))
            .collect();
    }
    let mut person = Person::before(view, Vec2::new(1920.0, 1080.0));
    let frame = |_| {
        let start = std::time::Instant::now();
        person.harness.step();
        start.elapsed()
    };
    let best = (0..20).map(frame).min().expect("twenty");
    assert!(best.as_millis() < 15, "{best:?}");
}
