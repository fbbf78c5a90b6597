//! The game without a window, as the tests play it.

#![allow(dead_code, reason = "each test uses a part")]

use std::collections::HashMap;
use std::path::PathBuf;

use bevy::input::ButtonState;
use bevy::input::keyboard::{Key, KeyboardInput, NativeKey};
use bevy::prelude::*;
use box_game::action::{Action, Actions, Push};
use box_game::app;
use box_game::cli::Cli;
use box_game::cli::start::open_files;
use box_game::record::csv_log::CsvLog;
use box_game::scene::session::{MainBox, Session};
use box_physics::prelude::*;
use clap::Parser;

/// The command line of these words.
pub(crate) fn cli(line: &str) -> Cli {
    parsed(line.split_whitespace().map(str::to_owned).collect())
}

fn parsed(mut words: Vec<String>) -> Cli {
    words.insert(0, "box_game".to_owned());
    Cli::try_parse_from(words).expect("valid")
}

/// The game with this command line; every update is one tick.
pub(crate) fn game(line: &str) -> App {
    started(cli(line))
}

fn started(cli: Cli) -> App {
    let mut app = app::headless(cli.clone());
    // The fixed clock does not run on the first update.
    app.update();
    open_files(&mut app, &cli).expect("files can be opened");
    app
}

/// A CSV log in a temporary folder.
pub(crate) struct Log {
    path: PathBuf,
    _folder: tempfile::TempDir,
}

/// The game with this command line and a CSV log.
pub(crate) fn logged_game(line: &str) -> (App, Log) {
    let _folder = tempfile::tempdir().expect("a folder");
    let path = _folder.path().join("log.csv");
    let mut cli = cli(line);
    cli.log = Some(path.clone());
    (started(cli), Log { path, _folder })
}

impl Log {
    /// The rows so far, each by the names of its columns.
    pub(crate) fn rows(&self, app: &mut App) -> Vec<HashMap<String, String>> {
        let mut log = app.world_mut().resource_mut::<CsvLog>();
        log.sync().expect("on disk");
        let reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .from_path(&self.path);
        let rows = reader.expect("readable").into_deserialize();
        rows.map(|row| row.expect("a row")).collect()
    }
}

/// The game with a file of this name and content as the last word of its command line.
pub(crate) fn game_with_file(line: &str, name: &str, text: &str) -> (App, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("writable");
    let mut words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
    words.push(path.to_str().expect("utf-8").to_owned());
    (started(parsed(words)), folder)
}

/// Updates `updates` times.
pub(crate) fn play(app: &mut App, updates: usize) {
    (0..updates).for_each(|_| app.update());
}

/// Updates until the game ends, at most `updates` times.
pub(crate) fn play_to_the_end(app: &mut App, updates: usize) -> Option<AppExit> {
    let mut updates = 0..updates;
    while app.should_exit().is_none() && updates.next().is_some() {
        app.update();
    }
    app.should_exit()
}

/// Requests an action and updates.
pub(crate) fn ask(app: &mut App, action: Action) {
    request(app, action);
    app.update();
}

/// Requests an action for the next update.
pub(crate) fn request(app: &mut App, action: Action) {
    app.world_mut().resource_mut::<Actions>().0.push(action);
}

/// A push along an axis of the world.
pub(crate) fn push(direction: DVec3, off_center: bool) -> Action {
    Action::Push(Push {
        direction,
        world: true,
        off_center,
    })
}

/// Presses or releases a key that types `typed`.
pub(crate) fn key(app: &mut App, key_code: KeyCode, typed: &str, state: ButtonState) {
    app.world_mut().write_message(KeyboardInput {
        key_code,
        logical_key: match typed {
            "" => Key::Unidentified(NativeKey::Unidentified),
            _ => Key::Character(typed.into()),
        },
        state,
        text: None,
        repeat: false,
        window: Entity::PLACEHOLDER,
    });
}

pub(crate) const CONTROL: (KeyCode, &str) = (KeyCode::ControlLeft, "");
pub(crate) const SHIFT: (KeyCode, &str) = (KeyCode::ShiftLeft, "");

/// Presses these keys together and releases them, each with an update.
pub(crate) fn press(app: &mut App, keys: &[(KeyCode, &str)]) {
    for state in [ButtonState::Pressed, ButtonState::Released] {
        for &(code, typed) in keys {
            key(app, code, typed, state);
        }
        app.update();
    }
}

/// The session.
pub(crate) fn session(app: &App) -> &Session {
    app.world().resource::<Session>()
}

/// The last notice.
pub(crate) fn notice(app: &App) -> String {
    session(app).notices.back().cloned().unwrap_or_default()
}

/// The clock.
pub(crate) fn clock(app: &App) -> PhysicsClock {
    *app.world().resource::<PhysicsClock>()
}

/// The integrator of the main box.
pub(crate) fn integrator(app: &App) -> Integrator {
    app.world().resource::<GlobalIntegrator>().0
}

/// A component of the main box.
pub(crate) fn of_main_box<C: Component + Clone>(app: &mut App) -> C {
    let mut main_box = app.world_mut().query_filtered::<&C, With<MainBox>>();
    main_box.single(app.world()).expect("one main box").clone()
}

/// The state of the main box.
pub(crate) fn main_box(app: &mut App) -> BodyState {
    of_main_box(app)
}
