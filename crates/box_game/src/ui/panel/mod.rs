//! The panel: a pure function of a [`PanelView`] that emits [`Action`]s.
//!
//! ```text
//! ┌ top bar ─────────────────────────────────────────┐
//! │ headline, lesson over the picture    ┬ side      │
//! │ the picture: `PanelLayout::central`  │ sections  │
//! ├ drawer: Error Energy … Table ────────┤           │
//! └──────────────────────────────────────┴───────────┘
//! ```
//!
//! It draws, requests actions, and changes only its own [`PanelMemory`]. Every interactive widget has an accessible
//! name and an id for tests (`widgets`). The picture keeps at least [`SHARE`] of the window: the drawer is lower if
//! necessary. If that is not enough, the side panel is hidden while the drawer is open.

mod axis;
pub(crate) mod decimate;
mod drawer;
pub(crate) mod format;
mod hint;
mod keys;
mod memory;
mod overlay;
mod picker;
mod row;
mod side;
#[cfg(test)]
mod tests;
mod top_bar;
mod view;
mod widgets;

pub use keys::KEYS;
pub use memory::PanelMemory;
#[cfg(test)]
pub(crate) use tests::sample::sample_view;
pub use view::PanelView;
pub(crate) use view::{DemoView, FIGURES};

use bevy_egui::egui::{self, Rect, Ui};

use crate::action::Action;
use crate::view::style;
use widgets::Panel;

/// Areas of the window in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelLayout {
    /// Area of the picture \[points\]; multiply by `pixels_per_point` for pixels. Its size is never negative.
    pub central: Rect,
    /// Height of the captions at the top of `central` \[points\].
    pub captions: f32,
    /// Area of the open plot or table \[points\].
    pub plot: Option<Rect>,
}

/// Width of the side panel, enough for all of its contents [points].
const SIDE: f32 = 304.0;
/// Minimum share of the window for the picture.
pub const SHARE: f32 = 0.45;
/// Height of the drawer: the minimum [points], and the default relative to the height below the top bar.
const DRAWER_LEAST: f32 = 110.0;
const DRAWER: f32 = 0.3;

/// Draws the panel into `ui`, which spans the window, and appends the requested actions to `out`.
pub fn show(
    ui: &mut Ui,
    view: &PanelView,
    memory: &mut PanelMemory,
    out: &mut Vec<Action>,
) -> PanelLayout {
    style::install(ui.ctx(), view.preferences.light);
    let panel = &mut Panel { view, memory, out };
    overlay::help(ui, panel);
    picker::show(ui, panel);
    let window = ui.available_rect_before_wrap();
    if view.hidden {
        overlay::hud(ui, panel);
        return PanelLayout {
            central: window,
            captions: 0.0,
            plot: None,
        };
    }
    egui::Panel::top("top bar").show(ui, |ui| top_bar::show(ui, panel));

    let open = view.preferences.show_plots;
    // The most that the drawer may have beside a side panel of this width.
    let most = |ui: &Ui, side: f32| {
        let width = (ui.available_width() - side - 2.0).max(1.0);
        ui.available_height() - SHARE * window.area() / width
    };
    let side = !open || most(ui, SIDE) >= DRAWER_LEAST;
    if side {
        egui::Panel::right("side panel")
            .resizable(false)
            .exact_size(SIDE)
            .show(ui, |ui| side::show(ui, panel));
    }
    let plot = open.then(|| {
        let most = most(ui, 0.0).max(DRAWER_LEAST);
        egui::Panel::bottom("drawer")
            .resizable(true)
            .default_size((ui.available_height() * DRAWER).clamp(DRAWER_LEAST, most))
            .size_range(DRAWER_LEAST..=most)
            .show(ui, |ui| drawer::show(ui, panel))
            .inner
    });
    let left = ui.available_rect_before_wrap();
    let central = Rect::from_min_size(left.min, left.size().max(egui::Vec2::ZERO));
    PanelLayout {
        central,
        captions: overlay::captions(ui, central, side, panel),
        plot,
    }
}
