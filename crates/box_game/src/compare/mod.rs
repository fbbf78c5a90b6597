//! The same scene under several integrators at once. The core runs the comparisons, each with its own clock. They have
//! the start of the plugin's main box, and the same inputs at the same simulated times. Each trajectory has its errors
//! relative to one reference, its balance of energy and momentum, and its past.
//!
//! - [`run`]: one run of a scene; [`runner`]: a comparison with its clock; [`track`]: its measurements.
//! - [`LiveReference`](box_scenarios::LiveReference): the common reference; [`Balance`](box_scenarios::Balance): the
//!   expected energy and angular momentum; [`series`]: time series in fixed memory.
//! - `input`: inputs common to all.
//! - [`sweep`]: work–precision in a separate thread; `view`: data for the panel.
//! - [`plugin`]: the Bevy plugin.

mod copy;
pub mod flips;
pub mod headless;
mod input;
pub mod plugin;
pub mod run;
pub mod runner;
pub mod sampling;
pub mod series;
pub mod sweep;
pub mod track;
pub(crate) mod verdict;
pub(crate) mod view;

use std::time::Duration;

use bevy::ecs::message::MessageCursor;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use box_physics::prelude::{ApplyImpulse, Integrator};
use box_scenarios::Scenario;

pub use crate::action::compare::{CompareAction, Fairness, Layout, Window};
pub use run::{Mark, MarkKind, Run};
pub use series::Quantity;
pub use view::Settings;
pub(crate) use view::{CompareView, TrajectoryView};

use crate::scene::session::Session;
use sweep::Sweep;

/// Time for comparisons per frame. Steps that do not fit are caught up later, which the status shows.
const BUDGET: Duration = Duration::from_micros(2500);
/// Number of comparisons that a scene opens with.
const RECOMMENDED: usize = 2;
/// Smallest and largest step of a comparison, relative to that of the clock.
const FACTORS: (f64, f64) = (1.0 / 16.0, 16.0);
/// Largest step of a comparison \[s\].
const MAX_STEP: f64 = 0.5;

/// The comparisons that a scene opens with: the first recommended ones other than the main box's integrator.
pub(crate) fn default_comparisons(
    scene: &Scenario,
    main_box: Integrator,
) -> impl Iterator<Item = Integrator> {
    let others = scene.recommended().into_iter();
    others.filter(move |&i| i != main_box).take(RECOMMENDED)
}

/// The comparison of the current scene.
#[derive(Resource, Default)]
pub struct Comparison {
    /// Settings chosen by the user.
    pub settings: Settings,
    /// The run, once a main box exists.
    pub run: Option<Run>,
    /// The sweep.
    pub sweep: Sweep,
    /// `true` if a sweep was requested. It starts once the scene has started.
    pub sweep_requested: bool,
    /// Time for simulating and measuring in the last frame \[ms\].
    pub comparisons_ms: f64,
    chosen: Vec<Integrator>,
    /// The scene that `chosen` is for.
    scene: Option<&'static str>,
    main_box: Option<Entity>,
    pending: Vec<ApplyImpulse>,
    cursor: MessageCursor<ApplyImpulse>,
    spent: Duration,
    /// Fairness, comparisons and main box's integrator for which the steps were last set.
    fair: Option<(Fairness, Vec<Integrator>, Integrator)>,
}

impl Comparison {
    /// Creates a comparison for `scene` with these integrators.
    pub fn with_comparisons(scene: &'static str, comparisons: &[Integrator]) -> Self {
        let mut comparison = Self {
            scene: Some(scene),
            ..Self::default()
        };
        comparison.choose(comparisons.iter().copied());
        comparison
    }

    /// Returns `true` if a sweep is running or about to start.
    pub fn is_sweeping(&self) -> bool {
        self.sweep_requested || self.sweep.is_running()
    }

    /// The chosen integrators, in the order of the menu. That of the main box is skipped.
    pub fn chosen(&self) -> &[Integrator] {
        &self.chosen
    }

    /// Sets the chosen integrators.
    pub fn choose(&mut self, comparisons: impl IntoIterator<Item = Integrator>) {
        self.chosen = comparisons.into_iter().collect();
        self.chosen.sort();
        self.chosen.dedup();
    }

    fn toggle(&mut self, integrator: Integrator) {
        if self.chosen.contains(&integrator) {
            self.chosen.retain(|&i| i != integrator);
        } else {
            self.choose(self.chosen.clone().into_iter().chain([integrator]));
        }
    }

    /// Starts a run. In another scene, the comparisons become those that the scene recommends.
    fn begin(&mut self, session: &Session, main_box: Integrator, step: f64) {
        let scene = &session.scenario;
        if self.scene != Some(scene.id) {
            self.scene = Some(scene.id);
            self.choose(default_comparisons(scene, main_box));
            self.sweep.clear();
        }
        let (setup, truth) = (session.setup(), session.truth.clone());
        self.run = Some(Run::new(&setup, truth, main_box, step));
        self.fair = None;
        self.pending.clear();
        self.settle();
    }

    /// Updates the comparisons of the run to the chosen integrators.
    fn settle(&mut self) {
        let Some(run) = &mut self.run else {
            return;
        };
        let own = run.main_box.integrator();
        let wanted = self.chosen.iter().copied().filter(|&i| i != own);
        if !wanted.clone().eq(run.integrators()) {
            run.choose(wanted);
        }
    }

    /// Simulates the comparisons up to the clock's time, within the remaining budget of the frame.
    fn advance(&mut self) {
        let Some(run) = &mut self.run else {
            return;
        };
        let start = Instant::now();
        let left = BUDGET.saturating_sub(self.spent);
        run.advance(Some(start + left));
        run.rank();
        self.spent += start.elapsed();
    }

    /// Sets the step of every comparison, once all costs are known. `cost` is (evaluations, ns) per step.
    fn make_fair(&mut self, cost: impl Fn(Integrator) -> Option<(f64, f64)>) {
        let Some(run) = &mut self.run else {
            return;
        };
        let comparisons = run.integrators().collect();
        let main_box = run.main_box.integrator();
        let key = (self.settings.fairness, comparisons, main_box);
        if self.fair.as_ref() == Some(&key) {
            return;
        }
        let figure = |i: Integrator| {
            let figure = match key.0 {
                Fairness::Step => Some(1.0),
                Fairness::Evaluations => cost(i).map(|c| c.0),
                Fairness::Cost => cost(i).map(|c| c.1),
            };
            figure.filter(|f| *f > 0.0 && f.is_finite())
        };
        let figures: Option<Vec<f64>> = key.1.iter().map(|&i| figure(i)).collect();
        let (Some(own), Some(figures)) = (figure(key.2), figures) else {
            return;
        };
        let most = FACTORS.1.min((MAX_STEP / run.step).max(1.0));
        let mut changed = false;
        for (runner, figure) in run.comparisons.iter_mut().zip(figures) {
            let factor = (figure / own).clamp(FACTORS.0, most);
            changed |= runner.factor != factor;
            runner.factor = factor;
        }
        if changed && run.clock > 0.0 {
            run.mark(run.clock, MarkKind::Step);
        }
        self.fair = Some(key);
    }
}
