//! Fills the view of the comparison.

use super::runner::SAME;
use super::track::Track;
use super::{CompareView, Comparison, LaneView, Quantity, Settings, SweepView};
use crate::action::Plot;
use crate::compare::sampling::IntegratorSamples;
use crate::ui::panel::decimate::{NARROW, decimate_to};
use box_physics::prelude::Integrator;

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
pub fn compare_view(
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
        lanes_ms: comparison.lanes_ms,
        ..CompareView::default()
    };
    let Some(run) = &comparison.run else {
        return view;
    };
    let shown = quantities(plot, &settings);
    let window = settings.window.seconds();
    let lane = |integrator: Integrator, track: &Track, dt: f64| LaneView {
        integrator,
        hero: false,
        dt,
        skew: 0.0,
        status: String::new(),
        nanoseconds: samples.statistics(integrator),
        evaluations: samples.evaluations(integrator),
        now: track.now.sample.values,
        worst: track.now.worst,
        energies: track.now.energies,
        lines: shown
            .iter()
            .map(|&q| {
                (
                    q,
                    decimate_to(NARROW, track.series.points(q, window).into_iter()),
                )
            })
            .collect(),
    };
    let touching = run.law.meets_floor(&run.hero.state, 0.0);
    view.lanes.push(LaneView {
        hero: true,
        status: match run.hero.track.diverged {
            Some(t) => diverged(t),
            None if touching && still(&run.hero.state) => "resting".to_owned(),
            None if touching => "contact".to_owned(),
            None => "ok".to_owned(),
        },
        ..lane(run.hero.integrator, &run.hero.track, run.step)
    });
    for runner in &run.lanes {
        let dt = runner.factor * run.step;
        let behind = run.clock - runner.lane.time > dt * (1.0 + SAME);
        view.lanes.push(LaneView {
            skew: runner.skew,
            status: match runner.track.diverged {
                Some(t) => diverged(t),
                None if behind => format!(
                    "catching up, {:.0} %",
                    100.0 * runner.lane.time / run.clock.max(1e-9)
                ),
                None if runner.lane.contacts() > 0 && still(&runner.lane.state) => {
                    "resting".to_owned()
                }
                None if runner.lane.contacts() > 0 => "contact".to_owned(),
                None => "ok".to_owned(),
            },
            ..lane(runner.lane.integrator, &runner.track, dt)
        });
    }
    view.attitude = run.attitude_says_more();
    view.reference = run.reference.description();
    view.rules = run.rules.iter().copied().collect();
    view.conservative = run.law.is_conservative()
        && run
            .law
            .floor
            .is_none_or(|f| f.restitution >= 1.0 && f.friction <= 0.0);
    if boxes > 1 {
        view.note = "The lanes simulate the first box alone, without the load.".to_owned();
    }
    view
}

fn diverged(t: f64) -> String {
    format!("DIVERGED @ t = {t:.1} s")
}

fn still(state: &box_physics::prelude::BodyState) -> bool {
    state.velocity == glam::DVec3::ZERO && state.angular_momentum == glam::DVec3::ZERO
}
