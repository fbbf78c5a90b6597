//! The game without a window, as the tests play it.

#![allow(dead_code, reason = "each test uses a part")]

use std::collections::HashMap;
use std::path::Path;

use bevy::input::InputPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_game::action::{Action, Actions};
use box_game::app::GamePlugin;
use box_game::cli::Cli;
use box_game::cli::start::open_files;
use box_game::record::csv_log::CsvLog;
use box_game::scene::session::MainBox;
use box_physics::prelude::*;
use clap::Parser;

/// The command line.
pub(crate) fn cli(arguments: &[&str]) -> Cli {
    Cli::try_parse_from([&["box_game"], arguments].concat()).expect("valid")
}

/// The game with this command line; every update is one tick.
pub(crate) fn game(arguments: &[&str]) -> App {
    let cli = cli(arguments);
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, InputPlugin, GamePlugin { cli: cli.clone() }))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    // The fixed clock does not run on the first update.
    app.update();
    open_files(&mut app, &cli).expect("files can be opened");
    app
}

/// Requests an action and updates.
pub(crate) fn ask(app: &mut App, action: Action) {
    app.world_mut().resource_mut::<Actions>().0.push(action);
    app.update();
}

/// The main box.
pub(crate) fn main_box(app: &mut App) -> BodyState {
    *app.world_mut()
        .query_filtered::<&BodyState, With<MainBox>>()
        .single(app.world())
        .expect("one main box")
}

/// The rows of the open log, each by the names of its columns.
pub(crate) fn log_rows(app: &mut App, path: &Path) -> Vec<HashMap<String, String>> {
    let mut log = app.world_mut().resource_mut::<CsvLog>();
    log.sync().expect("on disk");
    let reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(path);
    let rows = reader.expect("readable").into_deserialize();
    rows.map(|row| row.expect("a row")).collect()
}
