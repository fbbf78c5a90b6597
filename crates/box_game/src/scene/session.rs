//! What is being played: the scene, its parameters, and what is switched on.

use std::collections::VecDeque;

use bevy::prelude::*;
use box_physics::prelude::{
    AngularDamping, ContactSettings, DQuat, DVec3, Floor, GlobalIntegrator, Integrator, LinearDrag,
    PhysicsClock, PointForces, ReportContacts, RigidBox, Springs, WorldGravity,
};
use box_physics::prelude::{AngularDrag, BodyState, BodyTorque, ExternalForce, QuadraticDrag};
use box_scenarios::{ForceSet, ReferenceSolution, Scenario, Setup};
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt as _, SeedableRng as _};

use crate::action::Plot;
use crate::demo_2012::Demo2012;
use crate::interaction::grab::Grip;
use crate::ui::panel::Parameters;

/// Speeds of the ladder [simulated seconds per second].
pub const SPEEDS: [f64; 9] = [0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0];

/// The longest frame that is simulated \[s\]; what a hitch takes beyond it is dropped, counted and
/// shown. That bounds the work of a frame: times speed over dt it is 15 ticks at 60 Hz in real time, and
/// 1920 at most (dt = 1/1920 s, speed 4), each of up to 64 substeps.
pub const LONGEST_FRAME: f64 = 0.25;

/// The box that is pushed; the others are load.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Hero;

/// Everything that a restart replaces.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct SceneEntity;

/// Which box of the scene it is: 0 is the hero.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoxNumber(pub u32);

/// The present scene and settings.
#[derive(Resource)]
pub struct Session {
    /// The scene as it comes.
    pub scenario: Scenario,
    /// Its own parameters.
    pub defaults: Parameters,
    /// The parameters as set.
    pub parameters: Parameters,
    /// Counts the starts: part of the log's `run_id`.
    pub run: u32,
    /// Which of the scene's timed impulses comes next.
    pub next_impulse: usize,
    /// The trusted answer, where there is one and nothing was changed or pushed since the start.
    pub truth: Option<ReferenceSolution>,
    /// Target speed.
    pub speed: f64,
    /// Seed of the load boxes' attitudes.
    pub seed: u64,
    /// What was pushed or changed, for the log; taken by the next row.
    pub events: Vec<String>,
    /// Bounding boxes are drawn.
    pub show_aabb: bool,
    /// Contacts are drawn.
    pub show_contacts: bool,
    /// Body axes and velocities are drawn.
    pub show_axes: bool,
    /// The list of keys is open.
    pub show_help: bool,
    /// The list of scenes to search in is open.
    pub show_picker: bool,
    /// The panel is hidden.
    pub hidden: bool,
    /// The drawer is open.
    pub show_plots: bool,
    /// Which plot it shows.
    pub plot: Plot,
    /// Last messages to the person.
    pub notices: VecDeque<String>,
    /// Simulated time dropped by hitches since the start of the scene \[s\].
    pub dropped: f64,
    /// Body-steps since the start of the scene that the integrator handed to `split`.
    pub fallbacks: u64,
    /// Body-steps since then whose iteration ended at its cap.
    pub unconverged: u64,
}

impl Session {
    /// A session that opens with `scenario`.
    pub fn new(scenario: Scenario, seed: u64) -> Self {
        let defaults = parameters_of(&scenario);
        Self {
            scenario,
            defaults,
            parameters: defaults,
            run: 0,
            next_impulse: 0,
            truth: None,
            speed: 1.0,
            seed,
            events: Vec::new(),
            show_aabb: false,
            show_contacts: false,
            show_axes: false,
            show_help: false,
            show_picker: false,
            hidden: false,
            show_plots: true,
            plot: Plot::Energy,
            notices: VecDeque::new(),
            dropped: 0.0,
            fallbacks: 0,
            unconverged: 0,
        }
    }

    /// Says something to the person, in the panel and in the log.
    pub fn notice(&mut self, text: impl Into<String>) {
        let text = text.into();
        info!("{text}");
        self.notices.push_back(text);
        while self.notices.len() > 4 {
            self.notices.pop_front();
        }
    }

    /// Of the present run, for the log: scene, seed, number of the start.
    pub fn run_id(&self) -> String {
        format!("{}-{}-{}", self.scenario.id, self.seed, self.run)
    }

    /// Something happened that the scene's trusted answer does not know of.
    pub fn perturb(&mut self, event: String) {
        self.truth = None;
        self.events.push(event);
    }

    /// The scene with the parameters as set: what is simulated.
    pub fn setup(&self) -> Setup {
        let mut setup = self.scenario.setup.clone();
        let p = &self.parameters;
        if p.half_extents != self.defaults.half_extents || p.mass != self.defaults.mass {
            // Checked where it was set; the same spin, another box.
            if let Ok(body) = RigidBox::new(p.half_extents, p.mass) {
                let spin = setup.initial.body_angular_velocity(&setup.body);
                setup.initial = setup.initial.with_body_angular_velocity(&body, spin);
                setup.body = body;
            }
        }
        setup.forces = self.forces();
        if let Some(floor) = &mut setup.floor {
            floor.restitution = p.restitution.unwrap_or(floor.restitution);
            floor.friction = p.friction.unwrap_or(floor.friction);
        }
        setup
    }

    /// The scene's forces with the parameters as set.
    pub fn forces(&self) -> ForceSet {
        let (p, d) = (&self.parameters, &self.defaults);
        let mut forces = self.scenario.setup.forces.clone();
        if p.gravity != d.gravity {
            forces.gravity = DVec3::NEG_Y * p.gravity;
        }
        forces.linear_drag = p.linear_drag;
        forces.angular_damping = p.angular_damping;
        forces
    }
}

/// What can be set of a scene, as it comes.
pub fn parameters_of(scenario: &Scenario) -> Parameters {
    let setup = &scenario.setup;
    Parameters {
        gravity: -setup.forces.gravity.y,
        restitution: setup.floor.map(|f| f.restitution),
        friction: setup.floor.map(|f| f.friction),
        linear_drag: setup.forces.linear_drag,
        angular_damping: setup.forces.angular_damping,
        half_extents: setup.body.half_extents(),
        mass: setup.body.mass(),
        // A push that changes the velocity by 1 m/s.
        impulse: setup.body.mass(),
        boxes: scenario.boxes,
    }
}

/// Starts the scene anew with the session's parameters: despawns the old boxes, spawns the new, clock
/// to zero.
pub fn start_scene(world: &mut World) {
    let old: Vec<Entity> = world
        .query_filtered::<Entity, With<SceneEntity>>()
        .iter(world)
        .collect();
    for entity in old {
        world.despawn(entity);
    }
    let mut session = world.resource_mut::<Session>();
    let setup = session.setup();
    let (boxes, seed) = (session.parameters.boxes, session.seed);
    session.truth = Some(ReferenceSolution::of(&setup));
    session.run += 1;
    session.next_impulse = 0;
    session.dropped = 0.0;
    (session.fallbacks, session.unconverged) = (0, 0);
    session.events = vec!["start".to_owned()];
    apply_world(world, &setup);
    world.resource_mut::<PhysicsClock>().reset();
    world.resource_mut::<Demo2012>().state = None;
    world.resource_mut::<Grip>().0 = None;
    for k in 0..boxes {
        let initial = place(&setup, k, seed);
        let mut entity = world.spawn((SceneEntity, BoxNumber(k), setup.body, initial));
        if k == 0 {
            entity.insert((Hero, ReportContacts, Name::new("hero")));
        }
        insert_forces(&mut entity, &setup.forces);
    }
}

/// Gravity and floor as the session has them, without touching a box.
pub fn apply_world(world: &mut World, setup: &Setup) {
    world.insert_resource(WorldGravity(setup.forces.gravity));
    match setup.floor {
        Some(f) => match Floor::new(f.height, f.restitution, f.friction) {
            Ok(floor) => world.insert_resource(floor),
            Err(error) => world
                .resource_mut::<Session>()
                .notice(format!("floor: {error}")),
        },
        None => {
            world.remove_resource::<Floor>();
        }
    }
    world.init_resource::<ContactSettings>();
}

/// The force components of a body; a force that is absent has none.
pub fn insert_forces(entity: &mut EntityWorldMut, forces: &ForceSet) {
    entity.remove::<(
        LinearDrag,
        QuadraticDrag,
        AngularDamping,
        AngularDrag,
        ExternalForce,
        BodyTorque,
        PointForces,
        Springs,
    )>();
    if forces.linear_drag != 0.0 {
        entity.insert(LinearDrag(forces.linear_drag));
    }
    if forces.quadratic_drag != 0.0 {
        entity.insert(QuadraticDrag(forces.quadratic_drag));
    }
    if forces.angular_damping != 0.0 {
        entity.insert(AngularDamping(forces.angular_damping));
    }
    if forces.angular_drag != 0.0 {
        entity.insert(AngularDrag(forces.angular_drag));
    }
    if forces.force != DVec3::ZERO || forces.world_torque != DVec3::ZERO {
        entity.insert(ExternalForce {
            force: forces.force,
            torque: forces.world_torque,
        });
    }
    if forces.body_torque != DVec3::ZERO {
        entity.insert(BodyTorque(forces.body_torque));
    }
    if !forces.point_forces.is_empty() {
        entity.insert(PointForces(forces.point_forces.clone()));
    }
    if !forces.springs.is_empty() {
        entity.insert(Springs(forces.springs.clone()));
    }
}

/// Start of box `k`: the hero as the scene says, the others on a grid round it, each at an attitude of
/// its own and with the same motion.
pub fn place(setup: &Setup, k: u32, seed: u64) -> BodyState {
    let mut state = setup.initial;
    if k == 0 {
        return state;
    }
    let pitch = 2.5 * setup.body.radius();
    let (i, j) = spiral(k);
    state.position += DVec3::new(f64::from(i) * pitch, 0.0, f64::from(j) * pitch);
    // Uniform on the unit 3-sphere, by rejection from the cube.
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed.rotate_left(32) ^ u64::from(k));
    state.rotation = loop {
        let [x, y, z, w] = core::array::from_fn(|_| random.random_range(-1.0..=1.0));
        let q = DQuat::from_xyzw(x, y, z, w);
        let norm = q.length();
        if norm > 0.1 && norm <= 1.0 {
            break q / norm;
        }
    };
    state
}

/// The `k`-th cell of a square spiral round the origin.
fn spiral(k: u32) -> (i32, i32) {
    // Ring r holds the cells with max(|i|, |j|) = r: 8r of them.
    let mut r = 0_u32;
    while (2 * r + 1) * (2 * r + 1) <= k {
        r += 1;
    }
    let along = (k - (2 * r - 1) * (2 * r - 1)) as i32;
    let (r, side) = (r as i32, 2 * r as i32);
    match along / side {
        0 => (-r + along % side, -r),
        1 => (r, -r + along % side),
        2 => (r - along % side, r),
        _ => (-r, r - along % side),
    }
}

/// Opens with `integrator`.
pub fn choose(world: &mut World, integrator: Integrator) {
    world.insert_resource(GlobalIntegrator(integrator));
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn the_spiral_visits_every_cell_once() {
        let cells: HashSet<_> = (1..2601).map(spiral).collect();
        assert_eq!(cells.len(), 2600);
        assert!(!cells.contains(&(0, 0)));
        assert!(cells.iter().all(|&(i, j)| i.abs() <= 25 && j.abs() <= 25));
    }

    #[test]
    fn attitudes_follow_the_seed() {
        let setup = Scenario::find("load").expect("a scene").setup;
        assert_eq!(place(&setup, 5, 1), place(&setup, 5, 1));
        assert_ne!(place(&setup, 5, 1), place(&setup, 5, 2));
        assert_eq!(place(&setup, 0, 1), setup.initial);
        assert!((place(&setup, 7, 3).rotation.length() - 1.0).abs() < 1e-15);
    }
}
