//! The log for people: error, warning and info through `tracing`, to the console and to a file.

use std::fs::File;
use std::path::PathBuf;
use std::sync::Mutex;

use bevy::log::tracing_subscriber::Layer;
use bevy::log::{BoxedLayer, LogPlugin, tracing_subscriber};
use bevy::prelude::*;

/// Where it goes: `box_game.log` in the current directory.
pub fn file() -> PathBuf {
    PathBuf::from("box_game.log")
}

/// Bevy's log with a file beside the console.
pub fn plugin() -> LogPlugin {
    LogPlugin {
        // What the libraries under the game think of the machine helps nobody who plays.
        filter: "wgpu=error,naga=warn,bevy_egui=error,winit=error,bevy_asset=error,bevy_app=warn"
            .to_owned(),
        custom_layer: file_layer,
        ..default()
    }
}

fn file_layer(_app: &mut App) -> Option<BoxedLayer> {
    // A folder that cannot be written to is no reason not to play.
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
