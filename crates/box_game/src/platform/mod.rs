//! Everything that differs between a desktop and a browser, under the same names in `native` and `web`:
//!
//! | | desktop | browser |
//! |---|---|---|
//! | arguments | of the program | query string, see [`query`] |
//! | text for the user | standard output and error | the page |
//! | written files | the file system | downloads |
//! | read files | the file system | shipped, dropped on the page, fetched by it |
//! | background work | threads | slices of the frames |
//! | CPU usage | of the system | not available |
//!
//! The clock is Bevy's (`bevy::platform::time`). Bevy stores the preferences (`bevy::settings`) in a file, or in the
//! browser's local storage. Errors are those of the operating system; in a browser there are none unless documented.

pub mod query;

#[cfg(any(test, target_family = "wasm"))]
macro_rules! shipped {
    ($path:literal) => {
        ($path, include_str!(concat!("../../../../", $path)))
    };
}

#[cfg(not(target_family = "wasm"))]
mod native;
#[cfg(target_family = "wasm")]
mod web;

#[cfg(not(target_family = "wasm"))]
use native as system;
#[cfg(target_family = "wasm")]
use web as system;

pub use system::{
    COPIED, CPU_USAGE, SCREENSHOT_KEY, Stamp, Stream, SyncedFile, Worker, absolute, arguments,
    check, complain, copy, cpu_usage, create, create_folder, exists, list, log_layer, plugin,
    probe, read, refuse, remove, reproduce, say, scene_folder, stamp, window, write,
};

use std::io;
use std::path::PathBuf;

use clap::ValueEnum;

/// The files shipped with the game, by their paths in a checkout. On a desktop the files themselves are read.
#[cfg(any(test, target_family = "wasm"))]
pub(crate) const SHIPPED: &[(&str, &str)] = &[
    shipped!("assets/scenes/example.ron"),
    shipped!("assets/scenes/moon-hop.ron"),
    shipped!("assets/scenes/weighted-bar.ron"),
    shipped!("assets/scripts/flip-race.ron"),
    shipped!("assets/scripts/tour.ron"),
];

/// The first of `name-01`, `name-02`, … with this extension that does not exist.
pub fn next_free(name: &str, extension: &str) -> io::Result<PathBuf> {
    (1..10_000)
        .map(|n| PathBuf::from(format!("{name}-{n:02}.{extension}")))
        .find(|path| !exists(path))
        .ok_or_else(|| {
            let last = format!("{name}-9999.{extension}");
            io::Error::other(format!(
                "all names from {name}-01.{extension} to {last} are taken"
            ))
        })
}

/// The path, if it has this extension, in any case.
pub fn with_extension(text: &str, extension: &str) -> Option<PathBuf> {
    let path = PathBuf::from(text);
    let own = path.extension()?;
    own.eq_ignore_ascii_case(extension).then_some(path)
}

/// Requirements of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Need {
    /// A window and a GPU.
    Window,
    /// Only a GPU.
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

    /// The browser version contains every scene and script of the checkout.
    #[test]
    fn every_asset_is_shipped() {
        let root = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let folders = ["assets/scenes", "assets/scripts"].map(|folder| list(&root.join(folder)));
        let mut found = folders.concat();
        found.sort();
        let shipped: Vec<_> = SHIPPED.iter().map(|(path, _)| root.join(path)).collect();
        assert_eq!(shipped, found);
    }
}
