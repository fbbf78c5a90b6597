//! Time series for the plots, in rings of fixed size.

use std::collections::VecDeque;

use bevy::diagnostic::{DiagnosticsStore, FrameTimeDiagnosticsPlugin};
use bevy::prelude::*;
use box_physics::prelude::PhysicsClock;

use crate::platform;

/// Maximum number of points per curve: 15 minutes of CPU usage at 4 per second.
const LENGTH: usize = 3600;

/// The time series.
#[derive(Resource, Clone, Debug, Default)]
pub struct History {
    /// (wall time \[s\], process CPU \[%\], system CPU \[%\]).
    pub cpu: VecDeque<(f64, f64, f64)>,
    /// (wall time \[s\], simulated time \[s\]) of the last second, for the actual speed.
    pace: VecDeque<(f64, f64)>,
}

impl History {
    /// Simulated seconds per second over the last second.
    pub fn actual_speed(&self) -> Option<f64> {
        let (first, last) = (self.pace.front()?, self.pace.back()?);
        let wall = last.0 - first.0;
        (wall > 0.2).then(|| (last.1 - first.1) / wall)
    }
}

/// Adds this frame.
pub fn record(
    mut history: ResMut<History>,
    clock: Res<PhysicsClock>,
    time: Res<Time<Real>>,
    diagnostics: Option<Res<DiagnosticsStore>>,
) {
    let (wall, simulated) = (time.elapsed_secs_f64(), clock.elapsed().as_secs_f64());
    let history = &mut *history;
    // A restart clears the series.
    if history.pace.back().is_some_and(|last| last.1 > simulated) {
        history.pace.clear();
    }
    history.pace.push_back((wall, simulated));
    while history.pace.front().is_some_and(|p| p.0 < wall - 1.0) {
        history.pace.pop_front();
    }
    let due = history.cpu.back().is_none_or(|last| wall - last.0 >= 0.25);
    if let (Some(store), true) = (diagnostics, due)
        && let Some((process, system)) = platform::cpu_usage(&store)
    {
        history.cpu.push_back((wall, process, system));
        if history.cpu.len() > LENGTH {
            history.cpu.pop_front();
        }
    }
}

/// Smoothed duration of a frame \[ms\].
pub fn frame_time(store: Option<&DiagnosticsStore>) -> Option<f64> {
    store?
        .get(&FrameTimeDiagnosticsPlugin::FRAME_TIME)?
        .smoothed()
}
