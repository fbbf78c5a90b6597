//! The desktop: command line, standard output, file system, threads.

mod display;
mod synced_file;

use std::ffi::OsString;
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::thread::JoinHandle;
use std::time::SystemTime;

use bevy::clipboard::Clipboard;
use bevy::diagnostic::{Diagnostic, DiagnosticsStore, SystemInformationDiagnosticsPlugin};
use bevy::log::BoxedLayer;
use bevy::log::tracing_subscriber::{self, Layer as _};
use bevy::prelude::*;

pub use display::{check, probe};
pub use synced_file::SyncedFile;

/// Reason why the CPU usage is unknown, if it is.
pub const CPU_USAGE: Result<(), &str> = Ok(());
/// Name of the result of [`reproduce`].
pub const COPIED: &str = "command line";
/// The screenshot key.
pub const SCREENSHOT_KEY: Option<KeyCode> = Some(KeyCode::F12);

/// A file that is written incrementally.
pub type Stream = std::fs::File;
/// Last change and length \[bytes\] of a file.
pub type Stamp = (SystemTime, u64);

/// The arguments, starting with the name of the program.
pub fn arguments() -> impl Iterator<Item = OsString> {
    std::env::args_os()
}

/// Ends the program after invalid arguments or a request for help.
pub fn refuse(error: &clap::Error) -> ExitCode {
    error.exit()
}

/// Prints to standard output. A closed pipe (`| head`) is not an error.
pub fn say(text: &str) -> ExitCode {
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => ExitCode::FAILURE,
        _ => ExitCode::SUCCESS,
    }
}

/// Prints an error.
pub fn complain(text: &str) {
    eprintln!("{text}");
}

/// The words of a command line, for a shell.
///
/// # Errors
/// None: a shell has every file.
pub fn reproduce(words: &[String]) -> Result<String, &'static str> {
    let words = words.iter().map(|word| format!(" {}", quoted(word)));
    Ok(format!("box_game{}", words.collect::<String>()))
}

/// Copies a text to the clipboard. Returns `false` if that fails.
pub fn copy(world: &mut World, text: &str) -> bool {
    let clipboard = world.get_resource_mut::<Clipboard>();
    clipboard.is_some_and(|mut clipboard| clipboard.set_text(text).is_ok())
}

/// Quotes a word for a shell, if necessary.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./,=".contains(c);
    if word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// The window with the settings of this platform.
pub fn window(window: Window) -> Window {
    window
}

/// CPU usage of this process [% of all cores] and of the system \[%\], once it is known.
pub fn cpu_usage(store: &DiagnosticsStore) -> Option<(f64, f64)> {
    let value = |path| store.get(&path).and_then(Diagnostic::value);
    let process = value(SystemInformationDiagnosticsPlugin::PROCESS_CPU_USAGE)?;
    let system = value(SystemInformationDiagnosticsPlugin::SYSTEM_CPU_USAGE)?;
    Some((process, system))
}

/// Adds plugins for this platform: CPU usage.
pub fn plugin(app: &mut App) {
    app.add_plugins(SystemInformationDiagnosticsPlugin);
}

/// A log file in addition to the console: `box_game.log` in the current folder, appended to.
pub fn log_layer(_: &mut App) -> Option<BoxedLayer> {
    let options = std::fs::File::options()
        .create(true)
        .append(true)
        .open("box_game.log");
    // The game also runs in a folder that cannot be written to.
    let layer = tracing_subscriber::fmt::layer().with_ansi(false);
    Some(layer.with_writer(Mutex::new(options.ok()?)).boxed())
}

/// The file's full path.
pub fn absolute(path: &Path) -> io::Result<PathBuf> {
    std::path::absolute(path)
}

/// Returns `true` if the file exists.
pub fn exists(path: &Path) -> bool {
    path.exists()
}

/// Removes a file, if it exists and can be removed.
pub fn remove(path: &Path) {
    let _ = std::fs::remove_file(path);
}

/// Creates a folder for files, if it is missing.
pub fn create_folder(path: &Path) -> io::Result<()> {
    std::fs::create_dir_all(path)
}

/// Creates a file, or empties an existing one.
pub fn create(path: &Path) -> io::Result<Stream> {
    std::fs::File::create(path)
}

/// Writes a temporary file and moves it to `path`, so that no incomplete file is ever visible.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    let mut builder = tempfile::Builder::new();
    // A temporary file is private by default.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
    let mut file = builder.tempfile_in(folder.unwrap_or(Path::new(".")))?;
    file.write_all(bytes)?;
    file.persist(path)?;
    Ok(())
}

/// The content of a file, up to `most` bytes.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path)?;
    file.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Last change and length of a file, if available.
pub fn stamp(path: &Path) -> Option<Stamp> {
    let data = std::fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}

/// The files of a folder, in any order; empty if the folder does not exist.
pub fn list(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    entries
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .collect()
}

/// The folder of the scene files: `assets/scenes` under `BEVY_ASSET_ROOT`, the current folder, or that of the program.
pub fn scene_folder() -> PathBuf {
    let root = std::env::var_os("BEVY_ASSET_ROOT").map(PathBuf::from);
    let program = std::env::current_exe().ok();
    let beside = program.and_then(|p| p.parent().map(Path::to_owned));
    [root, Some(PathBuf::new()), beside]
        .into_iter()
        .flatten()
        .map(|base| base.join("assets/scenes"))
        .find(|folder| folder.is_dir())
        .unwrap_or_else(|| PathBuf::from("assets/scenes"))
}

/// Background work in a thread.
pub struct Worker(JoinHandle<()>);

impl Worker {
    /// Starts a thread that calls `work` until it returns `false`.
    pub fn spawn(mut work: impl FnMut() -> bool + Send + 'static) -> io::Result<Self> {
        let run = move || while work() {};
        let thread = std::thread::Builder::new().name("sweep".to_owned());
        thread.spawn(run).map(Self)
    }

    /// Does nothing: the thread needs no frames.
    pub fn tick(&mut self) {}

    /// Returns `true` if the work is not finished.
    pub fn is_running(&self) -> bool {
        !self.0.is_finished()
    }

    /// Waits for the end of the work.
    pub fn join(self) {
        // A panic of the thread was printed there.
        let _ = self.0.join();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_for_a_shell() {
        let words = ["my scenes/a.ron", "--set", "gravity=1.62"].map(str::to_owned);
        let line = "box_game 'my scenes/a.ron' --set gravity=1.62";
        assert_eq!(reproduce(&words).expect("no errors"), line);
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }

    #[test]
    fn files_are_replaced_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.png");
        for text in ["longer than the next", "short"] {
            write(&path, text.as_bytes()).expect("writable");
            assert_eq!(read(&path, 1000).expect("readable"), text.as_bytes());
        }
        assert_eq!(read(&path, 2).expect("readable"), b"sh");
        assert_eq!(list(folder.path()), std::slice::from_ref(&path));
        remove(&path);
        assert!(!exists(&path) && stamp(&path).is_none());
        assert!(list(&path).is_empty());
    }
}
