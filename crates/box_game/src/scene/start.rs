//! Opening, starting and changing a scene.

use bevy::prelude::*;
use box_physics::prelude::{
    AngularDamping, AngularDrag, BodyState, BodyTorque, ContactSettings, ExternalForce, Floor,
    Friction, GlobalIntegrator, LinearDrag, PhysicsClock, PointForces, QuadraticDrag,
    ReportPersisting, Restitution, RigidBox, Springs, StaticPlane, WorldGravity,
};
use box_scenarios::{ForceSet, ReferenceSolution, Scenario, Setup};

use super::boxes::place;
use super::clock::{set_speed, set_step};
use super::session::{BoxNumber, MainBox, SceneEntity, Session};
use crate::action::Action;
use crate::parameters::{Effect, Parameter, Parameters};

/// Event: a scene was opened, or reloaded from its file.
#[derive(Event, Clone, Copy, Debug)]
pub struct SceneOpened {
    /// `true` if it is another scene than before.
    pub new: bool,
}

/// Event: a scene was started, with new boxes and the clock at zero.
#[derive(Event, Clone, Copy, Debug)]
pub struct SceneStarted;

/// Observes the actions that start or change a scene.
pub fn on_action(action: On<Action>, mut commands: Commands) {
    match *action {
        Action::Restart => commands.queue(start_scene),
        Action::Set(parameter, value) => {
            commands.queue(move |world: &mut World| set(world, parameter, value));
        }
        Action::ResetParameters => commands.queue(|world: &mut World| {
            let mut session = world.resource_mut::<Session>();
            session.parameters = session.own_parameters();
            start_scene(world);
        }),
        Action::ResetEverything => commands.queue(reset_everything),
        _ => {}
    }
}

/// Opens `scenario` with its default parameters. A `new` scene also selects its plot; a reloaded one does not.
pub fn open_scene(world: &mut World, scenario: Scenario, new: bool) {
    let mut session = world.resource_mut::<Session>();
    session.defaults = Parameters::of(&scenario);
    session.parameters = session.own_parameters();
    if new {
        session.plot = scenario.view.plot;
        session.show_picker = false;
    }
    session.scenario = scenario;
    world.trigger(SceneOpened { new });
    start_scene(world);
}

/// Starts the scene with the session's parameters: new boxes, clock at zero.
pub fn start_scene(world: &mut World) {
    for entity in entities::<SceneEntity>(world) {
        world.despawn(entity);
    }
    let mut session = world.resource_mut::<Session>();
    let setup = session.setup();
    let (boxes, seed) = (session.parameters.boxes(), session.seed);
    session.truth = Some(ReferenceSolution::of(&setup));
    session.run += 1;
    session.next_impulse = 0;
    (session.fallbacks, session.unconverged) = (0, 0);
    session.events = vec!["start".to_owned()];
    apply_world(world, &setup);
    world.resource_mut::<PhysicsClock>().reset();
    for k in 0..boxes {
        let initial = place(&setup, k, seed);
        let mut entity = world.spawn((SceneEntity, BoxNumber(k), setup.body, initial));
        if k == 0 {
            entity.insert((MainBox, ReportPersisting, Name::new("main_box")));
        }
        insert_forces(&mut entity, &setup.forces);
    }
    world.trigger(SceneStarted);
}

fn entities<C: Component>(world: &mut World) -> Vec<Entity> {
    let mut entities = world.query_filtered::<Entity, With<C>>();
    entities.iter(world).collect()
}

/// Sets a parameter, or shows the reason for a failure.
fn set(world: &mut World, parameter: Parameter, value: f64) {
    let mut session = world.resource_mut::<Session>();
    match session.parameters.set(parameter, value) {
        Ok(()) => take_effect(world, parameter.info().effect, parameter.describe(value)),
        Err(error) => session.notice(error),
    }
}

/// Applies the session's parameters after a change with this effect; `event` is logged.
pub fn take_effect(world: &mut World, effect: Effect, event: String) {
    match effect {
        Effect::Restart => start_scene(world),
        Effect::Clock => {
            set_step(world);
            world.resource_mut::<Session>().events.push(event);
        }
        Effect::Live => {
            let mut session = world.resource_mut::<Session>();
            session.perturb(event);
            let setup = session.setup();
            apply_world(world, &setup);
            for entity in entities::<SceneEntity>(world) {
                insert_forces(&mut world.entity_mut(entity), &setup.forces);
            }
        }
        Effect::None => {}
    }
}

/// Resets the game to its initial state; log and notices are kept.
fn reset_everything(world: &mut World) {
    world.insert_resource(GlobalIntegrator::default());
    world.resource_mut::<PhysicsClock>().paused = false;
    let mut session = world.resource_mut::<Session>();
    let fresh = Session::new(Scenario::default(), session.seed);
    *session = Session {
        run: session.run,
        notices: core::mem::take(&mut session.notices),
        ..fresh
    };
    set_speed(world, 1.0);
    set_step(world);
    open_scene(world, Scenario::default(), true);
}

/// Applies the scene's timed impulses to every box, at the first step boundary at or after their time.
pub fn apply_timed_impulses(
    mut session: ResMut<Session>,
    clock: Res<PhysicsClock>,
    mut boxes: Query<(&RigidBox, &mut BodyState), With<SceneEntity>>,
) {
    let start = clock.time() - clock.step();
    let impulses = &session.scenario.setup.impulses;
    let mut next = session.next_impulse;
    let due = start + 1e-9 * clock.step();
    while let Some(i) = impulses.get(next).filter(|i| i.t <= due) {
        for (body, mut state) in &mut boxes {
            state.apply_impulse_at_body_point(body, i.impulse, i.body_point);
        }
        next += 1;
    }
    if next != session.next_impulse {
        session.next_impulse = next;
    }
}

fn apply_world(world: &mut World, setup: &Setup) {
    world.insert_resource(WorldGravity(setup.forces.gravity));
    apply_walls(world, setup);
    let floor = setup
        .floor
        .map(|f| Floor::new(f.height, f.restitution, f.friction));
    match floor {
        Some(Ok(floor)) => world.insert_resource(floor),
        Some(Err(error)) => {
            let mut session = world.resource_mut::<Session>();
            session.notice(format!("floor: {error}"));
        }
        None => {
            world.remove_resource::<Floor>();
        }
    }
    let law = setup.floor.map(|f| f.restitution_law).unwrap_or_default();
    world.init_resource::<ContactSettings>();
    world.resource_mut::<ContactSettings>().restitution = law;
}

/// A wall of the scene.
#[derive(Component)]
pub struct Wall;

/// Replaces the walls, unless they are the same.
fn apply_walls(world: &mut World, setup: &Setup) {
    let surface = setup.floor.and_then(|f| {
        let friction = Friction::new(f.friction).ok()?;
        Some((friction, Restitution::new(f.restitution).ok()?))
    });
    let shapes = setup.floor.map(|f| f.walls()).unwrap_or_default();
    let walls: Vec<_> = surface
        .into_iter()
        .flat_map(|(mu, e)| shapes.iter().map(move |&plane| (plane, mu, e)))
        .collect();
    let mut old = world.query_filtered::<(&StaticPlane, &Friction, &Restitution), With<Wall>>();
    let there = old.iter(world).map(|(&plane, &mu, &e)| (plane, mu, e));
    if there.eq(walls.iter().copied()) {
        return;
    }
    for entity in entities::<Wall>(world) {
        world.despawn(entity);
    }
    for wall in walls {
        world.spawn((Wall, Name::new("wall"), wall));
    }
}

/// Replaces the force components of a body; components of absent forces are removed.
fn insert_forces(entity: &mut EntityWorldMut, forces: &ForceSet) {
    let f = forces.clone();
    let external = ExternalForce {
        force: f.force,
        torque: f.world_torque,
    };
    keep(entity, external);
    keep(entity, LinearDrag(f.linear_drag));
    keep(entity, QuadraticDrag(f.quadratic_drag));
    keep(entity, AngularDamping(f.angular_damping));
    keep(entity, AngularDrag(f.angular_drag));
    keep(entity, BodyTorque(f.body_torque));
    keep(entity, PointForces(f.point_forces));
    keep(entity, Springs(f.springs));
}

/// Inserts a force component, or removes it if the force is zero.
fn keep<C: Component + Default + PartialEq>(entity: &mut EntityWorldMut, component: C) {
    if component == C::default() {
        entity.remove::<C>();
    } else {
        entity.insert(component);
    }
}
