//! The game without a window, which tests drive: physics, scene, keys, actions, log, timing, ending.

use std::path::PathBuf;

use bevy::app::AppExit;
use bevy::prelude::*;
use box_physics::prelude::{
    BodyQuarantined, BodyState, PhysicsClock, PhysicsPlugins, PhysicsSchedule, PhysicsSystems,
    RigidBox,
};
use box_scenarios::Scenario;

use crate::action::{Action, Plot};
use crate::apply::{Accepted, Asked, accept, apply_actions, set_speed, set_step};
use crate::cli::Cli;
use crate::compare::plugin::after_step;
use crate::compare::sampling::{IntegratorSamples, sample_integrators};
use crate::compare::{CompareAction, ComparePlugin, Comparison};
use crate::demo_2012::{Demo2012, run_cycle};
use crate::input::keys::{UiFocus, read_keys};
use crate::input::script::{self, PendingPictures, Script};
use crate::interaction::InteractionPlugin;
use crate::record::csv_log::CsvLog;
use crate::record::history::{History, count_dropped, record};
use crate::record::rows;
use crate::record::screenshot::ScreenshotRequest;
use crate::scene::library::{self, SceneLibrary, watch_scenes};
use crate::scene::opening::plot_of;
use crate::scene::session::{LONGEST_FRAME, SceneEntity, Session, choose, start_scene};
use crate::ui::preferences::{Preferences, follow, restore};

/// When to end by itself.
#[derive(Resource, Clone, Debug, Default)]
pub struct Ending {
    /// After this much simulated time \[s\].
    pub duration: Option<f64>,
    /// After this many frames.
    pub frames: Option<u32>,
    /// With a picture of the last frame.
    pub screenshot: Option<PathBuf>,
    /// With exit code 3 if a body was quarantined.
    pub fail_on_divergence: bool,
}

/// The whole game but window, picture and panel: physics, scene, keys, actions, log, sampling.
/// Needs time and input; runs in a test under `MinimalPlugins` and `InputPlugin`.
pub struct GamePlugin {
    /// The command line.
    pub cli: Cli,
}

impl Plugin for GamePlugin {
    fn build(&self, app: &mut App) {
        let cli = &self.cli;
        let id = cli.scene.as_deref().unwrap_or(Scenario::ALL[0]().id);
        let library = SceneLibrary::shipped(library::file_path(id));
        // The command line has checked it.
        let scenario = library.find(id).unwrap_or_default();
        let mut session = Session::new(scenario, cli.seed);
        session.plot = plot_of(session.scenario.view.plot);
        if let Some(boxes) = cli.boxes {
            session.parameters.boxes = boxes;
        }
        for wish in &cli.set {
            if accept(&mut session.parameters, wish) == Accepted::No {
                session.notice(format!("not possible: {wish:?}"));
            }
        }
        app.init_resource::<Preferences>();
        let mut kept = app.world_mut().resource_mut::<Preferences>();
        restore(&mut session, &mut kept);
        if let Some(scale) = cli.ui_scale {
            kept.ui_scale = scale;
        }
        app.add_plugins((PhysicsPlugins::default(), InteractionPlugin))
            .insert_resource(session)
            .insert_resource(library)
            .init_resource::<Demo2012>()
            .init_resource::<PendingPictures>()
            .init_resource::<Asked>()
            .init_resource::<UiFocus>()
            .init_resource::<History>()
            .init_resource::<IntegratorSamples>()
            .insert_resource(Ending {
                duration: cli.duration,
                frames: cli.frames,
                screenshot: cli.screenshot.clone(),
                fail_on_divergence: cli.fail_on_divergence,
            });
        if let Some(&integrator) = cli.integrator.first() {
            choose(app.world_mut(), integrator);
        }
        let mut comparison = Comparison::default();
        if let [_, beside @ ..] = cli.integrator.as_slice() {
            let scene = app.world().resource::<Session>().scenario.id;
            comparison = Comparison::with_lanes(scene, beside);
        }
        comparison.settings.layout = cli.layout;
        app.insert_resource(comparison).add_plugins(ComparePlugin);
        if let Some(plot) = cli.plot {
            app.world_mut().resource_mut::<Session>().plot = plot;
        }
        if cli.plot == Some(Plot::WorkPrecision) {
            app.add_systems(Update, sweep_once);
        }
        set_step(app.world_mut(), cli.dt);
        app.world_mut().resource_mut::<PhysicsClock>().substeps = cli.substeps;
        app.world_mut()
            .resource_mut::<Time<Virtual>>()
            .set_max_delta(core::time::Duration::from_secs_f64(LONGEST_FRAME));
        set_speed(app.world_mut(), cli.speed);
        start_scene(app.world_mut());
        app.add_systems(
            PreUpdate,
            (script::play, read_keys, apply_actions)
                .chain()
                .after(bevy::input::InputSystems),
        )
        .add_systems(
            PhysicsSchedule,
            (
                timed_impulses.in_set(PhysicsSystems::First),
                run_cycle
                    .after(PhysicsSystems::Writeback)
                    .before(PhysicsSystems::Last),
                rows::write_rows
                    .in_set(PhysicsSystems::Last)
                    .after(after_step),
            ),
        )
        .add_systems(
            Update,
            (
                watch_scenes,
                follow,
                count_dropped,
                record,
                sample_integrators,
                end,
            )
                .chain(),
        );
        #[cfg(feature = "gamepad")]
        app.add_systems(
            PreUpdate,
            crate::input::gamepad::read_buttons
                .after(read_keys)
                .before(apply_actions),
        );
    }
}

/// Asks for a sweep as soon as there is something to compare.
fn sweep_once(comparison: Res<Comparison>, mut asked: ResMut<Asked>, mut done: Local<bool>) {
    if !*done && comparison.run.is_some() {
        asked.0.push(Action::Compare(CompareAction::StartSweep));
        *done = true;
    }
}

/// The scene's own impulses, on every box, at the first step boundary at or after their time.
fn timed_impulses(
    mut session: ResMut<Session>,
    clock: Res<PhysicsClock>,
    mut boxes: Query<(&RigidBox, &mut BodyState), With<SceneEntity>>,
) {
    let start = clock.time() - clock.step();
    let impulses = &session.scenario.setup.impulses;
    let mut next = session.next_impulse;
    while let Some(i) = impulses
        .get(next)
        .filter(|i| i.t <= start + 1e-9 * clock.step())
    {
        for (body, mut state) in &mut boxes {
            state.apply_impulse_at_body_point(body, i.impulse, i.body_point);
        }
        next += 1;
    }
    if next != session.next_impulse {
        session.next_impulse = next;
    }
}

/// Opens the log and the script that the command line asks for.
///
/// # Errors
/// What the file system says, or what is wrong with the script.
pub fn open_log(app: &mut App, cli: &Cli) -> std::io::Result<()> {
    if let Some(path) = &cli.log {
        let session = app.world().resource::<Session>();
        let log = CsvLog::create(path, session.scenario.id, session.seed)?;
        app.insert_resource(log);
    }
    if let Some(path) = &cli.script {
        let beats = script::load(path).map_err(std::io::Error::other)?;
        app.insert_resource(Script::new(beats));
    }
    Ok(())
}

/// Ends the program when it is time; with a picture, once that is on disk.
fn end(
    ending: Res<Ending>,
    clock: Res<PhysicsClock>,
    mut quarantined: MessageReader<BodyQuarantined>,
    mut frames: Local<u32>,
    mut asked: Local<Option<u32>>,
    mut diverged: Local<bool>,
    mut commands: Commands,
    mut exit: MessageWriter<AppExit>,
) {
    *frames += 1;
    *diverged |= quarantined.read().next().is_some();
    let code = if *diverged && ending.fail_on_divergence {
        AppExit::from_code(3)
    } else {
        AppExit::Success
    };
    let timed_out = ending
        .duration
        .is_some_and(|d| clock.elapsed().as_secs_f64() >= d - 1e-9);
    let frame_limit = match (&ending.screenshot, ending.frames, ending.duration) {
        (_, Some(n), _) => Some(n),
        (Some(_), None, None) => Some(60),
        _ => None,
    };
    let done = timed_out || frame_limit.is_some_and(|n| *frames >= n);
    if !done {
        return;
    }
    let Some(path) = &ending.screenshot else {
        exit.write(code);
        return;
    };
    match *asked {
        None => {
            // A picture left from an earlier run must not pass for this one's.
            let _ = std::fs::remove_file(path);
            commands.insert_resource(ScreenshotRequest::of(Some(path.clone())));
            *asked = Some(*frames);
        }
        Some(_) if path.exists() => {
            exit.write(code);
        }
        Some(since) if *frames > since + 600 => {
            error!("the picture {} was not written", path.display());
            exit.write(AppExit::from_code(1));
        }
        Some(_) => {}
    }
}
