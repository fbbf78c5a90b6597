//! Texts over the picture: headline, lesson, notices; the list of keys; and the one line of a hidden panel.

use bevy_egui::egui::{
    Area, Frame, Grid, Id, Label, Margin, Modal, Order, Rect, RichText, ScrollArea, TextFormat,
    TextStyle, TextWrapMode, Theme, Ui, UiBuilder, text::LayoutJob,
};

use super::demo;
use super::keys::KEYS;
use super::memory::PanelMemory;
use super::view::PanelView;
use super::widgets::{Text, button, choice, own_button, text, toggle};
use crate::action::Action;
use crate::compare::verdict::headline;
use crate::view::style;

/// In a picture lower than this [points] the lesson is left out (beside the strip of 2012 already in the second), and lower
/// than the last the headline.
const LESSON_ROOM: [f32; 2] = [300.0, 450.0];
const HEADLINE_ROOM: f32 = 150.0;

/// Time that a notice stays \[s\].
const NOTICE_STAYS: f64 = 20.0;

/// Headline, lesson, the strip of 2012, errors and the newest notice on a plate over the top of the picture. Returns how
/// much of the picture they cover [points].
pub(super) fn captions(
    ui: &Ui,
    picture: Rect,
    view: &PanelView,
    memory: &mut PanelMemory,
    out: &mut Vec<Action>,
) -> f32 {
    let notice = notice(ui, view, memory);
    let area = Area::new(Id::new("captions"))
        .order(Order::Middle)
        .fixed_pos(picture.min)
        .constrain_to(picture)
        .show(ui.ctx(), |ui| {
            // The picture is dark in both themes.
            ui.set_style(ui.ctx().style_of(Theme::Dark));
            ui.set_width(picture.width());
            Frame::new()
                .fill(style::PICTURE_PLATE)
                .inner_margin(Margin::symmetric(10, 4))
                .show(ui, |ui| {
                    ui.set_width(ui.available_width());
                    ui.spacing_mut().item_spacing.y = 2.0;
                    // The strip of the 2012 demo shows its stepper, which is not among the integrators.
                    let of_2012 = view.demo.as_ref().is_some_and(|d| d.stepper.is_some());
                    if picture.height() > HEADLINE_ROOM && !of_2012 {
                        let words = RichText::new(headline(&view.compare)).heading().strong();
                        ui.add(Label::new(words).wrap());
                    }
                    demo::show(ui, view, picture.height() > LESSON_ROOM[0], out);
                    let dismissed = memory.dismissed_lesson.as_ref() == Some(&view.scene);
                    let lesson = !view.lesson.is_empty() && !dismissed;
                    if lesson
                        && picture.height() > LESSON_ROOM[usize::from(view.demo.is_some())]
                        && self::lesson(ui, view)
                    {
                        memory.dismissed_lesson = Some(view.scene.clone());
                    }
                    for error in &view.scene_errors {
                        let color = ui.visuals().error_fg_color;
                        let text = RichText::new(format!("⚠ {error}")).color(color);
                        ui.add(Label::new(text).wrap());
                    }
                    if let Some(text) = notice
                        && dismissible(ui, "notice", |ui| {
                            ui.add(Label::new(text).wrap());
                        })
                    {
                        memory.dismissed_notice = Some((view.notices.len(), text.clone()));
                    }
                });
        });
    area.response.rect.height()
}

/// The newest notice, unless it was dismissed or has been there for long.
fn notice<'a>(ui: &Ui, view: &'a PanelView, memory: &mut PanelMemory) -> Option<&'a String> {
    let notice = view.notices.last()?;
    let shown = (view.notices.len(), notice.clone());
    let now = ui.input(|i| i.time);
    let since = match &memory.shown_notice {
        Some((same, since)) if *same == shown => *since,
        _ => now,
    };
    memory.shown_notice = Some((shown.clone(), since));
    let dismissed = memory.dismissed_notice.as_ref() == Some(&shown);
    (!dismissed && now - since < NOTICE_STAYS).then_some(notice)
}

/// Lesson and suggestions; returns whether they were dismissed.
fn lesson(ui: &mut Ui, view: &PanelView) -> bool {
    let hints: Vec<&str> = (view.hints.iter())
        .map(String::as_str)
        .filter(|hint| !hint.is_empty())
        .collect();
    let try_this = (!hints.is_empty()).then(|| format!("Try: {}", hints.join("  ·  ")));
    dismissible(ui, "lesson", |ui| {
        ui.add(Label::new(&view.lesson).wrap());
        if let Some(text) = try_this {
            ui.add(Label::new(controls_in_bold(ui, &text)).wrap());
        }
    })
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

/// Text with a button to dismiss it; returns whether that was clicked.
fn dismissible(ui: &mut Ui, what: &str, add: impl FnOnce(&mut Ui)) -> bool {
    let name = format!("Dismiss {what}");
    ui.horizontal_top(|ui| {
        let close = own_button(ui, Text("✖", &name, &format!("{name}.")), &name);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            add(ui);
        });
        close
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
            close = own_button(
                ui,
                text("Close help", "F1 or ? opens it again."),
                "Close help",
            );
            let reset = text(
                "Reset all parameters",
                "Restore the scene's own parameters.",
            );
            button(ui, reset, Action::ResetParameters, out);
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
    let hint = "Restore the first scene and every default.";
    if !memory.sure {
        memory.sure = own_button(ui, text("Reset everything…", hint), "reset everything");
        return;
    }
    let before = out.len();
    button(
        ui,
        text("Yes, reset everything", hint),
        Action::ResetEverything,
        out,
    );
    let no = own_button(ui, text("No", "Change nothing."), "no");
    memory.sure = !no && out.len() == before;
}

/// Scales of the panel by one click.
const SCALES: [f64; 5] = [0.75, 1.0, 1.25, 1.5, 2.0];

fn scale(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    ui.label("Panel scale:");
    for scale in SCALES {
        let chosen = (f64::from(view.preferences.ui_scale) - scale).abs() < 1e-3;
        let name = format!("{:.0} %", scale * 100.0);
        choice(
            ui,
            chosen,
            text(&name, "Scale."),
            Action::SetUiScale(scale),
            out,
        );
    }
    ui.label("(Ctrl and + or −)");
    let light = view.preferences.light;
    let theme = text("Light theme", "Light or dark panel.");
    toggle(ui, light, theme, Action::ToggleTheme, out);
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
    let line = format!(
        "{} · {}{} · t = {:.2} s · {}/step{}",
        view.title,
        style::marked_name(view.integrator),
        if view.paused { " · PAUSED" } else { "" },
        view.time,
        view.step_time(),
        if view.log.is_some() {
            " · ● REC"
        } else {
            ""
        },
    );
    let place = ui.available_rect_before_wrap().shrink(6.0);
    ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
                button(
                    ui,
                    text("Show panel", "Show the panel (`)."),
                    Action::TogglePanel,
                    out,
                );
                ui.add(Label::new(line).truncate());
            });
        });
    });
}
