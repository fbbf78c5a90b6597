//! What is compared, with verdict and cost; the cost of a step by stage; the list of every integrator; layout and
//! fairness of the comparisons.

use bevy_egui::egui::{
    Align, AtomExt as _, Button, Checkbox, CollapsingHeader, Color32, Label, Layout, Painter, Rect,
    RichText, Sense, TextFormat, TextStyle, Ui, WidgetInfo, WidgetType, pos2, text::LayoutJob,
    vec2,
};
use box_physics::plugin::Stage;
use box_physics::prelude::Integrator;

use super::super::format::number;
use super::super::memory::PanelMemory;
use super::super::view::{IntegratorTiming, PanelView};
use super::super::widgets::{Text, button, choice, id_of, identify, own_button, text};
use crate::action::Action;
use crate::action::compare::{self, CompareAction, Fairness};
use crate::compare::verdict::short;
use crate::view::style;

pub(super) fn show(ui: &mut Ui, view: &PanelView, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    compared(ui, view, out);
    step_cost(ui, view);
    let list = CollapsingHeader::new("Add or switch")
        .open(Some(memory.all_integrators))
        .show_unindented(ui, |ui| list(ui, view, out));
    identify(&list.header_response, "section all integrators");
    if list.header_response.clicked() {
        memory.all_integrators ^= true;
    }
    together(ui, view, out);
}

/// What is on the picture: the reference, the main box and the comparisons, with verdict and cost.
fn compared(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    if !view.compare.reference.is_empty() {
        let text = format!("┄ Reference: {}", view.compare.reference);
        ui.add(Label::new(text).truncate())
            .on_hover_text("Dashed white in the picture. Errors are measured against it.");
    }
    let main = view.compare.trajectories.iter().find(|t| t.main_box);
    let main = main.and_then(|t| t.cost).map_or(f64::NAN, |c| c.min);
    for trajectory in &view.compare.trajectories {
        let integrator = trajectory.integrator;
        ui.horizontal(|ui| {
            let mut job = LayoutJob::default();
            let font = TextStyle::Body.resolve(ui.style());
            let mut append = |text: &str, color| {
                job.append(text, 0.0, TextFormat::simple(font.clone(), color));
            };
            let looks = style::of(integrator);
            append(looks.glyph, looks.ink(ui.ctx().theme()));
            let name = format!(" {}", integrator.name());
            append(&name, ui.visuals().text_color());
            if trajectory.main_box {
                append(" (main)", ui.visuals().weak_text_color());
            }
            ui.add(Label::new(job).extend());
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if !trajectory.main_box {
                    let name = format!("Stop comparing {}", integrator.name());
                    let stop = Text("✖", &name, "Stop comparing this integrator.");
                    if own_button(ui, stop, &format!("stop {}", integrator.id())) {
                        out.push(CompareAction::ToggleComparison(integrator).into());
                    }
                }
                let cost = trajectory.cost.map_or_else(
                    || "… ns".to_owned(),
                    |cost| {
                        let ratio = cost.min / main;
                        let ratio = (!trajectory.main_box && ratio.is_finite())
                            .then(|| format!("{}×  ", short(ratio)));
                        format!("{}{} ns", ratio.unwrap_or_default(), short(cost.min))
                    },
                );
                ui.add(Label::new(RichText::new(cost).monospace()).truncate())
                    .on_hover_text(COST);
            });
        });
        let quality = trajectory.quality(view.compare.attitude);
        let text = RichText::new(format!("    {} {quality}", quality.sign()))
            .small()
            .weak();
        ui.add(Label::new(text).truncate());
    }
}

/// What the figures of cost are.
const COST: &str = "Cost of a step of a box in this scene, and over that of the main box: the fastest sample of the \
                    last two seconds, as in sweep and report. Median and 95th percentile stand in the table.";

/// Colors of the stages of a step.
const STAGES: [Color32; Stage::ALL.len()] = [
    Color32::from_rgb(0x4C, 0x8D, 0xF0),
    Color32::from_rgb(0xE6, 0x9F, 0x00),
    Color32::from_rgb(0x8A, 0x93, 0xA0),
    Color32::from_rgb(0x3F, 0xB0, 0x8A),
];

/// Time of a step in the plugin by stage: a stacked bar of now, and the last two seconds as columns.
pub(super) fn step_cost(ui: &mut Ui, view: &PanelView) {
    let Some(stages) = view.stages_us else {
        return;
    };
    let boxes = match view.parameters.boxes() {
        1 => "1 box".to_owned(),
        n => {
            let each = 1e3 * stages.iter().sum::<f64>() / f64::from(n);
            format!("{n} boxes, {} ns each", short(each))
        }
    };
    let text = format!("Step in the plugin: {} for {boxes}", view.step_time());
    ui.add(Label::new(RichText::new(text).small()).truncate());
    let width = ui.available_width();
    let (place, response) = ui.allocate_exact_size(vec2(width, 26.0), Sense::hover());
    let words: Vec<String> = Stage::ALL
        .into_iter()
        .zip(stages)
        .map(|(stage, time)| format!("{} {} µs", stage.name(), short(time)))
        .collect();
    let words = words.join(", ");
    response.widget_info(|| {
        WidgetInfo::labeled(WidgetType::Image, true, format!("Step by stage: {words}"))
    });
    let painter = ui.painter_at(place);
    painter.rect_filled(place, 3.0, ui.visuals().extreme_bg_color);
    let total = |stages: &[f64]| stages.iter().filter(|t| t.is_finite()).sum::<f64>();
    // The bar of now, over its whole width; below it the columns, the highest at full height.
    let bar = Rect::from_min_size(place.min, vec2(width, 9.0));
    stack(&painter, bar, &stages, total(&stages), false);
    let most = view
        .stage_history
        .iter()
        .map(|s| total(s))
        .fold(1e-9, f64::max);
    let count = view.stage_history.len().max(1) as f32;
    let low = Rect::from_min_max(pos2(place.left(), bar.bottom() + 2.0), place.max);
    for (k, stages) in view.stage_history.iter().enumerate() {
        let left = low.left() + k as f32 / count * low.width();
        let column = Rect::from_min_max(
            pos2(left, low.top()),
            pos2(left + low.width() / count, low.bottom()),
        );
        stack(&painter, column, stages, most, true);
    }
    response.on_hover_ui(|ui| {
        ui.label("Median of the last two seconds by the plugin's own clock, without rendering; below, each step.");
        for ((stage, time), color) in Stage::ALL.into_iter().zip(stages).zip(STAGES) {
            ui.horizontal(|ui| {
                ui.colored_label(color, "■");
                ui.label(format!("{} {} µs", stage.name(), short(time)));
            });
        }
    });
}

/// Stages one after the other, or one above the other, in a room for `most`.
fn stack(painter: &Painter, room: Rect, stages: &[f64], most: f64, upright: bool) {
    let mut done = 0.0;
    for (time, color) in stages.iter().zip(STAGES) {
        let share = (time / most) as f32;
        if !share.is_finite() || share <= 0.0 {
            continue;
        }
        let part = if upright {
            let bottom = room.bottom() - done * room.height();
            Rect::from_min_max(
                pos2(room.left(), bottom - share * room.height()),
                pos2(room.right(), bottom),
            )
        } else {
            let left = room.left() + done * room.width();
            Rect::from_min_size(
                pos2(left, room.top()),
                vec2(share * room.width(), room.height()),
            )
        };
        painter.rect_filled(part.intersect(room), 0.0, color);
        done += share;
    }
}

/// Every integrator: checkbox, name and cost.
fn list(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let mut group = None;
    for &integrator in Integrator::ALL {
        if group.replace(integrator.info().group) != Some(integrator.info().group) {
            ui.weak(integrator.info().group.name());
        }
        ui.horizontal(|ui| {
            tick(ui, view, integrator, out);
            if row(ui, view, integrator) && active(view) != Some(integrator) {
                if active(view).is_none() {
                    out.push(Action::SetDemo(None));
                }
                out.push(Action::SetIntegrator(integrator));
            }
        });
    }
    ui.label(RichText::new("☑ compare · click a name to switch · ns per step of a box").small());
}

/// The integrator that moves the box; none while a stepper of 2012 does.
fn active(view: &PanelView) -> Option<Integrator> {
    let demo = view.demo.as_ref().and_then(|demo| demo.stepper);
    demo.is_none().then_some(view.integrator)
}

/// The checkbox that compares an integrator.
fn tick(ui: &mut Ui, view: &PanelView, integrator: Integrator, out: &mut Vec<Action>) {
    let main_box = integrator == view.integrator;
    let trajectories = &view.compare.trajectories;
    let mut on = main_box || trajectories.iter().any(|l| l.integrator == integrator);
    let response = ui.add_enabled(!main_box, Checkbox::without_text(&mut on));
    response.widget_info(|| {
        let name = format!("Compare {}", integrator.name());
        WidgetInfo::selected(WidgetType::Checkbox, !main_box, on, name)
    });
    let action = Action::from(CompareAction::ToggleComparison(integrator));
    identify(&response, id_of(&action));
    let hint = "Compare it on the same scene, with the same inputs (Shift + its key).";
    if response.on_hover_text(hint).changed() {
        out.push(action);
    }
}

/// Layout, fairness, re-sync.
fn together(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let settings = &view.compare.settings;
    ui.horizontal_wrapped(|ui| {
        ui.label("Layout");
        for layout in compare::Layout::ALL {
            let hint = match layout {
                compare::Layout::Solo => "The main box alone (G).",
                compare::Layout::Overlaid => "All in one place, comparisons as edges (G).",
                compare::Layout::SideBySide => "Side by side; only the picture is shifted (V).",
                compare::Layout::Views => "One view each, for up to four (V).",
            };
            let action = CompareAction::SetLayout(layout);
            choice(
                ui,
                settings.layout == layout,
                text(layout.name(), hint),
                action,
                out,
            );
        }
    });
    ui.horizontal_wrapped(|ui| {
        for fairness in Fairness::ALL {
            let hint = match fairness {
                Fairness::Step => "Same step for every integrator.",
                Fairness::Evaluations => "Same force evaluations per simulated second.",
                Fairness::Cost => "Same measured cost per simulated second.",
            };
            let action = CompareAction::SetFairness(fairness);
            choice(
                ui,
                settings.fairness == fairness,
                text(fairness.name(), hint),
                action,
                out,
            );
        }
    });
    ui.horizontal_wrapped(|ui| {
        let resync = "Move the main box and every comparison to the reference's state.";
        for (name, hint, action) in [
            (
                "Compare all",
                "Compare every integrator.",
                CompareAction::CompareAll,
            ),
            (
                "Compare none",
                "Compare nothing.",
                CompareAction::CompareNone,
            ),
            ("Re-sync", resync, CompareAction::Resync),
        ] {
            button(ui, text(name, hint), action, out);
        }
    });
    if !view.compare.note.is_empty() {
        ui.label(RichText::new(&view.compare.note).small());
    }
}

/// Draws one row and returns whether it was chosen.
fn row(ui: &mut Ui, view: &PanelView, integrator: Integrator) -> bool {
    let active = active(view) == Some(integrator);
    let timing = view
        .timings
        .iter()
        .find(|timing| timing.integrator == integrator);
    let cost = timing.and_then(|timing| timing.cost).map_or_else(
        || "… ns".to_owned(),
        |cost| format!("{} ns", short(cost.min)),
    );
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    let looks = style::of(integrator);
    // Marks differ in width; the names line up.
    let mark = RichText::new(looks.glyph)
        .color(looks.ink(ui.ctx().theme()))
        .size(15.0)
        .atom_size(vec2(16.0, 14.0));
    let name = if active {
        format!("{} · active", integrator.name())
    } else {
        integrator.name().into()
    };
    let row = Button::selectable(active, (mark, name))
        .right_text(RichText::new(cost.clone()).monospace())
        .min_size(size)
        .truncate();
    let response = ui.add(row);
    response.widget_info(|| WidgetInfo {
        current_text_value: Some(format!("{}{cost}", if active { "active, " } else { "" })),
        ..WidgetInfo::selected(WidgetType::RadioButton, true, active, integrator.name())
    });
    identify(&response, id_of(&Action::SetIntegrator(integrator)));
    let clicked = response.clicked();
    response.on_hover_ui(|ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        for line in describe(integrator, timing) {
            ui.label(line);
        }
    });
    clicked
}

/// The tooltip, all from what the integrator says of itself.
fn describe(integrator: Integrator, timing: Option<&IntegratorTiming>) -> Vec<String> {
    let info = integrator.info();
    let mut lines = vec![
        info.summary.to_owned(),
        format!(
            "Order: rotation {}, gravity {}.",
            info.orders.rotation, info.orders.gravity
        ),
        format!(
            "Force evaluations per {}: {} in free flight, {} with a state-dependent force.",
            if info.evaluations.per_iteration {
                "iteration"
            } else {
                "step"
            },
            info.evaluations.free,
            info.evaluations.forced
        ),
        format!("Energy of a free spin: {}.", info.keeps.energy),
    ];
    if let Some(cost) = timing.and_then(|timing| timing.cost) {
        lines.push(format!(
            "ns per step of a box in this scene: min {}, median {}, 95 % under {}.",
            number(cost.min),
            number(cost.median),
            number(cost.p95)
        ));
    }
    if let Some(key) = box_scenarios::style::key(integrator) {
        lines.push(format!("Key: {key}."));
    }
    lines.push(format!("Source: {}", info.source));
    lines
}
