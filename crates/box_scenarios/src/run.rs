//! Runs a setup from sample to sample, through its impulses, in equal steps.

use box_physics::integrators::Integrator;
use box_physics::state::BodyState;

use crate::driver::{Driver, Totals};
use crate::model::Model;
use crate::setup::{Setup, TimedImpulse};

/// Number of equal steps of at most `dt` \[s\] in `interval` \[s\]. This is their ratio rounded up, where a ratio
/// within 1e-9 of an integer counts as that integer (30.000000000000004 steps are 30).
pub fn steps_in(interval: f64, dt: f64) -> u64 {
    let ratio = interval / dt;
    let nearest = ratio.round();
    let n = if (ratio - nearest).abs() <= 1e-9 * ratio.max(1.0) {
        nearest
    } else {
        ratio.ceil()
    };
    n as u64
}

/// An interval without events: `steps` of `h` \[s\], then possibly a sample, then possibly impulses.
#[derive(Clone, Debug, PartialEq)]
struct Leg {
    h: f64,
    steps: u64,
    /// Time at the end \[s\].
    end: f64,
    /// `true` if the state at the end (before the impulses) is a sample.
    sample: bool,
    impulses: Vec<TimedImpulse>,
}

/// The steps of a run: each interval between samples and impulses is divided into equal steps of at most dt.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    legs: Vec<Leg>,
    /// Maximum number of force evaluations.
    budget: u64,
}

impl Plan {
    /// A plan for samples at `times` \[s\] (≥ 0, not decreasing) and `impulses` (sorted by time; those after the last
    /// sample are ignored), with steps of at most `dt` \[s\]. A sample at the time of an impulse is the state just
    /// before it.
    pub fn new(times: &[f64], impulses: &[TimedImpulse], dt: f64) -> Self {
        let mut legs: Vec<Leg> = Vec::with_capacity(times.len() + impulses.len());
        let mut now = 0.0;
        let mut waiting = impulses.iter().copied().peekable();
        let mut leg_to = |t: f64, sample| {
            let steps = if t > now {
                steps_in(t - now, dt).max(1)
            } else {
                0
            };
            let h = if steps > 0 {
                (t - now) / steps as f64
            } else {
                0.0
            };
            now = t;
            Leg {
                h,
                steps,
                end: t,
                sample,
                impulses: Vec::new(),
            }
        };
        for &t in times {
            while let Some(i) = waiting.next_if(|i| i.t < t) {
                let mut leg = leg_to(i.t, false);
                leg.impulses.push(i);
                legs.push(leg);
            }
            legs.push(leg_to(t, true));
        }
        Self {
            legs,
            budget: u64::MAX,
        }
    }

    /// A plan with `samples` samples, one after every `stride` steps of exactly `h` \[s\], like the clock of a game.
    /// All steps have exactly the same length, so that an integrator's memory stays valid throughout.
    pub fn clock(h: f64, stride: u64, samples: u64) -> Self {
        let leg = |k: u64| Leg {
            h,
            steps: stride,
            end: (k * stride) as f64 * h,
            sample: true,
            impulses: Vec::new(),
        };
        Self {
            legs: (1..=samples).map(leg).collect(),
            budget: u64::MAX,
        }
    }

    /// Limits the run: it ends soon after `evaluations` force evaluations. For setups from files, which may be
    /// arbitrarily expensive.
    #[must_use]
    pub fn within(self, evaluations: u64) -> Self {
        Self {
            budget: evaluations,
            ..self
        }
    }

    /// Total number of steps.
    pub fn steps(&self) -> u64 {
        // A file may require more steps than fit into the type.
        self.legs
            .iter()
            .fold(0, |sum: u64, leg| sum.saturating_add(leg.steps))
    }
}

/// Outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// The run reached the end of its plan.
    Complete,
    /// The run was stopped at a sample.
    Stopped,
    /// A step led to an invalid state.
    Failed {
        /// Time at the end of that step \[s\].
        at: f64,
    },
    /// The run needed more force evaluations than allowed.
    OutOfBudget,
}

/// A run that can be interrupted. It advances from one sample or impulse of its plan to the next.
#[derive(Clone, Debug)]
pub struct PlanRun {
    model: Model,
    driver: Driver,
    leg: usize,
}

impl PlanRun {
    /// Creates a run at the start of `setup`.
    pub fn new(setup: &Setup, integrator: Integrator) -> Self {
        Self {
            model: Model::of(setup),
            driver: Driver::new(setup.initial, integrator),
            leg: 0,
        }
    }

    /// Restarts the run at the start of `setup`.
    pub fn restart(&mut self, setup: &Setup) {
        self.driver = Driver::new(setup.initial, self.driver.integrator);
        self.leg = 0;
    }

    /// Runs the next interval of `plan`, as in [`run_plan`]. Returns how the run ended, once it has.
    pub fn advance(
        &mut self,
        plan: &Plan,
        look: impl FnOnce(f64, &BodyState) -> bool,
    ) -> Option<End> {
        let (driver, model) = (&mut self.driver, &self.model);
        let Some(leg) = plan.legs.get(self.leg) else {
            return Some(End::Complete);
        };
        self.leg += 1;
        if !driver.run(model, leg.h, leg.steps, plan.budget) {
            return Some(End::Failed { at: driver.time });
        }
        if driver.totals.evaluations > plan.budget {
            return Some(End::OutOfBudget);
        }
        // Set exactly, instead of summing steps.
        driver.time = leg.end;
        if leg.sample && !look(leg.end, &driver.state) {
            return Some(End::Stopped);
        }
        for i in &leg.impulses {
            driver.apply(model, i);
        }
        None
    }
}

/// Runs `setup` with `integrator` along `plan`, and passes time \[s\] and state at every sample to `look`, which
/// returns whether to continue.
pub fn run_plan(
    setup: &Setup,
    integrator: Integrator,
    plan: &Plan,
    mut look: impl FnMut(f64, &BodyState) -> bool,
) -> (Totals, End) {
    let mut run = PlanRun::new(setup, integrator);
    loop {
        if let Some(end) = run.advance(plan, &mut look) {
            return (run.driver.totals, end);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forces::ForceSet;
    use box_physics::body::RigidBox;
    use glam::DVec3;

    #[test]
    fn the_ceiling_knows_rounding() {
        assert_eq!(steps_in(0.5, 1.0 / 60.0), 30);
        assert_eq!(steps_in(30.000000000000004 / 60.0, 1.0 / 60.0), 30);
        assert_eq!(steps_in(0.25, 1.0 / 60.0), 15);
        assert_eq!(steps_in(0.125, 1.0 / 60.0), 8);
        assert_eq!(steps_in(0.5001, 1.0 / 60.0), 31);
        assert_eq!(steps_in(1e-6, 1.0 / 60.0), 1);
    }

    #[test]
    fn samples_come_before_impulses() {
        let kick = |t| TimedImpulse {
            t,
            impulse: DVec3::X,
            body_point: DVec3::ZERO,
        };
        let setup = Setup::new(
            RigidBox::default(),
            BodyState::default(),
            ForceSet::none(),
            2.0,
        )
        .with_impulses(vec![kick(0.0), kick(0.95), kick(1.0), kick(5.0)]);
        let plan = Plan::new(&[0.0, 1.0, 2.0], &setup.impulses, 0.1);
        let mut seen = Vec::new();
        let (totals, end) = run_plan(&setup, Integrator::Split, &plan, |t, s| {
            seen.push((t, s.velocity.x));
            true
        });
        assert_eq!(seen, [(0.0, 0.0), (1.0, 2.0), (2.0, 3.0)]);
        // 0.95 in 10 steps, 0.05 in 1, 1 in 10.
        assert_eq!((totals.steps, plan.steps(), end), (21, 21, End::Complete));
    }
}
