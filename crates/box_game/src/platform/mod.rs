//! Everything that differs between a desktop and a browser, under the same names in `native` and `web`:
//!
//! | | desktop | browser |
//! |---|---|---|
//! | arguments | of the program | query string, see [`query`] |
//! | text for the user | standard output and error | the page |
//! | files that are written | the file system | downloads |
//! | files that are read | the file system | shipped, dropped on the page, fetched by it |
//! | work beside the frames | threads | slices of the frames |
//! | CPU usage | of the system | not available |
//!
//! The clock is Bevy's (`bevy::platform::time`), and Bevy keeps the preferences (`bevy::settings`): a file, or the
//! browser's local storage.

pub mod query;

#[cfg(any(test, target_family = "wasm"))]
macro_rules! shipped {
    ($path:literal) => {
        ($path, include_str!(concat!("../../../../", $path)))
    };
}

#[cfg(not(target_family = "wasm"))]
mod native;
#[cfg(not(target_family = "wasm"))]
pub use native::{
    COPIED, CPU_USAGE, SCREENSHOT_KEY, Stamp, Stream, SyncedFile, Worker, absolute, arguments,
    check, complain, cpu_usage, create, create_folder, exists, list, log_layer, plugin, probe,
    read, refuse, remove, reproduce, say, scene_folder, stamp, window, write,
};

#[cfg(target_family = "wasm")]
mod web;
#[cfg(target_family = "wasm")]
pub use web::{
    COPIED, CPU_USAGE, SCREENSHOT_KEY, Stamp, Stream, SyncedFile, Worker, absolute, arguments,
    check, complain, cpu_usage, create, create_folder, exists, list, log_layer, plugin, probe,
    read, refuse, remove, reproduce, say, scene_folder, stamp, window, write,
};

use clap::ValueEnum;

/// The files that come with the game, by their paths in a checkout. A desktop reads the files themselves.
#[cfg(any(test, target_family = "wasm"))]
const SHIPPED: &[(&str, &str)] = &[
    shipped!("assets/scenes/example.ron"),
    shipped!("assets/scenes/moon-hop.ron"),
    shipped!("assets/scenes/weighted-bar.ron"),
    shipped!("assets/scripts/film.ron"),
    shipped!("assets/scripts/flip-race.ron"),
    shipped!("assets/scripts/tour.ron"),
];

/// Requirements of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Need {
    /// A window and a GPU.
    Window,
    /// A GPU alone.
    Gpu,
}

/// A missing requirement, with a remedy.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{reason}\n{advice}")]
pub struct Unavailable {
    /// The missing part.
    pub reason: String,
    /// A remedy.
    pub advice: &'static str,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The browser has every scene and script of the checkout.
    #[test]
    fn every_asset_is_shipped() {
        let root = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let mut found: Vec<_> = ["assets/scenes", "assets/scripts"]
            .iter()
            .flat_map(|folder| list(&root.join(folder)))
            .map(|path| {
                path.strip_prefix(root)
                    .expect("inside")
                    .display()
                    .to_string()
            })
            .collect();
        found.sort();
        let shipped: Vec<_> = SHIPPED.iter().map(|(path, _)| *path).collect();
        assert_eq!(shipped, found);
    }
}
