//! The list of scenes with a search field.

use bevy_egui::egui::{Id, Key, Modal, ScrollArea, TextEdit, Ui, WidgetInfo, WidgetType};

use super::memory::PanelMemory;
use super::view::PanelView;
use crate::action::Action;

/// The list over everything, if it is open. Arrows go through it, Enter takes one; Esc is left to the game's own keys.
pub(super) fn show(ui: &Ui, view: &PanelView, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    if !view.show_picker {
        memory.search.clear();
        memory.picked = 0;
        return;
    }
    let screen = ui.ctx().content_rect();
    let modal = Modal::new(Id::new("picker")).show(ui.ctx(), |ui| {
        ui.set_width(420.0_f32.min(screen.width() - 60.0).max(0.0));
        let field = TextEdit::singleline(&mut memory.search)
            .hint_text("Search scenes…")
            .desired_width(f32::INFINITY);
        let field = ui.add(field);
        field.widget_info(|| WidgetInfo::labeled(WidgetType::TextEdit, true, "Search scenes"));
        if !field.lost_focus() {
            field.request_focus();
        }
        if field.changed() {
            memory.picked = 0;
        }
        let found = search(&memory.search, &view.scenes);
        let (up, down, enter) = ui.input(|i| {
            let pressed = |key| i.key_pressed(key);
            (
                pressed(Key::ArrowUp),
                pressed(Key::ArrowDown),
                pressed(Key::Enter),
            )
        });
        let last = found.len().saturating_sub(1);
        memory.picked = (memory.picked + usize::from(down)).min(last);
        memory.picked = memory.picked.saturating_sub(usize::from(up));
        let mut chosen = None;
        if enter {
            chosen = found.get(memory.picked).copied();
        }
        let height = (screen.height() - 160.0).clamp(40.0, 420.0);
        ScrollArea::vertical()
            .max_height(height)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                for (place, &k) in found.iter().enumerate() {
                    let (id, title) = &view.scenes[k];
                    let text = format!("{title}  ·  {id}");
                    let label = ui.selectable_label(place == memory.picked, text);
                    if place == memory.picked && (up || down) {
                        label.scroll_to_me(None);
                    }
                    if label.clicked() {
                        chosen = Some(k);
                    }
                }
                if found.is_empty() {
                    ui.label("No scene matches.");
                }
            });
        chosen
    });
    if let Some((id, _)) = modal.inner.and_then(|k| view.scenes.get(k)) {
        out.push(Action::SelectScene(id.clone()));
    } else if modal.backdrop_response.clicked() {
        out.push(Action::TogglePicker);
    }
}

/// Indices of the scenes whose id or title contains every word of `text`.
fn search(text: &str, scenes: &[(String, String)]) -> Vec<usize> {
    let text = text.to_lowercase();
    let matches = |(id, title): &(String, String)| {
        let name = format!("{id} {title}").to_lowercase();
        text.split_whitespace().all(|word| name.contains(word))
    };
    (0..scenes.len()).filter(|&k| matches(&scenes[k])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_find_a_scene() {
        let scenes: Vec<_> = box_scenarios::Scenario::ALL
            .iter()
            .map(|build| build())
            .map(|s| (s.id.to_owned(), s.title.to_owned()))
            .collect();
        let first = |pattern: &str| {
            let found = search(pattern, &scenes);
            found.first().map(|&k| scenes[k].0.as_str())
        };
        assert_eq!(first("dzha"), Some("dzhanibekov"));
        assert_eq!(first("2012"), Some("dissertation-2012"));
        assert_eq!(first("SPRING stiff"), Some("stiff-spring"));
        assert_eq!(first("xyzzy"), None);
        assert_eq!(search("", &scenes).len(), scenes.len());
    }
}
