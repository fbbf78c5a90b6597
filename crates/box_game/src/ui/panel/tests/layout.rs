//! Layout tests: nothing is outside the window or overlaps at any size and scale, and no contents of a view cause a
//! panic.

use bevy_egui::egui::{self, Rect, TextStyle, Vec2, accesskit::Role, pos2, vec2};
use box_bench::measure::Cost;
use box_physics::prelude::DVec3;
use box_scenarios::dissertation::Stepper;
use box_scenarios::{Divergence, Reason, Scenario, Status};

use super::super::drawer::TABS;
use super::super::{FIGURES, PanelLayout, PanelMemory, PanelView, SHARE};
use super::{Person, TALL, USUAL, demo, sample_view, with};
use crate::action::{Action, Plot};
use crate::compare::{CompareView, Mark, MarkKind};
use crate::parameters::{Parameter, Parameters};

/// 1280×720 at 75, 100, 125, 150 and 200 %, 1920×1080 at 75, 100 and 200 %, a narrow window: points.
const SIZES: [(f32, f32); 9] = [
    (900.0, 720.0),
    (1024.0, 576.0),
    (960.0, 540.0),
    (1706.0, 960.0),
    (1280.0, 720.0),
    (853.0, 480.0),
    (640.0, 360.0),
    (2560.0, 1440.0),
    (1920.0, 1080.0),
];

fn long() -> PanelView {
    let mut view = sample_view();
    view.scenario.title = "A scene with a title far longer than any list has room for";
    view.scenes[0].title = view.scenario.title;
    view.scenario.lesson = "A lesson of some length that must wrap onto a second line in a narrow window. \
         A lesson of some length that must wrap onto a second line in a narrow window. ";
    (view.time, view.steps) = (12_345.678, 9_999_999_999);
    (view.parameters.step, view.parameters.substeps) = (0.012_345, 64.0);
    (view.speed, view.actual_speed) = (0.25, Some(0.12));
    let folder = "very-long-folder".repeat(6);
    let path = format!("/home/somebody/{folder}/run-0007-of-a-long-name-indeed.csv");
    view.log = Some((path, 123_456_789));
    view.software_rendering = true;
    view.notices = vec!["cannot write /a/b/c.csv: no space left on device".into()];
    view.parameters.linear_drag = 1.234e-5;
    for (k, trajectory) in view.compare.trajectories.iter_mut().enumerate() {
        trajectory.status = Status::Diverged(Divergence {
            t: 12345.6,
            reason: Reason::Energy,
        });
        trajectory.skew = 0.012_345 * k as f64;
        trajectory.now = [-1.234_567e-9; 7];
    }
    let kinds = [
        MarkKind::Contact,
        MarkKind::Flip,
        MarkKind::Input,
        MarkKind::Step,
        MarkKind::Integrator,
    ];
    view.compare.marks = kinds.map(|kind| Mark { t: 1.0, kind }).into();
    view.compare.note = "The comparisons simulate only the first box.".into();
    view.figures = [-1.234_567e-9; FIGURES.len()];
    for (cost, _) in &mut view.timings {
        *cost = Some(Cost::of(&[123_456.7, 234_567.8, 345_678.9]));
    }
    view
}

/// Text and widgets; not panels, scroll areas and other containers.
fn leaves(person: &Person) -> Vec<(String, Rect)> {
    let kinds = [
        Role::Button,
        Role::CheckBox,
        Role::ComboBox,
        Role::Label,
        Role::RadioButton,
        Role::Slider,
        Role::SpinButton,
        Role::Image,
    ];
    let nodes = person.nodes().into_iter();
    let nodes = nodes.filter(|(role, ..)| kinds.contains(role));
    nodes.map(|(_, name, rect)| (name, rect)).collect()
}

/// Returns `true` for each axis (x, y) along which `rect` may extend beyond the window. Side panel and drawer scroll
/// vertically; the table in the drawer also scrolls horizontally.
fn scrolls(layout: &PanelLayout, rect: Rect, plot: Plot) -> [bool; 2] {
    let side = rect.left() >= layout.central.right();
    let below = rect.top() > layout.central.bottom();
    [below && plot == Plot::Table, side || below]
}

fn check_layout(person: &Person, size: Vec2, what: &str) {
    let screen = Rect::from_min_size(egui::Pos2::ZERO, size);
    let (plot, layout) = (person.harness.state().view.plot, person.layout());
    assert!(screen.contains_rect(layout.central), "{what}: {layout:?}");
    let leaves = leaves(person);
    for (k, (name, rect)) in leaves.iter().enumerate() {
        let [aside, down] = scrolls(&layout, *rect, plot);
        let across = screen.left() <= rect.left() && rect.right() <= screen.right() + 0.5;
        let upright = screen.top() <= rect.top() && rect.bottom() <= screen.bottom() + 0.5;
        assert!(
            (aside || across) && (down || upright),
            "{what}: {name} at {rect:?}"
        );
        for (other, there) in &leaves[..k] {
            let common = rect.shrink(1.0).intersect(there.shrink(1.0));
            // What is scrolled aside is out of sight.
            let hidden = aside || scrolls(&layout, *there, plot)[0];
            // This plot has its legend inside, and hints their buttons.
            let holds = |n: &String| ["CPU usage", "Try: "].iter().any(|s| n.starts_with(s));
            let inside = holds(name) || holds(other);
            let apart = hidden || inside || !common.is_positive();
            assert!(apart, "{what}: {name} at {rect:?} and {other} at {there:?}");
        }
    }
}

/// All texts at their longest.
#[test]
fn nothing_is_cut_or_covered() {
    for size in SIZES.into_iter().chain([TALL.into()]) {
        for (plot, ..) in TABS {
            let mut view = long();
            view.plot = plot;
            let person = Person::before(view, size.into());
            check_layout(&person, size.into(), &format!("{size:?} {plot:?}"));
        }
    }
}

/// Every scene fits with every tab at every size, and the picture keeps its share of the window.
#[test]
fn every_scene_fits() {
    for size in SIZES {
        let memory = PanelMemory::default();
        let mut person = Person::remembering(memory, sample_view(), size.into());
        for scene in Scenario::ALL.iter().map(|build| build()) {
            for (plot, ..) in TABS {
                let view = person.view();
                view.scenario = scene.clone();
                view.parameters = Parameters::of(&scene);
                view.plot = plot;
                view.demo = (scene.id == crate::demo_2012::SCENE).then(demo);
                person.harness.run_steps(3);
                let what = format!("{} {size:?} {plot:?}", scene.id);
                check_layout(&person, size.into(), &what);
                let layout = person.layout();
                let share = layout.central.area() / (size.0 * size.1);
                // The harness keeps a margin of 8 points, of which the window's share knows nothing.
                let all = (size.0 - 16.0) * (size.1 - 16.0) / (size.0 * size.1);
                let enough = share >= SHARE * all - 1e-3;
                assert!(enough, "{what}: the picture has {share}");
                let covered = layout.captions / layout.central.height();
                assert!(covered < 0.5, "{what}: captions cover {covered}");
            }
        }
    }
}

/// Every character shown has a glyph in egui's default fonts.
#[test]
fn no_character_is_a_hollow_box() {
    let mut texts = String::new();
    for (plot, ..) in TABS {
        for paused in [false, true] {
            let mut view = long();
            (view.plot, view.paused, view.show_help) = (plot, paused, paused);
            let person = Person::before(view, TALL);
            texts.extend(person.nodes().into_iter().map(|(_, name, _)| name));
        }
    }
    for scene in Scenario::ALL.iter().map(|build| build()) {
        texts.extend([scene.title, scene.lesson].into_iter().chain(scene.hints));
    }
    texts.extend(crate::demo_2012::FAULTS);
    texts.extend(Stepper::ALL.map(|s| s.fault()));
    texts.push_str("☰⏮↶↷⏸ Pause▶⏭⟲◂▸✖↻·…−×½ωγµ");
    let person = with(|view| view.hidden = true);
    texts.extend(person.nodes().into_iter().map(|(_, name, _)| name));

    let context = &person.harness.ctx;
    let font = TextStyle::Body.resolve(&context.global_style());
    let glyph = |c: char| {
        let (text, font) = (c.to_string(), font.clone());
        let galley = context.fonts_mut(|f| f.layout_no_wrap(text, font, egui::Color32::WHITE));
        let uv = galley.rows[0].glyphs[0].uv_rect;
        (uv.min, uv.max)
    };
    // A character of no font: what the replacement looks like.
    let hollow = glyph('\u{10fffd}');
    for c in texts.chars().filter(|c| !c.is_whitespace()) {
        assert!(glyph(c) != hollow, "no glyph for {c} (U+{:04X})", c as u32);
    }
}

#[test]
fn nothing_a_view_may_hold_makes_it_panic() {
    let nan = f64::NAN;
    let mut broken = long();
    (broken.time, broken.speed, broken.actual_speed) = (nan, nan, Some(nan));
    broken.parameters.step = nan;
    (broken.stages_us, broken.frame_time_ms, broken.dropped) = (Some([nan; 4]), f64::INFINITY, nan);
    broken.scenario.id = "deleted";
    broken.parameters.gravity = nan;
    broken.parameters.friction = Some(f64::INFINITY);
    broken.parameters.half_extents = DVec3::NAN;
    broken.figures = [nan; FIGURES.len()];
    broken.figures[5] = f64::NEG_INFINITY;
    for (k, timing) in broken.timings.iter_mut().enumerate() {
        *timing = ((k % 2 == 0).then(|| Cost::of(&[nan])), nan);
    }
    let long_run = |k: u32| match k.is_multiple_of(777) {
        true => nan,
        false => f64::from(k % 97),
    };
    let integrators = broken.timings.len();
    for trajectory in &mut broken.compare.trajectories {
        trajectory.now = [nan; 7];
        (trajectory.dt, trajectory.energies) = (nan, [nan, f64::INFINITY, -1e300]);
        for (_, points) in &mut trajectory.lines {
            let point = |k| [f64::from(k) / 60.0, 1e300 * long_run(k)];
            *points = (0..1000).map(point).collect();
        }
    }
    let times = (0..10_000).map(f64::from);
    let runs = times.zip((0..10_000).map(long_run));
    broken.timing_history = vec![runs.clone().collect(); integrators];
    broken.cpu_history = runs.map(|(t, run)| (t, run, nan)).collect();
    broken.grain = Some((1e300, nan));
    let mut empty = sample_view();
    empty.scenes.clear();
    empty.timings.clear();
    (empty.timing_history, empty.cpu_history) = (vec![], vec![]);
    empty.compare = CompareView::default();
    (empty.actual_speed, empty.scenario.lesson) = (None, "");
    (empty.parameters.restitution, empty.parameters.friction) = (None, None);
    let mut one_point = sample_view();
    for trajectory in &mut one_point.compare.trajectories {
        trajectory.lines.iter_mut().for_each(|(_, p)| p.truncate(1));
    }
    one_point.cpu_history = vec![(f64::INFINITY, 1.0, 1.0)];
    one_point.no_cpu = Some("CPU usage is not available in a browser");
    for view in [broken, empty, one_point] {
        for (plot, ..) in TABS {
            for hidden in [false, true] {
                let view = PanelView {
                    plot,
                    hidden,
                    show_help: hidden,
                    ..view.clone()
                };
                let mut person = Person::before(view, USUAL);
                assert_eq!(person.asked(), [], "asks for nothing by itself");
                person.harness.hover_at(pos2(300.0, 600.0));
                assert_eq!(person.asked(), []);
            }
        }
    }
}

/// A slider at NaN can still be set.
#[test]
fn a_broken_value_can_be_mended() {
    let mut person = with(|view| view.parameters.gravity = f64::NAN);
    person.find("gravity").click_secondary();
    assert_eq!(person.asked(), [Action::Set(Parameter::Gravity, 9.81)]);
}

#[test]
fn a_window_too_small_for_anything_is_survived() {
    for size in [vec2(320.0, 200.0), vec2(60.0, 40.0), vec2(1.0, 1.0)] {
        let person = Person::remembering(PanelMemory::default(), long(), size);
        let central = person.layout().central;
        assert!(central.width() >= 0.0 && central.height() >= 0.0);
    }
}
