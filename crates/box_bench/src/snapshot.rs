//! What a step of the bodies of a scene costs under any integrator: the one definition of that figure for panel, table
//! and benchmarks.
//!
//! A [`Snapshot`] copies bodies, states and contacts of one moment. Each call puts the copies back there and steps them
//! a few times by the path that the plugin takes for that many bodies: in free flight under gravity alone several at a
//! time in SIMD lanes, with other forces one by one, at the floor by the contact solver.

use std::time::Duration;

use box_physics::floor::{
    ContactSettings, ContactState, Floor, FloorContext, may_touch, step_on_floor,
};
use box_physics::force::{ForceModel, Gravity};
use box_physics::integrators::{GravityField, Group, Integrate, IntegratorVisitor};
use box_physics::prelude::{BodyState, Integrator, IntegratorMemory, RigidBox, StepOutcome};
use box_scenarios::ForceSet;

use crate::measure::{Contender, sample};

/// Bodies that are copied at most: as many as the plugin steps in one piece.
const MOST: usize = 512;
/// The same where some are at the floor: a call stays within a few milliseconds.
const MOST_AT_FLOOR: usize = 128;
/// Body-steps in a call, roughly, and the steps that may be.
const BODY_STEPS: usize = 1024;
const STEPS: (usize, usize) = (2, 16);

/// See the module.
#[derive(Clone, Debug)]
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
    steps: usize,
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
            bodies: Vec::new(),
            start: Vec::new(),
            states: Vec::new(),
            contacts: Vec::new(),
            memories: Vec::new(),
            faults: Vec::new(),
            forces: forces.clone(),
            floor,
            h,
            steps: 0,
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

    /// Body-steps in one call.
    pub fn units(&self) -> f64 {
        (self.bodies.len() * self.steps) as f64
    }

    /// From the snapshot's moment, a few steps by `integrator`: what is timed.
    pub fn call(&mut self, integrator: Integrator) -> StepOutcome {
        integrator.dispatch(Call(self))
    }

    /// One sample of at least `shortest` under `integrator`.
    pub fn time(&mut self, integrator: Integrator, shortest: Duration) -> Sample {
        let evaluations = self.call(integrator).evaluations as f64 / self.units();
        let mut contender = Contender::new(self.units(), || {
            std::hint::black_box(self.call(integrator));
        });
        Sample {
            nanoseconds: sample(&mut contender, shortest),
            evaluations,
        }
    }

    fn is_at_floor(&self, i: usize, force: &impl ForceModel) -> bool {
        self.floor.as_ref().is_some_and(|(floor, _)| {
            self.contacts[i].touching() != 0
                || may_touch(floor, &self.bodies[i], &self.states[i], force, self.h)
        })
    }

    fn fly<S: Integrate>(&mut self, from: usize, to: usize) -> StepOutcome {
        if from == to {
            return StepOutcome::default();
        }
        S::step_group(
            &mut Group {
                bodies: &self.bodies[from..to],
                states: &mut self.states[from..to],
                memories: &mut self.memories[from..to],
                gravity: GravityField::Uniform(self.forces.gravity),
                faults: &mut self.faults,
            },
            self.h,
        )
    }

    fn step<S: Integrate>(&mut self) -> StepOutcome {
        let mut outcome = StepOutcome::default();
        let (count, only_gravity) = (self.bodies.len(), self.forces.is_gravity_alone());
        if only_gravity && self.floor.is_none() {
            return self.fly::<S>(0, count);
        }
        let gravity = Gravity(self.forces.gravity);
        // In flight, not yet stepped.
        let mut from = 0;
        for i in 0..count {
            if only_gravity {
                if self.is_at_floor(i, &gravity) {
                    outcome += self.fly::<S>(from, i);
                    outcome += self.touch::<S, _>(i, &gravity);
                    from = i + 1;
                }
            } else {
                let forces = core::mem::take(&mut self.forces);
                let force = forces.forces(&self.bodies[i]);
                outcome += if self.is_at_floor(i, &force) {
                    self.touch::<S, _>(i, &force)
                } else {
                    let (body, state) = (&self.bodies[i], &mut self.states[i]);
                    S::step(body, state, &force, self.h, &mut self.memories[i])
                };
                self.forces = forces;
            }
        }
        if only_gravity {
            outcome += self.fly::<S>(from, count);
        }
        outcome
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

struct Call<'a>(&'a mut Snapshot);

impl IntegratorVisitor for Call<'_> {
    type Output = StepOutcome;

    fn visit<S: Integrate>(self) -> StepOutcome {
        let this = self.0;
        this.states.clear();
        this.states.extend(this.start.iter().map(|s| s.0));
        this.contacts.clear();
        this.contacts.extend(this.start.iter().map(|s| s.1.clone()));
        this.faults.clear();
        let mut outcome = StepOutcome::default();
        for _ in 0..this.steps {
            outcome += this.step::<S>();
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bodies::Situation;

    fn snapshot(situation: Situation, n: usize) -> Snapshot {
        let bodies = situation.bodies(n);
        let forces = ForceSet {
            gravity: situation.gravity(),
            ..ForceSet::none()
        };
        let floor = situation.floor().map(|f| (f, ContactSettings::default()));
        let bodies = bodies.iter().map(|(b, s)| (b, s, ContactState::default()));
        Snapshot::new(bodies, &forces, floor, 1.0 / 60.0).expect("bodies")
    }

    /// A call is the plugin's steps: the same bits, for one body and for many, in flight, near the floor, on it.
    #[test]
    fn it_steps_as_the_plugin_does() {
        use crate::plugin_world::PluginWorld;
        for situation in [
            Situation::Flight,
            Situation::Near,
            Situation::Settling,
            Situation::Rest,
        ] {
            for n in [1, 9] {
                let mut snapshot = snapshot(situation, n);
                // Over the clock's step, which is whole nanoseconds.
                snapshot.h = Duration::from_nanos(16_666_667).as_secs_f64();
                let mut world = PluginWorld::new(situation, Integrator::Split, n);
                world.restart();
                snapshot.call(Integrator::Split);
                for _ in 0..snapshot.steps {
                    world.step();
                }
                let world = world.app().world_mut();
                let mut states = world
                    .query::<&BodyState>()
                    .iter(world)
                    .copied()
                    .collect::<Vec<_>>();
                let by_place = |a: &BodyState, b: &BodyState| {
                    let key = |s: &BodyState| {
                        ((s.position.z / 4.0).round(), (s.position.x / 4.0).round())
                    };
                    key(a).partial_cmp(&key(b)).expect("finite")
                };
                states.sort_by(by_place);
                let mut ours = snapshot.states.clone();
                ours.sort_by(by_place);
                assert_eq!(states, ours, "{} bodies: {}", n, situation.name());
            }
        }
    }

    /// Many bodies in flight are stepped in SIMD lanes: cheaper than one by one. Where forces forbid that, they are not.
    #[test]
    fn many_bodies_in_flight_share_lanes() {
        let cost = |n: usize, forces: ForceSet| {
            let mut s = snapshot(Situation::Flight, n);
            s.forces = forces;
            (0..5)
                .map(|_| {
                    s.time(Integrator::Split, Duration::from_micros(200))
                        .nanoseconds
                })
                .fold(f64::MAX, f64::min)
        };
        let (one, many) = (cost(1, ForceSet::none()), cost(512, ForceSet::none()));
        assert!(many < 0.7 * one, "one {one} ns, of many {many} ns");
        let drag = ForceSet {
            linear_drag: 0.1,
            ..ForceSet::none()
        };
        assert!(cost(512, drag) > many);
    }

    #[test]
    fn every_integrator_can_be_timed_anywhere() {
        for situation in Situation::ALL {
            let mut snapshot = snapshot(situation, 3);
            for &i in Integrator::ALL {
                let s = snapshot.time(i, Duration::from_nanos(1));
                assert!(s.nanoseconds > 0.0 && s.nanoseconds.is_finite(), "{i}");
                // A box at rest is not evaluated.
                let moves = situation != Situation::Rest;
                assert!(s.evaluations >= 1.0 || !moves, "{i}: {}", situation.name());
            }
        }
        let none = std::iter::empty::<(&RigidBox, &BodyState, ContactState)>();
        assert!(Snapshot::new(none, &ForceSet::none(), None, 0.1).is_none());
    }
}
