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
    /// The integrator that the main box is compared with in words; the first trajectory if `None`.
    pub selected: Option<Integrator>,
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
            selected: None,
        }
    }
}

/// The comparison in one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompareView {
    /// What is chosen.
    pub settings: Settings,
    /// The main box, then the comparisons.
    pub trajectories: Vec<TrajectoryView>,
    /// Whether the attitudes have gone more wrong than the positions have.
    pub attitude: bool,
    /// Where the trusted answer comes from.
    pub reference: String,
    /// After this time \[s\] the motion is chaotic, and there are no errors.
    pub horizon: Option<f64>,
    /// Vertical lines in the plots.
    pub rules: Vec<Rule>,
    /// Whether nothing but inputs should change the energy.
    pub conservative: bool,
    /// How far the sweep is.
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
pub struct TrajectoryView {
    /// The integrator.
    pub integrator: Integrator,
    /// Whether it is the main box.
    pub main_box: bool,
    /// Its step \[s\].
    pub dt: f64,
    /// By how much it took the last input late \[s\].
    pub skew: f64,
    /// What can be said of it.
    pub status: Status,
    /// Of the recent samples [ns per body-step].
    pub cost: Option<Cost>,
    /// Mean cost of this run so far [ns per simulated second], as the sweep measures it.
    pub run_cost: Option<f64>,
    /// Force evaluations per step.
    pub evaluations: f64,
    /// Now, in the order of [`Quantity::ALL`]; NaN where unknown.
    pub now: [f64; Quantity::ALL.len()],
    /// Largest distance \[m\] and angle \[°\] from the reference so far.
    pub worst: (f64, f64),
    /// The flip that is late (> 0) or early (< 0) most, from 1, and by how much \[s\].
    pub late: Option<(usize, f64)>,
    /// Energies \[J\]: of translation, of rotation, potential.
    pub energies: [f64; 3],
    /// The lines of the open plot.
    pub lines: Vec<(Quantity, Vec<[f64; 2]>)>,
}

impl TrajectoryView {
    /// One of the present values.
    pub fn get(&self, quantity: Quantity) -> f64 {
        self.now[quantity as usize]
    }

    /// Cost of a simulated second \[ns\]: the minimum, as everywhere.
    pub fn cost_per_second(&self) -> Option<f64> {
        let cost = self.cost?.min / self.dt;
        (cost > 0.0 && cost.is_finite()).then_some(cost)
    }

    /// Whether it was given up.
    pub fn diverged(&self) -> bool {
        self.status.is_diverged()
    }
}

/// The sweep in one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweepView {
    /// Whether it runs.
    pub running: bool,
    /// Points done and to do.
    pub progress: (u32, u32),
    /// The lines so far.
    pub lines: Vec<SweepLine>,
}

/// Errors below are rounding: no ratio of them says anything.
const ROUNDING: f64 = 1e-11;

/// The main box against the chosen trajectory, in words, from the side of the more accurate.
pub fn verdict(view: &CompareView) -> String {
    let Some(main_box) = view.trajectories.iter().find(|l| l.main_box) else {
        return String::new();
    };
    let others = || view.trajectories.iter().filter(|l| !l.main_box);
    let chosen = others()
        .find(|l| Some(l.integrator) == view.settings.selected)
        .or_else(|| others().next());
    let Some(other) = chosen else {
        return "Tick an integrator to compare with.".to_owned();
    };
    let (h, o) = (main_box.integrator.name(), other.integrator.name());
    match (main_box.diverged(), other.diverged()) {
        (true, true) => return format!("{h} and {o} have both diverged."),
        (true, false) => return format!("{h} has diverged, {o} has not."),
        (false, true) => return format!("{o} has diverged, {h} has not."),
        (false, false) => {}
    }
    let (a, b, what) = if view.attitude {
        (main_box.worst.1, other.worst.1, "attitude")
    } else {
        (main_box.worst.0, other.worst.0, "position")
    };
    let (best, worst, small, large) = if a <= b {
        (main_box, other, a, b)
    } else {
        (other, main_box, b, a)
    };
    let (best_name, worst_name) = (best.integrator.name(), worst.integrator.name());
    let price = match (best.cost_per_second(), worst.cost_per_second()) {
        (Some(x), Some(y)) => format!(", {} cost", times(x / y)),
        _ => String::new(),
    };
    if large <= ROUNDING {
        return format!(
            "{h} and {o} are both right to rounding; {best_name}{}",
            match price.strip_prefix(", ") {
                Some(price) => format!(": {price}."),
                None => " is not timed yet.".to_owned(),
            }
        );
    }
    let ratio = if small <= ROUNDING {
        "right to rounding".to_owned()
    } else {
        format!("{} smaller {what} error", times(large / small))
    };
    format!("{best_name}: {ratio}{price} (against {worst_name}).")
}

/// `310×`, `3.4×`, `1.6e6×`.
pub(super) fn times(ratio: f64) -> String {
    if ratio >= 1e5 {
        format!("{ratio:.1e}×")
    } else if ratio >= 10.0 {
        format!("{ratio:.0}×")
    } else if ratio >= 0.1 {
        format!("{ratio:.1}×")
    } else {
        format!("{ratio:.2}×")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trajectory(
        integrator: Integrator,
        main_box: bool,
        error: (f64, f64),
        ns: f64,
    ) -> TrajectoryView {
        TrajectoryView {
            integrator,
            main_box,
            dt: 1.0 / 60.0,
            skew: 0.0,
            status: Status::Ok,
            cost: Some(Cost::of(&[ns])),
            run_cost: None,
            evaluations: 1.0,
            now: [0.0; Quantity::ALL.len()],
            worst: error,
            late: None,
            energies: [0.0; 3],
            lines: Vec::new(),
        }
    }

    #[test]
    fn verdicts() {
        use Integrator::{Rk4, SemiImplicitEuler};
        let with = |a: (f64, f64), b: (f64, f64)| CompareView {
            trajectories: vec![
                trajectory(Rk4, true, a, 68.0),
                trajectory(SemiImplicitEuler, false, b, 20.0),
            ],
            attitude: a.1.max(b.1) > 0.0,
            ..CompareView::default()
        };
        assert_eq!(
            verdict(&with((0.0, 0.1), (0.0, 31.0))),
            "RK4: 310× smaller attitude error, 3.4× cost (against Semi-implicit Euler)."
        );
        assert_eq!(
            verdict(&with((2.0, 0.0), (0.5, 0.0))),
            "Semi-implicit Euler: 4.0× smaller position error, 0.3× cost (against RK4)."
        );
        assert_eq!(
            verdict(&with((0.0, 0.0), (0.5, 0.0))),
            "RK4: right to rounding, 3.4× cost (against Semi-implicit Euler)."
        );
        assert!(verdict(&with((0.0, 0.0), (0.0, 0.0))).contains("both right to rounding"));
        let mut view = with((0.0, 0.1), (0.0, 31.0));
        view.trajectories[1].status = Status::Diverged(box_scenarios::Divergence {
            t: 3.2,
            reason: box_scenarios::Reason::Energy,
        });
        assert_eq!(
            verdict(&view),
            "Semi-implicit Euler has diverged, RK4 has not."
        );
        view.trajectories.truncate(1);
        assert_eq!(verdict(&view), "Tick an integrator to compare with.");
        assert_eq!(verdict(&CompareView::default()), "");
        assert_eq!(times(1.6e6), "1.6e6×");
    }
}
