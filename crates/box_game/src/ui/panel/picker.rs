//! The scene menu: a card per scene, with its title and what to watch for, and a search field.

use bevy_egui::egui::{
    Button, Grid, Id, Key, Modal, ScrollArea, TextEdit, TextFormat, TextStyle, TextWrapMode, Ui,
    Vec2, WidgetInfo, WidgetType, text::LayoutJob,
};

use box_scenarios::Scenario;

use super::widgets::{Panel, id_of, identify};
use crate::action::Action;
use crate::scene::library::watch;

/// Size of a card [points].
const CARD: Vec2 = Vec2::new(290.0, 44.0);

/// The menu over everything, if it is open. Arrows select, Enter opens a scene; Esc is handled by the game's keys.
pub(super) fn show(ui: &Ui, panel: &mut Panel<'_>) {
    let (view, memory) = (panel.view, &mut *panel.memory);
    if !view.show_picker {
        memory.search.clear();
        let playing = view.scenes.iter().position(|s| s.id == view.scenario.id);
        memory.picked = playing.unwrap_or(0);
        return;
    }
    let screen = ui.ctx().content_rect();
    let columns = ((screen.width() - 80.0) / (CARD.x + 8.0)).clamp(1.0, 3.0) as usize;
    let modal = Modal::new(Id::new("picker")).show(ui.ctx(), |ui| {
        let width = columns as f32 * (CARD.x + 8.0);
        ui.set_width(width.min(screen.width() - 60.0).max(0.0));
        let field = TextEdit::singleline(&mut memory.search).hint_text("Search scenes…");
        let field = ui.add(field.desired_width(f32::INFINITY));
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
        let mut chosen = found.get(memory.picked).filter(|_| pressed(Key::Enter));
        let cards = |ui: &mut Ui| {
            for (place, k) in found.iter().enumerate() {
                if card(ui, &view.scenes[*k], place == memory.picked, up || down) {
                    chosen = Some(k);
                }
                if place % columns == columns - 1 {
                    ui.end_row();
                }
            }
        };
        ScrollArea::vertical()
            .max_height((screen.height() - 160.0).max(40.0))
            .auto_shrink([false, true])
            .show(ui, |ui| {
                Grid::new("scenes").spacing([8.0, 6.0]).show(ui, cards);
                if found.is_empty() {
                    ui.label("No scene matches.");
                }
            });
        chosen.copied()
    });
    if let Some(scene) = modal.inner.and_then(|k| view.scenes.get(k)) {
        panel.ask(Action::SelectScene(scene.id.to_owned()));
    } else if modal.backdrop_response.clicked() {
        panel.ask(Action::TogglePicker);
    }
}

/// Draws the title and what to watch for; returns `true` if the card was clicked.
fn card(ui: &mut Ui, scene: &Scenario, picked: bool, moved: bool) -> bool {
    let visuals = ui.visuals();
    let [strong, weak] = if picked {
        [visuals.selection.stroke.color; 2]
    } else {
        [visuals.strong_text_color(), visuals.weak_text_color()]
    };
    let mut job = LayoutJob::default();
    for (text, style, color) in [
        (scene.title, TextStyle::Body, strong),
        ("\n", TextStyle::Small, weak),
        (watch(scene), TextStyle::Small, weak),
    ] {
        let format = TextFormat::simple(style.resolve(ui.style()), color);
        job.append(text, 0.0, format);
    }
    let card = Button::selectable(picked, job).frame_when_inactive(true);
    let card = ui.add(card.wrap_mode(TextWrapMode::Wrap).min_size(CARD));
    identify(&card, id_of(&Action::SelectScene(scene.id.to_owned())));
    if picked && moved {
        card.scroll_to_me(None);
    }
    card.clicked()
}

/// Indices of the scenes whose card contains every word of `text`.
fn search(text: &str, scenes: &[Scenario]) -> Vec<usize> {
    let text = text.to_lowercase();
    let matches = |s: &Scenario| {
        let name = format!("{} {} {}", s.id, s.title, watch(s)).to_lowercase();
        text.split_whitespace().all(|word| name.contains(word))
    };
    (0..scenes.len()).filter(|&k| matches(&scenes[k])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_find_a_scene() {
        let scenes: Vec<_> = Scenario::ALL.iter().map(|build| build()).collect();
        for (words, first) in [
            ("dzha", Some("dzhanibekov")),
            ("2012", Some("dissertation-2012")),
            ("SPRING stiff", Some("stiff-spring")),
            ("simplest motion", Some("ballistic")),
            ("xyzzy", None),
        ] {
            let found = search(words, &scenes);
            let found = found.first().map(|&k| scenes[k].id);
            assert_eq!(found, first);
        }
        assert_eq!(search("", &scenes).len(), scenes.len());
    }
}
