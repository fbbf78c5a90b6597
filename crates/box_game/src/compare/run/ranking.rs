//! The order of the comparisons by their worst error so far, for layouts that show them side by side.

use box_physics::prelude::Integrator;

use super::Run;
use crate::compare::runner::Runner;
use crate::compare::verdict::Quality;

/// Shortest simulated time between two changes of the order \[s\].
const PERIOD: f64 = 1.0;
/// The order changes if the errors of two comparisons in the wrong order differ by more than this factor.
const MIN_ERROR_RATIO: f64 = 2.0;

/// A stable order, which does not flicker.
#[derive(Clone, Debug, Default)]
pub(super) struct Ranking {
    order: Vec<Integrator>,
    /// Simulated time of the last check \[s\].
    at: f64,
}

impl Run {
    /// The comparisons, smallest error first; new ones are last.
    pub fn ranked(&self) -> Vec<&Runner> {
        let order = &self.ranking.order;
        let place = |r: &&Runner| order.iter().position(|i| *i == r.integrator());
        let mut ranked: Vec<_> = self.comparisons.iter().collect();
        ranked.sort_by_key(|r| place(r).unwrap_or(usize::MAX));
        ranked
    }

    /// Sorts the comparisons by error, if some differ clearly, at most once per second.
    pub fn rank(&mut self) {
        if (0.0..PERIOD).contains(&(self.clock - self.ranking.at)) {
            return;
        }
        let attitude = self.attitude_says_more();
        let severity = |r: &Runner| {
            let (worst, late) = (r.track.now.worst, self.late(&r.track));
            Quality::of(worst, late, r.simulation.status(), attitude).severity()
        };
        let ranked = self.ranked().into_iter();
        let mut ranked: Vec<_> = ranked.map(|r| (severity(r), r.integrator())).collect();
        let before = |k: usize| ranked[..k].iter();
        let wrong = |k: usize| before(k).any(|other| MIN_ERROR_RATIO * ranked[k].0 < other.0);
        if (1..ranked.len()).any(wrong) {
            ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        self.ranking = Ranking {
            order: ranked
                .into_iter()
                .map(|(_, integrator)| integrator)
                .collect(),
            at: self.clock,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_scenarios::Scenario;

    /// A near tie keeps its order. A clear difference changes it, but not before a second has passed.
    #[test]
    fn the_order_follows_clear_differences_alone() {
        use Integrator::{ExplicitEuler, Midpoint, Rk4};
        let setup = Scenario::find("throw").expect("a scene").setup;
        let mut run = Run::new(&setup, None, Integrator::Split, 1.0 / 60.0);
        run.choose([ExplicitEuler, Midpoint, Rk4]);
        let mut order = |clock: f64, degrees: [f64; 3]| {
            run.clock = clock;
            for (runner, angle) in run.comparisons.iter_mut().zip(degrees) {
                runner.track.now.worst = (0.0, angle);
            }
            run.rank();
            let ranked = run.ranked().into_iter().map(Runner::integrator);
            ranked.collect::<Vec<_>>()
        };
        assert_eq!(order(0.5, [30.0, 3.0, 0.0]), [ExplicitEuler, Midpoint, Rk4]);
        assert_eq!(order(1.0, [3.0, 2.0, 1.6]), [ExplicitEuler, Midpoint, Rk4]);
        assert_eq!(order(1.5, [30.0, 3.0, 0.0]), [ExplicitEuler, Midpoint, Rk4]);
        assert_eq!(order(2.0, [30.0, 3.0, 0.0]), [Rk4, Midpoint, ExplicitEuler]);
        // After stepping back.
        assert_eq!(order(1.0, [3.0, 30.0, 0.0]), [Rk4, ExplicitEuler, Midpoint]);
    }
}
