//! The application log: errors, warnings and notes through `tracing`, to the console and appended to a file.

use std::fs::File;
use std::path::PathBuf;
use std::sync::Mutex;

use bevy::log::tracing_subscriber::Layer;
use bevy::log::{BoxedLayer, LogPlugin, tracing_subscriber};
use bevy::prelude::*;

/// Path of the log: `box_game.log` in the current directory.
pub fn file() -> PathBuf {
    PathBuf::from("box_game.log")
}

/// Bevy's log with a file beside the console.
pub fn plugin() -> LogPlugin {
    LogPlugin {
        // Notes of the libraries about the machine do not help a player.
        filter: "wgpu=error,naga=warn,bevy_egui=error,winit=error,bevy_asset=error,bevy_app=warn"
            .to_owned(),
        custom_layer: file_layer,
        ..default()
    }
}

fn file_layer(_app: &mut App) -> Option<BoxedLayer> {
    // The game also runs in a folder that cannot be written to.
    let file = File::options()
        .create(true)
        .append(true)
        .open(file())
        .ok()?;
    Some(
        tracing_subscriber::fmt::layer()
            .with_ansi(false)
            .with_writer(Mutex::new(file))
            .boxed(),
    )
}
