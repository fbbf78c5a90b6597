//! The panel: a pure function of a [`PanelView`] that emits [`Action`]s.
//!
//! ```text
//! ┌ top bar ─────────────────────────────┬───────────┐
//! │ lesson, notice                       │ side      │
//! │ the picture: `PanelLayout::central`  │ sections  │
//! ├ drawer: Error Energy … Table ────────┤           │
//! └──────────────────────────────────────┴───────────┘
//! ```
//!
//! It draws and asks, and changes nothing but its own [`PanelMemory`]. Every widget that can be used has
//! an accessible name, by which the tests find it: a button its text without key or sign ("Pause"), a
//! slider `Gravity [m/s²]`, its typed value `Gravity value [m/s²]`, an integrator its name.

pub(crate) mod decimate;
mod demo;
mod drawer;
mod format;
mod keys;
mod linear_axis;
mod log_axis;
mod memory;
mod overlay;
mod picker;
mod row;
mod sample;
mod side;
#[cfg(test)]
mod tests;
mod top_bar;
mod view;
mod widgets;

pub use format::number;
pub use keys::KEYS;
pub use memory::{PanelMemory, Section};
#[doc(hidden)]
pub use sample::sample_view;
pub use view::{DemoView, HistoryView, IntegratorTiming, LogView, MainBoxView, PanelView};

use bevy_egui::egui::{Panel, Rect, Ui};

use crate::action::Action;
use crate::view::style;

/// Room that the panel leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelLayout {
    /// For the picture \[points\]: times `pixels_per_point` for pixels. Never negative in size.
    pub central: Rect,
    /// The open plot or table \[points\].
    pub plot: Option<Rect>,
}

/// Width of the side panel: as it opens, and the least that shows everything [points].
const SIDE: f32 = 340.0;
const SIDE_LEAST: f32 = 300.0;

/// Draws the panel into `ui`, which spans the window, and appends what was asked for to `out`.
pub fn show(
    ui: &mut Ui,
    view: &PanelView,
    memory: &mut PanelMemory,
    out: &mut Vec<Action>,
) -> PanelLayout {
    style::install(ui.ctx(), view.preferences.light);
    overlay::help(ui, view, memory, out);
    picker::show(ui, view, memory, out);
    if view.hidden {
        let central = ui.available_rect_before_wrap();
        overlay::hud(ui, view, out);
        return PanelLayout {
            central,
            plot: None,
        };
    }
    Panel::top("top bar").show(ui, |ui| top_bar::show(ui, view, out));

    let width = ui.available_width();
    Panel::right("side panel")
        .default_size(SIDE.min(width * 0.5).max(SIDE_LEAST))
        .size_range(SIDE_LEAST..=(width * 0.6).max(SIDE_LEAST))
        .show(ui, |ui| side::show(ui, view, memory, out));

    let plot = view.preferences.show_plots.then(|| {
        let height = ui.available_height();
        Panel::bottom("drawer")
            .resizable(true)
            .default_size((height * 0.38).clamp(90.0, 300.0))
            .size_range(80.0..=(height * 0.6).max(80.0))
            .show(ui, |ui| drawer::show(ui, view, memory, out))
            .inner
    });
    overlay::strips(ui, view, memory);
    demo::show(ui, view, out);

    let left = ui.available_rect_before_wrap();
    PanelLayout {
        central: Rect::from_min_size(left.min, left.size().max(Default::default())),
        plot,
    }
}
