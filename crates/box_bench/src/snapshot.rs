//! The cost of a step of a scene's bodies under each integrator: the one definition of that figure for panel, headless
//! table, sweep, report and benchmarks.
//!
//! A [`Snapshot`] copies the bodies, states and contacts of one moment. Each call puts the copies back there and steps
//! them by the path that the plugin takes for that many bodies: in free flight under gravity alone several at a time in
//! SIMD lanes, with other forces by [`ForcedGroup::step_each`], at the floor by the contact solver. The steps are a few
//! ([`Snapshot::new`]) or those of a whole scene ([`Snapshot::of_scene`]).
//!
//! All integrators take turns on the same snapshot ([`measure`](crate::measure)). The cost is the **minimum** of the
//! samples, in ns per body-step; the median says how quiet the machine was. The second figure, where it is wanted, is
//! that of a lone body by the integrator's plain step ([`lone_body`]).

use core::ops::Range;

use box_physics::floor::{
    ContactSettings, ContactState, Floor, FloorContext, may_touch, step_on_floor,
};
use box_physics::force::{ForceModel, Gravity};
use box_physics::integrators::{ForcedGroup, GravityField, Group, Integrate, IntegratorVisitor};
use box_physics::prelude::{BodyState, DVec3, Integrator, IntegratorMemory, RigidBox, StepOutcome};
use box_scenarios::{Driver, ForceSet, Model, Setup};

use crate::measure::{Contender, Cost, Settings, interleaved};

/// Bodies that are copied at most: as many as the plugin steps in one piece.
const MOST: usize = 512;
/// The same where some are at the floor: a call stays within a few milliseconds.
const MOST_AT_FLOOR: usize = 128;
/// Body-steps in a call, roughly, and the steps that may be.
const BODY_STEPS: usize = 1024;
const STEPS: (usize, usize) = (4, 16);
/// Body-steps in a call that follows a whole scene, unless the bodies that are followed at least make more: enough of
/// them for the plugin's path of many.
const SCENE_BODY_STEPS: usize = 65_536;
const SCENE_BODIES: usize = 32;
/// How much of a scene is followed \[s\].
pub const LONGEST_SCENE: f64 = 10.0;

/// See the module.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    bodies: Vec<RigidBox>,
    start: Vec<(BodyState, ContactState)>,
    states: Vec<BodyState>,
    contacts: Vec<ContactState>,
    memories: Vec<IntegratorMemory>,
    faults: Vec<usize>,
    forces: ForceSet,
    floor: Option<(Floor, ContactSettings)>,
    h: f64,
    /// Steps of a call, and those that [`Self::advance`] has done of it.
    steps: usize,
    done: usize,
}

impl Snapshot {
    /// Of `bodies` under `forces`, over a floor or none, in steps of `h` \[s\]. `None` without bodies or where `h` is
    /// not positive.
    pub fn new<'a>(
        bodies: impl Iterator<Item = (&'a RigidBox, &'a BodyState, ContactState)>,
        forces: &ForceSet,
        floor: Option<(Floor, ContactSettings)>,
        h: f64,
    ) -> Option<Self> {
        let mut this = Self {
            forces: forces.clone(),
            floor,
            h,
            ..Self::default()
        };
        let mut at_floor = false;
        for (body, state, contact) in bodies.take(MOST) {
            at_floor |= this.floor.as_ref().is_some_and(|(floor, _)| {
                contact.touching() != 0 || may_touch(floor, body, state, &forces.forces(body), h)
            });
            if at_floor && this.bodies.len() >= MOST_AT_FLOOR {
                break;
            }
            this.bodies.push(*body);
            this.start.push((*state, contact));
        }
        if at_floor {
            this.bodies.truncate(MOST_AT_FLOOR);
            this.start.truncate(MOST_AT_FLOOR);
        }
        let count = this.bodies.len();
        this.memories = vec![IntegratorMemory::default(); count];
        this.steps = (BODY_STEPS / count.max(1)).clamp(STEPS.0, STEPS.1);
        (count > 0 && h > 0.0).then_some(this)
    }

    /// Of a scene with `boxes` boxes, from its start through its whole duration (at most [`LONGEST_SCENE`]) in steps of
    /// `h` \[s\], without its impulses. Of many boxes a part is followed, so that a call stays short.
    pub fn of_scene(setup: &Setup, boxes: usize, h: f64) -> Option<Self> {
        let steps = (setup.duration.min(LONGEST_SCENE) / h).round().max(1.0) as usize;
        let boxes = boxes.clamp(1, (SCENE_BODY_STEPS / steps).max(SCENE_BODIES));
        let model = Model::of(setup);
        let start =
            std::iter::repeat_with(|| (&setup.body, &setup.initial, ContactState::default()));
        let floor = model.floor.map(|f| (f, model.settings));
        let this = Self::new(start.take(boxes), &setup.forces, floor, h)?;
        Some(Self { steps, ..this })
    }

    /// The costs of `integrators` on this snapshot, in turns, in their order.
    pub fn costs(&self, integrators: &[Integrator], settings: &Settings) -> Vec<Cost> {
        let mut contenders: Vec<_> = integrators
            .iter()
            .map(|&i| self.clone().contender(i))
            .collect();
        interleaved(&mut contenders, settings)
    }

    /// Calls under `integrator`; the units are body-steps.
    pub fn contender(mut self, integrator: Integrator) -> Contender<'static> {
        Contender::counted(self.units(), move || self.work(integrator))
    }

    /// Body-steps in one call.
    pub fn units(&self) -> f64 {
        (self.bodies.len() * self.steps) as f64
    }

    /// From the snapshot's moment, a few steps by `integrator`: what is timed.
    pub fn call(&mut self, integrator: Integrator) -> StepOutcome {
        self.restart();
        let steps = self.steps;
        integrator.dispatch(Advance(self, steps))
    }

    /// The next `steps` steps of a call, but not beyond its end; returns their evaluations and body-steps like
    /// [`Self::work`].
    pub fn advance(&mut self, integrator: Integrator, steps: usize) -> u64 {
        let steps = steps.min(self.steps - self.done);
        let evaluations = integrator.dispatch(Advance(self, steps)).evaluations;
        evaluations + (self.bodies.len() * steps) as u64
    }

    /// Whether no call is in progress: [`Self::advance`] has reached the end of one.
    pub fn is_at_start(&self) -> bool {
        self.done == 0
    }

    /// Gives up the call in progress.
    pub fn restart(&mut self) {
        self.done = 0;
    }

    /// Number of bodies that are stepped.
    pub fn bodies(&self) -> usize {
        self.bodies.len()
    }

    /// One sample under `integrator`, for a caller that lets the integrators take turns itself.
    pub fn sample(&mut self, integrator: Integrator, settings: &Settings) -> Sample {
        // The untimed call before a sample; a new contender makes none.
        let evaluations = self.call(integrator).evaluations as f64 / self.units();
        let units = self.units();
        let mut contender = Contender::counted(units, || self.work(integrator));
        Sample {
            nanoseconds: contender.sample(settings),
            evaluations,
        }
    }

    /// A call; returns its evaluations and body-steps.
    pub fn work(&mut self, integrator: Integrator) -> u64 {
        self.call(integrator).evaluations + self.units() as u64
    }

    fn is_at_floor(&self, i: usize, force: &impl ForceModel) -> bool {
        self.floor.as_ref().is_some_and(|(floor, _)| {
            self.contacts[i].touching() != 0
                || may_touch(floor, &self.bodies[i], &self.states[i], force, self.h)
        })
    }

    /// Consecutive bodies in free flight, under `gravity` alone or each under its own forces.
    fn fly<S: Integrate, F: ForceModel>(
        &mut self,
        range: Range<usize>,
        gravity: Option<DVec3>,
        force: &impl Fn(&RigidBox) -> F,
    ) -> StepOutcome {
        let (h, faults) = (self.h, &mut self.faults);
        let bodies = &self.bodies[range.clone()];
        let states = &mut self.states[range.clone()];
        let memories = &mut self.memories[range];
        let Some(gravity) = gravity else {
            let columns = (bodies, states, memories);
            return ForcedGroup::step_each::<S>(columns, |k| force(&bodies[k]), h, faults);
        };
        let mut group = Group {
            bodies,
            states,
            memories,
            gravity: GravityField::Uniform(gravity),
            faults,
            floor: None,
        };
        S::step_group(&mut group, h)
    }

    fn step<S: Integrate>(&mut self) -> StepOutcome {
        let forces = core::mem::take(&mut self.forces);
        let outcome = if forces.is_gravity_alone() {
            let gravity = Some(forces.gravity);
            self.step_under::<S, _>(gravity, |_| Gravity(forces.gravity))
        } else {
            self.step_under::<S, _>(None, |body| forces.forces(body))
        };
        self.forces = forces;
        outcome
    }

    fn step_under<S: Integrate, F: ForceModel>(
        &mut self,
        gravity: Option<DVec3>,
        force: impl Fn(&RigidBox) -> F,
    ) -> StepOutcome {
        let (mut outcome, count) = (StepOutcome::default(), self.bodies.len());
        if self.floor.is_none() {
            return self.fly::<S, F>(0..count, gravity, &force);
        }
        // In flight, not yet stepped.
        let mut from = 0;
        for i in 0..count {
            let force_here = force(&self.bodies[i]);
            if self.is_at_floor(i, &force_here) {
                outcome += self.fly::<S, F>(from..i, gravity, &force);
                outcome += self.touch::<S, F>(i, &force_here);
                self.restore_if_invalid(i);
                from = i + 1;
            }
        }
        outcome += self.fly::<S, F>(from..count, gravity, &force);
        outcome
    }

    /// A body that an integrator makes diverge begins again: what is timed are steps of valid bodies.
    fn restore_if_invalid(&mut self, i: usize) {
        if !self.states[i].is_valid() {
            (self.states[i], self.contacts[i]) = self.start[i].clone();
        }
    }

    fn touch<S: Integrate, F: ForceModel>(&mut self, i: usize, force: &F) -> StepOutcome {
        let Some((floor, settings)) = &self.floor else {
            return StepOutcome::default();
        };
        let context = FloorContext {
            floor,
            settings,
            body: &self.bodies[i],
            force,
        };
        let (state, memory) = (&mut self.states[i], &mut self.memories[i]);
        step_on_floor::<S, F>(&context, state, self.h, memory, &mut self.contacts[i], None).step
    }
}

/// A number of steps, not beyond the end of a call.
struct Advance<'a>(&'a mut Snapshot, usize);

impl IntegratorVisitor for Advance<'_> {
    type Output = StepOutcome;

    fn visit<S: Integrate>(self) -> StepOutcome {
        let Self(this, steps) = self;
        if this.done == 0 {
            this.states.clear();
            this.states.extend(this.start.iter().map(|s| s.0));
            this.contacts.clear();
            this.contacts.extend(this.start.iter().map(|s| s.1.clone()));
            this.faults.clear();
        }
        let mut outcome = StepOutcome::default();
        for _ in 0..steps {
            outcome += this.step::<S>();
        }
        this.done = (this.done + steps) % this.steps;
        std::hint::black_box(&this.states);
        outcome
    }
}

/// One measurement of one integrator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// ns per body-step.
    pub nanoseconds: f64,
    /// Force evaluations per body-step.
    pub evaluations: f64,
}

/// The lone body of `setup` from its start by the integrator's plain step in steps of `h` \[s\], over the whole scene
/// like [`Snapshot::of_scene`]; the units are steps.
pub fn lone_body(setup: &Setup, integrator: Integrator, h: f64) -> Contender<'static> {
    let steps = (setup.duration.min(LONGEST_SCENE) / h).round().max(1.0) as u64;
    let (model, start) = (Model::of(setup), setup.initial);
    Contender::counted(steps as f64, move || {
        let mut driver = Driver::new(start, integrator);
        driver.run(&model, h, steps, u64::MAX);
        std::hint::black_box(driver.state);
        driver.totals.evaluations + steps
    })
}

#[cfg(test)]
mod tests;
