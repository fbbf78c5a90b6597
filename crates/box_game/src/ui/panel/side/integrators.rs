//! The section of the integrators: the compared ones with verdict and cost, and the list of all. It also shows the cost
//! of a step by stage, and layout and fairness of the comparisons.

use bevy_egui::egui::{
    Align, AtomExt as _, Button, Checkbox, CollapsingHeader, Color32, Label, Layout, Painter, Rect,
    RichText, Sense, TextFormat, TextStyle, Ui, WidgetInfo, WidgetType, text::LayoutJob, vec2,
};
use box_bench::measure::Cost;
use box_physics::plugin::Stage;
use box_physics::prelude::Integrator;
use box_scenarios::dissertation::Stepper;

use super::super::format::number;
use super::super::view::PanelView;
use super::super::widgets::{Panel, Text, button, describe, id_of, identify, note};
use crate::action::Action;
use crate::action::compare::{CompareAction, Fairness, Layout as Layouts};
use crate::compare::TrajectoryView;
use crate::compare::verdict::short;
use crate::view::style;

pub(super) fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    compared(ui, panel);
    step_cost(ui, panel.view);
    let all = CollapsingHeader::new("Add or switch").default_open(panel.memory.all_open);
    let all = all.show_unindented(ui, |ui| list(ui, panel));
    identify(&all.header_response, "section all integrators");
    together(ui, panel);
}

/// Lists the trajectories in the picture: the reference, the main box and the comparisons, with verdict and cost.
fn compared(ui: &mut Ui, panel: &mut Panel<'_>) {
    let view = &panel.view.compare;
    if !view.reference.is_empty() {
        let text = format!("┄ Reference: {}", view.reference);
        ui.add(Label::new(text).truncate())
            .on_hover_text("Dashed white in the 3D view. Errors are relative to it.");
    }
    let stepper = panel.view.demo.as_ref().and_then(|demo| demo.stepper);
    let main = view.trajectories.iter().find(|t| t.main_box);
    let main = main.and_then(|t| t.cost).map_or(f64::NAN, |c| c.min);
    for trajectory in &view.trajectories {
        let stepper = stepper.filter(|_| trajectory.main_box);
        ui.horizontal(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let integrator = trajectory.integrator;
                if !trajectory.main_box {
                    let name = format!("Stop comparing {}", integrator.name());
                    let stop = Text("✖", &name, "Stop comparing this integrator.");
                    if button(ui, stop, &format!("stop {}", integrator.id())) {
                        panel.ask(CompareAction::ToggleComparison(integrator));
                    }
                }
                if stepper.is_none() {
                    let mut cost = nanoseconds(trajectory.cost.map(|cost| cost.min));
                    let ratio = trajectory.cost.map_or(f64::NAN, |cost| cost.min / main);
                    if !trajectory.main_box && ratio.is_finite() {
                        cost = format!("{}×  {cost}", short(ratio));
                    }
                    ui.add(Label::new(RichText::new(cost).monospace()).extend())
                        .on_hover_text(COST);
                }
                // A long name is cut, not its cost.
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(Label::new(name(ui, trajectory, stepper)).truncate());
                });
            });
        });
        let quality = trajectory.quality(view.attitude);
        let text = format!("    {} {quality}", quality.sign());
        note(ui, RichText::new(text).weak());
    }
}

/// Marker and name. For the main box, an integrator of 2012 that moves it replaces the name.
fn name(ui: &Ui, trajectory: &TrajectoryView, stepper: Option<Stepper>) -> LayoutJob {
    let mut job = LayoutJob::default();
    let font = TextStyle::Body.resolve(ui.style());
    let looks = style::of(trajectory.integrator);
    let mark = looks.glyph.to_string();
    let name = stepper.map_or(trajectory.integrator.name(), Stepper::name);
    let name = format!(" {name}");
    let main = if trajectory.main_box { " (main)" } else { "" };
    for (text, color) in [
        (mark.as_str(), looks.ink(ui.ctx().theme())),
        (&name, ui.visuals().text_color()),
        (main, ui.visuals().weak_text_color()),
    ] {
        job.append(text, 0.0, TextFormat::simple(font.clone(), color));
    }
    job
}

/// Formats a cost, or `…` if it is unknown.
fn nanoseconds(cost: Option<f64>) -> String {
    format!("{} ns", cost.map_or_else(|| "…".to_owned(), short))
}

/// Tooltip of a cost.
const COST: &str = "Cost per box and step in this scene, and its ratio to the main box's cost. Fastest sample of the \
                    last two seconds, as in sweep and report. The table also shows median and 95th percentile.";

/// Colors of the stages of a step.
const STAGES: [[u8; 3]; Stage::ALL.len()] = [
    [0x4C, 0x8D, 0xF0],
    [0xE6, 0x9F, 0x00],
    [0x8A, 0x93, 0xA0],
    [0x3F, 0xB0, 0x8A],
];

/// Draws the time of a plugin step by stage: the median as a stacked bar, and the last two seconds as columns.
fn step_cost(ui: &mut Ui, view: &PanelView) {
    let Some(stages) = view.stages_us else {
        return;
    };
    let total = |stages: &[f64]| stages.iter().filter(|t| t.is_finite()).sum::<f64>();
    let boxes = match view.parameters.boxes() {
        1 => "1 box".to_owned(),
        n => {
            let each = |us: f64| format!("{} ns each", short(1e3 * us / f64::from(n)));
            format!("{n} boxes, {}", view.measured(stages.iter().sum(), each))
        }
    };
    let text = format!("Step in the plugin: {} for {boxes}", view.step_time());
    note(ui, text);
    let size = vec2(ui.available_width(), 26.0);
    let (place, response) = ui.allocate_exact_size(size, Sense::hover());
    let named = |k: usize| {
        let time = view.measured(stages[k], |us| format!("{} µs", short(us)));
        format!("{} {time}", Stage::ALL[k].name())
    };
    let words: Vec<String> = (0..stages.len()).map(named).collect();
    describe(&response, &format!("Step by stage: {}", words.join(", ")));
    let colors = STAGES.map(|rgb| style::ink(rgb, ui.ctx().theme()));
    let painter = ui.painter_at(place);
    painter.rect_filled(place, 3.0, ui.visuals().extreme_bg_color);
    // The bar of now, over its whole width; below it the columns, the highest at full height.
    let bar = Rect::from_min_size(place.min, vec2(size.x, 9.0));
    let parts =
        |stages: &[f64; Stage::ALL.len()]| stages.iter().copied().zip(colors).collect::<Vec<_>>();
    stack(&painter, bar, &parts(&stages), total(&stages), false);
    let history = &view.stage_history;
    let most = history.iter().map(|s| total(s)).fold(1e-9, f64::max);
    let width = size.x / history.len().max(1) as f32;
    for (k, stages) in history.iter().enumerate() {
        let corner = bar.left_bottom() + vec2(k as f32 * width, 2.0);
        let column = vec2(width, place.bottom() - corner.y);
        let room = Rect::from_min_size(corner, column);
        stack(&painter, room, &parts(stages), most, true);
    }
    response.on_hover_ui(|ui| {
        ui.label("Median of the last two seconds, measured by the plugin, without rendering. The columns show single steps.");
        for (words, color) in words.iter().zip(colors) {
            ui.horizontal(|ui| {
                ui.colored_label(color, "■");
                ui.label(words);
            });
        }
    });
}

/// Draws stages side by side, or stacked if `upright`, in a `room` whose full length means `most`.
fn stack(painter: &Painter, room: Rect, parts: &[(f64, Color32)], most: f64, upright: bool) {
    let mut left = room;
    for &(time, color) in parts {
        let share = (time / most) as f32;
        if !share.is_finite() || share <= 0.0 {
            continue;
        }
        let part = if upright {
            left.split_top_bottom_at_y(left.bottom() - share * room.height())
        } else {
            let (part, rest) = left.split_left_right_at_x(left.left() + share * room.width());
            (rest, part)
        };
        painter.rect_filled(part.1.intersect(room), 0.0, color);
        left = part.0;
    }
}

/// Lists every integrator with checkbox, name and cost.
fn list(ui: &mut Ui, panel: &mut Panel<'_>) {
    let mut group = None;
    for &integrator in Integrator::ALL {
        if group.replace(integrator.info().group) != Some(integrator.info().group) {
            ui.weak(integrator.info().group.name());
        }
        ui.horizontal(|ui| {
            tick(ui, panel, integrator);
            let active = active(panel.view);
            if row(ui, panel.view, integrator) && active != Some(integrator) {
                if active.is_none() {
                    panel.ask(Action::SetDemo(None));
                }
                panel.ask(Action::SetIntegrator(integrator));
            }
        });
    }
    ui.small("☑ compare · click a name to switch · ns per box and step");
}

/// The integrator that moves the box; `None` while one of 2012 does.
fn active(view: &PanelView) -> Option<Integrator> {
    let demo = view.demo.as_ref().and_then(|demo| demo.stepper);
    demo.is_none().then_some(view.integrator)
}

/// Adds the checkbox that compares an integrator.
fn tick(ui: &mut Ui, panel: &mut Panel<'_>, integrator: Integrator) {
    let main_box = integrator == panel.view.integrator;
    let mut compared = panel.view.compare.trajectories.iter();
    let mut on = main_box || compared.any(|l| l.integrator == integrator);
    let response = ui.add_enabled(!main_box, Checkbox::without_text(&mut on));
    response.widget_info(|| {
        let name = format!("Compare {}", integrator.name());
        WidgetInfo::selected(WidgetType::Checkbox, !main_box, on, name)
    });
    let action = Action::from(CompareAction::ToggleComparison(integrator));
    identify(&response, id_of(&action));
    let hint = "Run it on the same scene with the same inputs (Shift + its key).";
    if response.on_hover_text(hint).changed() {
        panel.ask(action);
    }
}

fn together(ui: &mut Ui, panel: &mut Panel<'_>) {
    let view = &panel.view.compare;
    let now = view.settings;
    panel.choices(ui, now.layout, Layouts::ALL, CompareAction::SetLayout);
    panel.choices(ui, now.fairness, Fairness::ALL, CompareAction::SetFairness);
    #[rustfmt::skip]
    let buttons = [
        ("Compare all", "Compare every integrator.", CompareAction::CompareAll),
        ("Compare none", "Remove all comparisons.", CompareAction::CompareNone),
        ("Re-sync", "Set the main box and all comparisons to the reference state.", CompareAction::Resync),
    ];
    panel.buttons(ui, buttons);
    if !view.note.is_empty() {
        ui.small(&view.note);
    }
}

/// Draws one row; returns `true` if it was clicked.
fn row(ui: &mut Ui, view: &PanelView, integrator: Integrator) -> bool {
    let active = active(view) == Some(integrator);
    let timing = view.timings.get(integrator.index()).and_then(|t| t.0);
    let cost = nanoseconds(timing.map(|cost| cost.min));
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    // Marks differ in width; the names line up.
    let glyph = style::of(integrator).glyph;
    let mark = match active {
        // On the accent, every mark has the color of the text.
        true => RichText::new(glyph),
        false => style::in_ink(ui, integrator, glyph),
    };
    let mark = mark.size(15.0).atom_size(vec2(16.0, 14.0));
    let [suffix, prefix] = if active {
        [" · active", "active, "]
    } else {
        [""; 2]
    };
    let row = Button::selectable(active, (mark, format!("{}{suffix}", integrator.name())))
        .right_text(RichText::new(&cost).monospace())
        .min_size(size)
        .truncate();
    let response = ui.add(row);
    response.widget_info(|| WidgetInfo {
        current_text_value: Some(format!("{prefix}{cost}")),
        ..WidgetInfo::selected(WidgetType::RadioButton, true, active, integrator.name())
    });
    identify(&response, id_of(&Action::SetIntegrator(integrator)));
    let clicked = response.clicked();
    response.on_hover_ui(|ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        for line in properties(integrator, timing) {
            ui.label(line);
        }
    });
    clicked
}

/// Lines of the tooltip, from the properties of the integrator.
fn properties(integrator: Integrator, timing: Option<Cost>) -> Vec<String> {
    let info = integrator.info();
    let (orders, evaluations) = (info.orders, info.evaluations);
    let part = if evaluations.per_iteration {
        "iteration"
    } else {
        "step"
    };
    let mut lines = vec![
        info.summary.to_owned(),
        format!(
            "Order: rotation {}, gravity {}.",
            orders.rotation, orders.gravity
        ),
        format!(
            "Force evaluations per {part}: {} in free flight, {} with a state-dependent force.",
            evaluations.free, evaluations.forced
        ),
        format!("Energy of a free spin: {}.", info.conserved.energy),
    ];
    if let Some(cost) = timing {
        let [min, median, p95] = [cost.min, cost.median, cost.p95].map(number);
        lines.push(format!(
            "ns per box and step in this scene: min {min}, median {median}, p95 {p95}."
        ));
    }
    if let Some(key) = box_scenarios::style::key(integrator) {
        lines.push(format!("Key: {key}."));
    }
    lines.push(format!("Source: {}", info.source));
    lines
}
