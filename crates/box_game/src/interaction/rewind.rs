//! Stepping back: complete states before the last ticks, from which the motion repeats bit for bit.

use std::collections::VecDeque;

use bevy::ecs::system::Command;
use bevy::prelude::*;
use box_physics::floor::ContactState;
use box_physics::prelude::{
    BodySnapshot, BodyState, IntegratorMemory, PhysicsClock, RestingSince, StepPhysics,
};
use box_scenarios::dissertation;

use crate::action::Action;
use crate::demo_2012::Demo2012;
use crate::scene::session::{BoxNumber, Session};
use crate::scene::start::SceneOpened;

/// Maximum number of ticks kept: half a minute at 60 Hz.
pub const MAX_TICKS: usize = 2000;
/// Maximum number of steps in one action.
const MAX_STEPS: u32 = 10_000;
/// Maximum number of bodies in a scene for stepping back.
pub const MAX_BODIES: usize = 1000;
/// Maximum number of bodies kept over all ticks: about 50 MB.
const BUDGET: usize = 80_000;

/// All data that determine the motion, between two ticks.
#[derive(Clone, Debug)]
pub struct Moment {
    clock: PhysicsClock,
    next_impulse: usize,
    demo: Option<dissertation::State>,
    /// Sorted by number.
    bodies: Vec<(BoxNumber, BodySnapshot)>,
}

impl Moment {
    /// The current moment; `None` with more than [`MAX_BODIES`] bodies.
    pub fn now(world: &mut World) -> Option<Self> {
        let mut bodies = world.query::<(
            &BoxNumber,
            &BodyState,
            &IntegratorMemory,
            &ContactState,
            &RestingSince,
        )>();
        if bodies.iter(world).len() > MAX_BODIES {
            return None;
        }
        let bodies = bodies
            .iter(world)
            .map(|(&number, &state, memory, contact, &resting)| {
                let (memory, contact) = (memory.clone(), contact.clone());
                let body = BodySnapshot {
                    state,
                    memory,
                    contact,
                    resting,
                };
                (number, body)
            });
        let mut bodies: Vec<_> = bodies.collect();
        bodies.sort_unstable_by_key(|body| body.0);
        Some(Self {
            clock: *world.resource::<PhysicsClock>(),
            next_impulse: world.resource::<Session>().next_impulse,
            demo: world.resource::<Demo2012>().state,
            bodies,
        })
    }

    /// Restores everything except pause, substeps and step size.
    pub fn restore(&self, world: &mut World) {
        let present = *world.resource::<PhysicsClock>();
        let mut clock = self.clock;
        (clock.paused, clock.substeps) = (present.paused, present.substeps);
        world.insert_resource(clock);
        world.resource_mut::<Session>().next_impulse = self.next_impulse;
        world.resource_mut::<Demo2012>().state = self.demo;
        let mut boxes = world.query::<(Entity, &BoxNumber)>();
        let boxes: Vec<_> = boxes.iter(world).map(|(e, number)| (e, *number)).collect();
        for (entity, number) in boxes {
            if let Ok(at) = self.bodies.binary_search_by_key(&number, |body| body.0) {
                world.entity_mut(entity).insert(self.bodies[at].1.clone());
            }
        }
    }
}

/// The last moments, oldest first.
#[derive(Resource, Clone, Debug, Default)]
pub struct Rewind {
    ring: VecDeque<Moment>,
}

impl Rewind {
    /// Number of moments stored.
    pub fn kept(&self) -> usize {
        self.ring.len()
    }

    fn push(&mut self, moment: Moment) {
        // After a restart or a step back, removes moments that are no longer in the past.
        let future = |last: &mut Moment| last.clock.steps() >= moment.clock.steps();
        while self.ring.pop_back_if(future).is_some() {}
        let bodies = moment.bodies.len().max(1);
        self.ring.push_back(moment);
        while self.ring.len() > MAX_TICKS.min(BUDGET / bodies) {
            self.ring.pop_front();
        }
    }
}

/// Observes steps forward and back.
pub fn on_action(action: On<Action>, mut commands: Commands) {
    match *action {
        Action::Step(n) => commands.queue(move |world: &mut World| {
            world.resource_mut::<PhysicsClock>().paused = true;
            for _ in 0..n.min(MAX_STEPS) {
                keep(world);
                StepPhysics(1).apply(world);
            }
        }),
        Action::StepBack(n) => commands.queue(move |world: &mut World| step_back(world, n)),
        _ => {}
    }
}

/// Clears the past of the previous scene.
pub fn forget(_: On<SceneOpened>, mut rewind: ResMut<Rewind>) {
    rewind.ring.clear();
}

/// Stores the moment before a tick.
fn keep(world: &mut World) {
    match Moment::now(world) {
        Some(moment) => world.resource_mut::<Rewind>().push(moment),
        None => world.resource_mut::<Rewind>().ring.clear(),
    }
}

/// Stores the moment before every tick of the running clock.
pub fn record(world: &mut World) {
    if !world.resource::<PhysicsClock>().paused {
        keep(world);
    }
}

/// Steps back by `ticks`, or to the oldest moment, and pauses.
fn step_back(world: &mut World, ticks: u32) {
    world.resource_mut::<PhysicsClock>().paused = true;
    let steps = world.resource::<PhysicsClock>().steps();
    let mut rewind = world.resource_mut::<Rewind>();
    // Skips moments from before a restart.
    let past = core::iter::from_fn(|| rewind.ring.pop_back());
    let target = past
        .filter(|moment| moment.clock.steps() < steps)
        .take(ticks as usize)
        .last();
    match target {
        Some(moment) => {
            moment.restore(world);
            let mut session = world.resource_mut::<Session>();
            session.events.push("step back".to_owned());
        }
        None => world.resource_mut::<Session>().notice(
            "No earlier step is stored (limits: 2000 steps, 80 000 box states, 1000 boxes).",
        ),
    }
}
