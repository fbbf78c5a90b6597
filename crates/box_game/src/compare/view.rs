//! What the panel shows of the comparison: plain data.

use box_bench::measure::Cost;
use box_physics::prelude::Integrator;
use box_scenarios::Status;

use super::run::Rule;
use super::series::Quantity;
use super::sweep::SweepLine;
use crate::action::compare::{Fairness, Layout, Window};

/// What can be chosen about the comparison and its plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// How the trajectories are drawn.
    pub layout: Layout,
    /// What is equal between them.
    pub fairness: Fairness,
    /// How much of the past is plotted.
    pub window: Window,
    /// Errors on a logarithmic axis.
    pub logarithmic: bool,
    /// Energy and angular momentum on a logarithmic axis, by size.
    pub logarithmic_energy: bool,
    /// Error of each step alone, instead of since the start.
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
    /// Whether the attitudes have gone more wrong than the positions have.
    pub attitude: bool,
    /// Where the trusted answer comes from.
    pub reference: String,
    /// After this time \[s\] the motion is chaotic, and there are no errors.
    pub horizon: Option<f64>,
    pub rules: Vec<Rule>,
    /// Whether nothing but inputs should change the energy.
    pub conservative: bool,
    pub sweep: SweepView,
    /// What there is to say about this comparison, or nothing.
    pub note: String,
    /// What simulating and measuring the trajectories cost in the last frame \[ms\].
    pub comparisons_ms: f64,
    /// What drawing the panel cost in the last frame \[ms\].
    pub panel_ms: f64,
}

/// One trajectory in one frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TrajectoryView {
    pub integrator: Integrator,
    pub main_box: bool,
    pub dt: f64,
    /// By how much it took the last input late \[s\].
    pub skew: f64,
    pub status: Status,
    /// Of the recent samples [ns per body-step].
    pub cost: Option<Cost>,
    /// Mean cost of this run so far [ns per simulated second], as the sweep measures it.
    pub run_cost: Option<f64>,
    pub evaluations: f64,
    /// Now, in the order of [`Quantity::ALL`]; NaN where unknown.
    pub now: [f64; Quantity::ALL.len()],
    /// Largest distance \[m\] and angle \[°\] from the reference so far.
    pub worst: (f64, f64),
    /// The flip that is late (> 0) or early (< 0) most, from 1, and by how much \[s\].
    pub late: Option<(usize, f64)>,
    /// Energies \[J\]: of translation, of rotation, potential.
    pub energies: [f64; 3],
    pub lines: Vec<(Quantity, Vec<[f64; 2]>)>,
}

impl TrajectoryView {
    pub(crate) fn get(&self, quantity: Quantity) -> f64 {
        self.now[quantity as usize]
    }

    /// Cost of a simulated second \[ns\]: the minimum, as everywhere.
    pub(crate) fn cost_per_second(&self) -> Option<f64> {
        let cost = self.cost?.min / self.dt;
        (cost > 0.0 && cost.is_finite()).then_some(cost)
    }

    pub(crate) fn diverged(&self) -> bool {
        self.status.is_diverged()
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct SweepView {
    pub running: bool,
    pub progress: (u32, u32),
    pub lines: Vec<SweepLine>,
}
