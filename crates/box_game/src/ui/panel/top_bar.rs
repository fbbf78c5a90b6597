//! The bar along the top: which scene, how fast, where in time.

use bevy_egui::egui::{Button, ComboBox, Label, RichText, Ui, WidgetInfo, WidgetType};

use super::format::{grouped, number, step_size};
use super::view::PanelView;
use super::widgets::{named_button, toggle};
use crate::action::Action;
use crate::parameters::SPEEDS;

/// The clock is behind below this share of its target speed.
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

/// Starts a new row where a group would not fit: a combo box does not wrap by itself.
fn room(ui: &mut Ui, width: f32) {
    if ui.available_size_before_wrap().x < width {
        ui.end_row();
    }
}

fn scene(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let combo = ComboBox::from_id_salt("scene")
        .width(190.0)
        .truncate()
        .selected_text(&view.title)
        .show_ui(ui, |ui| {
            for (id, title) in &view.scenes {
                let chosen = *id == view.scene;
                if ui.selectable_label(chosen, title).clicked() && !chosen {
                    out.push(Action::SelectScene(id.clone()));
                }
            }
        })
        .response;
    combo.widget_info(|| WidgetInfo {
        label: Some("Scene".into()),
        current_text_value: Some(view.title.clone()),
        ..WidgetInfo::new(WidgetType::ComboBox)
    });
    combo.on_hover_text("Scene: [ and ] step through the list, Ctrl+O searches it.");
    if named_button(ui, "◂", "Previous scene", "Previous scene ([)") {
        out.push(Action::PreviousScene);
    }
    if named_button(ui, "▸", "Next scene", "Next scene (])") {
        out.push(Action::NextScene);
    }
}

fn clock(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let (text, name) = if view.paused {
        ("▶ Resume", "Resume")
    } else {
        ("⏸ Pause", "Pause")
    };
    if named_button(ui, text, name, "Pause or resume (P or Space).") {
        out.push(Action::TogglePause);
    }
    let hint = "Step back; pauses (,). With Shift: ten steps.";
    if named_button(ui, "⏮ Back", "Step back", hint) {
        out.push(Action::StepBack(ten(ui)));
    }
    let hint = "Step forward; pauses (.). With Shift: ten steps.";
    if named_button(ui, "⏭ Step", "Step", hint) {
        out.push(Action::Step(ten(ui)));
    }
    let hint = "Restart the scene with the current parameters (R).";
    if named_button(ui, "⟲ Restart", "Restart", hint) {
        out.push(Action::Restart);
    }
}

/// Steps per click.
fn ten(ui: &Ui) -> u32 {
    if ui.input(|i| i.modifiers.shift) {
        10
    } else {
        1
    }
}

fn speed(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    room(ui, 290.0);
    if named_button(ui, "−", "Slower", "Slower (-)") {
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
    if named_button(ui, "+", "Faster", "Faster (=)") {
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
        ("↶", "Undo", view.undoes, "Ctrl+Z", Action::Undo),
        ("↷", "Redo", view.redoes, "Ctrl+Shift+Z", Action::Redo),
    ] {
        let response = ui.add_enabled(what.is_some(), Button::new(text));
        let enabled = what.is_some();
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, enabled, name));
        let hint = what.unwrap_or("nothing");
        if response
            .on_hover_text(format!("{name}: {hint} ({key})."))
            .clicked()
        {
            out.push(action);
        }
    }
    for (on, text, hint, action) in [
        (
            view.preferences.show_plots,
            "Plots",
            "Show or hide the plots (M).",
            Action::TogglePlots,
        ),
        (
            false,
            "Hide panel",
            "Hide all but one line; the backtick key (`) shows the panel again.",
            Action::TogglePanel,
        ),
        (
            view.show_help,
            "Help",
            "List all keys (F1 or ?).",
            Action::ToggleHelp,
        ),
    ] {
        if toggle(ui, on, text, hint) {
            out.push(action);
        }
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
    let substeps = if view.parameters.substeps > 1.0 {
        format!(" in {} parts", view.parameters.substeps)
    } else {
        String::new()
    };
    read(
        ui,
        format!("dt = {}{substeps}", step_size(view.parameters.step)),
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
            "Rendering on the CPU: frame times mean little; integrator times are right.",
        );
    }
}
