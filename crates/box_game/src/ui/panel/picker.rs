//! Finding a scene by a few of its letters.

use bevy_egui::egui::{Id, Key, Modal, ScrollArea, TextEdit, Ui, WidgetInfo, WidgetType};

use super::memory::PanelMemory;
use super::view::PanelView;
use crate::action::Action;

/// The list over everything, if it is open. Arrows go through it, Enter takes one; Esc is left to the game's own keys.
pub(super) fn show(ui: &Ui, view: &PanelView, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    if !view.interaction.show_picker {
        memory.search.clear();
        memory.picked = 0;
        return;
    }
    let screen = ui.ctx().content_rect();
    let modal = Modal::new(Id::new("picker")).show(ui.ctx(), |ui| {
        ui.set_width(420.0_f32.min(screen.width() - 60.0).max(0.0));
        let field = TextEdit::singleline(&mut memory.search)
            .hint_text("Type some letters of a scene…")
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
                    ui.label("No scene has these letters in this order.");
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

/// Indices of the scenes that have the letters of `pattern` in this order, the best first.
fn search(pattern: &str, scenes: &[(String, String)]) -> Vec<usize> {
    let mut found: Vec<(u32, usize)> = scenes
        .iter()
        .enumerate()
        .filter_map(|(k, (id, title))| {
            let best = score(pattern, id).max(score(pattern, title))?;
            Some((u32::MAX - best, k))
        })
        .collect();
    found.sort_unstable();
    found.into_iter().map(|(_, k)| k).collect()
}

/// How well the letters of `pattern` are found in `text`, in their order: `None` if they are not. Letters
/// that follow each other and letters that begin a word count more.
fn score(pattern: &str, text: &str) -> Option<u32> {
    let text: Vec<char> = text.chars().flat_map(char::to_lowercase).collect();
    let (mut at, mut points, mut run) = (0, 1, 0);
    for wanted in pattern.chars().filter(|c| !c.is_whitespace()) {
        let wanted = wanted.to_lowercase().next().unwrap_or(wanted);
        let skipped = text[at..].iter().position(|&c| c == wanted)?;
        let place = at + skipped;
        let begins = place == 0 || !text[place - 1].is_alphanumeric();
        run = if skipped == 0 && at > 0 { run + 1 } else { 0 };
        points += 1 + 3 * run + if begins { 5 } else { 0 };
        at = place + 1;
    }
    Some(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_in_order_find_a_scene() {
        let scenes: Vec<_> = box_scenarios::Scenario::ALL
            .iter()
            .map(|build| build())
            .map(|s| (s.id.to_owned(), s.title.to_owned()))
            .collect();
        let first = |pattern: &str| {
            let found = search(pattern, &scenes);
            found.first().map(|&k| scenes[k].0.as_str())
        };
        assert_eq!(first("dz"), Some("dzhanibekov"));
        assert_eq!(first("2012"), Some("dissertation-2012"));
        assert_eq!(first("STIFF SP"), Some("stiff-spring"));
        assert_eq!(first("ht"), Some("heavy-top"));
        assert_eq!(first("qd"), Some("quadratic-drag"));
        assert_eq!(first("xyzzy"), None);
        assert_eq!(search("", &scenes).len(), scenes.len());
    }
}
