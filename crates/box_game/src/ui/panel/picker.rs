//! The menu of scenes: a card each, with its title and what to watch for, and a search field.

use bevy_egui::egui::{
    Button, Grid, Id, Key, Modal, ScrollArea, TextEdit, TextFormat, TextStyle, TextWrapMode, Ui,
    WidgetInfo, WidgetType, text::LayoutJob, vec2,
};

use super::memory::PanelMemory;
use super::view::PanelView;
use super::widgets::{id_of, identify};
use crate::action::Action;
use crate::scene::library::SceneCard;

/// Size of a card [points].
const CARD: bevy_egui::egui::Vec2 = vec2(290.0, 44.0);

/// The menu over everything, if it is open. Arrows go through it, Enter takes one; Esc is left to the game's own keys.
pub(super) fn show(ui: &Ui, view: &PanelView, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    if !view.show_picker {
        memory.search.clear();
        let playing = view.scenes.iter().position(|s| s.id == view.scene);
        memory.picked = playing.unwrap_or(0);
        return;
    }
    let screen = ui.ctx().content_rect();
    let columns = ((screen.width() - 80.0) / (CARD.x + 8.0)).clamp(1.0, 3.0) as usize;
    let modal = Modal::new(Id::new("picker")).show(ui.ctx(), |ui| {
        ui.set_width(
            (columns as f32 * (CARD.x + 8.0))
                .min(screen.width() - 60.0)
                .max(0.0),
        );
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
        let pressed = |key| ui.input(|i| i.key_pressed(key));
        let (up, down) = (pressed(Key::ArrowUp), pressed(Key::ArrowDown));
        let last = found.len().saturating_sub(1);
        memory.picked = (memory.picked + usize::from(down)).min(last);
        memory.picked = memory.picked.saturating_sub(usize::from(up));
        let mut chosen = pressed(Key::Enter)
            .then(|| found.get(memory.picked))
            .flatten();
        ScrollArea::vertical()
            .max_height((screen.height() - 160.0).max(40.0))
            .auto_shrink([false, true])
            .show(ui, |ui| {
                Grid::new("scenes").spacing([8.0, 6.0]).show(ui, |ui| {
                    for (place, k) in found.iter().enumerate() {
                        if card(ui, &view.scenes[*k], place == memory.picked, up || down) {
                            chosen = Some(k);
                        }
                        if place % columns == columns - 1 {
                            ui.end_row();
                        }
                    }
                });
                if found.is_empty() {
                    ui.label("No scene matches.");
                }
            });
        chosen.copied()
    });
    if let Some(scene) = modal.inner.and_then(|k| view.scenes.get(k)) {
        out.push(Action::SelectScene(scene.id.clone()));
    } else if modal.backdrop_response.clicked() {
        out.push(Action::TogglePicker);
    }
}

/// Title over what there is to see; returns whether it was clicked.
fn card(ui: &mut Ui, scene: &SceneCard, picked: bool, moved: bool) -> bool {
    let visuals = ui.visuals();
    let colors = if picked {
        [visuals.selection.stroke.color; 2]
    } else {
        [visuals.strong_text_color(), visuals.weak_text_color()]
    };
    let mut job = LayoutJob::default();
    let mut append = |text: &str, style: TextStyle, color| {
        job.append(
            text,
            0.0,
            TextFormat::simple(style.resolve(ui.style()), color),
        );
    };
    append(&scene.title, TextStyle::Body, colors[0]);
    append("\n", TextStyle::Small, colors[1]);
    append(&scene.watch, TextStyle::Small, colors[1]);
    let card = Button::selectable(picked, job)
        .frame_when_inactive(true)
        .wrap_mode(TextWrapMode::Wrap)
        .min_size(CARD);
    let card = ui.add(card);
    identify(&card, id_of(&Action::SelectScene(scene.id.clone())));
    if picked && moved {
        card.scroll_to_me(None);
    }
    card.clicked()
}

/// Indices of the scenes whose card contains every word of `text`.
fn search(text: &str, scenes: &[SceneCard]) -> Vec<usize> {
    let text = text.to_lowercase();
    let matches = |s: &SceneCard| {
        let name = format!("{} {} {}", s.id, s.title, s.watch).to_lowercase();
        text.split_whitespace().all(|word| name.contains(word))
    };
    (0..scenes.len()).filter(|&k| matches(&scenes[k])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_scenarios::Scenario;

    #[test]
    fn words_find_a_scene() {
        let scenes: Vec<_> = Scenario::ALL
            .iter()
            .map(|build| SceneCard::of(&build()))
            .collect();
        let first = |pattern: &str| {
            let found = search(pattern, &scenes);
            found.first().map(|&k| scenes[k].id.as_str())
        };
        assert_eq!(first("dzha"), Some("dzhanibekov"));
        assert_eq!(first("2012"), Some("dissertation-2012"));
        assert_eq!(first("SPRING stiff"), Some("stiff-spring"));
        assert_eq!(first("simplest motion"), Some("ballistic"));
        assert_eq!(first("xyzzy"), None);
        assert_eq!(search("", &scenes).len(), scenes.len());
    }
}
