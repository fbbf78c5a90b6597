//! What a person has set and wants to find again: kept in the settings file of the user.

use bevy::app::AppExit;
use bevy::prelude::*;
use bevy::settings::{
    ReflectSettingsGroup, SaveSettingsDeferred, SaveSettingsSync, SettingsGroup, SettingsPlugin,
};

use crate::scene::session::Session;

/// The folder of the settings, below the user's own.
const APPLICATION: &str = "io.github.box_physics.box_game";

/// Smallest and largest scale of the panel.
pub const UI_SCALES: (f32, f32) = (0.75, 2.0);

/// What is kept. In `settings.toml`, section `box_game`.
#[derive(Resource, SettingsGroup, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, SettingsGroup, Default)]
#[settings_group(group = "box_game")]
pub struct Preferences {
    /// Scale of the panel, 0.75 to 2.
    pub ui_scale: f32,
    /// The drawer is open.
    pub show_plots: bool,
    /// Bounding boxes are drawn.
    pub show_aabb: bool,
    /// Contacts are drawn.
    pub show_contacts: bool,
    /// Body axes and velocity are drawn.
    pub show_axes: bool,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            ui_scale: 1.0,
            show_plots: true,
            show_aabb: false,
            show_contacts: false,
            show_axes: false,
        }
    }
}

/// Loads the settings at once and saves them when they change. Add it before the game.
pub struct PreferencesPlugin;

impl Plugin for PreferencesPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Preferences>()
            .add_plugins(SettingsPlugin::new(APPLICATION))
            .add_systems(Last, save);
    }
}

/// Gives the session what was kept.
pub fn restore(session: &mut Session, kept: &mut Preferences) {
    // A file can say anything.
    kept.ui_scale = if kept.ui_scale.is_finite() {
        kept.ui_scale.clamp(UI_SCALES.0, UI_SCALES.1)
    } else {
        1.0
    };
    session.show_plots = kept.show_plots;
    session.show_aabb = kept.show_aabb;
    session.show_contacts = kept.show_contacts;
    session.show_axes = kept.show_axes;
}

/// Takes over what was switched.
pub fn follow(session: Res<Session>, mut kept: ResMut<Preferences>) {
    let now = Preferences {
        ui_scale: kept.ui_scale,
        show_plots: session.show_plots,
        show_aabb: session.show_aabb,
        show_contacts: session.show_contacts,
        show_axes: session.show_axes,
    };
    kept.set_if_neq(now);
}

/// Saves a second after the last change, and at the end.
fn save(kept: Res<Preferences>, mut exit: MessageReader<AppExit>, mut commands: Commands) {
    if exit.read().next().is_some() {
        commands.queue(SaveSettingsSync::IfChanged);
    } else if kept.is_changed() && !kept.is_added() {
        commands.queue(SaveSettingsDeferred::default());
    }
}
