//! Start and end of the game, as set by the command line.

use std::io;

use bevy::prelude::*;
use box_physics::prelude::{BodyQuarantined, GlobalIntegrator, PhysicsClock};
use box_scenarios::Scenario;

use super::{Cli, DIVERGED, command_line};
use crate::action::{Action, Plot};
use crate::compare::{Comparison, Run};
use crate::input::script::{self, Script};
use crate::platform;
use crate::preferences::Preferences;
use crate::record::csv_log::CsvLog;
use crate::record::screenshot::{Pictures, ScreenshotRequest};
use crate::scene::clock::{set_speed, set_step};
use crate::scene::library::{self, SceneLibrary};
use crate::scene::session::Session;
use crate::scene::start::start_scene;

/// Maximum number of frames to wait for a screenshot.
const MAX_WAIT: u32 = 600;

/// The end of the program.
#[derive(Resource, Default)]
struct Ending {
    asked: bool,
    /// Number of frames spent waiting for screenshots.
    waited: u32,
}

/// Starts the scene of the command line, and ends the program as specified there. Call it last.
pub fn start(app: &mut App, cli: &Cli) {
    let id = cli.scene.as_deref().unwrap_or(Scenario::ALL[0]().id);
    let library = SceneLibrary::shipped(library::file_path(id));
    // The command line has validated the id.
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
        .init_resource::<Ending>()
        .add_observer(command_line::on_action)
        .add_observer(quit)
        .add_systems(PostUpdate, end);
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

fn quit(action: On<Action>, mut ending: ResMut<Ending>) {
    ending.asked |= *action == Action::Quit;
}

/// Ends the program on time or on request, once its screenshots are on disk.
fn end(
    (cli, clock, comparison): (Res<Cli>, Res<PhysicsClock>, Res<Comparison>),
    (pictures, request): (Res<Pictures>, Option<Res<ScreenshotRequest>>),
    mut quarantined: MessageReader<BodyQuarantined>,
    (mut frames, mut diverged): (Local<u32>, Local<bool>),
    mut ending: ResMut<Ending>,
    mut commands: Commands,
    mut exit: MessageWriter<AppExit>,
) {
    *frames += 1;
    *diverged |= quarantined.read().next().is_some();
    *diverged |= comparison.run.as_ref().is_some_and(Run::any_diverged);
    let time = clock.elapsed().as_secs_f64();
    let timed_out = cli.duration.is_some_and(|d| time >= d - 1e-9);
    let picture_alone = cli.screenshot.is_some() && cli.duration.is_none();
    let limit = cli.frames.or(picture_alone.then_some(60));
    if !ending.asked && (timed_out || limit.is_some_and(|n| *frames >= n)) {
        ending.asked = true;
        if let Some(path) = cli.screenshot.clone() {
            // A screenshot of an earlier run must not be mistaken for this one.
            platform::remove(&path);
            commands.insert_resource(ScreenshotRequest {
                path: Some(path),
                plot: false,
            });
            return;
        }
    }
    let waiting = request.is_some() || pictures.pending > 0;
    if !ending.asked || (waiting && ending.waited < MAX_WAIT) {
        ending.waited += u32::from(ending.asked);
        return;
    }
    // Unnamed screenshots (F12) do not count.
    let request = request.and_then(|request| request.path.clone());
    let missing = pictures.missing.iter().chain(&request);
    let missing: Vec<String> = missing.map(|path| path.display().to_string()).collect();
    exit.write(if !missing.is_empty() {
        error!("screenshots not written: {}", missing.join(", "));
        AppExit::from_code(1)
    } else if *diverged && cli.fail_on_divergence {
        AppExit::from_code(DIVERGED)
    } else {
        AppExit::Success
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::action::Actions;
    use clap::Parser;
    use std::ffi::OsStr;

    /// A missing screenshot that the user took is not an error.
    #[test]
    fn a_named_picture_that_never_arrives_ends_the_program_with_an_error() {
        for (missing, code) in [
            (vec!["a.png".into()], AppExit::from_code(1)),
            (vec![], AppExit::Success),
        ] {
            let cli = Cli::try_parse_from(["box_game"]).expect("valid");
            let mut app = crate::app::headless(cli);
            let world = app.world_mut();
            *world.resource_mut::<Pictures>() = Pictures {
                pending: 1,
                missing,
            };
            world.resource_mut::<Ending>().waited = MAX_WAIT - 1;
            world.resource_mut::<Actions>().0.push(Action::Quit);
            app.update();
            assert_eq!(app.should_exit(), None);
            app.update();
            assert_eq!(app.should_exit(), Some(code));
        }
    }

    /// A screenshot of an earlier run is removed as well.
    #[test]
    fn a_screenshot_that_was_not_taken_leaves_no_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.png");
        std::fs::write(&path, "old").expect("writable");
        let line = ["box_game", "--frames", "1", "--screenshot"].map(OsStr::new);
        let line = line.into_iter().chain([path.as_os_str()]);
        let cli = Cli::try_parse_from(line).expect("valid");
        let mut app = crate::app::headless(cli);
        app.world_mut().resource_mut::<Ending>().waited = MAX_WAIT;
        app.update();
        assert!(!path.exists());
        app.update();
        assert_eq!(app.should_exit(), Some(AppExit::from_code(1)));
    }
}
