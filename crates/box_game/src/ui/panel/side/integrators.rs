//! A row for every integrator: checkbox, mark, name and present cost; below, layout and fairness of the
//! comparisons.

use bevy_egui::egui::{AtomExt as _, Button, Checkbox, RichText, Ui, WidgetInfo, WidgetType, vec2};
use box_physics::prelude::Integrator;

use super::super::format::{number, quantity};
use super::super::view::{IntegratorTiming, PanelView};
use super::super::widgets::{button, toggle};
use crate::action::Action;
use crate::action::compare::{CompareAction, Fairness, Layout};
use crate::view::style;

pub(super) fn show(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let mut group = None;
    for &integrator in Integrator::ALL {
        if group.replace(integrator.info().group) != Some(integrator.info().group) {
            ui.weak(integrator.info().group.name());
        }
        ui.horizontal(|ui| {
            if tick(ui, view, integrator) {
                out.push(Action::Compare(CompareAction::ToggleComparison(integrator)));
            }
            if row(ui, view, integrator) && active(view) != Some(integrator) {
                if active(view).is_none() {
                    out.push(Action::SetDemo(None));
                }
                out.push(Action::SetIntegrator(integrator));
            }
        });
    }
    ui.label(RichText::new("☑ compare · click a name to switch · median ns per body-step").small());
    together(ui, view, out);
}

/// The integrator that moves the box; none while a stepper of 2012 does.
fn active(view: &PanelView) -> Option<Integrator> {
    let demo = view.demo.as_ref().and_then(|demo| demo.stepper);
    demo.is_none().then_some(view.integrator)
}

/// The checkbox that compares an integrator; returns whether it was changed.
fn tick(ui: &mut Ui, view: &PanelView, integrator: Integrator) -> bool {
    let main_box = integrator == view.integrator;
    let trajectories = &view.compare.trajectories;
    let mut on = main_box || trajectories.iter().any(|l| l.integrator == integrator);
    let response = ui.add_enabled(!main_box, Checkbox::without_text(&mut on));
    response.widget_info(|| {
        let name = format!("Compare {}", integrator.name());
        WidgetInfo::selected(WidgetType::Checkbox, !main_box, on, name)
    });
    response
        .on_hover_text("Compare it on the same scene, with the same inputs (Shift + its key).")
        .changed()
}

/// Layout, fairness, re-sync.
fn together(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let settings = &view.compare.settings;
    let mut ask = |action| out.push(Action::Compare(action));
    ui.horizontal_wrapped(|ui| {
        ui.label("Layout");
        for layout in Layout::ALL {
            let hint = match layout {
                Layout::Solo => "The main box alone (G).",
                Layout::Overlaid => "All in one place, comparisons translucent (G).",
                Layout::SideBySide => "Side by side; only the picture is shifted (V).",
                Layout::Views => "One view each, for up to four (V).",
            };
            let chosen = settings.layout == layout;
            if toggle(ui, chosen, layout.name(), hint) && !chosen {
                ask(CompareAction::SetLayout(layout));
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        for fairness in Fairness::ALL {
            let hint = match fairness {
                Fairness::Step => "Same step for every integrator.",
                Fairness::Evaluations => "Same force evaluations per simulated second.",
                Fairness::Cost => "Same measured cost per simulated second.",
            };
            let chosen = settings.fairness == fairness;
            if toggle(ui, chosen, fairness.name(), hint) && !chosen {
                ask(CompareAction::SetFairness(fairness));
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
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
            (
                "Re-sync",
                "Move the main box and every comparison to the reference's state.",
                CompareAction::Resync,
            ),
        ] {
            if button(ui, name, hint) {
                ask(action);
            }
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
    let cost = timing.and_then(|timing| timing.nanoseconds).map_or_else(
        || "… ns".to_owned(),
        |(_, median, _)| format!("{} ns", quantity(median)),
    );
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    let looks = style::of(integrator);
    // Marks differ in width; the names line up.
    let mark = RichText::new(looks.glyph)
        .color(looks.color())
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
    if let Some((min, median, p95)) = timing.and_then(|timing| timing.nanoseconds) {
        lines.push(format!(
            "ns per body-step on this scene's bodies: min {}, median {}, 95 % under {}.",
            number(min),
            number(median),
            number(p95)
        ));
    }
    if let Some(key) = box_scenarios::style::key(integrator) {
        lines.push(format!("Key: {key}."));
    }
    lines.push(format!("Source: {}", info.source));
    lines
}
