//! Keyboard, gamepad and scripts: sources of [`Action`](crate::action::Action)s.

pub mod focus;
#[cfg(feature = "gamepad")]
mod gamepad;
mod keys;
pub mod script;

use bevy::prelude::*;

use crate::action::ActionSystems;

/// Requests actions from scripts, keys and gamepads.
pub fn plugin(app: &mut App) {
    app.init_resource::<focus::UiFocus>()
        .init_resource::<script::PendingPictures>()
        .add_systems(
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
