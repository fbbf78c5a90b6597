//! The application log: errors, warnings and notes through `tracing`, to the console and, on a desktop, a file.

use bevy::log::LogPlugin;
use bevy::prelude::*;

use crate::platform;

/// Bevy's log, with what the platform adds.
pub(crate) fn plugin() -> LogPlugin {
    LogPlugin {
        // Notes of the libraries about the machine do not help a player.
        filter: "wgpu=error,naga=warn,bevy_egui=error,winit=error,bevy_asset=error,bevy_app=warn"
            .to_owned(),
        custom_layer: platform::log_layer,
        ..default()
    }
}
