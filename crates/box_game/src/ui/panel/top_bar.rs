//! The bar along the top: which scene, how fast, where in time, and what is out of the ordinary.

use bevy_egui::egui::{Button, ComboBox, Label, RichText, Ui, WidgetInfo, WidgetType};

use super::format::{grouped, number};
use super::view::PanelView;
use super::widgets::{Text, button, choice, id_of, identify, text, toggle};
use crate::action::Action;
use crate::parameters::SPEEDS;

/// The clock is behind below this share of its target speed.
const BEHIND: f64 = 0.95;
/// In a narrower window [points] buttons show their signs alone.
const NAMED: f32 = 1240.0;

/// Draws the bar: one row, which wraps where it must.
pub(super) fn show(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    let named = ui.available_width() >= NAMED;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = if named { 6.0 } else { 3.0 };
        scene(ui, view, named, out);
        ui.separator();
        clock(ui, view, named, out);
        ui.separator();
        speed(ui, view, out);
        ui.separator();
        windows(ui, view, named, out);
        ui.separator();
        readouts(ui, view, named);
    });
}

fn scene(ui: &mut Ui, view: &PanelView, named: bool, out: &mut Vec<Action>) {
    let width = if named { 190.0 } else { 104.0 };
    let height = ui.spacing().interact_size.y;
    let title = Button::new(format!("☰ {}", view.title)).truncate();
    let title = ui
        .allocate_ui([width, height].into(), |ui| ui.add(title))
        .inner;
    title.widget_info(|| WidgetInfo {
        current_text_value: Some(view.title.clone()),
        ..WidgetInfo::labeled(WidgetType::Button, true, "Scenes")
    });
    identify(&title, id_of(&Action::TogglePicker));
    if title.on_hover_text("Choose a scene (Ctrl+O).").clicked() {
        out.push(Action::TogglePicker);
    }
    let previous = Text("◂", "Previous scene", "Previous scene ([)");
    button(ui, previous, Action::PreviousScene, out);
    button(
        ui,
        Text("▸", "Next scene", "Next scene (])"),
        Action::NextScene,
        out,
    );
}

fn clock(ui: &mut Ui, view: &PanelView, named: bool, out: &mut Vec<Action>) {
    // Steps per click.
    let ten = if ui.input(|i| i.modifiers.shift) {
        10
    } else {
        1
    };
    let pause = if view.paused {
        ("▶", "Resume")
    } else {
        ("⏸", "Pause")
    };
    for ((sign, name), hint, action) in [
        (pause, "Pause or resume (P or Space).", Action::TogglePause),
        (
            ("⏮", "Back"),
            "Step back; pauses (,). With Shift: ten steps.",
            Action::StepBack(ten),
        ),
        (
            ("⏭", "Step"),
            "Step forward; pauses (.). With Shift: ten steps.",
            Action::Step(ten),
        ),
        (
            ("⟲", "Restart"),
            "Restart the scene with the current parameters (R).",
            Action::Restart,
        ),
    ] {
        let written = if named {
            format!("{sign} {name}")
        } else {
            sign.to_owned()
        };
        button(ui, Text(&written, name, hint), action, out);
    }
}

fn speed(ui: &mut Ui, view: &PanelView, out: &mut Vec<Action>) {
    button(ui, Text("−", "Slower", "Slower (-)"), Action::Slower, out);
    let target = format!("{}×", number(view.speed));
    let combo = ComboBox::from_id_salt("speed")
        .width(56.0)
        .selected_text(&target)
        .show_ui(ui, |ui| {
            for speed in SPEEDS {
                let name = format!("{}×", number(speed));
                let hint = "Simulated seconds per second.";
                choice(
                    ui,
                    speed == view.speed,
                    text(&name, hint),
                    Action::SetSpeed(speed),
                    out,
                );
            }
        })
        .response;
    combo.widget_info(|| WidgetInfo {
        label: Some("Speed".into()),
        current_text_value: Some(target.clone()),
        ..WidgetInfo::new(WidgetType::ComboBox)
    });
    identify(&combo, "speed");
    combo.on_hover_text("Target: simulated seconds per second (default 1× · key 0).");
    button(ui, Text("+", "Faster", "Faster (=)"), Action::Faster, out);
}

fn windows(ui: &mut Ui, view: &PanelView, named: bool, out: &mut Vec<Action>) {
    for (sign, name, what, key, action) in [
        ("↶", "Undo", view.undoes, "Ctrl+Z", Action::Undo),
        ("↷", "Redo", view.redoes, "Ctrl+Shift+Z", Action::Redo),
    ] {
        let hint = format!("{name}: {} ({key}).", what.unwrap_or("nothing"));
        ui.add_enabled_ui(what.is_some(), |ui| {
            button(ui, Text(sign, name, &hint), action, out);
        });
    }
    let plots = text("Plots", "Show or hide the plots (M).");
    toggle(
        ui,
        view.preferences.show_plots,
        plots,
        Action::TogglePlots,
        out,
    );
    if named {
        let hint = "Hide all but one line; the backtick key (`) shows the panel again.";
        button(ui, text("Hide panel", hint), Action::TogglePanel, out);
    }
    let help = text("Help", "Keys, scale and theme (F1 or ?).");
    toggle(ui, view.show_help, help, Action::ToggleHelp, out);
}

/// The time; and a paused or late clock, a log, a renderer without a GPU.
fn readouts(ui: &mut Ui, view: &PanelView, named: bool) {
    let read = |ui: &mut Ui, text: String, hint: &str| {
        ui.add(Label::new(RichText::new(text).monospace()).extend())
            .on_hover_text(hint);
    };
    let hint = format!(
        "Simulated time, after {} steps. Dropped by slow frames since the start: {} s.",
        grouped(view.steps),
        number(view.dropped)
    );
    read(ui, format!("t = {:.2} s", view.time), &hint);
    match view.actual_speed {
        _ if view.paused => read(ui, "PAUSED".to_owned(), "P or Space resumes."),
        Some(speed) if speed < BEHIND * view.speed => {
            let hint = "Measured over the last second: the computer cannot keep up.";
            read(ui, format!("only {speed:.2}×"), hint);
        }
        _ => {}
    }
    if let Some(log) = &view.log {
        let rows = format!("● REC {}", grouped(log.rows));
        read(ui, rows, &format!("Rows logged to {}", log.path));
    }
    if view.software_rendering {
        let badge = if named { "⚠ no GPU" } else { "⚠" };
        let hint = "Rendering on the CPU: frame times mean little; integrator times are right.";
        read(ui, badge.to_owned(), hint);
    }
}
