//! Buttons with a tooltip and an accessible name.

use bevy_egui::egui::{Button, TextWrapMode, Ui, WidgetInfo, WidgetType};

/// A button; returns whether it was clicked.
pub(super) fn button(ui: &mut Ui, text: &str, hint: &str) -> bool {
    named_button(ui, text, text, hint)
}

/// A button whose accessible name is not its text; returns whether it was clicked.
pub(super) fn named_button(ui: &mut Ui, text: &str, name: &str, hint: &str) -> bool {
    let response = ui.add(Button::new(text).wrap_mode(TextWrapMode::Extend));
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, name));
    response.on_hover_text(hint).clicked()
}

/// A button that shows whether it is on; returns whether it was clicked.
pub(super) fn toggle(ui: &mut Ui, on: bool, text: &str, hint: &str) -> bool {
    named_toggle(ui, on, text, text, hint)
}

/// A toggle whose accessible name is not its text; returns whether it was clicked.
pub(super) fn named_toggle(ui: &mut Ui, on: bool, text: &str, name: &str, hint: &str) -> bool {
    let response = ui.add(Button::selectable(on, text).frame_when_inactive(true));
    response.widget_info(|| WidgetInfo::selected(WidgetType::Button, true, on, name));
    response.on_hover_text(hint).clicked()
}
