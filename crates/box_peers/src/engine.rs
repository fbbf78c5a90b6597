//! What every engine is asked to do.

use std::time::Duration;

use box_physics::body::RigidBox;
use box_physics::state::BodyState;

/// A box and how it starts.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Size, mass, inertia.
    pub shape: RigidBox,
    /// Place and motion at the start.
    pub start: BodyState,
}

/// What the boxes are doing.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// They tumble and fall.
    Free,
    /// They drop onto the floor, bounce and settle.
    Landing,
    /// They lie on the floor.
    Resting,
}

/// A world to build.
#[derive(Clone, Copy, Debug)]
pub struct Spec<'a> {
    /// Steps per second.
    pub rate: u32,
    /// Gravity downwards [m/s²].
    pub gravity: f32,
    /// Whether there is a floor at y = 0.
    pub floor: bool,
    /// The boxes, which do not collide with one another.
    pub bodies: &'a [Body],
}

/// Coefficient of friction of floor and boxes, the same in every engine: that of our floor by default.
pub const FRICTION: f32 = 0.5;
/// Coefficient of restitution of floor and boxes, likewise.
pub const RESTITUTION: f32 = 0.3;

/// A world at work.
pub trait Simulation {
    /// One step, as a user has it.
    fn step(&mut self);
    /// Time simulated since the start \[s\].
    fn time(&self) -> f64;
    /// Time spent in physics alone since the world was built, if it is part of an app that does more.
    fn physics_time(&self) -> Option<Duration> {
        None
    }
    /// Where the box of this number is, and how it moves.
    fn state(&self, body: usize) -> BodyState;
}

/// An engine.
pub trait Engine {
    /// As typed.
    fn id(&self) -> &'static str;
    /// As shown.
    fn name(&self) -> &'static str;
    /// Its crate's version.
    fn version(&self) -> String;
    /// The threads that it may use.
    fn threads(&self) -> usize;
    /// How it is driven, in a few words.
    fn driven(&self) -> String;
    /// Returns whether the cost is measured in this situation. Special settings are measured in some only.
    fn is_timed(&self, _place: Place, _bodies: usize) -> bool {
        true
    }
    /// Builds a world.
    ///
    /// # Errors
    /// What the engine says.
    fn build(&self, spec: &Spec) -> Result<Box<dyn Simulation>, String>;
}

/// The threads of the machine, which Bevy's engines share out.
pub fn all_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Factor of an engine's default number of substeps in its *fine* setting.
pub const FINE: u32 = 10;
/// Number of boxes in free flight for which the cost of the fine setting is measured.
pub const FINE_BODIES: usize = 1000;

/// The floor of engines that have no plane: half-extents \[m\] of a slab whose top is y = 0.
pub const SLAB: [f32; 3] = [2000.0, 1.0, 2000.0];

/// The version that the lock file gives the package `name`.
pub fn locked_version(name: &str) -> String {
    const LOCK: &str = include_str!("../Cargo.lock");
    let heading = format!("name = \"{name}\"");
    let version = LOCK
        .lines()
        .skip_while(|l| *l != heading)
        .nth(1)
        .and_then(|l| l.strip_prefix("version = \""))
        .and_then(|l| l.strip_suffix('"'));
    version.unwrap_or("?").to_owned()
}
