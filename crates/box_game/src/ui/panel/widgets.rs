//! Controls. Each has an id in the accessibility tree, by which the tests find it. The id is the action as in a script,
//! or a name if the control affects only the panel.

use bevy_egui::egui::{
    Align, Button, Label, Rect, Response, RichText, Stroke, StrokeKind, TextWrapMode, Ui,
    UiBuilder, WidgetInfo, WidgetType, accesskit::Node,
};

use super::memory::PanelMemory;
use super::view::PanelView;
use crate::action::Action;

/// Context of every part of the panel: the view, the panel's own state, and the list of requested actions.
pub(super) struct Panel<'a> {
    pub view: &'a PanelView,
    pub memory: &'a mut PanelMemory,
    pub out: &'a mut Vec<Action>,
}

impl Panel<'_> {
    pub(super) fn ask(&mut self, action: impl Into<Action>) {
        self.out.push(action.into());
    }

    /// Adds a button that requests `action`.
    pub(super) fn button(&mut self, ui: &mut Ui, text: Text<'_>, action: impl Into<Action>) {
        let action = action.into();
        if button(ui, text, &id_of(&action)) {
            self.ask(action);
        }
    }

    /// Adds buttons in a row: text, tooltip, action.
    pub(super) fn buttons<'a, A: Into<Action>>(
        &mut self,
        ui: &mut Ui,
        buttons: impl IntoIterator<Item = (&'a str, &'a str, A)>,
    ) {
        ui.horizontal_wrapped(|ui| {
            for (name, hint, action) in buttons {
                self.button(ui, text(name, hint), action);
            }
        });
    }

    /// Adds a toggle button that requests `action`.
    pub(super) fn toggle(
        &mut self,
        ui: &mut Ui,
        on: bool,
        text: Text<'_>,
        action: impl Into<Action>,
    ) {
        let action = action.into();
        if toggle(ui, on, text, &id_of(&action)) {
            self.ask(action);
        }
    }

    /// Adds a toggle button that requests `action`, unless it is already chosen.
    pub(super) fn choice(
        &mut self,
        ui: &mut Ui,
        chosen: bool,
        text: Text<'_>,
        action: impl Into<Action>,
    ) {
        let before = self.out.len();
        self.toggle(ui, chosen, text, action);
        if chosen {
            self.out.truncate(before);
        }
    }

    /// Adds a row of alternatives: value, text and tooltip of each, and the action that chooses it.
    pub(super) fn choices<'a, T: PartialEq, A: Into<Action>>(
        &mut self,
        ui: &mut Ui,
        chosen: T,
        all: impl IntoIterator<Item = (T, &'a str, &'a str)>,
        action: impl Fn(T) -> A,
    ) {
        ui.horizontal_wrapped(|ui| {
            for (value, name, hint) in all {
                let chosen = value == chosen;
                self.choice(ui, chosen, text(name, hint), action(value));
            }
        });
    }
}

/// The id of a control that requests `action`: `TogglePause`, `Compare(ToggleComparison("rk4"))`.
pub(super) fn id_of(action: &Action) -> String {
    ron::to_string(action).unwrap_or_default()
}

/// Gives a control its id.
pub(super) fn identify(response: &Response, id: impl Into<String>) {
    let set = |node: &mut Node| node.set_author_id(id.into());
    response.ctx.accesskit_node_builder(response.id, set);
}

/// Text, accessible name and tooltip of a control.
#[derive(Clone, Copy)]
pub(super) struct Text<'a>(pub &'a str, pub &'a str, pub &'a str);

/// Creates a [`Text`] whose accessible name is the text itself.
pub(super) const fn text<'a>(text: &'a str, hint: &'a str) -> Text<'a> {
    Text(text, text, hint)
}

/// Adds a button; returns `true` if it was clicked.
pub(super) fn button(ui: &mut Ui, Text(text, name, hint): Text<'_>, id: &str) -> bool {
    let response = ui.add(Button::new(text).wrap_mode(TextWrapMode::Extend));
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, ui.is_enabled(), name));
    identify(&response, id);
    response.on_hover_text(hint).clicked()
}

/// Adds a toggle button; returns `true` if it was clicked.
pub(super) fn toggle(ui: &mut Ui, on: bool, Text(text, name, hint): Text<'_>, id: &str) -> bool {
    let response = ui.add(Button::selectable(on, text).frame_when_inactive(true));
    response.widget_info(|| WidgetInfo::selected(WidgetType::Button, true, on, name));
    identify(&response, id);
    response.on_hover_text(hint).clicked()
}

/// Outlines the control with this name, and scrolls to it, while a hint highlights it.
pub(super) fn mark(ui: &Ui, memory: &PanelMemory, name: &str, control: &Response) {
    if memory.marked.is_some_and(|(marked, _)| marked == name) {
        let stroke = Stroke::new(2.0, ui.visuals().selection.bg_fill);
        let ring = control.rect.expand(1.0);
        ui.painter()
            .rect_stroke(ring, 4.0, stroke, StrokeKind::Inside);
        control.scroll_to_me(Some(Align::Center));
    }
}

/// Adds small text in one line, truncated if necessary.
pub(super) fn note(ui: &mut Ui, text: impl Into<RichText>) -> Response {
    ui.add(Label::new(text.into().small()).truncate())
}

/// Adds widgets in this area.
pub(super) fn within(ui: &mut Ui, place: Rect, add: impl FnOnce(&mut Ui)) {
    ui.scope_builder(UiBuilder::new().max_rect(place), add);
}

/// Sets the description of an image for screen readers.
pub(super) fn describe(response: &Response, words: &str) {
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Image, true, words));
}
