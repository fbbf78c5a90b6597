//! The start and the end of the game, as the command line sets them.

use std::io;

use bevy::prelude::*;
use box_physics::prelude::{BodyQuarantined, GlobalIntegrator, PhysicsClock};
use box_scenarios::Scenario;

use super::{Cli, DIVERGED, command_line};
use crate::action::Plot;
use crate::compare::{Comparison, Run};
use crate::input::script::{self, Script};
use crate::platform;
use crate::preferences::Preferences;
use crate::record::csv_log::CsvLog;
use crate::record::screenshot::ScreenshotRequest;
use crate::scene::clock::{set_speed, set_step};
use crate::scene::library::{self, SceneLibrary};
use crate::scene::session::Session;
use crate::scene::start::start_scene;

/// Starts the scene of the command line, and ends the program as it says. Call it last.
pub fn start(app: &mut App, cli: &Cli) {
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
    comparison.sweep_requested = cli.plot == Some(Plot::WorkPrecision);
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

/// Ends the program on time, and after its picture is on disk.
fn end(
    (cli, clock, comparison): (Res<Cli>, Res<PhysicsClock>, Res<Comparison>),
    mut quarantined: MessageReader<BodyQuarantined>,
    mut frames: Local<u32>,
    mut asked: Local<Option<u32>>,
    mut diverged: Local<bool>,
    mut commands: Commands,
    mut exit: MessageWriter<AppExit>,
) {
    *frames += 1;
    *diverged |= quarantined.read().next().is_some();
    *diverged |= comparison.run.as_ref().is_some_and(Run::any_diverged);
    let code = if *diverged && cli.fail_on_divergence {
        AppExit::from_code(DIVERGED)
    } else {
        AppExit::Success
    };
    let time = clock.elapsed().as_secs_f64();
    let timed_out = cli.duration.is_some_and(|d| time >= d - 1e-9);
    let picture_alone = cli.screenshot.is_some() && cli.duration.is_none();
    let frame_limit = cli.frames.or(picture_alone.then_some(60));
    if !(timed_out || frame_limit.is_some_and(|n| *frames >= n)) {
        return;
    }
    let Some(path) = &cli.screenshot else {
        exit.write(code);
        return;
    };
    match *asked {
        None => {
            // A picture left from an earlier run must not pass for this one's.
            platform::remove(path);
            commands.insert_resource(ScreenshotRequest {
                path: Some(path.clone()),
                plot: false,
            });
            *asked = Some(*frames);
        }
        Some(_) if platform::exists(path) => {
            exit.write(code);
        }
        Some(since) if *frames > since + 600 => {
            error!("screenshot {} was not written", path.display());
            exit.write(AppExit::from_code(1));
        }
        Some(_) => {}
    }
}
