//! The demo of 2012 on screen. In its scene the main box moves as in [`box_scenarios::dissertation`] or, at the press
//! of a button, by `box_physics`.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use bevy::platform::time::Instant;
use bevy::prelude::*;
use box_physics::prelude::{
    BodyState, DVec3, PhysicsClock, PhysicsSchedule, PhysicsSystems, RigidBox, WorldAabb,
};
use box_scenarios::dissertation::{Demo, State, Stepper};

use crate::action::Action;
use crate::platform::{self, Stream};
use crate::scene::session::{MainBox, Session};
use crate::scene::start::{SceneOpened, SceneStarted};

/// The scene of the demo.
pub const SCENE: &str = "dissertation-2012";

/// Faults of its physics. The strip shows the last one.
pub const FAULTS: [&str; 5] = [
    "gravity sets the velocity: the box falls at a constant 9.81 m/s",
    "a push replaces the previous one",
    "spin grows by α/60 per step at any step size, without the gyroscopic term, and with 0.83 for 1/12 in the inertia",
    "damping of 0.005 per millisecond stops it within a second",
    "contact only lifts the bounding box: no bounce, no friction, a tilted cube balances on its corner",
];

/// Moves the main box by the 2012 demo in its scene.
pub fn plugin(app: &mut App) {
    app.init_resource::<Demo2012>()
        .add_observer(on_action)
        .add_observer(|opened: On<SceneOpened>, mut demo: ResMut<Demo2012>| {
            if opened.new {
                demo.stepper = Demo2012::default().stepper;
            }
        })
        .add_observer(|_: On<SceneStarted>, mut demo: ResMut<Demo2012>| {
            (demo.state, demo.fault, demo.pushes) = (None, 0, 0);
        })
        .add_systems(
            PhysicsSchedule,
            run_cycle
                .after(PhysicsSystems::Writeback)
                .before(PhysicsSystems::Last),
        );
}

/// Observes the choice of an integrator and the switch of the log.
fn on_action(action: On<Action>, mut commands: Commands) {
    match *action {
        Action::SetDemo(stepper) => commands.queue(move |world: &mut World| choose(world, stepper)),
        Action::ToggleDemoLog => commands.queue(toggle_log),
        _ => {}
    }
}

/// The 2012 integrator that moves the main box, and its timing.
#[derive(Resource, Debug)]
pub struct Demo2012 {
    /// The 2012 integrator; `None` for `box_physics`.
    pub stepper: Option<Stepper>,
    /// The demo's state of the main box, once it exists.
    pub state: Option<State>,
    /// Time of the last integration cycle \[ns\].
    pub cycle_ns: u64,
    /// Index of the last fault in [`FAULTS`].
    fault: usize,
    /// Pushes since the start.
    pushes: u32,
    log: Option<CycleLog>,
}

impl Default for Demo2012 {
    fn default() -> Self {
        Self {
            stepper: Some(Stepper::default()),
            state: None,
            cycle_ns: 0,
            fault: 0,
            pushes: 0,
            log: None,
        }
    }
}

impl Demo2012 {
    /// The 2012 integrator, if it moves the main box in `session`'s scene.
    pub fn active(&self, session: &Session) -> Option<Stepper> {
        self.stepper.filter(|_| session.scenario.id == SCENE)
    }

    /// The last fault.
    pub fn fault(&self) -> &'static str {
        FAULTS[self.fault]
    }

    /// Path and number of lines of the log of cycle times.
    pub fn log(&self) -> Option<(&Path, u64)> {
        self.log.as_ref().map(|l| (l.path.as_path(), l.cycles))
    }
}

/// The demo's log: a text file with the time of every integration cycle, one per line.
#[derive(Debug)]
struct CycleLog {
    path: PathBuf,
    file: Stream,
    cycles: u64,
}

impl CycleLog {
    fn create(path: PathBuf) -> io::Result<Self> {
        let mut file = platform::create(&path)?;
        file.write_all(b"cycle milliseconds stepper\n")?;
        Ok(Self {
            path: platform::absolute(&path)?,
            file,
            cycles: 0,
        })
    }

    fn write(&mut self, stepper: Stepper, nanoseconds: u64) -> io::Result<()> {
        self.cycles += 1;
        let (cycle, milliseconds) = (self.cycles, nanoseconds as f64 * 1e-6);
        let line = format!("{cycle} {milliseconds:.6} {}\n", stepper.id());
        self.file.write_all(line.as_bytes())
    }
}

/// Moves the main box by one cycle of the demo. Replaces the state and the pose that the plugin has just written.
fn run_cycle(
    session: Res<Session>,
    clock: Res<PhysicsClock>,
    mut demo: ResMut<Demo2012>,
    main_box: Single<(&RigidBox, &mut BodyState, &mut Transform, &mut WorldAabb), With<MainBox>>,
) {
    let Some(stepper) = demo.active(&session) else {
        return;
    };
    let (body, mut state, mut transform, mut aabb) = main_box.into_inner();
    let demo = &mut *demo;
    let floor = session.scenario.setup.floor.map(|f| f.height);
    let law = Demo::of(body, floor);
    let own = demo
        .state
        .get_or_insert_with(|| State::new(body, &session.setup().initial));
    // The demo yielded its time slice before it read the clock; its logged times were mostly that.
    std::thread::yield_now();
    let start = Instant::now();
    law.cycle(stepper, own, clock.step());
    demo.cycle_ns = start.elapsed().as_nanos() as u64;
    *state = own.body_state(body);
    transform.translation = state.position.as_vec3();
    transform.rotation = state.rotation.as_quat();
    let before = core::mem::replace(&mut *aabb, WorldAabb::of(body, &state));
    let is_over = |aabb: &WorldAabb| floor.is_none_or(|floor| f64::from(aabb.0.min.y) > floor);
    if is_over(&before) && !is_over(&aabb) {
        demo.fault = 4;
    }
    if let Some(log) = &mut demo.log
        && let Err(error) = log.write(stepper, demo.cycle_ns)
    {
        warn!("cycle log closed: {error}");
        demo.log = None;
    }
}

/// Selects a 2012 integrator, or `box_physics`. Each continues from the current state of the box.
fn choose(world: &mut World, stepper: Option<Stepper>) {
    let main_box = main_box(world);
    let mut demo = world.resource_mut::<Demo2012>();
    if demo.stepper.is_none() {
        demo.state = main_box.map(|(body, state)| State::new(&body, &state));
    }
    demo.stepper = stepper;
    let text = stepper.map_or("box_physics", Stepper::id);
    let mut session = world.resource_mut::<Session>();
    session.perturb(format!("2012: {text}"));
}

/// Applies the demo's push, which replaces the motion, if the demo moves the box.
pub fn push(world: &mut World, impulse: DVec3, body_point: DVec3) {
    let session = world.resource::<Session>();
    let demo = world.resource::<Demo2012>();
    if demo.active(session).is_none() {
        return;
    }
    let initial = session.setup().initial;
    let Some((body, _)) = main_box(world) else {
        return;
    };
    let demo = &mut *world.resource_mut::<Demo2012>();
    demo.fault = match demo.pushes {
        0 if body_point.cross(impulse) == DVec3::ZERO => 3,
        0 => 2,
        _ => 1,
    };
    demo.pushes += 1;
    let start = || State::new(&body, &initial);
    let state = demo.state.get_or_insert_with(start);
    Demo::of(&body, None).push(state, Demo::force_for(impulse), body_point);
}

/// Starts or ends the log of cycle times.
fn toggle_log(world: &mut World) {
    let mut demo = world.resource_mut::<Demo2012>();
    let text = if let Some(CycleLog { path, cycles, .. }) = demo.log.take() {
        format!("cycle log closed: {} ({cycles} cycles)", path.display())
    } else {
        match platform::next_free("cycles-2012", "txt").and_then(CycleLog::create) {
            Ok(log) => format!("cycle log: {}", demo.log.insert(log).path.display()),
            Err(error) => format!("cycle log: {error}"),
        }
    };
    world.resource_mut::<Session>().notice(text);
}

fn main_box(world: &mut World) -> Option<(RigidBox, BodyState)> {
    let mut boxes = world.query_filtered::<(&RigidBox, &BodyState), With<MainBox>>();
    let (body, state) = boxes.iter(world).next()?;
    Some((*body, *state))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_is_a_line_a_cycle() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("log.txt");
        let mut log = CycleLog::create(path.clone()).expect("writable");
        log.write(Stepper::Rk4, 1_234_567).expect("writable");
        log.write(Stepper::Heun, 500).expect("writable");
        drop(log);
        let text = std::fs::read_to_string(path).expect("written");
        assert_eq!(
            text,
            "cycle milliseconds stepper\n1 1.234567 2012-rk4\n2 0.000500 2012-heun\n"
        );
    }
}
