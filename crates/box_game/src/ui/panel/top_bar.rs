//! The bar at the top: scene, speed, time and unusual conditions.

use bevy_egui::egui::{Button, ComboBox, Label, RichText, Ui, WidgetInfo, WidgetType, vec2};

use super::format::{grouped, number};
use super::view::PanelView;
use super::widgets::{Panel, Text, id_of, identify, text};
use crate::action::Action;
use crate::parameters::SPEEDS;

/// Fraction of the target speed below which the clock is behind.
const BEHIND: f64 = 0.95;
/// Width of the window below which buttons show only their symbols [points].
const NAMED: f32 = 1240.0;

/// Draws the bar: one row, which wraps if necessary.
pub(super) fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    let named = ui.available_width() >= NAMED;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = if named { 6.0 } else { 3.0 };
        scene(ui, panel, named);
        ui.separator();
        clock(ui, panel, named);
        ui.separator();
        speed(ui, panel);
        ui.separator();
        windows(ui, panel, named);
        ui.separator();
        readouts(ui, panel.view, named);
    });
}

fn scene(ui: &mut Ui, panel: &mut Panel<'_>, named: bool) {
    let title = panel.view.scenario.title;
    let width = if named { 190.0 } else { 104.0 };
    let size = vec2(width, ui.spacing().interact_size.y);
    let menu = Button::new(format!("☰ {title}")).truncate();
    let menu = ui.allocate_ui(size, |ui| ui.add(menu)).inner;
    menu.widget_info(|| WidgetInfo {
        current_text_value: Some(title.to_owned()),
        ..WidgetInfo::labeled(WidgetType::Button, true, "Scenes")
    });
    identify(&menu, id_of(&Action::TogglePicker));
    if menu.on_hover_text("Choose a scene (Ctrl+O).").clicked() {
        panel.ask(Action::TogglePicker);
    }
    let previous = Text("◂", "Previous scene", "Previous scene ([)");
    panel.button(ui, previous, Action::PreviousScene);
    let next = Text("▸", "Next scene", "Next scene (])");
    panel.button(ui, next, Action::NextScene);
}

fn clock(ui: &mut Ui, panel: &mut Panel<'_>, named: bool) {
    let (paused, shift) = (panel.view.paused, ui.input(|i| i.modifiers.shift));
    let steps = if shift { 10 } else { 1 };
    let (sign, name) = [("⏸", "Pause"), ("▶", "Resume")][usize::from(paused)];
    #[rustfmt::skip]
    let buttons = [
        (sign, name, "Pause or resume (P or Space).", Action::TogglePause),
        ("⏮", "Back", "Step back; pauses (,). With Shift: ten steps.", Action::StepBack(steps)),
        ("⏭", "Step", "Step forward; pauses (.). With Shift: ten steps.", Action::Step(steps)),
        ("⟲", "Restart", "Restart the scene with the current parameters (R).", Action::Restart),
    ];
    for (sign, name, hint, action) in buttons {
        let both = format!("{sign} {name}");
        let written = if named { both.as_str() } else { sign };
        panel.button(ui, Text(written, name, hint), action);
    }
}

fn speed(ui: &mut Ui, panel: &mut Panel<'_>) {
    panel.button(ui, Text("−", "Slower", "Slower (-)"), Action::Slower);
    let now = panel.view.speed;
    let target = format!("{}×", number(now));
    let list = |ui: &mut Ui| {
        for speed in SPEEDS {
            let name = format!("{}×", number(speed));
            let name = text(&name, "Simulated seconds per second.");
            panel.choice(ui, speed == now, name, Action::SetSpeed(speed));
        }
    };
    let combo = ComboBox::from_id_salt("speed").width(56.0);
    let combo = combo.selected_text(&target).show_ui(ui, list).response;
    combo.widget_info(|| WidgetInfo {
        label: Some("Speed".into()),
        current_text_value: Some(target.clone()),
        ..WidgetInfo::new(WidgetType::ComboBox)
    });
    identify(&combo, "speed");
    combo.on_hover_text("Target speed: simulated seconds per second (0 resets to 1×).");
    panel.button(ui, Text("+", "Faster", "Faster (=)"), Action::Faster);
}

fn windows(ui: &mut Ui, panel: &mut Panel<'_>, named: bool) {
    let view = panel.view;
    for (sign, name, what, key, action) in [
        ("↶", "Undo", view.undoes, "Ctrl+Z", Action::Undo),
        ("↷", "Redo", view.redoes, "Ctrl+Shift+Z", Action::Redo),
    ] {
        let hint = format!("{name}: {} ({key}).", what.unwrap_or("nothing"));
        ui.add_enabled_ui(what.is_some(), |ui| {
            panel.button(ui, Text(sign, name, &hint), action);
        });
    }
    let plots = text("Plots", "Show or hide the plots (M).");
    let open = view.preferences.show_plots;
    panel.toggle(ui, open, plots, Action::TogglePlots);
    if named {
        let hint = "Reduce the panel to one line; backtick (`) restores it.";
        panel.button(ui, text("Hide panel", hint), Action::TogglePanel);
    }
    let help = text("Help", "Keys, scale and theme (F1 or ?).");
    panel.toggle(ui, view.show_help, help, Action::ToggleHelp);
}

/// The time; and a paused or late clock, a log, a renderer without a GPU.
fn readouts(ui: &mut Ui, view: &PanelView, named: bool) {
    let mut read = |text: &str, hint: &str| {
        ui.add(Label::new(RichText::new(text).monospace()).extend())
            .on_hover_text(hint);
    };
    let (steps, dropped) = (grouped(view.steps), number(view.dropped));
    let hint = format!(
        "Simulated time, after {steps} steps. Dropped by slow frames since the start: {dropped} s."
    );
    read(&format!("t = {:.2} s", view.time), &hint);
    match view.actual_speed {
        _ if view.paused => read("PAUSED", "P or Space resumes."),
        Some(speed) if speed < BEHIND * view.speed => {
            let hint = "Measured over the last second: the computer cannot keep up.";
            read(&format!("only {speed:.2}×"), hint);
        }
        _ => {}
    }
    if let Some((path, rows)) = &view.log {
        let hint = format!("Rows logged to {path}");
        read(&format!("● REC {}", grouped(*rows)), &hint);
    }
    if view.software_rendering {
        let hint =
            "Software rendering: frame times are not representative; integrator timings are.";
        read(if named { "⚠ no GPU" } else { "⚠" }, hint);
    }
}
