//! One number of the side panel: name, slider, typed value; a right click anywhere resets it.

use bevy_egui::egui::{
    DragValue, Label, PointerButton, Response, Slider, SliderClamping, Ui, WidgetInfo, WidgetType,
    vec2,
};

use super::format::{number, parse};
use super::memory::PanelMemory;
use super::widgets::identify;
use crate::action::Action;
use crate::parameters::{Effect, Info, Parameter, Parameters};

/// Widths of the name and of the typed value; the slider takes the rest [points].
const NAME: f32 = 88.0;
const VALUE: f32 = 104.0;

/// Draws the row and returns a new value: allowed, and other than the present one. A parameter that the
/// scene does not have has no row.
pub(super) fn row(
    ui: &mut Ui,
    parameter: Parameter,
    now: &Parameters,
    scene: &Parameters,
    memory: &mut PanelMemory,
) -> Option<Action> {
    let value = now.get(parameter)?;
    let default = scene.get(parameter).unwrap_or(value);
    let draft = memory.draft.filter(|(p, _)| *p == parameter);
    let shown = draft.map_or(value, |(_, draft)| draft);
    // A slider cannot stand at NaN; it stands at the default until moved.
    let shown = if shown.is_finite() { shown } else { default };
    let info = parameter.info();
    let (edited, dragging, reset) = ui.horizontal(|ui| widgets(ui, &info, shown, default)).inner;
    let new = |value: f64| parameter.nearest(value);
    let set = |new: f64| (new != value).then_some(Action::Set(parameter, new));
    if reset {
        memory.draft = None;
        return new(default).and_then(set);
    }
    if info.effect == Effect::Restart && dragging {
        memory.draft = Some((parameter, edited.unwrap_or(shown)));
        return None;
    }
    let dropped = memory.draft.take_if(|(p, _)| *p == parameter);
    let wanted = edited.or(dropped.map(|(_, draft)| draft))?;
    new(wanted).and_then(set)
}

/// Returns (a value other than `shown`, whether one is being dragged, whether to reset).
fn widgets(ui: &mut Ui, field: &Info, shown: f64, default: f64) -> (Option<f64>, bool, bool) {
    let height = ui.spacing().interact_size.y;
    let gap = ui.spacing().item_spacing.x;
    let name = if field.effect == Effect::Restart {
        format!("{} ↻", field.label)
    } else {
        field.label.to_owned()
    };
    let name = ui
        .scope(|ui| {
            ui.set_width(NAME);
            ui.set_height(height);
            ui.add(Label::new(name).truncate())
        })
        .inner;

    // The right button is for resetting: it must not drag on its way.
    let right = ui.input(|i| {
        i.pointer.button_down(PointerButton::Secondary)
            || i.pointer.button_released(PointerButton::Secondary)
    });

    let mut slid = shown;
    ui.spacing_mut().slider_width = (ui.available_width() - VALUE - gap).max(40.0);
    let mut slider = Slider::new(&mut slid, field.slider.0..=field.slider.1)
        .logarithmic(field.logarithmic)
        .clamping(SliderClamping::Edits)
        .show_value(false);
    if field.logarithmic && field.slider.0 == 0.0 {
        // Five decades above zero.
        slider = slider.smallest_positive(field.slider.1 * 1e-5);
    }
    if field.integer {
        slider = slider.integer();
    }
    let slider = ui.add(slider).labelled_by(name.id);
    slider.widget_info(|| WidgetInfo::slider(true, slid, named(field.label, field.unit)));
    identify(&slider, field.id);

    let mut typed = shown;
    let speed = if field.logarithmic {
        (shown.abs() * 0.01).max((field.slider.1 - field.slider.0) * 1e-5)
    } else {
        (field.slider.1 - field.slider.0) * 0.005
    };
    let suffix = if field.unit.is_empty() {
        String::new()
    } else {
        format!(" {}", field.unit)
    };
    let value = DragValue::new(&mut typed)
        .range(field.range.0..=field.range.1)
        .clamp_existing_to_range(false)
        .speed(if field.integer { speed.max(0.1) } else { speed })
        .update_while_editing(false)
        .suffix(suffix)
        .custom_formatter(|value, _| number(value))
        .custom_parser(parse);
    let value = ui
        .add_sized(vec2(VALUE.min(ui.available_width()), height), value)
        .labelled_by(name.id);
    value.widget_info(|| WidgetInfo {
        label: Some(named(&format!("{} value", field.label), field.unit)),
        value: Some(typed),
        ..WidgetInfo::new(WidgetType::DragValue)
    });

    identify(&value, format!("{} value", field.id));

    let mut reset = false;
    for response in [&name, &slider, &value] {
        reset |= response.contains_pointer()
            && ui.input(|i| i.pointer.button_clicked(PointerButton::Secondary));
        explain(response, field, shown, default);
    }
    let edited = if right {
        None
    } else if slid != shown {
        Some(slid)
    } else {
        // The text shows four digits: leaving it as it stood is no change.
        Some(typed).filter(|typed| number(*typed) != number(shown))
    };
    (
        edited,
        !right && (slider.dragged() || value.dragged()),
        reset,
    )
}

/// Accessible name of a widget: `Gravity [m/s²]`.
fn named(label: &str, unit: &str) -> String {
    if unit.is_empty() {
        label.to_owned()
    } else {
        format!("{label} [{unit}]")
    }
}

/// The tooltip: what it is, value and default with units, range, and how to reset.
fn explain(response: &Response, field: &Info, shown: f64, default: f64) {
    response.clone().on_hover_ui(|ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        let with_unit = |value: f64| {
            if field.unit.is_empty() {
                number(value)
            } else {
                format!("{} {}", number(value), field.unit)
            }
        };
        ui.label(format!(
            "{} {} (default {} · right-click resets)",
            field.label,
            with_unit(shown),
            with_unit(default)
        ));
        ui.label(field.hint);
        ui.label(format!(
            "Allowed: {} to {}.",
            number(field.range.0),
            with_unit(field.range.1)
        ));
        if field.effect == Effect::Restart {
            ui.label("↻ A change restarts the scene.");
        }
    });
}
