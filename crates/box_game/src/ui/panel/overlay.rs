//! Texts over the picture: headline, lesson, the strip of the 2012 scene, notices, the list of keys, and the single
//! line of a hidden panel.

use bevy_egui::egui::{
    Area, Frame, Grid, Id, Label, Margin, Modal, Order, Rect, RichText, ScrollArea, TextWrapMode,
    Theme, Ui,
};
use box_scenarios::dissertation::Stepper;

use super::format::number;
use super::hint;
use super::keys::{KEYS, SCREENSHOT};
use super::view::DemoView;
use super::widgets::{Panel, Text, button, text, within};
use crate::action::Action;
use crate::compare::verdict::headline;
use crate::demo_2012::FAULTS;
use crate::platform;
use crate::view::style;

/// Minimum heights of the picture [points]: for the lesson (the second one if there is also the strip of 2012), and for
/// the headline.
const LESSON_ROOM: [f32; 2] = [300.0, 450.0];
const HEADLINE_ROOM: f32 = 150.0;

/// Time that a notice is shown \[s\].
const NOTICE_STAYS: f64 = 20.0;

/// Draws headline, lesson, the strip of 2012, errors and the newest notice on a plate at the top of the picture.
/// Returns the covered height [points]. `side` is `false` without a side panel.
pub(super) fn captions(ui: &Ui, picture: Rect, side: bool, panel: &mut Panel<'_>) -> f32 {
    let content = |ui: &mut Ui| {
        ui.set_width(ui.available_width());
        ui.spacing_mut().item_spacing.y = 2.0;
        let view = panel.view;
        let room = |least: f32| picture.height() > least;
        // The strip of the 2012 demo shows its integrator, which is not one of [`Integrator`].
        let of_2012 = view.demo.as_ref().is_some_and(|d| d.stepper.is_some());
        if room(HEADLINE_ROOM) && !of_2012 {
            let words = RichText::new(headline(&view.compare)).heading().strong();
            ui.add(Label::new(words).wrap());
        }
        if let Some(demo) = &view.demo {
            strip(ui, demo, room(LESSON_ROOM[0]), panel);
        }
        if room(LESSON_ROOM[usize::from(view.demo.is_some())]) {
            lesson(ui, side, panel);
        }
        for error in &view.scene_errors {
            let text = RichText::new(format!("⚠ {error}"));
            ui.add(Label::new(text.color(ui.visuals().error_fg_color)).wrap());
        }
        notice(ui, panel);
    };
    let area = Area::new(Id::new("captions"))
        .order(Order::Middle)
        .fixed_pos(picture.min)
        .constrain_to(picture)
        .show(ui.ctx(), |ui| {
            // The picture is dark in both themes.
            ui.set_style(ui.ctx().style_of(Theme::Dark));
            ui.set_width(picture.width());
            let plate = Frame::new().fill(style::PICTURE_PLATE);
            let plate = plate.inner_margin(Margin::symmetric(10, 4));
            plate.show(ui, content);
        });
    area.response.rect.height()
}

/// The newest notice, unless it was dismissed or has expired.
fn notice(ui: &mut Ui, panel: &mut Panel<'_>) {
    let Some(notice) = panel.view.notices.last() else {
        return;
    };
    let (count, now) = (panel.view.notices.len(), ui.input(|i| i.time));
    let same = |(n, text, _): &&mut (usize, String, f64)| *n == count && text == notice;
    let since = match panel.memory.notice.as_mut().filter(same) {
        Some((.., since)) => since,
        None => &mut panel.memory.notice.insert((count, notice.clone(), now)).2,
    };
    if now - *since < NOTICE_STAYS
        && dismissible(ui, "notice", |ui| {
            ui.add(Label::new(notice).wrap());
        })
    {
        *since = f64::NEG_INFINITY;
    }
}

/// Lesson and suggestions, until they are dismissed.
fn lesson(ui: &mut Ui, side: bool, panel: &mut Panel<'_>) {
    let scene = &panel.view.scenario;
    let dismissed = panel.memory.dismissed_lesson.as_deref() == Some(scene.id);
    if scene.lesson.is_empty() || dismissed {
        return;
    }
    let hints: Vec<&str> = scene.hints.into_iter().filter(|h| !h.is_empty()).collect();
    let hints = hints.join("  ·  ");
    let dismiss = dismissible(ui, "lesson", |ui| {
        ui.add(Label::new(scene.lesson).wrap());
        if !hints.is_empty() {
            hint::show(ui, &format!("Try: {hints}"), side, panel);
        }
    });
    if dismiss {
        panel.memory.dismissed_lesson = Some(scene.id.to_owned());
    }
}

/// Text with a button to dismiss it; returns `true` if that was clicked.
fn dismissible(ui: &mut Ui, what: &str, add: impl FnOnce(&mut Ui)) -> bool {
    let name = format!("Dismiss {what}");
    ui.horizontal_top(|ui| {
        let close = button(ui, Text("✖", &name, &format!("{name}.")), &name);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            add(ui);
        });
        close
    })
    .inner
}

/// The strip of the 2012 scene: the integrator that moves the box and, if there is `room`, its faults.
fn strip(ui: &mut Ui, demo: &DemoView, room: bool, panel: &mut Panel<'_>) {
    ui.horizontal_wrapped(|ui| {
        let of_2012 = Stepper::ALL.map(Some);
        for stepper in of_2012.into_iter().chain([None]) {
            let ours = "Use the plugin with the selected integrator.";
            let hint = stepper.map_or(ours, Stepper::fault);
            let words = text(stepper.map_or("box_physics", Stepper::name), hint);
            panel.choice(ui, demo.stepper == stepper, words, Action::SetDemo(stepper));
        }
        if demo.stepper.is_some() {
            let name = ["Start cycle log", "Stop cycle log"][usize::from(demo.log.is_some())];
            let hint = "Write the time of every integration cycle to a text file, as in 2012.";
            panel.button(ui, text(name, hint), Action::ToggleDemoLog);
            let words = |us: f64| format!("{} µs", number((us * 100.0).round() / 100.0));
            let cycle = panel.view.measured(demo.cycle_us, words);
            ui.add(Label::new(RichText::new(format!("last cycle {cycle}")).small()).extend());
            if let Some((path, cycles)) = &demo.log {
                ui.small(format!("{path} · {cycles} cycles"));
            }
        }
    });
    let words = match demo.stepper {
        Some(stepper) => format!("{}\nNow: {}.", stepper.fault(), demo.fault),
        None => format!(
            "{}: pushes add up, the fall is a parabola, contact acts at the corners.",
            panel.view.integrator.name()
        ),
    };
    if room {
        let all = format!("All three integrators of 2012: {}.", FAULTS.join("; "));
        ui.add(Label::new(words).wrap()).on_hover_text(all);
    }
}

/// The list of keys over everything. A click next to it or on Close requests to close it. Esc is handled by the game's
/// keys, so that one press is one request.
pub(super) fn help(ui: &Ui, panel: &mut Panel<'_>) {
    if !panel.view.show_help {
        panel.memory.sure = false;
        return;
    }
    let screen = ui.ctx().content_rect();
    let modal = Modal::new(Id::new("help")).show(ui.ctx(), |ui| {
        ui.set_width(560.0_f32.min(screen.width() - 60.0).max(0.0));
        let mut close = false;
        ui.horizontal_wrapped(|ui| {
            ui.heading("Keys");
            let words = text("Close help", "F1 or ? opens it again.");
            close = button(ui, words, "Close help");
            let hint = "Restore the scene's parameters.";
            let reset = text("Reset all parameters", hint);
            panel.button(ui, reset, Action::ResetParameters);
            reset_everything(ui, panel);
        });
        ui.horizontal_wrapped(|ui| scale(ui, panel));
        ui.label("Right-click a slider to reset it. Typed values may exceed the slider's range.");
        let height = (screen.height() - 140.0).max(40.0);
        let list = ScrollArea::vertical().max_height(height);
        list.min_scrolled_height(height).show(ui, keys);
        close
    });
    if modal.inner || modal.backdrop_response.clicked() {
        panel.ask(Action::ToggleHelp);
    }
}

/// Asks for confirmation before resetting everything.
fn reset_everything(ui: &mut Ui, panel: &mut Panel<'_>) {
    let hint = "Restore the first scene and every default.";
    if !panel.memory.sure {
        let reset = text("Reset everything…", hint);
        panel.memory.sure = button(ui, reset, "reset everything");
        return;
    }
    let before = panel.out.len();
    let yes = text("Yes, reset everything", hint);
    panel.button(ui, yes, Action::ResetEverything);
    let no = button(ui, text("No", "Keep everything as it is."), "no");
    panel.memory.sure = !no && panel.out.len() == before;
}

/// Scales of the panel with a button each.
const SCALES: [f64; 5] = [0.75, 1.0, 1.25, 1.5, 2.0];

fn scale(ui: &mut Ui, panel: &mut Panel<'_>) {
    let preferences = panel.view.preferences;
    ui.label("Panel scale:");
    for scale in SCALES {
        let chosen = (f64::from(preferences.ui_scale) - scale).abs() < 1e-3;
        let name = format!("{:.0} %", scale * 100.0);
        panel.choice(
            ui,
            chosen,
            text(&name, "Set the panel scale."),
            Action::SetUiScale(scale),
        );
    }
    ui.label("(Ctrl and + or −)");
    let theme = text("Light theme", "Switch between light and dark panel.");
    panel.toggle(ui, preferences.light, theme, Action::ToggleTheme);
}

fn keys(ui: &mut Ui) {
    let grid = Grid::new("keys").num_columns(2).striped(true);
    grid.show(ui, |ui| {
        let known = |key| key != SCREENSHOT || platform::SCREENSHOT_KEY.is_some();
        for (key, what) in KEYS.iter().filter(|(key, _)| known(*key)) {
            ui.add(Label::new(RichText::new(*key).strong()).extend());
            ui.add(Label::new(*what).wrap());
            ui.end_row();
        }
    });
}

/// The single line of a hidden panel, over the picture.
pub(super) fn hud(ui: &mut Ui, panel: &mut Panel<'_>) {
    let view = panel.view;
    let line = format!(
        "{} · {}{} · t = {:.2} s · {}/step{}",
        view.scenario.title,
        style::marked_name(view.integrator),
        ["", " · PAUSED"][usize::from(view.paused)],
        view.time,
        view.step_time(),
        ["", " · ● REC"][usize::from(view.log.is_some())],
    );
    let place = ui.available_rect_before_wrap().shrink(6.0);
    within(ui, place, |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
                let show = text("Show panel", "Show the panel (`).");
                panel.button(ui, show, Action::TogglePanel);
                ui.add(Label::new(line).truncate());
            });
        });
    });
}
