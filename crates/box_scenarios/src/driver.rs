//! Steps one box with one integrator outside of the plugin, bit for bit like the plugin.
//!
//! Headless runs, panel, sweep, comparisons, report and benchmarks all step through [`Driver`], so that contact rules
//! and execution path are the same everywhere:
//!
//! - under gravity alone, a loop compiled for it runs;
//! - a box that cannot reach the floor in a step takes the integrator's plain step;
//! - a box that may reach the floor, or touched it, takes [`step_on_floor`];
//! - in a tray it takes [`step_on_planes`];
//! - an invalid state is discarded: the box keeps its last state.

use box_physics::floor::{
    ContactState, FloorContext, FloorOutcome, PlanesContext, may_touch, may_touch_planes,
    step_on_floor, step_on_planes,
};
use box_physics::force::{ForceModel, Gravity};
use box_physics::integrators::{
    Integrate, Integrator, IntegratorMemory, IntegratorVisitor, StepOutcome,
};
use box_physics::state::BodyState;

use crate::model::Model;
use crate::setup::TimedImpulse;

/// Cost of a run, and the number of exceptional steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Steps taken.
    pub steps: u64,
    /// Force evaluations.
    pub evaluations: u64,
    /// Steps taken by `split` as a fallback.
    pub fallbacks: u64,
    /// Iterations that reached their maximum number.
    pub unconverged: u64,
    /// Impacts on the floor.
    pub impacts: u64,
}

impl Totals {
    /// Adds one step.
    #[inline(always)]
    fn count(&mut self, outcome: StepOutcome) {
        self.steps += 1;
        self.evaluations += outcome.evaluations;
        self.fallbacks += outcome.fallbacks;
        self.unconverged += outcome.unconverged;
    }

    /// Force evaluations per step; 0 before the first step.
    pub fn evaluations_per_step(&self) -> f64 {
        self.evaluations as f64 / self.steps.max(1) as f64
    }
}

impl core::ops::AddAssign for Totals {
    fn add_assign(&mut self, other: Self) {
        self.steps += other.steps;
        self.evaluations += other.evaluations;
        self.fallbacks += other.fallbacks;
        self.unconverged += other.unconverged;
        self.impacts += other.impacts;
    }
}

/// Steps between two checks of the budget of evaluations.
const BLOCK: u64 = 4096;

/// A box under one integrator, with its own clock.
#[derive(Clone, Debug)]
pub struct Driver {
    /// The integrator.
    pub integrator: Integrator,
    /// The current state, which is the last valid one.
    pub state: BodyState,
    /// Simulated time \[s\].
    pub time: f64,
    /// Cost so far.
    pub totals: Totals,
    /// The memory of the integrator.
    pub memory: IntegratorMemory,
    /// Contact of the box with the floor at the end of the last step.
    pub contact: ContactState,
}

impl Driver {
    /// Creates a driver for a box in `state` at time 0.
    pub fn new(state: BodyState, integrator: Integrator) -> Self {
        Self {
            integrator,
            state,
            time: 0.0,
            totals: Totals::default(),
            memory: IntegratorMemory::default(),
            contact: ContactState::default(),
        }
    }

    /// Sets the time \[s\].
    #[must_use]
    pub fn at_time(mut self, time: f64) -> Self {
        self.time = time;
        self
    }

    /// Number of corners at the floor at the end of the last step.
    pub fn contacts(&self) -> u32 {
        self.contact.touching().count_ones()
    }

    /// Takes one step of `h` \[s\] and returns its outcome. Returns `None` if it led to an invalid state; the box then
    /// keeps its last state.
    pub fn step(&mut self, model: &Model, h: f64) -> Option<FloorOutcome> {
        let mut last = FloorOutcome::default();
        self.steps(model, h, 1, &mut last).then_some(last)
    }

    /// Takes `n` steps of `h` \[s\]. Returns `false` if one of them led to an invalid state; the run then ends at the
    /// last valid one. It also ends soon after the total number of evaluations exceeds `budget`.
    pub fn run(&mut self, model: &Model, h: f64, n: u64, budget: u64) -> bool {
        let mut left = n;
        while left > 0 && self.totals.evaluations <= budget {
            let block = left.min(BLOCK);
            if !self.steps(model, h, block, &mut FloorOutcome::default()) {
                return false;
            }
            left -= block;
        }
        true
    }

    /// Applies an impulse at a point of the box.
    pub fn apply(&mut self, model: &Model, i: &TimedImpulse) {
        self.state
            .apply_impulse_at_body_point(&model.body, i.impulse, i.body_point);
    }

    fn steps(&mut self, model: &Model, h: f64, n: u64, last: &mut FloorOutcome) -> bool {
        let forces = model.forces.forces(&model.body);
        if model.is_uniform_acceleration() {
            self.steps_under(&Gravity(forces.acceleration), model, h, n, last)
        } else {
            self.steps_under(&forces, model, h, n, last)
        }
    }

    fn steps_under<F: ForceModel>(
        &mut self,
        force: &F,
        model: &Model,
        h: f64,
        n: u64,
        last: &mut FloorOutcome,
    ) -> bool {
        self.integrator.dispatch(Steps {
            driver: self,
            model,
            force,
            h,
            n,
            last,
        })
    }
}

/// `n` steps, compiled for one integrator and force model.
struct Steps<'a, F> {
    driver: &'a mut Driver,
    model: &'a Model,
    force: &'a F,
    h: f64,
    n: u64,
    last: &'a mut FloorOutcome,
}

impl<F: ForceModel> IntegratorVisitor for Steps<'_, F> {
    type Output = bool;

    fn visit<S: Integrate>(self) -> bool {
        let Driver {
            state,
            time,
            totals,
            memory,
            contact,
            ..
        } = self.driver;
        let (body, force, h) = (&self.model.body, self.force, self.h);
        let (planes, settings) = (&self.model.planes[..], &self.model.settings);
        for _ in 0..self.n {
            let before = *state;
            let outcome = match &self.model.floor {
                Some(_)
                    if !planes.is_empty()
                        && (contact.touching() != 0
                            || may_touch_planes(planes, body, state, force, h)) =>
                {
                    let context = PlanesContext {
                        planes,
                        settings,
                        body,
                        force,
                    };
                    step_on_planes::<S, _>(&context, state, h, memory, contact, None)
                }
                Some(floor)
                    if planes.is_empty()
                        && (contact.touching() != 0 || may_touch(floor, body, state, force, h)) =>
                {
                    let context = FloorContext {
                        floor,
                        settings,
                        body,
                        force,
                    };
                    step_on_floor::<S, _>(&context, state, h, memory, contact, None)
                }
                _ => FloorOutcome {
                    step: S::step(body, state, force, h, memory),
                    ..FloorOutcome::default()
                },
            };
            totals.count(outcome.step);
            totals.impacts += u64::from(outcome.impacts);
            *self.last = outcome;
            *time += h;
            if !state.is_valid() {
                *state = before;
                return false;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forces::ForceSet;
    use crate::scenario::Scenario;
    use box_physics::body::RigidBox;
    use glam::DVec3;

    #[test]
    fn a_block_of_steps_is_the_same_as_single_steps() {
        for id in ["contact", "heavy-top", "throw", "dice-tray"] {
            let setup = Scenario::find(id).expect("a scene").setup;
            let model = Model::of(&setup);
            for &i in Integrator::ALL {
                let (mut whole, mut single) =
                    (Driver::new(setup.initial, i), Driver::new(setup.initial, i));
                let valid = whole.run(&model, 1.0 / 60.0, 120, u64::MAX);
                let each = (0..120).all(|_| single.step(&model, 1.0 / 60.0).is_some());
                assert_eq!(valid, each, "{i} on {id}");
                assert_eq!(whole.state, single.state, "{i} on {id}");
                assert_eq!(whole.totals, single.totals, "{i} on {id}");
            }
        }
    }

    /// Explicit Euler at c·h/m = 10 multiplies the velocity by −9 per step, up to the limit of a valid state, 1e38.
    #[test]
    fn an_invalid_state_is_not_kept() {
        let drag = ForceSet {
            linear_drag: 10.0,
            ..ForceSet::none()
        };
        let body = RigidBox::cube(1.0, 1.0).expect("valid");
        let model = Model::without_floor(body, drag);
        let start = BodyState::default().with_velocity(DVec3::X);
        let mut driver = Driver::new(start, Integrator::ExplicitEuler);
        assert!(!driver.run(&model, 1.0, 1000, u64::MAX));
        // 9^39 = 1.6e37, 9^40 = 1.5e38.
        assert_eq!(driver.totals.steps, 40);
        assert!(driver.state.is_valid() && driver.state.velocity.length() > 1e37);
        assert!(driver.step(&model, 1.0).is_none());
    }

    /// A die stays between the walls, never gains energy, and rests before the end.
    #[test]
    fn a_die_stays_in_its_tray() {
        let setup = Scenario::find("dice-tray").expect("a scene").setup;
        let (model, tray) = (Model::of(&setup), setup.floor.expect("a floor").tray);
        let mut driver = Driver::new(setup.initial, Integrator::Split);
        let mut before = model.energy(&driver.state);
        while driver.time < setup.duration {
            driver.step(&model, 1.0 / 60.0).expect("valid");
            let (x, after) = (driver.state.position, model.energy(&driver.state));
            assert!(x.x.abs().max(x.z.abs()) < tray - 0.249 && x.y > 0.249);
            assert!(after <= before + 1e-12 * before.abs());
            before = after;
        }
        assert!(driver.contact.is_resting(&driver.state) && driver.totals.impacts > 5);
    }

    #[test]
    fn a_budget_ends_a_run() {
        let setup = Scenario::default().setup;
        let mut driver = Driver::new(setup.initial, Integrator::Split);
        assert!(driver.run(&Model::of(&setup), 1e-3, 100_000, 10_000));
        let evaluations = driver.totals.evaluations;
        assert!((10_000..20_000).contains(&evaluations), "{evaluations}");
    }
}
