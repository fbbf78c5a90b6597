//! The bar along the top: which scene, how fast, where in time.

use bevy_egui::egui::{Button, ComboBox, Label, Response, RichText, Ui, WidgetInfo, WidgetType};

use super::fields::SPEEDS;
use super::format::{grouped, number, step_size};
use super::view::PanelView;
use crate::action::Action;

/// Below this share of its target the clock is called behind.
const BEHIND: f64 = 0.95;

/// Draws the bar: a row of controls over a row of read-outs; both wrap in a narrow window.
pub(super) fn show(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        scene(ui, view, out);
        ui.separator();
        clock(ui, view, out);
        ui.separator();
        speed(ui, view, out);
        ui.separator();
        windows(ui, view, out);
    });
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 20.0;
        readouts(ui, view);
    });
}

/// A button with its key in the tooltip.
fn button(ui: &mut Ui, text: &str, name: &str, hint: &str) -> Response {
    let response = ui.add(Button::new(text).wrap_mode(bevy_egui::egui::TextWrapMode::Extend));
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, name));
    response.on_hover_text(hint)
}

/// Starts a new row where a group would not fit: a combo box does not wrap by itself.
fn room(ui: &mut Ui, width: f32) {
    if ui.available_size_before_wrap().x < width {
        ui.end_row();
    }
}

fn scene(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let title = view
        .scenes
        .get(view.scene)
        .map_or("no scene", |(_, title)| title);
    let combo = ComboBox::from_id_salt("scene")
        .width(190.0)
        .truncate()
        .selected_text(title)
        .show_ui(ui, |ui| {
            for (k, (id, title)) in view.scenes.iter().enumerate() {
                if ui.selectable_label(k == view.scene, title).clicked() && k != view.scene {
                    out.push(Action::SelectScene(id.clone()));
                }
            }
        })
        .response;
    combo.widget_info(|| WidgetInfo {
        label: Some("Scene".into()),
        current_text_value: Some(title.into()),
        ..WidgetInfo::new(WidgetType::ComboBox)
    });
    combo.on_hover_text("Scene; [ and ] go through the list, Ctrl+O searches in it.");
    if button(ui, "◂", "Previous scene", "Previous scene ([)").clicked() {
        out.push(Action::PreviousScene);
    }
    if button(ui, "▸", "Next scene", "Next scene (])").clicked() {
        out.push(Action::NextScene);
    }
}

fn clock(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let (text, name) = if view.paused {
        ("▶ Resume", "Resume")
    } else {
        ("⏸ Pause", "Pause")
    };
    if button(ui, text, name, "Stop or resume the clock (P or Space).").clicked() {
        out.push(Action::TogglePause);
    }
    let hint = "One step back, the clock standing (,). With Shift: ten.";
    if button(ui, "⏮ Back", "Step back", hint).clicked() {
        out.push(Action::StepBack(ten(ui)));
    }
    let hint = "One step, the clock standing (.). With Shift: ten.";
    if button(ui, "⏭ Step", "Step", hint).clicked() {
        out.push(Action::Step(ten(ui)));
    }
    let hint = "The scene from its start, with the present parameters (R).";
    if button(ui, "⟲ Restart", "Restart", hint).clicked() {
        out.push(Action::Restart);
    }
}

/// How many steps a click means.
fn ten(ui: &Ui) -> u32 {
    if ui.input(|i| i.modifiers.shift) {
        10
    } else {
        1
    }
}

fn speed(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    room(ui, 290.0);
    if button(ui, "−", "Slower", "Slower (-)").clicked() {
        out.push(Action::Slower);
    }
    let target = format!("{}×", number(view.speed));
    let combo = ComboBox::from_id_salt("speed")
        .width(70.0)
        .selected_text(&target)
        .show_ui(ui, |ui| {
            for speed in SPEEDS {
                let chosen = speed == view.speed;
                if ui
                    .selectable_label(chosen, format!("{}×", number(speed)))
                    .clicked()
                    && !chosen
                {
                    out.push(Action::SetSpeed(speed));
                }
            }
        })
        .response;
    combo.widget_info(|| WidgetInfo {
        label: Some("Speed".into()),
        current_text_value: Some(target.clone()),
        ..WidgetInfo::new(WidgetType::ComboBox)
    });
    combo.on_hover_text("Target: simulated seconds per second (default 1× · key 0).");
    if button(ui, "+", "Faster", "Faster (=)").clicked() {
        out.push(Action::Faster);
    }
    let actual = match view.actual_speed {
        _ if view.paused => "PAUSED".to_owned(),
        Some(speed) if speed < BEHIND * view.speed => format!("actual {speed:.2}× behind"),
        Some(speed) => format!("actual {speed:.2}×"),
        None => "actual …".to_owned(),
    };
    ui.add(Label::new(RichText::new(actual).monospace()).extend())
        .on_hover_text(format!(
            "Measured over the last second. Dropped by slow frames since the start: {} s.",
            number(view.dropped)
        ));
}

fn windows(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    for (text, name, what, key, action) in [
        (
            "↶",
            "Undo",
            &view.interaction.undoes,
            "Ctrl+Z",
            Action::Undo,
        ),
        (
            "↷",
            "Redo",
            &view.interaction.redoes,
            "Ctrl+Shift+Z",
            Action::Redo,
        ),
    ] {
        let response = ui.add_enabled(what.is_some(), Button::new(text));
        let enabled = what.is_some();
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, enabled, name));
        let hint = what.as_deref().unwrap_or("nothing");
        if response
            .on_hover_text(format!("{name}: {hint} ({key})."))
            .clicked()
        {
            out.push(action);
        }
    }
    let toggle = |ui: &mut Ui, on: bool, text: &str, hint: &str| {
        let response = ui.add(Button::selectable(on, text).frame_when_inactive(true));
        response.widget_info(|| WidgetInfo::selected(WidgetType::Button, true, on, text));
        response.on_hover_text(hint).clicked()
    };
    if toggle(ui, view.show_plots, "Plots", "Show or hide the plots (M).") {
        out.push(Action::TogglePlots);
    }
    if toggle(
        ui,
        false,
        "Hide panel",
        "Leave one line; the same key (`) brings the panel back.",
    ) {
        out.push(Action::TogglePanel);
    }
    if toggle(ui, view.show_help, "Help", "All keys (F1 or ?).") {
        out.push(Action::ToggleHelp);
    }
}

fn readouts(ui: &mut Ui, view: &PanelView) {
    let read = |ui: &mut Ui, text: String, hint: &str| {
        ui.add(Label::new(RichText::new(text).monospace()).extend())
            .on_hover_text(hint);
    };
    read(ui, format!("t = {:.3} s", view.time), "Simulated time.");
    read(
        ui,
        format!("step {}", grouped(view.steps)),
        "Steps since the start of the scene.",
    );
    let substeps = if view.substeps > 1 {
        format!(" in {} parts", view.substeps)
    } else {
        String::new()
    };
    read(
        ui,
        format!("dt = {}{substeps}", step_size(view.step)),
        "Step size.",
    );
    match &view.log {
        Some(log) => {
            let name = log.path.rsplit(['/', '\\']).next().unwrap_or_default();
            // The full path is in the tooltip and the LOG section.
            let name: String = name.chars().take(32).collect();
            read(
                ui,
                format!("● REC {name} {} rows", grouped(log.rows)),
                &log.path,
            );
        }
        None => read(ui, "not logging".into(), "L starts a CSV log."),
    }
    if view.software_rendering {
        let badge = RichText::new("⚠ software rendering").strong();
        ui.add(Label::new(badge).extend()).on_hover_text(
            "No graphics card is in use: frame times say nothing. Integrator times stand.",
        );
    }
}
