//! One scheme on one scene, outside the ECS: the core with a clock of its own.

use box_physics::floor::{ContactSettings, ContactState, Floor, may_touch, step_on_floor};
use box_physics::prelude::{BodyState, Forces, Integrator, SchemeMemory, StepOutcome};
use box_physics::schemes::{Scheme, SchemeVisitor};
use box_scenarios::Setup;

/// A body of `setup` under `integrator`, stepped by hand.
#[derive(Clone, Debug)]
pub struct Lane {
    /// The scheme.
    pub integrator: Integrator,
    /// Its present state.
    pub state: BodyState,
    /// Simulated time \[s\].
    pub time: f64,
    next_impulse: usize,
    /// Steps taken.
    pub steps: u64,
    /// What they cost.
    pub outcome: StepOutcome,
    memory: SchemeMemory,
    contact: ContactState,
}

impl Lane {
    /// At the start of `setup`.
    pub fn new(setup: &Setup, integrator: Integrator) -> Self {
        Self {
            integrator,
            state: setup.initial,
            time: 0.0,
            next_impulse: 0,
            steps: 0,
            outcome: StepOutcome::default(),
            memory: SchemeMemory::default(),
            contact: ContactState::default(),
        }
    }

    /// One step of `h` \[s\], at the floor if there is one. The scene's timed impulses act at the first
    /// step boundary at or after their time. Returns whether the state is still sound; if not, the lane
    /// has stopped at its last good state.
    pub fn step(&mut self, setup: &Setup, floor: Option<&Floor>, h: f64) -> bool {
        let before = self.state;
        while let Some(i) = setup.impulses.get(self.next_impulse) {
            if i.t > self.time + 1e-9 * h {
                break;
            }
            self.state
                .apply_impulse_at_body_point(&setup.body, i.impulse, i.body_point);
            self.next_impulse += 1;
        }
        let law = setup.forces.forces(&setup.body);
        let settings = ContactSettings::default();
        let outcome = self.integrator.dispatch(OneStep {
            setup,
            law: &law,
            floor: floor.map(|f| (f, &settings)),
            h,
            state: &mut self.state,
            memory: &mut self.memory,
            contact: &mut self.contact,
        });
        self.outcome += outcome;
        self.steps += 1;
        self.time += h;
        if self.state.is_sound() {
            return true;
        }
        self.state = before;
        false
    }
}

struct OneStep<'a> {
    setup: &'a Setup,
    law: &'a Forces<'a>,
    floor: Option<(&'a Floor, &'a ContactSettings)>,
    h: f64,
    state: &'a mut BodyState,
    memory: &'a mut SchemeMemory,
    contact: &'a mut ContactState,
}

impl SchemeVisitor for OneStep<'_> {
    type Output = StepOutcome;

    fn visit<S: Scheme>(self) -> StepOutcome {
        let body = &self.setup.body;
        match self.floor {
            Some((floor, settings)) if may_touch(floor, body, self.state, self.law, self.h) => {
                step_on_floor::<S, _>(
                    floor,
                    settings,
                    body,
                    self.state,
                    self.law,
                    self.h,
                    self.memory,
                    self.contact,
                    None,
                )
                .step
            }
            _ => S::step(body, self.state, self.law, self.h, self.memory),
        }
    }
}
