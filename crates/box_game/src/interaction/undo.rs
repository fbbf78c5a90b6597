//! Taking back a change of a parameter, or a reset.

use core::mem::{Discriminant, discriminant};
use core::time::Duration;

use bevy::prelude::*;
use box_physics::prelude::{GlobalIntegrator, Integrator, PhysicsClock};

use super::rewind::Moment;
use crate::action::Action;
use crate::apply::{live_parameters, set_step};
use crate::scene::session::{Session, start_scene};
use crate::ui::panel::Parameters;

/// The most changes that are kept.
const MOST: usize = 100;
/// Changes of one thing closer than this are one: a slider being dragged.
const ONE_GESTURE: Duration = Duration::from_millis(700);

/// What can be taken back.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Settings {
    parameters: Parameters,
    integrator: Integrator,
    step: Duration,
    substeps: u32,
}

/// How it was before a change.
#[derive(Clone, Debug)]
struct Entry {
    settings: Settings,
    /// Where the boxes were, if the change put them elsewhere.
    moment: Option<Moment>,
    /// In words: "gravity".
    what: &'static str,
}

/// Changes that can be taken back, and those that were.
#[derive(Resource, Debug, Default)]
pub struct UndoStack {
    past: Vec<Entry>,
    future: Vec<Entry>,
    last: Option<(Discriminant<Action>, Duration)>,
}

impl UndoStack {
    /// What the next undo takes back.
    pub fn undoes(&self) -> Option<&'static str> {
        self.past.last().map(|e| e.what)
    }

    /// What the next redo does again.
    pub fn redoes(&self) -> Option<&'static str> {
        self.future.last().map(|e| e.what)
    }

    /// Forgets everything: another scene.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

/// What an action changes, in words, and whether it moves boxes; `None` if it cannot be taken back.
fn kind(action: &Action) -> Option<(&'static str, bool)> {
    Some(match action {
        Action::SetIntegrator(_) => ("integrator", false),
        Action::SetStep(_) => ("dt", false),
        Action::SetSubsteps(_) => ("substeps", false),
        Action::SetGravity(_) => ("gravity", false),
        Action::SetRestitution(_) => ("restitution", false),
        Action::SetFriction(_) => ("friction", false),
        Action::SetLinearDrag(_) => ("linear drag", false),
        Action::SetAngularDamping(_) => ("angular damping", false),
        Action::SetImpulse(_) => ("strength", false),
        Action::SetHalfExtents(_) => ("size", true),
        Action::SetMass(_) => ("mass", true),
        Action::SetBoxes(_) => ("boxes", true),
        Action::Restart => ("restart", true),
        Action::ResetParameters => ("reset", true),
        _ => return None,
    })
}

fn settings(world: &World) -> Settings {
    Settings {
        parameters: world.resource::<Session>().parameters,
        integrator: world.resource::<GlobalIntegrator>().0,
        step: world.resource::<Time<Fixed>>().timestep(),
        substeps: world.resource::<PhysicsClock>().substeps,
    }
}

/// Carries out `action` by `apply`, and keeps what it changed.
pub fn around(world: &mut World, action: Action, apply: fn(&mut World, Action)) {
    let Some((what, moves)) = kind(&action) else {
        apply(world, action);
        return;
    };
    let entry = Entry {
        settings: settings(world),
        moment: if moves { Moment::now(world) } else { None },
        what,
    };
    let same = discriminant(&action);
    apply(world, action);
    let changed = settings(world) != entry.settings || what == "restart";
    if !changed {
        return;
    }
    let now = world.resource::<Time<Real>>().elapsed();
    let mut stack = world.resource_mut::<UndoStack>();
    stack.future.clear();
    let dragging = !moves
        && stack
            .last
            .is_some_and(|(before, then)| before == same && now.saturating_sub(then) < ONE_GESTURE);
    stack.last = Some((same, now));
    if !dragging {
        stack.past.push(entry);
        if stack.past.len() > MOST {
            stack.past.remove(0);
        }
    }
}

/// Takes back the last change.
pub fn undo(world: &mut World) {
    let entry = world.resource_mut::<UndoStack>().past.pop();
    if let Some(entry) = entry {
        let now = swap(world, entry);
        world.resource_mut::<UndoStack>().future.push(now);
    }
}

/// Does the last change again that was taken back.
pub fn redo(world: &mut World) {
    let entry = world.resource_mut::<UndoStack>().future.pop();
    if let Some(entry) = entry {
        let now = swap(world, entry);
        world.resource_mut::<UndoStack>().past.push(now);
    }
}

/// Puts `entry` into place and returns what was there.
fn swap(world: &mut World, entry: Entry) -> Entry {
    let moves = entry.moment.is_some();
    let before = Entry {
        settings: settings(world),
        moment: if moves { Moment::now(world) } else { None },
        what: entry.what,
    };
    let wanted = entry.settings;
    world.resource_mut::<Session>().parameters = wanted.parameters;
    world.insert_resource(GlobalIntegrator(wanted.integrator));
    world.resource_mut::<PhysicsClock>().substeps = wanted.substeps;
    if wanted.step != before.settings.step {
        set_step(world, wanted.step.as_secs_f64());
        world
            .resource_mut::<Time<Fixed>>()
            .set_timestep(wanted.step);
    }
    if moves {
        start_scene(world);
    } else if wanted.parameters != before.settings.parameters {
        live_parameters(world, format!("undo {}", entry.what));
    }
    if let Some(moment) = &entry.moment {
        moment.restore(world);
        // The boxes go on from where they were, not from the start that the trusted answer knows.
        world
            .resource_mut::<Session>()
            .perturb(format!("undo {}", entry.what));
    }
    let mut stack = world.resource_mut::<UndoStack>();
    stack.last = None;
    before
}
