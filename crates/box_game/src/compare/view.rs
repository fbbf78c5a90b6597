//! Plain data of the comparison for the panel, filled once per frame.

use box_bench::measure::Cost;
use box_physics::prelude::{Floor, Integrator};
use box_scenarios::Status;

use super::runner::SAME;
use super::sampling::IntegratorSamples;
use super::sweep::SweepLine;
use super::{Comparison, Fairness, Layout, Mark, Quantity, Window};
use crate::action::Plot;
use crate::ui::panel::decimate::{NARROW, decimate};

/// Settings of the comparison and its plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Layout of the trajectories.
    pub layout: Layout,
    /// Quantity that is equal for all trajectories.
    pub fairness: Fairness,
    /// Time window of the plots.
    pub window: Window,
    /// Errors on a logarithmic axis.
    pub logarithmic: bool,
    /// Energy and angular momentum on a logarithmic axis, by magnitude.
    pub logarithmic_energy: bool,
    /// Error of each step alone, instead of the error since the start.
    pub local: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            layout: Layout::default(),
            fairness: Fairness::default(),
            window: Window::default(),
            logarithmic: true,
            logarithmic_energy: false,
            local: false,
        }
    }
}

/// The comparison in one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CompareView {
    pub settings: Settings,
    /// The main box, then the comparisons.
    pub trajectories: Vec<TrajectoryView>,
    /// `true` if the attitude errors exceed the position errors, at the radius of the box.
    pub attitude: bool,
    /// Description of the reference.
    pub reference: String,
    /// Time after which the motion is chaotic and has no errors \[s\], if any.
    pub horizon: Option<f64>,
    pub marks: Vec<Mark>,
    /// `true` if only inputs should change the energy.
    pub conservative: bool,
    /// The lines of the sweep so far.
    pub sweep: Vec<SweepLine>,
    /// Number of finished points and of all points, while the sweep runs.
    pub sweeping: Option<(u32, u32)>,
    /// A note about this comparison; may be empty.
    pub note: String,
    /// Time for simulating and measuring the trajectories in the last frame \[ms\].
    pub comparisons_ms: f64,
    /// Time for drawing the panel in the last frame \[ms\].
    pub panel_ms: f64,
}

/// One trajectory in one frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TrajectoryView {
    pub integrator: Integrator,
    pub main_box: bool,
    pub dt: f64,
    /// Delay of the last input \[s\].
    pub skew: f64,
    pub status: Status,
    /// Cost from the recent samples [ns per body-step].
    pub cost: Option<Cost>,
    /// Mean cost of this run so far [ns per simulated second], as the sweep measures it.
    pub run_cost: Option<f64>,
    pub evaluations: f64,
    /// Current values in the order of [`Quantity::ALL`]; NaN where unknown.
    pub now: [f64; Quantity::ALL.len()],
    /// Largest distance \[m\] and angle \[°\] from the reference so far.
    pub worst: (f64, f64),
    /// Number (from 1) and lateness \[s\] of the flip that is most late (> 0) or early (< 0).
    pub late: Option<(usize, f64)>,
    /// Translational, rotational and potential energy \[J\].
    pub energies: [f64; 3],
    pub lines: Vec<(Quantity, Vec<[f64; 2]>)>,
}

impl TrajectoryView {
    pub(crate) fn get(&self, quantity: Quantity) -> f64 {
        self.now[quantity as usize]
    }

    /// Minimum cost of a simulated second \[ns\].
    pub(crate) fn cost_per_second(&self) -> Option<f64> {
        let cost = self.cost?.min / self.dt;
        (cost > 0.0 && cost.is_finite()).then_some(cost)
    }

    pub(crate) fn diverged(&self) -> bool {
        self.status.is_diverged()
    }
}

fn quantities(plot: Option<Plot>, settings: &Settings) -> &'static [Quantity] {
    match plot {
        Some(Plot::Error) if settings.local => &[Quantity::LocalPosition, Quantity::LocalAttitude],
        Some(Plot::Error) => &[Quantity::Position, Quantity::Attitude],
        Some(Plot::Energy) => &[Quantity::Energy, Quantity::Momentum, Quantity::Direction],
        _ => &[],
    }
}

/// Creates the view of this frame, with the lines of the open `plot`. `boxes` is their number in the scene.
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
        sweep: sweep.lines(),
        sweeping: sweep.is_running().then(|| sweep.progress()),
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
    view.marks = run.marks.iter().copied().collect();
    let ideal = |f: Floor| f.restitution >= 1.0 && f.friction <= 0.0;
    view.conservative = run.law.is_conservative() && run.law.floor().is_none_or(ideal);
    if boxes > 1 {
        view.note = "The comparisons simulate only the first box.".to_owned();
    }
    view
}
