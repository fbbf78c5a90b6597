//! Undo and redo of parameters, integrators and restarts, with one entry per frame with changes.

use core::time::Duration;

use bevy::prelude::*;
use box_physics::prelude::{GlobalIntegrator, Integrator};

use super::rewind::Moment;
use crate::action::{Action, Actions};
use crate::parameters::{Effect, Parameter, Parameters};
use crate::scene::session::Session;
use crate::scene::start::{SceneOpened, take_effect};

/// Maximum number of changes kept.
const MAX_CHANGES: usize = 100;
/// Time within which changes of the same kind are merged, such as a drag of a slider.
const ONE_GESTURE: Duration = Duration::from_millis(700);

/// Settings that undo restores, and the number of the scene's start.
type Settings = (Parameters, Integrator, u32);

/// The settings before a change.
#[derive(Clone, Debug)]
struct Entry {
    settings: Settings,
    /// The boxes, if the change restarts the scene.
    moment: Option<Moment>,
    /// Name of the change.
    what: &'static str,
}

/// Changes to undo and to redo.
#[derive(Resource, Debug, Default)]
pub struct UndoStack {
    past: Vec<Entry>,
    future: Vec<Entry>,
    /// The settings before a possible change in this frame.
    pending: Option<Entry>,
    /// Name and time of the last change.
    last: Option<(&'static str, Duration)>,
}

impl UndoStack {
    /// Name of the next change to undo.
    pub fn undoes(&self) -> Option<&'static str> {
        self.past.last().map(|e| e.what)
    }

    /// Name of the next change to redo.
    pub fn redoes(&self) -> Option<&'static str> {
        self.future.last().map(|e| e.what)
    }
}

/// Name of the change that an action makes, and `true` if it restarts the scene. `None` if it cannot be undone.
fn change(action: &Action) -> Option<(&'static str, bool)> {
    match action {
        Action::SetIntegrator(_) => Some(("Integrator", false)),
        Action::Restart => Some(("Restart", true)),
        Action::ResetParameters => Some(("Reset", true)),
        Action::Set(parameter, _) => {
            let info = parameter.info();
            Some((info.label, info.effect == Effect::Restart))
        }
        _ => None,
    }
}

impl Entry {
    fn now(world: &mut World, what: &'static str, restarts: bool) -> Self {
        let session = world.resource::<Session>();
        let integrator = world.resource::<GlobalIntegrator>().0;
        Self {
            settings: (session.parameters, integrator, session.run),
            moment: restarts.then(|| Moment::now(world)).flatten(),
            what,
        }
    }

    /// Restores the entry, and returns the previous settings.
    fn swap(self, world: &mut World) -> Self {
        let before = Self::now(world, self.what, self.moment.is_some());
        let ((old, old_integrator, _), (new, integrator, _)) = (before.settings, self.settings);
        let event = format!("undo {}", self.what);
        world.resource_mut::<Session>().parameters = new;
        let changed = |p: &Parameter| old.get(*p) != new.get(*p);
        let changes = || Parameter::ALL.into_iter().filter(changed);
        for effect in [Effect::Clock, Effect::Live, Effect::Restart] {
            let restart = effect == Effect::Restart && self.moment.is_some();
            if restart || changes().any(|p| p.info().effect == effect) {
                take_effect(world, effect, event.clone());
            }
        }
        if old_integrator != integrator {
            world.trigger(Action::SetIntegrator(integrator));
        }
        if let Some(moment) = &self.moment {
            moment.restore(world);
            // The scene's reference starts at the scene's start, not at this moment.
            world.resource_mut::<Session>().perturb(event);
        }
        before
    }
}

/// Stores the settings before the actions of a frame, if one of them can be undone.
pub fn remember(world: &mut World) {
    let actions = &world.resource::<Actions>().0;
    if actions.contains(&Action::Undo) || actions.contains(&Action::Redo) {
        return;
    }
    let changes: Vec<_> = actions.iter().filter_map(change).collect();
    if let Some(&(what, _)) = changes.first() {
        let restarts = changes.iter().any(|change| change.1);
        let entry = Entry::now(world, what, restarts);
        world.resource_mut::<UndoStack>().pending = Some(entry);
    }
}

/// Keeps the settings from [`remember`], if the frame changed them.
pub fn keep(world: &mut World) {
    let Some(entry) = world.resource_mut::<UndoStack>().pending.take() else {
        return;
    };
    if Entry::now(world, entry.what, false).settings == entry.settings {
        return;
    }
    let now = world.resource::<Time<Real>>().elapsed();
    let mut stack = world.resource_mut::<UndoStack>();
    stack.future.clear();
    let dragging = entry.moment.is_none()
        && stack.last.is_some_and(|(what, then)| {
            what == entry.what && now.saturating_sub(then) < ONE_GESTURE
        });
    stack.last = Some((entry.what, now));
    if !dragging {
        stack.past.push(entry);
        if stack.past.len() > MAX_CHANGES {
            stack.past.remove(0);
        }
    }
}

/// Observes undo and redo.
pub fn on_action(action: On<Action>, mut stack: ResMut<UndoStack>, mut commands: Commands) {
    let undo = match *action {
        Action::Undo => true,
        Action::Redo => false,
        _ => return,
    };
    stack.last = None;
    let stack = &mut *stack;
    let from = if undo {
        &mut stack.past
    } else {
        &mut stack.future
    };
    let Some(entry) = from.pop() else {
        return;
    };
    commands.queue(move |world: &mut World| {
        let before = entry.swap(world);
        let stack = &mut *world.resource_mut::<UndoStack>();
        let to = if undo {
            &mut stack.future
        } else {
            &mut stack.past
        };
        to.push(before);
    });
}

/// Clears the changes of the previous scene.
pub fn forget(_: On<SceneOpened>, mut stack: ResMut<UndoStack>) {
    *stack = UndoStack::default();
}
