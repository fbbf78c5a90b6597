//! A world with physics, as the tests of the plugin play it.

#![allow(dead_code, reason = "each test uses a part")]

use bevy::app::Plugins;
use bevy::ecs::component::Mutable;
use bevy::ecs::message::Messages;
use bevy::ecs::system::Command;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

/// An app in which every `update` is exactly one tick of 1/60 s.
pub(crate) fn app() -> App {
    app_with(PhysicsPlugins::default())
}

/// [`app`] with these plugins of the physics.
pub(crate) fn app_with<M>(physics: impl Plugins<M>) -> App {
    let mut app = App::new();
    app.add_plugins(MinimalPlugins)
        .add_plugins(physics)
        .insert_resource(Time::<Fixed>::from_hz(60.0))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    // The first update only starts the clock.
    app.update();
    app.world_mut().resource_mut::<PhysicsClock>().reset();
    app
}

/// The box of most tests: 1 × ½ × ¼ m, 3 kg.
pub(crate) fn brick() -> RigidBox {
    RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid")
}

/// A brick in flight, far from the floor.
pub(crate) fn tumbling() -> BodyState {
    BodyState::at(DVec3::new(0.1, 50.0, 0.2))
        .with_velocity(DVec3::new(1.0, 2.0, 3.0))
        .with_angular_velocity(&brick(), DVec3::new(1.5, 2.5, 1.0))
}

/// Operations of the tests on an app.
pub(crate) trait Play {
    /// Updates `updates` times.
    fn play(&mut self, updates: u32);
    /// Takes steps at once, whatever the clock does.
    fn step(&mut self, steps: u32);
    /// Stops the clock of the physics.
    fn pause(&mut self);
    /// The clock of the physics.
    fn clock(&self) -> PhysicsClock;
    /// A new entity.
    fn spawn(&mut self, parts: impl Bundle) -> Entity;
    /// Sends a message.
    fn send(&mut self, message: impl Message);
    /// Applies a command at once.
    fn queue(&mut self, command: impl Command<Out = ()>);
    /// An entity, to insert and remove components.
    fn entity(&mut self, entity: Entity) -> EntityWorldMut<'_>;
    /// Takes all messages of a kind.
    fn drain<M: Message>(&mut self) -> Vec<M>;
    /// A component of an entity that has it.
    fn get<C: Component>(&self, entity: Entity) -> &C;
    /// A component of an entity that has it, to be changed.
    fn edit<C: Component<Mutability = Mutable>>(&mut self, entity: Entity) -> Mut<'_, C>;
    /// The state of a body.
    fn state(&self, body: Entity) -> BodyState;
}

impl Play for App {
    fn play(&mut self, updates: u32) {
        (0..updates).for_each(|_| self.update());
    }

    fn step(&mut self, steps: u32) {
        self.queue(StepPhysics(steps));
    }

    fn pause(&mut self) {
        self.world_mut().resource_mut::<PhysicsClock>().paused = true;
    }

    fn clock(&self) -> PhysicsClock {
        *self.world().resource::<PhysicsClock>()
    }

    fn spawn(&mut self, parts: impl Bundle) -> Entity {
        self.world_mut().spawn(parts).id()
    }

    fn send(&mut self, message: impl Message) {
        self.world_mut().write_message(message);
    }

    fn queue(&mut self, command: impl Command<Out = ()>) {
        self.world_mut().commands().queue(command);
        self.world_mut().flush();
    }

    fn entity(&mut self, entity: Entity) -> EntityWorldMut<'_> {
        self.world_mut().entity_mut(entity)
    }

    fn drain<M: Message>(&mut self) -> Vec<M> {
        let mut messages = self.world_mut().resource_mut::<Messages<M>>();
        messages.drain().collect()
    }

    fn get<C: Component>(&self, entity: Entity) -> &C {
        self.world().get(entity).expect("its component")
    }

    fn edit<C: Component<Mutability = Mutable>>(&mut self, entity: Entity) -> Mut<'_, C> {
        self.world_mut().get_mut(entity).expect("its component")
    }

    fn state(&self, body: Entity) -> BodyState {
        *self.get(body)
    }
}
