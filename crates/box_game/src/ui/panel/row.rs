//! One number of the side panel: name, slider, typed value. A right click anywhere resets it.

use bevy_egui::egui::{
    DragValue, Label, PointerButton, Slider, SliderClamping, Ui, WidgetInfo, WidgetType, vec2,
};

use super::format::{number, parse};
use super::widgets::{Panel, identify, mark};
use crate::action::Action;
use crate::parameters::{Effect, Info, Parameter};

/// Widths of the name and of the typed value; the slider fills the remaining width [points].
const NAME: f32 = 88.0;
const VALUE: f32 = 104.0;

/// Draws the row and requests a new value if it is allowed and differs from the current one. A parameter that the scene
/// does not have is not drawn.
pub(super) fn row(ui: &mut Ui, parameter: Parameter, panel: &mut Panel<'_>) {
    let Some(value) = panel.view.parameters.get(parameter) else {
        return;
    };
    let default = panel.view.defaults.get(parameter).unwrap_or(value);
    let draft = &mut panel.memory.draft;
    let dragged = draft.filter(|(p, _)| *p == parameter);
    let shown = dragged.map_or(value, |(_, draft)| draft);
    // A slider cannot show NaN; it shows the default until moved.
    let shown = if shown.is_finite() { shown } else { default };
    let info = parameter.info();
    let row = ui.horizontal(|ui| widgets(ui, &info, shown, default));
    let (edited, dragging, reset) = row.inner;
    let wanted = if reset {
        *draft = None;
        Some(default)
    } else if info.effect == Effect::Restart && dragging {
        *draft = Some((parameter, edited.unwrap_or(shown)));
        None
    } else {
        let dropped = draft.take_if(|(p, _)| *p == parameter);
        edited.or(dropped.map(|(_, draft)| draft))
    };
    mark(ui, panel.memory, info.label, &row.response);
    let new = wanted.and_then(|value| parameter.nearest(value));
    if let Some(new) = new.filter(|new| *new != value) {
        panel.ask(Action::Set(parameter, new));
    }
}

/// Returns a value other than `shown`, `true` if one is being dragged, and `true` to reset.
fn widgets(ui: &mut Ui, info: &Info, shown: f64, default: f64) -> (Option<f64>, bool, bool) {
    let height = ui.spacing().interact_size.y;
    let gap = ui.spacing().item_spacing.x;
    let (low, high) = info.slider;
    let restarts = info.effect == Effect::Restart;
    let name = format!("{}{}", info.label, if restarts { " ↻" } else { "" });
    let name = ui.scope(|ui| {
        ui.set_width(NAME);
        ui.set_height(height);
        ui.add(Label::new(name).truncate())
    });
    let name = name.inner;
    let [unit, in_unit] = match info.unit {
        "" => Default::default(),
        unit => [format!(" {unit}"), format!(" [{unit}]")],
    };

    // The right button resets; it must not drag as well.
    let secondary = PointerButton::Secondary;
    let right =
        ui.input(|i| i.pointer.button_down(secondary) || i.pointer.button_released(secondary));

    let mut slid = shown;
    ui.spacing_mut().slider_width = (ui.available_width() - VALUE - gap).max(40.0);
    let mut slider = Slider::new(&mut slid, low..=high)
        .logarithmic(info.logarithmic)
        .clamping(SliderClamping::Edits)
        .show_value(false);
    if info.logarithmic && low == 0.0 {
        // Five decades above zero.
        slider = slider.smallest_positive(high * 1e-5);
    }
    if info.integer {
        slider = slider.integer();
    }
    let slider = ui.add(slider).labelled_by(name.id);
    slider.widget_info(|| WidgetInfo::slider(true, slid, format!("{}{in_unit}", info.label)));
    identify(&slider, info.id);

    let mut typed = shown;
    let speed = match info.logarithmic {
        true => (shown.abs() * 0.01).max((high - low) * 1e-5),
        false => (high - low) * 0.005,
    };
    let value = DragValue::new(&mut typed)
        .range(info.range.0..=info.range.1)
        .clamp_existing_to_range(false)
        .speed(if info.integer { speed.max(0.1) } else { speed })
        .update_while_editing(false)
        .suffix(unit.as_str())
        .custom_formatter(|value, _| number(value))
        .custom_parser(parse);
    let size = vec2(VALUE.min(ui.available_width()), height);
    let value = ui.add_sized(size, value).labelled_by(name.id);
    value.widget_info(|| WidgetInfo {
        label: Some(format!("{} value{in_unit}", info.label)),
        value: Some(typed),
        ..WidgetInfo::new(WidgetType::DragValue)
    });
    identify(&value, format!("{} value", info.id));

    let clicked = ui.input(|i| i.pointer.button_clicked(secondary));
    let responses = [&name, &slider, &value];
    let reset = clicked && responses.iter().any(|r| r.contains_pointer());
    for response in responses {
        response.clone().on_hover_ui(|ui| {
            ui.set_max_width(ui.spacing().tooltip_width);
            let [shown, default, least, most] =
                [shown, default, info.range.0, info.range.1].map(number);
            ui.label(format!(
                "{} {shown}{unit} (default {default}{unit} · right-click resets)",
                info.label
            ));
            ui.label(info.hint);
            ui.label(format!("Allowed: {least} to {most}{unit}."));
            if restarts {
                ui.label("↻ Changing this restarts the scene.");
            }
        });
    }
    let edited = if slid != shown {
        Some(slid)
    } else {
        // The text shows four digits: leaving it unchanged is no change.
        Some(typed).filter(|typed| number(*typed) != number(shown))
    };
    let dragging = slider.dragged() || value.dragged();
    (edited.filter(|_| !right), !right && dragging, reset)
}
