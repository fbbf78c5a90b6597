//! Controls. Each has an id in the accessibility tree by which the tests find it, whatever is written on it: its action
//! in the words of a script, or a name for what is the panel's own.

use bevy_egui::egui::{Button, Response, TextWrapMode, Ui, WidgetInfo, WidgetType};

use crate::action::Action;

/// The id of a control that asks for `action`: `TogglePause`, `Compare(ToggleComparison("rk4"))`.
pub(super) fn id_of(action: &Action) -> String {
    ron::to_string(action).unwrap_or_default()
}

/// Gives a control its id.
pub(super) fn identify(response: &Response, id: impl Into<String>) {
    let set = |node: &mut bevy_egui::egui::accesskit::Node| node.set_author_id(id.into());
    response.ctx.accesskit_node_builder(response.id, set);
}

/// What is written on a control, its accessible name and its tooltip.
#[derive(Clone, Copy)]
pub(super) struct Text<'a>(pub &'a str, pub &'a str, pub &'a str);

/// A control whose name is what is written on it, and its tooltip.
pub(super) const fn text<'a>(text: &'a str, hint: &'a str) -> Text<'a> {
    Text(text, text, hint)
}

/// A button that asks for `action`.
pub(super) fn button(
    ui: &mut Ui,
    text: Text<'_>,
    action: impl Into<Action>,
    out: &mut Vec<Action>,
) {
    let action = action.into();
    if own_button(ui, text, &id_of(&action)) {
        out.push(action);
    }
}

/// A button that shows whether it is on, and asks for `action` to change that.
pub(super) fn toggle(
    ui: &mut Ui,
    on: bool,
    text: Text<'_>,
    action: impl Into<Action>,
    out: &mut Vec<Action>,
) {
    let action = action.into();
    if own_toggle(ui, on, text, &id_of(&action)) {
        out.push(action);
    }
}

/// One of several: it asks for `action` unless it is chosen already.
pub(super) fn choice(
    ui: &mut Ui,
    chosen: bool,
    text: Text<'_>,
    action: impl Into<Action>,
    out: &mut Vec<Action>,
) {
    let mut asked = Vec::new();
    toggle(ui, chosen, text, action, &mut asked);
    out.extend(asked.into_iter().filter(|_| !chosen));
}

/// A button of the panel's own; returns whether it was clicked.
pub(super) fn own_button(ui: &mut Ui, Text(text, name, hint): Text<'_>, id: &str) -> bool {
    let response = ui.add(Button::new(text).wrap_mode(TextWrapMode::Extend));
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, ui.is_enabled(), name));
    identify(&response, id);
    response.on_hover_text(hint).clicked()
}

/// A toggle of the panel's own; returns whether it was clicked.
pub(super) fn own_toggle(
    ui: &mut Ui,
    on: bool,
    Text(text, name, hint): Text<'_>,
    id: &str,
) -> bool {
    let response = ui.add(Button::selectable(on, text).frame_when_inactive(true));
    response.widget_info(|| WidgetInfo::selected(WidgetType::Button, true, on, name));
    identify(&response, id);
    response.on_hover_text(hint).clicked()
}
