//! The panel and the preferences.

pub mod panel;
pub mod panel_view;
mod show;

use bevy::prelude::*;
use bevy_egui::EguiPrimaryContextPass;

use crate::action::Action;
use crate::camera::views::arrange_views;
use crate::preferences::{self, Preferences};
use crate::scene::session::Session;

/// Adds the switches of the panel; runs without a window.
pub fn switches_plugin(app: &mut App) {
    app.init_resource::<Preferences>()
        .add_observer(switch)
        .add_observer(preferences::on_action)
        .add_systems(PreStartup, preferences::clamp_scale);
}

/// Adds the panel. Needs a renderer and egui.
pub fn panel_plugin(app: &mut App) {
    let show = show::show_panel.before(arrange_views);
    app.add_systems(Startup, show::spawn_camera)
        .add_systems(EguiPrimaryContextPass, show);
}

fn switch(action: On<Action>, mut session: ResMut<Session>) {
    match *action {
        Action::ToggleHelp => session.show_help ^= true,
        Action::TogglePicker => session.show_picker ^= true,
        Action::TogglePanel => session.hidden ^= true,
        Action::SelectPlot(plot) => session.plot = plot,
        _ => {}
    }
}
