//! Fills the view of the comparison.

use super::runner::SAME;
use super::{CompareView, Comparison, Quantity, Settings, SweepView, TrajectoryView};
use crate::action::Plot;
use crate::compare::sampling::IntegratorSamples;
use crate::ui::panel::decimate::{NARROW, decimate};
use box_physics::prelude::Floor;
use box_scenarios::Status;

/// Which quantities a tab shows.
fn quantities(plot: Option<Plot>, settings: &Settings) -> &'static [Quantity] {
    match plot {
        Some(Plot::Error) if settings.local => &[Quantity::LocalPosition, Quantity::LocalAttitude],
        Some(Plot::Error) => &[Quantity::Position, Quantity::Attitude],
        Some(Plot::Energy) => &[Quantity::Energy, Quantity::Momentum, Quantity::Direction],
        _ => &[],
    }
}

/// The view of this frame, with the lines of the open `plot`; `boxes` are in the scene.
pub(crate) fn compare_view(
    comparison: &Comparison,
    samples: &IntegratorSamples,
    plot: Option<Plot>,
    boxes: u32,
) -> CompareView {
    let settings = comparison.settings;
    let sweep = &comparison.sweep;
    let mut view = CompareView {
        settings,
        sweep: SweepView {
            running: sweep.is_running(),
            progress: sweep.progress(),
            lines: sweep.lines(),
        },
        comparisons_ms: comparison.comparisons_ms,
        ..CompareView::default()
    };
    let Some(run) = &comparison.run else {
        return view;
    };
    let shown = quantities(plot, &settings);
    let window = settings.window.seconds();
    for (k, runner) in run.trajectories().enumerate() {
        let (integrator, track) = (runner.integrator(), &runner.track);
        let (dt, time) = (runner.factor * run.step, runner.simulation.driver.time);
        let behind = run.clock - time > dt * (1.0 + SAME);
        let status = runner.simulation.status();
        view.trajectories.push(TrajectoryView {
            integrator,
            main_box: k == 0,
            dt,
            skew: runner.skew,
            status: if behind && !status.is_diverged() {
                Status::CatchingUp(time / run.clock.max(1e-9))
            } else {
                status
            },
            cost: samples.cost(integrator),
            run_cost: samples.mean_of_run(integrator).map(|ns| ns / dt),
            evaluations: samples.evaluations(integrator),
            now: track.now.sample.values,
            worst: track.now.worst,
            late: run.late(track),
            energies: track.now.energies,
            lines: shown
                .iter()
                .map(|&q| (q, decimate(NARROW, &track.series.points(q, window))))
                .collect(),
        });
    }
    view.attitude = run.attitude_says_more();
    view.reference = run.reference.description();
    view.horizon = run.reference.horizon();
    view.rules = run.rules.iter().copied().collect();
    let ideal = |f: Floor| f.restitution >= 1.0 && f.friction <= 0.0;
    view.conservative = run.law.is_conservative() && run.law.floor.is_none_or(ideal);
    if boxes > 1 {
        view.note = "The comparisons simulate only the first box.".to_owned();
    }
    view
}
