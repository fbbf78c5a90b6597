//! The start of the game, as the command line sets it.

use std::io;

use bevy::prelude::*;
use box_physics::prelude::GlobalIntegrator;
use box_scenarios::Scenario;

use super::ending::end;
use super::{Cli, command_line};
use crate::action::Plot;
use crate::compare::Comparison;
use crate::input::script::{self, Script};
use crate::preferences::Preferences;
use crate::record::csv_log::CsvLog;
use crate::scene::clock::{set_speed, set_step};
use crate::scene::library::{self, SceneLibrary};
use crate::scene::session::Session;
use crate::scene::start::start_scene;

/// Starts the scene of the command line, and ends the program as it says. Add it last.
pub struct CommandLinePlugin {
    /// The command line.
    pub cli: Cli,
}

impl Plugin for CommandLinePlugin {
    fn build(&self, app: &mut App) {
        let cli = &self.cli;
        let id = cli.scene.as_deref().unwrap_or(Scenario::ALL[0]().id);
        let library = SceneLibrary::shipped(library::file_path(id));
        // The command line has checked it.
        let scenario = library.find(id).unwrap_or_default();
        let mut session = Session::new(scenario, cli.seed);
        session.plot = cli.plot.unwrap_or(session.scenario.view.plot);
        for (parameter, value) in cli.parameters() {
            if let Err(error) = session.parameters.set(parameter, value) {
                session.notice(error);
            }
        }
        if let Some(scale) = cli.ui_scale {
            app.world_mut().resource_mut::<Preferences>().ui_scale = scale;
        }
        let mut comparison = match cli.integrator.as_slice() {
            [_, others @ ..] => Comparison::with_comparisons(session.scenario.id, others),
            [] => Comparison::default(),
        };
        comparison.settings.layout = cli.layout;
        if let Some(&integrator) = cli.integrator.first() {
            app.insert_resource(GlobalIntegrator(integrator));
        }
        if cli.plot == Some(Plot::WorkPrecision) {
            comparison.request_sweep();
        }
        app.insert_resource(session)
            .insert_resource(library)
            .insert_resource(comparison)
            .insert_resource(cli.clone())
            .add_observer(command_line::on_action)
            .add_systems(Update, end);
        set_step(app.world_mut());
        set_speed(app.world_mut(), cli.speed);
        start_scene(app.world_mut());
    }
}

/// Opens the log and the script of the command line.
///
/// # Errors
/// An error of the file system, or in the script.
pub fn open_files(app: &mut App, cli: &Cli) -> io::Result<()> {
    if let Some(path) = &cli.log {
        let session = app.world().resource::<Session>();
        let log = CsvLog::create(path, session.scenario.id, session.seed)?;
        app.insert_resource(log);
    }
    if let Some(path) = &cli.script {
        let beats = script::load(path).map_err(io::Error::other)?;
        app.insert_resource(Script::new(beats));
    }
    Ok(())
}
