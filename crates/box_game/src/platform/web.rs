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
/// Name of what [`reproduce`] makes.
pub const COPIED: &str = "address";
/// The key that takes a picture: none, because F12 opens the developer tools.
pub const SCREENSHOT_KEY: Option<KeyCode> = None;

/// The folder of the files that come with the game or are dropped on the page.
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
    fn keep_keys();
    fn started();
}

/// The files that can be read, and the names of those that were written.
struct Files {
    texts: BTreeMap<PathBuf, (Stamp, String)>,
    written: Vec<PathBuf>,
}

static FILES: Mutex<Files> = Mutex::new(Files {
    texts: BTreeMap::new(),
    written: Vec::new(),
});

/// The files, with the shipped ones.
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
    /// Keeps what the page has been given; returns the paths.
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

/// The arguments, first of them the name of the program.
pub fn arguments() -> impl Iterator<Item = String> {
    // What the address names has been fetched.
    files().take_given();
    ["box_game".to_owned()]
        .into_iter()
        .chain(query::words(&search()))
}

/// The end of a program whose arguments are wrong, or that was only asked for help.
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

/// The address of the page with the words of a command line.
pub fn reproduce(words: &[String]) -> String {
    format!("{}?{}", address(), query::of(words))
}

/// The canvas of the page, as large as the page leaves it.
pub fn window(window: Window) -> Window {
    Window {
        canvas: Some("#game".to_owned()),
        fit_canvas_to_parent: true,
        // `keep_keys` is choosier: reloading, zooming and closing stay the browser's.
        prevent_default_event_handling: false,
        ..window
    }
}

/// Nothing: a page learns nothing about the processor.
pub fn cpu_usage(_: &DiagnosticsStore) -> Option<(f64, f64)> {
    None
}

/// Opens the files that are dropped on the page, and says when the game has ended.
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

/// The second frame: by the first the shaders are loaded.
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

/// Whether a run is possible: the page has looked for WebGL 2.
///
/// # Errors
/// Without a canvas there are no pictures.
pub fn check(need: Need) -> Result<(), Unavailable> {
    match need {
        Need::Window => Ok(()),
        Need::Gpu => Err(Unavailable {
            reason: "Offscreen rendering is not available in a browser.".to_owned(),
            advice: "Remove offscreen from the URL.",
        }),
    }
}

/// Nothing to find out.
pub fn probe(_: Need) -> Result<(), String> {
    Ok(())
}

/// None: the browser keeps a log in its console.
pub fn log_layer(_: &mut App) -> Option<BoxedLayer> {
    None
}

/// The same path.
pub fn absolute(path: &Path) -> io::Result<PathBuf> {
    Ok(path.to_owned())
}

/// Whether this file was written.
pub fn exists(path: &Path) -> bool {
    files().written.iter().any(|written| written == path)
}

/// Forgets that a file was written.
pub fn remove(path: &Path) {
    files().written.retain(|written| written != path);
}

/// Nothing to do.
pub fn create_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

/// A file that is written bit by bit: downloaded when it is closed.
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
        // Nothing can fail: a download is handed to the browser.
        let _ = write(&self.path, &self.bytes);
    }
}

/// A file of a log: kept until it is closed, then downloaded. There is no disk to sync.
pub struct SyncedFile(Stream);

impl SyncedFile {
    /// Of a file that was created.
    pub fn new(file: Stream) -> io::Result<Self> {
        Ok(Self(file))
    }

    /// Keeps `bytes`.
    pub fn write(&mut self, bytes: Vec<u8>) -> io::Result<()> {
        self.0.write_all(&bytes)
    }

    /// Does nothing.
    pub fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Begins a download.
pub fn create(path: &Path) -> io::Result<Stream> {
    files().written.push(path.to_owned());
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

/// The content of a file, up to `most` bytes of it.
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

/// Work beside the frames: a slice of it in each.
pub struct Worker {
    /// In a lock only because a resource must be one that threads could share.
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

    /// A frame has passed.
    pub fn tick(&mut self) {
        let work = self.work.get_mut().unwrap_or_else(PoisonError::into_inner);
        self.running = self.running && work();
    }

    /// Whether it is still at work.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Gives it up.
    pub fn join(self) {}
}
