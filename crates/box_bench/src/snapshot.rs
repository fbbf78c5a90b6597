//! The cost of a step of a scene's bodies under each integrator. It is defined only here, for panel, headless table,
//! sweep, report and benchmarks.
//!
//! A [`Snapshot`] copies the bodies, states and contacts at one time. Each call resets the copies and steps them by the
//! path that the plugin takes for this number of bodies. In free flight under gravity alone, several bodies are stepped
//! at a time in SIMD lanes; under other forces, [`ForcedGroup::step_each`] steps them; at the floor, the contact solver
//! does. A call takes a few steps ([`Snapshot::new`]) or those of a whole scene ([`Snapshot::of_scene`]).
//!
//! All integrators take turns on the same snapshot ([`measure`](crate::measure)). The cost is the **minimum** of the
//! samples, in ns per body-step; the median shows how quiet the machine was. The optional second cost is that of a
//! single body stepped by the integrator's plain step ([`lone_body`]).

use core::ops::Range;

use box_physics::floor::{
    ContactSettings, ContactState, Floor, FloorContext, may_touch, step_on_floor,
};
use box_physics::force::{ForceModel, Gravity};
use box_physics::integrators::{ForcedGroup, GravityField, Group, Integrate, IntegratorVisitor};
use box_physics::prelude::{BodyState, DVec3, Integrator, IntegratorMemory, RigidBox, StepOutcome};
use box_scenarios::{Driver, ForceSet, Model, Setup};

use crate::measure::{Contender, Cost, Settings, interleaved};

/// Maximum number of bodies that are copied: the size of the plugin's chunks.
const MAX_BODIES: usize = 512;
/// Maximum number of bodies if some are at the floor, so that a call takes at most a few milliseconds.
const MAX_BODIES_AT_FLOOR: usize = 128;
/// Approximate number of body-steps per call, and the range of the number of steps.
const BODY_STEPS: usize = 1024;
const STEPS: (usize, usize) = (4, 16);
/// Maximum number of body-steps in a call over a whole scene. The minimum number of bodies, which is enough for the
/// plugin's path for many bodies, takes precedence.
const SCENE_BODY_STEPS: usize = 65_536;
const SCENE_BODIES: usize = 32;
/// Maximum simulated time of a scene \[s\].
pub const LONGEST_SCENE: f64 = 10.0;

/// Copies of the bodies of a scene at one time; see the [module](self).
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
    /// Number of steps per call, and the number that [`Self::advance`] has taken.
    steps: usize,
    done: usize,
}

impl Snapshot {
    /// Copies `bodies` under `forces`, over an optional floor, with steps of `h` \[s\]. Returns `None` without bodies,
    /// or if `h` is not positive.
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
        for (body, state, contact) in bodies.take(MAX_BODIES) {
            at_floor |= this.floor.as_ref().is_some_and(|(floor, _)| {
                contact.touching() != 0 || may_touch(floor, body, state, &forces.forces(body), h)
            });
            if at_floor && this.bodies.len() >= MAX_BODIES_AT_FLOOR {
                break;
            }
            this.bodies.push(*body);
            this.start.push((*state, contact));
        }
        if at_floor {
            this.bodies.truncate(MAX_BODIES_AT_FLOOR);
            this.start.truncate(MAX_BODIES_AT_FLOOR);
        }
        let count = this.bodies.len();
        this.memories = vec![IntegratorMemory::default(); count];
        this.steps = (BODY_STEPS / count.max(1)).clamp(STEPS.0, STEPS.1);
        (count > 0 && h > 0.0).then_some(this)
    }

    /// Creates the snapshot of a scene with `boxes` boxes. A call runs it from the start over its whole duration (at
    /// most [`LONGEST_SCENE`]) in steps of `h` \[s\], without its impulses. If there are many boxes, only some are
    /// simulated, to keep a call short.
    pub fn of_scene(setup: &Setup, boxes: usize, h: f64) -> Option<Self> {
        let steps = (setup.duration.min(LONGEST_SCENE) / h).round().max(1.0) as usize;
        let boxes = boxes.clamp(1, (SCENE_BODY_STEPS / steps).max(SCENE_BODIES));
        let model = Model::of(setup);
        let start =
            std::iter::repeat_with(|| (&setup.body, &setup.initial, ContactState::default()));
        let floor = model.floor().map(|f| (f, model.settings));
        let this = Self::new(start.take(boxes), &setup.forces, floor, h)?;
        Some(Self { steps, ..this })
    }

    /// Measures the costs of `integrators` on this snapshot in turns, and returns them in the same order.
    pub fn costs(&self, integrators: &[Integrator], settings: &Settings) -> Vec<Cost> {
        let mut contenders: Vec<_> = integrators
            .iter()
            .map(|&i| self.clone().contender(i))
            .collect();
        interleaved(&mut contenders, settings)
    }

    /// A contender that makes calls with `integrator`; its units are body-steps.
    pub fn contender(mut self, integrator: Integrator) -> Contender<'static> {
        Contender::counted(self.units(), move || self.work(integrator))
    }

    /// Number of body-steps per call.
    pub fn units(&self) -> f64 {
        (self.bodies.len() * self.steps) as f64
    }

    /// Resets the bodies and takes the steps of a call with `integrator`. This is the timed work.
    pub fn call(&mut self, integrator: Integrator) -> StepOutcome {
        self.restart();
        let steps = self.steps;
        integrator.dispatch(Advance(self, steps))
    }

    /// Takes the next `steps` steps of a call, up to its end. Returns force evaluations plus body-steps, like
    /// [`Self::work`].
    pub fn advance(&mut self, integrator: Integrator, steps: usize) -> u64 {
        let steps = steps.min(self.steps - self.done);
        let evaluations = integrator.dispatch(Advance(self, steps)).evaluations;
        evaluations + (self.bodies.len() * steps) as u64
    }

    /// Returns `true` if no call is in progress, that is, [`Self::advance`] has completed one.
    pub fn is_at_start(&self) -> bool {
        self.done == 0
    }

    /// Aborts the call in progress.
    pub fn restart(&mut self) {
        self.done = 0;
    }

    /// Number of stepped bodies.
    pub fn bodies(&self) -> usize {
        self.bodies.len()
    }

    /// Takes one sample of `integrator`, for a caller that alternates between integrators itself.
    pub fn sample(&mut self, integrator: Integrator, settings: &Settings) -> Sample {
        // The untimed call before a sample, because a new contender makes none.
        let evaluations = self.call(integrator).evaluations as f64 / self.units();
        let units = self.units();
        let mut contender = Contender::counted(units, || self.work(integrator));
        Sample {
            nanoseconds: contender.sample(settings),
            evaluations,
        }
    }

    /// Makes a call and returns force evaluations plus body-steps.
    pub fn work(&mut self, integrator: Integrator) -> u64 {
        self.call(integrator).evaluations + self.units() as u64
    }

    fn is_at_floor(&self, i: usize, force: &impl ForceModel) -> bool {
        self.floor.as_ref().is_some_and(|(floor, _)| {
            self.contacts[i].touching() != 0
                || may_touch(floor, &self.bodies[i], &self.states[i], force, self.h)
        })
    }

    /// Steps consecutive bodies in free flight, under `gravity` alone or each under its own forces.
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
        // First body in flight that has not been stepped.
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

    /// Resets a body that has diverged, so that only steps of valid bodies are timed.
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

/// Takes a number of steps, up to the end of a call.
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

/// One measurement of an integrator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Time per body-step \[ns\].
    pub nanoseconds: f64,
    /// Force evaluations per body-step.
    pub evaluations: f64,
}

/// A contender that runs the single body of `setup` from its start by the integrator's plain step in steps of `h`
/// \[s\], over the whole scene like [`Snapshot::of_scene`]. Its units are steps.
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
