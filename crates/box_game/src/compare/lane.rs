//! One integrator on one scene, outside the ECS: the core with a clock of its own, stepped as the plugin
//! steps a body, bit for bit.

use box_physics::floor::{
    ContactSettings, ContactState, Floor, FloorContext, may_touch, step_on_floor,
};
use box_physics::integrators::{Integrate, IntegratorVisitor};
use box_physics::prelude::{
    BodyState, DVec3, Dissipation, ForceModel, Gravity, Integrator, IntegratorMemory, RigidBox,
    StepOutcome,
};
use box_scenarios::{FloorSpec, ForceSet, Setup};

/// A box and what acts on it; without its state.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// The box.
    pub body: RigidBox,
    /// What acts on it.
    pub forces: ForceSet,
    /// The floor, if there is one.
    pub floor: Option<Floor>,
}

impl Law {
    /// That of a setup. A floor out of range (a scene's tests see to it that there is none) is left out.
    pub fn of(setup: &Setup) -> Self {
        Self {
            body: setup.body,
            forces: setup.forces.clone(),
            floor: setup
                .floor
                .and_then(|f| Floor::new(f.height, f.restitution, f.friction).ok()),
        }
    }

    /// The motion from `state` under this law for `duration` \[s\], without impulses.
    pub fn setup(&self, state: BodyState, duration: f64) -> Setup {
        let setup = Setup::new(self.body, state, self.forces.clone(), duration);
        match &self.floor {
            Some(f) => setup.with_floor(FloorSpec {
                height: f.height,
                restitution: f.restitution,
                friction: f.friction,
            }),
            None => setup,
        }
    }

    /// Kinetic and potential energy \[J\].
    pub fn energy(&self, state: &BodyState) -> f64 {
        box_physics::energy::total_energy(&self.body, state, &self.forces.forces(&self.body))
    }

    /// Whether no force takes or gives energy (the floor apart).
    pub fn is_conservative(&self) -> bool {
        box_physics::energy::is_conservative(&self.forces.forces(&self.body))
    }

    /// Whether the floor may act on a box in this state within `h` \[s\].
    pub fn meets_floor(&self, state: &BodyState, h: f64) -> bool {
        let law = self.forces.forces(&self.body);
        self.floor
            .is_some_and(|floor| may_touch(&floor, &self.body, state, &law, h))
    }

    /// Whether gravity is all that acts: the plugin's table has then no force component, and its loop
    /// is compiled for that.
    fn only_gravity(&self) -> bool {
        let f = &self.forces;
        !f.has_wrench() && f.dissipation() == Dissipation::NONE && f.force == DVec3::ZERO
    }
}

/// A box under `integrator`, stepped by hand.
#[derive(Clone, Debug)]
pub struct Lane {
    /// The integrator.
    pub integrator: Integrator,
    /// Its present state.
    pub state: BodyState,
    /// Simulated time \[s\].
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// What they cost.
    pub outcome: StepOutcome,
    pub(crate) memory: IntegratorMemory,
    pub(crate) contact: ContactState,
}

/// What one step met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stepped {
    /// Whether the new state is sound; if not, the lane has stopped at its last good state.
    pub sound: bool,
    /// Impacts on the floor.
    pub impacts: u32,
}

impl Lane {
    /// In `state` at time 0.
    pub fn new(state: BodyState, integrator: Integrator) -> Self {
        Self {
            integrator,
            state,
            time: 0.0,
            steps: 0,
            outcome: StepOutcome::default(),
            memory: IntegratorMemory::default(),
            contact: ContactState::default(),
        }
    }

    /// The same at another time \[s\].
    #[must_use]
    pub fn at_time(mut self, time: f64) -> Self {
        self.time = time;
        self
    }

    /// Corners at the floor at the end of the last step.
    pub fn contacts(&self) -> u32 {
        self.contact.touching().count_ones()
    }

    /// One step of `h` \[s\].
    pub fn step(&mut self, law: &Law, h: f64) -> Stepped {
        let before = self.state;
        let forces = law.forces.forces(&law.body);
        let (outcome, impacts) = if law.only_gravity() {
            let gravity = Gravity(forces.acceleration);
            self.integrator
                .dispatch(OneStep::new(self, law, &gravity, h))
        } else {
            self.integrator
                .dispatch(OneStep::new(self, law, &forces, h))
        };
        self.outcome += outcome;
        self.steps += 1;
        self.time += h;
        let sound = self.state.is_valid();
        if !sound {
            self.state = before;
        }
        Stepped { sound, impacts }
    }
}

struct OneStep<'a, F> {
    body: &'a RigidBox,
    floor: Option<&'a Floor>,
    law: &'a F,
    h: f64,
    state: &'a mut BodyState,
    memory: &'a mut IntegratorMemory,
    contact: &'a mut ContactState,
}

impl<'a, F> OneStep<'a, F> {
    fn new(lane: &'a mut Lane, whole: &'a Law, law: &'a F, h: f64) -> Self {
        Self {
            body: &whole.body,
            floor: whole.floor.as_ref(),
            law,
            h,
            state: &mut lane.state,
            memory: &mut lane.memory,
            contact: &mut lane.contact,
        }
    }
}

impl<F: ForceModel> IntegratorVisitor for OneStep<'_, F> {
    type Output = (StepOutcome, u32);

    fn visit<S: Integrate>(self) -> Self::Output {
        let (body, law, h) = (self.body, self.law, self.h);
        match self.floor {
            Some(floor)
                if self.contact.touching() != 0 || may_touch(floor, body, self.state, law, h) =>
            {
                let settings = ContactSettings::default();
                let outcome = step_on_floor::<S, _>(
                    &FloorContext {
                        floor,
                        settings: &settings,
                        body,
                        force: law,
                    },
                    self.state,
                    h,
                    self.memory,
                    self.contact,
                    None,
                );
                (outcome.step, outcome.impacts)
            }
            _ => (S::step(body, self.state, law, h, self.memory), 0),
        }
    }
}
