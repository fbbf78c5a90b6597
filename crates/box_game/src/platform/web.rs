//! The browser: query string, page, downloads, slices of the frames.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Mutex, MutexGuard, PoisonError};

use bevy::app::AppExit;
use bevy::diagnostic::DiagnosticsStore;
use bevy::log::BoxedLayer;
use bevy::prelude::*;
use wasm_bindgen::prelude::wasm_bindgen;

use super::{Need, Unavailable, query, with_extension};
use crate::action::{Action, Actions};
use crate::scene::session::Session;

/// Reason why the CPU usage is unknown, if it is.
pub const CPU_USAGE: Result<(), &str> = Err("CPU usage is not available in a browser");
/// Name of the result of [`reproduce`].
pub const COPIED: &str = "URL";
/// The screenshot key: none, because F12 opens the developer tools.
pub const SCREENSHOT_KEY: Option<KeyCode> = None;

/// The folder of the files that are shipped with the game or dropped on the page.
const SCENES: &str = "assets/scenes";

/// A version of a file.
pub type Stamp = u64;

#[wasm_bindgen(module = "/src/platform/web.js")]
extern "C" {
    fn search() -> String;
    fn address() -> String;
    fn show(text: &str, failed: bool);
    fn ended(text: &str);
    fn download(name: &str, bytes: &[u8]);
    fn file_name() -> Option<String>;
    fn file_text() -> String;
    fn copy_text(text: &str) -> bool;
    fn keep_keys();
    fn keep_open(more: bool);
    fn started();
}

/// The readable files, and the names of the written ones.
struct Files {
    texts: BTreeMap<PathBuf, (Stamp, String)>,
    written: Vec<PathBuf>,
}

static FILES: Mutex<Files> = Mutex::new(Files {
    texts: BTreeMap::new(),
    written: Vec::new(),
});

/// The files, including the shipped ones.
fn files() -> MutexGuard<'static, Files> {
    let mut files = FILES.lock().unwrap_or_else(PoisonError::into_inner);
    if files.texts.is_empty() {
        for (path, text) in super::SHIPPED {
            files.texts.insert(path.into(), (0, (*text).to_owned()));
        }
    }
    files
}

impl Files {
    /// Stores the files given to the page; returns their paths.
    fn take_given(&mut self) -> Vec<PathBuf> {
        let mut given = Vec::new();
        while let Some(name) = file_name() {
            let text = file_text();
            let path = PathBuf::from(name);
            let version = self.texts.get(&path).map_or(1, |(version, _)| version + 1);
            self.texts.insert(path.clone(), (version, text));
            given.push(path);
        }
        given
    }
}

/// The arguments, starting with the name of the program.
pub fn arguments() -> impl Iterator<Item = String> {
    // Files named in the URL are already fetched.
    files().take_given();
    ["box_game".to_owned()]
        .into_iter()
        .chain(query::words(&search()))
}

/// Ends the program after invalid arguments or a request for help.
pub fn refuse(error: &clap::Error) -> ExitCode {
    show(&error.to_string(), error.use_stderr());
    ExitCode::from(if error.use_stderr() { 2 } else { 0 })
}

/// Shows a text.
pub fn say(text: &str) -> ExitCode {
    show(text, false);
    ExitCode::SUCCESS
}

/// Shows an error.
pub fn complain(text: &str) {
    show(text, true);
}

/// The URL of the page with the words of a command line.
///
/// # Errors
/// A scene file that was dropped on the page has no URL.
pub fn reproduce(words: &[String]) -> Result<String, &'static str> {
    let shipped = |word: &String| stamp(Path::new(word)) == Some(0);
    let dropped = |word: &&String| word.starts_with(SCENES) && !shipped(word);
    match words.first().filter(dropped) {
        Some(_) => Err(
            "This scene file is on this page only: put it on a web server, and open it by ?scene=URL.",
        ),
        None => Ok(format!("{}?{}", address(), query::of(words))),
    }
}

/// Copies a text to the clipboard. Where the browser refuses, the page shows the text. Returns `false` without a clipboard.
pub fn copy(_: &mut World, text: &str) -> bool {
    copy_text(text)
}

/// The canvas of the page, fitted to its parent element.
pub fn window(window: Window) -> Window {
    Window {
        canvas: Some("#game".to_owned()),
        fit_canvas_to_parent: true,
        // `keep_keys` is more selective: reload, zoom and close are left to the browser.
        prevent_default_event_handling: false,
        ..window
    }
}

/// Returns `None`: the CPU usage is not available to a page.
pub fn cpu_usage(_: &DiagnosticsStore) -> Option<(f64, f64)> {
    None
}

/// Adds systems that open files dropped on the page, and report the start and the end of the game.
pub fn plugin(app: &mut App) {
    keep_keys();
    app.add_systems(PreUpdate, open_files)
        .add_systems(Update, say_started)
        .add_systems(Last, say_ended);
}

fn open_files(mut actions: ResMut<Actions>, mut session: ResMut<Session>) {
    let given = files().take_given();
    for path in given {
        let path = path.display().to_string();
        if with_extension(&path, "ron").is_some() {
            actions.0.push(Action::SelectScene(path));
        } else {
            session.notice(format!("{path}: not a scene file (.ron)"));
        }
    }
}

/// Reports the start in the second frame, because the first one loads the shaders.
fn say_started(mut frames: Local<u32>) {
    *frames = frames.saturating_add(1);
    if *frames == 2 {
        started();
    }
}

fn say_ended(mut exit: MessageReader<AppExit>) {
    match exit.read().last() {
        Some(AppExit::Success) => ended("The game has ended."),
        Some(AppExit::Error(code)) => ended(&format!("The game has ended with code {code}.")),
        None => {}
    }
}

/// Checks the requirements of a run, except WebGL 2, which the page has checked.
///
/// # Errors
/// Offscreen rendering is not available in a browser.
pub fn check(need: Need) -> Result<(), Unavailable> {
    match need {
        Need::Window => Ok(()),
        Need::Gpu => Err(Unavailable {
            reason: "Offscreen rendering is not available in a browser.".to_owned(),
            advice: "Remove offscreen from the URL.",
        }),
    }
}

/// Returns `Ok`: a browser needs no probe.
pub fn probe(_: Need) -> Result<(), String> {
    Ok(())
}

/// Returns `None`: the log goes to the browser's console.
pub fn log_layer(_: &mut App) -> Option<BoxedLayer> {
    None
}

/// The same path.
pub fn absolute(path: &Path) -> io::Result<PathBuf> {
    Ok(path.to_owned())
}

/// Returns `true` if this file was written.
pub fn exists(path: &Path) -> bool {
    files().written.iter().any(|written| written == path)
}

/// Removes a file from the list of written files.
pub fn remove(path: &Path) {
    files().written.retain(|written| written != path);
}

/// Does nothing.
pub fn create_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

/// A file that is written incrementally, and downloaded when it is closed.
#[derive(Debug)]
pub struct Stream {
    path: PathBuf,
    bytes: Vec<u8>,
}

impl Write for Stream {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.bytes.extend_from_slice(buffer);
        Ok(buffer.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        // Nothing can fail: the browser performs the download.
        let _ = write(&self.path, &self.bytes);
        keep_open(false);
    }
}

/// A log file: kept in memory until it is closed, then downloaded.
pub struct SyncedFile(Stream);

impl SyncedFile {
    /// Creates a log in this file.
    pub fn new(file: Stream) -> io::Result<Self> {
        Ok(Self(file))
    }

    /// Appends `bytes`.
    pub fn write(&mut self, bytes: Vec<u8>) -> io::Result<()> {
        self.0.write_all(&bytes)
    }

    /// Does nothing.
    pub fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Creates a file, which is downloaded when it is closed.
pub fn create(path: &Path) -> io::Result<Stream> {
    files().written.push(path.to_owned());
    keep_open(true);
    Ok(Stream {
        path: path.to_owned(),
        bytes: Vec::new(),
    })
}

/// Downloads a file, under its name without folders.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let name = path.file_name().unwrap_or(path.as_os_str());
    download(&name.to_string_lossy(), bytes);
    let mut files = files();
    files.written.retain(|written| written != path);
    files.written.push(path.to_owned());
    Ok(())
}

/// The content of a file, up to `most` bytes.
///
/// # Errors
/// [`io::ErrorKind::NotFound`] if the page has no such file.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let files = files();
    let Some((_, text)) = files.texts.get(path) else {
        let text = "no such file; drop it on the page, or give its URL";
        return Err(io::Error::new(io::ErrorKind::NotFound, text));
    };
    let length = text.len().min(usize::try_from(most).unwrap_or(usize::MAX));
    Ok(text.as_bytes()[..length].to_owned())
}

/// The version of a file.
pub fn stamp(path: &Path) -> Option<Stamp> {
    files().texts.get(path).map(|(version, _)| *version)
}

/// The files of a folder.
pub fn list(folder: &Path) -> Vec<PathBuf> {
    let files = files();
    let inside = |path: &&PathBuf| path.parent() == Some(folder);
    files.texts.keys().filter(inside).cloned().collect()
}

/// The folder of the scene files.
pub fn scene_folder() -> PathBuf {
    SCENES.into()
}

/// Background work: one slice per frame.
pub struct Worker {
    /// In a mutex only because a resource must be `Sync`.
    work: Mutex<Box<dyn FnMut() -> bool + Send>>,
    running: bool,
}

impl Worker {
    /// Calls `work` once in each frame until it returns `false`.
    pub fn spawn(work: impl FnMut() -> bool + Send + 'static) -> io::Result<Self> {
        Ok(Self {
            work: Mutex::new(Box::new(work)),
            running: true,
        })
    }

    /// Runs the slice of this frame.
    pub fn tick(&mut self) {
        let work = self.work.get_mut().unwrap_or_else(PoisonError::into_inner);
        self.running = self.running && work();
    }

    /// Returns `true` if the work is not finished.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Abandons the work.
    pub fn join(self) {}
}
