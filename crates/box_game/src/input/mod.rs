//! Keyboard, gamepad and scripts: sources of [`Action`](crate::action::Action)s.

#[cfg(feature = "gamepad")]
mod gamepad;
mod keys;
pub mod script;

use bevy::prelude::*;

use crate::action::ActionSystems;

/// Requests actions from scripts, keys and gamepads.
pub fn plugin(app: &mut App) {
    app.init_resource::<UiFocus>().add_systems(
        PreUpdate,
        (script::play, keys::read_keys)
            .chain()
            .in_set(ActionSystems::Request),
    );
    #[cfg(feature = "gamepad")]
    app.add_systems(
        PreUpdate,
        gamepad::read_buttons
            .after(keys::read_keys)
            .in_set(ActionSystems::Request),
    );
}

/// Focus of keyboard and mouse on the panel.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UiFocus {
    /// A text field has the focus and receives letters.
    pub text: bool,
    /// A widget has the focus and receives Space, Enter and arrows.
    pub widget: bool,
    /// The pointer is over the panel, or a drag began there.
    pub pointer: bool,
}
