//! Texts over the picture: lesson, notices, the list of keys, and the one line of a hidden panel.

use bevy_egui::egui::{
    Frame, Grid, Id, Label, Modal, Panel, RichText, ScrollArea, TextFormat, TextStyle,
    TextWrapMode, Ui, UiBuilder, WidgetInfo, WidgetType, text::LayoutJob,
};

use super::keys::KEYS;
use super::memory::PanelMemory;
use super::view::PanelView;
use super::widgets::toggle;
use crate::action::Action;
use crate::compare::verdict::headline;
use crate::view::style;

/// Below this height [points] the picture matters more than the lesson.
const LESSON_ROOM: f32 = 300.0;
/// The same for the headline.
const HEADLINE_ROOM: f32 = 190.0;

/// Time that a notice stays \[s\].
const NOTICE_STAYS: f64 = 20.0;

/// Lesson and newest notice, each until dismissed; a notice goes by itself after a while.
pub(super) fn strips(ui: &mut Ui, view: &PanelView, memory: &mut PanelMemory) {
    // A stepper of 2012 is none of the integrators, and has a strip of its own.
    let of_2012 = view.demo.as_ref().is_some_and(|d| d.stepper.is_some());
    let headline = if of_2012 {
        String::new()
    } else {
        headline(&view.compare)
    };
    if !headline.is_empty() && ui.available_height() > HEADLINE_ROOM {
        Panel::top("headline").show(ui, |ui| {
            ui.add(Label::new(RichText::new(headline).heading().strong()).wrap());
        });
    }
    let lesson = !view.lesson.is_empty() && memory.dismissed_lesson.as_ref() != Some(&view.scene);
    if lesson && ui.available_height() > LESSON_ROOM && self::lesson(ui, view) {
        memory.dismissed_lesson = Some(view.scene.clone());
    }
    for error in &view.scene_errors {
        let text = RichText::new(format!("⚠ {error}")).color(ui.visuals().error_fg_color);
        Panel::top(Id::new(("scene error", error))).show(ui, |ui| ui.add(Label::new(text).wrap()));
    }
    let Some(notice) = view.notices.last() else {
        return;
    };
    let seen = memory
        .dismissed_notice
        .as_ref()
        .is_some_and(|(count, text)| *count == view.notices.len() && text == notice);
    if seen {
        return;
    }
    let now = ui.input(|i| i.time);
    let shown = (view.notices.len(), notice.clone());
    let since = match &memory.shown_notice {
        Some((same, since)) if *same == shown => *since,
        _ => now,
    };
    memory.shown_notice = Some((shown.clone(), since));
    if strip(ui, "notice", notice) || now - since > NOTICE_STAYS {
        memory.dismissed_notice = Some(shown);
    }
}

/// Lesson and suggestions across the top of the picture; returns whether they were dismissed.
fn lesson(ui: &mut Ui, view: &PanelView) -> bool {
    let hints: Vec<&str> = (view.hints.iter())
        .map(String::as_str)
        .filter(|hint| !hint.is_empty())
        .collect();
    let try_this = (!hints.is_empty()).then(|| format!("Try: {}", hints.join("  ·  ")));
    let try_this = try_this.map(|text| controls_in_bold(ui, &text));
    Panel::top(Id::new(("strip", "lesson")))
        .show(ui, |ui| {
            ui.horizontal_top(|ui| {
                let close = dismiss(ui, "lesson");
                ui.vertical(|ui| {
                    ui.spacing_mut().item_spacing.y = 2.0;
                    ui.add(Label::new(&view.lesson).wrap());
                    if let Some(text) = try_this {
                        ui.add(Label::new(text).wrap());
                    }
                });
                close
            })
            .inner
        })
        .inner
}

/// A hint with the names of controls, which it has in brackets, in bold.
fn controls_in_bold(ui: &Ui, hint: &str) -> LayoutJob {
    let mut job = LayoutJob::default();
    let font = TextStyle::Body.resolve(ui.style());
    let (plain, bold) = (
        ui.visuals().weak_text_color(),
        ui.visuals().strong_text_color(),
    );
    for (k, part) in hint.split(['[', ']']).enumerate() {
        let color = if k % 2 == 0 { plain } else { bold };
        job.append(part, 0.0, TextFormat::simple(font.clone(), color));
    }
    job
}

fn dismiss(ui: &mut Ui, what: &str) -> bool {
    let close = ui.small_button("✖");
    close.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, format!("Dismiss {what}")));
    close
        .on_hover_text(format!("Dismiss this {what}."))
        .clicked()
}

/// A line of text across the top of the picture; returns whether it was dismissed.
fn strip(ui: &mut Ui, what: &str, text: &str) -> bool {
    Panel::top(Id::new(("strip", what)))
        .show(ui, |ui| {
            ui.horizontal_top(|ui| {
                let close = dismiss(ui, what);
                ui.add(Label::new(text).wrap());
                close
            })
            .inner
        })
        .inner
}

/// The list of keys over everything. A click beside it or on Close asks to close it; Esc is left to the
/// game's own keys, so that one press is one request.
pub(super) fn help(ui: &Ui, view: &PanelView, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    if !view.show_help {
        memory.sure = false;
        return;
    }
    let screen = ui.ctx().content_rect();
    let modal = Modal::new(Id::new("help")).show(ui.ctx(), |ui| {
        ui.set_width(560.0_f32.min(screen.width() - 60.0).max(0.0));
        let mut close = false;
        ui.horizontal_wrapped(|ui| {
            ui.heading("Keys");
            close = ui.button("Close help").clicked();
            let reset = ui.button("Reset all parameters");
            if reset
                .on_hover_text("Restore the scene's own parameters.")
                .clicked()
            {
                out.push(Action::ResetParameters);
            }
            reset_everything(ui, memory, out);
        });
        ui.horizontal_wrapped(|ui| scale(ui, view, out));
        ui.label("Right-click a slider to reset it. Typed values may exceed the slider's range.");
        let height = (screen.height() - 140.0).max(40.0);
        ScrollArea::vertical()
            .max_height(height)
            .min_scrolled_height(height)
            .show(ui, keys);
        close
    });
    if modal.inner || modal.backdrop_response.clicked() {
        out.push(Action::ToggleHelp);
    }
}

/// The last rung of the ladder asks once more.
fn reset_everything(ui: &mut Ui, memory: &mut PanelMemory, out: &mut Vec<Action>) {
    if !memory.sure {
        let button = ui.button("Reset everything…");
        memory.sure = button
            .on_hover_text("Restore the first scene and every default.")
            .clicked();
        return;
    }
    if ui.button("Yes, reset everything").clicked() {
        out.push(Action::ResetEverything);
        memory.sure = false;
    }
    if ui.button("No").clicked() {
        memory.sure = false;
    }
}

/// Scales of the panel by one click.
const SCALES: [f64; 5] = [0.75, 1.0, 1.25, 1.5, 2.0];

fn scale(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    ui.label("Panel scale:");
    for scale in SCALES {
        let chosen = (f64::from(view.preferences.ui_scale) - scale).abs() < 1e-3;
        let text = format!("{:.0} %", scale * 100.0);
        if ui.selectable_label(chosen, text).clicked() && !chosen {
            out.push(Action::SetUiScale(scale));
        }
    }
    ui.label("(Ctrl and + or −)");
    let light = view.preferences.light;
    if toggle(ui, light, "Light theme", "Light or dark panel.") {
        out.push(Action::ToggleTheme);
    }
}

fn keys(ui: &mut Ui) {
    Grid::new("keys")
        .num_columns(2)
        .striped(true)
        .show(ui, |ui| {
            for (key, what) in KEYS {
                ui.add(Label::new(RichText::new(*key).strong()).extend());
                ui.add(Label::new(*what).wrap());
                ui.end_row();
            }
        });
}

/// The one line of a hidden panel, over the picture.
pub(super) fn hud(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let mut text = format!("{} · {}", view.title, style::marked_name(view.integrator));
    if view.paused {
        text.push_str(" · PAUSED");
    }
    text.push_str(&format!(
        " · t = {:.3} s · {}/step",
        view.time,
        view.step_time()
    ));
    if view.log.is_some() {
        text.push_str(" · ● REC");
    }
    let place = ui.available_rect_before_wrap().shrink(6.0);
    ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
                let show = ui
                    .small_button("Show panel")
                    .on_hover_text("Show the panel (`).");
                if show.clicked() {
                    out.push(Action::TogglePanel);
                }
                ui.add(Label::new(text).truncate());
            });
        });
    });
}
