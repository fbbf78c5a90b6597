//! Every scheme as a row to choose: its looks, name, and what it costs now.

use bevy_egui::egui::{AtomExt as _, Button, RichText, Ui, WidgetInfo, WidgetType, vec2};
use box_physics::prelude::Integrator;

use super::super::format::{number, quantity};
use super::super::view::{PanelView, SchemeTiming};
use crate::action::Action;
use crate::style;

pub(super) fn show(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    for &integrator in Integrator::ALL {
        if row(ui, view, integrator) && integrator != view.integrator {
            out.push(Action::SetIntegrator(integrator));
        }
    }
    ui.label(
        RichText::new("median ns per body-step of this scene's load, for every scheme").small(),
    );
}

/// Draws one row and returns whether it was chosen.
fn row(ui: &mut Ui, view: &PanelView, integrator: Integrator) -> bool {
    let active = integrator == view.integrator;
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
    let button = Button::selectable(active, (mark, name))
        .right_text(RichText::new(cost.clone()).monospace())
        .min_size(size)
        .truncate();
    let response = ui.add(button);
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

/// The tooltip, all from what the scheme says of itself.
fn describe(integrator: Integrator, timing: Option<&SchemeTiming>) -> Vec<String> {
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
            "ns per body-step: min {}, median {}, 95 % under {}.",
            number(min),
            number(median),
            number(p95)
        ));
    }
    lines.push(format!("Source: {}", info.source));
    lines
}
