//! Preferences: scale of the panel and switches of the view, stored in the user's settings file.

use bevy::app::AppExit;
use bevy::prelude::*;
use bevy::settings::{
    ReflectSettingsGroup, SaveSettingsDeferred, SaveSettingsSync, SettingsGroup, SettingsPlugin,
};

use crate::action::Action;
use crate::parameters::UI_SCALES;

/// The folder of the settings, below the user's settings folder.
const APPLICATION: &str = "io.github.box_physics.box_game";

/// The preferences; section `box_game` of `settings.toml`.
#[derive(Resource, SettingsGroup, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, SettingsGroup, Default)]
#[settings_group(group = "box_game")]
pub struct Preferences {
    /// Scale of the panel, 0.75 to 2.
    pub ui_scale: f32,
    /// `true` if the drawer is open.
    pub show_plots: bool,
    /// `true` if bounding boxes are drawn.
    pub show_aabb: bool,
    /// `true` if contacts are drawn.
    pub show_contacts: bool,
    /// `true` if body axes and velocity are drawn.
    pub show_axes: bool,
    /// `true` for the light theme.
    pub light: bool,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            ui_scale: 1.0,
            show_plots: true,
            show_aabb: false,
            show_contacts: false,
            show_axes: false,
            light: false,
        }
    }
}

/// Loads the preferences and saves them when they change. Add it before the game.
pub fn plugin(app: &mut App) {
    app.register_type::<Preferences>()
        .add_plugins(SettingsPlugin::new(APPLICATION))
        .add_systems(Last, save);
}

/// Clamps the scale, because the settings file may contain any value.
pub fn clamp_scale(mut preferences: ResMut<Preferences>) {
    let scale = preferences.ui_scale;
    let scale = if scale.is_nan() { 1.0 } else { scale };
    let allowed = scale.clamp(UI_SCALES.0, UI_SCALES.1);
    if allowed != preferences.ui_scale {
        preferences.ui_scale = allowed;
    }
}

/// Observes changes of the stored switches.
pub fn on_action(action: On<Action>, mut preferences: ResMut<Preferences>) {
    match *action {
        Action::ToggleAabb => preferences.show_aabb ^= true,
        Action::ToggleContacts => preferences.show_contacts ^= true,
        Action::ToggleAxes => preferences.show_axes ^= true,
        Action::ToggleTheme => preferences.light ^= true,
        Action::TogglePlots => preferences.show_plots ^= true,
        Action::SelectPlot(_) => preferences.show_plots = true,
        Action::SetUiScale(scale) if scale.is_finite() => {
            preferences.ui_scale = (scale as f32).clamp(UI_SCALES.0, UI_SCALES.1);
        }
        Action::ResetEverything => *preferences = Preferences::default(),
        _ => {}
    }
}

/// Saves a second after the last change, and at the end.
fn save(kept: Res<Preferences>, mut exit: MessageReader<AppExit>, mut commands: Commands) {
    if exit.read().next().is_some() {
        commands.queue(SaveSettingsSync::IfChanged);
    } else if kept.is_changed() && !kept.is_added() {
        commands.queue(SaveSettingsDeferred::default());
    }
}
