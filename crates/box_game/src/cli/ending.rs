//! The end of the program, as the command line sets it.

use std::path::PathBuf;

use bevy::app::AppExit;
use bevy::prelude::*;
use box_physics::prelude::{BodyQuarantined, PhysicsClock};

use super::Cli;
use crate::compare::{Comparison, Run};
use crate::platform;
use crate::record::screenshot::ScreenshotRequest;

/// Conditions that end the program.
#[derive(Resource, Clone, Debug, Default)]
pub(super) struct Ending {
    /// After this much simulated time \[s\].
    pub duration: Option<f64>,
    /// After this many frames.
    pub frames: Option<u32>,
    /// A picture of the last frame.
    pub screenshot: Option<PathBuf>,
    /// Exit code 3 if a body was quarantined, or the main box or a comparison diverged.
    pub fail_on_divergence: bool,
}

impl Ending {
    /// The conditions of the command line.
    pub(super) fn of(cli: &Cli) -> Self {
        Self {
            duration: cli.duration,
            frames: cli.frames,
            screenshot: cli.screenshot.clone(),
            fail_on_divergence: cli.fail_on_divergence,
        }
    }
}

/// Ends the program on time, and after its picture is on disk.
pub(super) fn end(
    (ending, clock, comparison): (Res<Ending>, Res<PhysicsClock>, Option<Res<Comparison>>),
    mut quarantined: MessageReader<BodyQuarantined>,
    mut frames: Local<u32>,
    mut asked: Local<Option<u32>>,
    mut diverged: Local<bool>,
    mut commands: Commands,
    mut exit: MessageWriter<AppExit>,
) {
    *frames += 1;
    *diverged |= quarantined.read().next().is_some();
    let run = comparison.as_ref().and_then(|c| c.run.as_ref());
    *diverged |= run.is_some_and(Run::any_diverged);
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
            error!("the picture {} was not written", path.display());
            exit.write(AppExit::from_code(1));
        }
        Some(_) => {}
    }
}
