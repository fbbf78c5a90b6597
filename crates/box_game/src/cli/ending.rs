//! The end of the program, as the command line sets it.

use bevy::app::AppExit;
use bevy::prelude::*;
use box_physics::prelude::{BodyQuarantined, PhysicsClock};

use super::{Cli, DIVERGED};
use crate::compare::{Comparison, Run};
use crate::platform;
use crate::record::screenshot::ScreenshotRequest;

/// Ends the program on time, and after its picture is on disk.
pub(super) fn end(
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
            error!("the picture {} was not written", path.display());
            exit.write(AppExit::from_code(1));
        }
        Some(_) => {}
    }
}
