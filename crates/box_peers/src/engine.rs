//! Common interface of all engines.

use std::time::Duration;

use box_physics::body::RigidBox;
use box_physics::state::BodyState;

/// A box and its initial state.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Size, mass, inertia.
    pub shape: RigidBox,
    /// State at the start.
    pub start: BodyState,
}

/// Situation of the boxes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// The boxes tumble and fall.
    Free,
    /// The boxes drop onto the floor, bounce and settle.
    Landing,
    /// The boxes rest on the floor.
    Resting,
}

/// A world to build.
#[derive(Clone, Copy, Debug)]
pub struct Spec<'a> {
    /// Steps per second.
    pub rate: u32,
    /// Gravity downwards [m/s²].
    pub gravity: f32,
    /// `true` for a floor at y = 0.
    pub floor: bool,
    /// The boxes, which do not collide with one another.
    pub bodies: &'a [Body],
}

/// Coefficient of friction of floor and boxes, the same in every engine: that of our floor by default.
pub const FRICTION: f32 = 0.5;
/// Coefficient of restitution of floor and boxes, likewise.
pub const RESTITUTION: f32 = 0.3;

/// A running world.
pub trait Simulation {
    /// Takes one step, as a user would.
    fn step(&mut self);
    /// Time simulated since the start \[s\].
    fn time(&self) -> f64;
    /// Time spent in physics alone since the world was built, if it is part of an app that does more.
    fn physics_time(&self) -> Option<Duration> {
        None
    }
    /// State of the box with this index.
    fn state(&self, body: usize) -> BodyState;
}

/// An engine.
pub trait Engine {
    /// Identifier on the command line.
    fn id(&self) -> &'static str;
    /// Display name.
    fn name(&self) -> &'static str;
    /// Version of the engine's crate.
    fn version(&self) -> String;
    /// Number of threads that the engine may use.
    fn threads(&self) -> usize;
    /// Short description of how the engine is driven.
    fn driven(&self) -> String;
    /// Returns whether the cost is measured in this situation. Special settings are measured in some only.
    fn is_timed(&self, _place: Place, _bodies: usize) -> bool {
        true
    }
    /// Builds a world.
    ///
    /// # Errors
    /// An error message of the engine.
    fn build(&self, spec: &Spec) -> Result<Box<dyn Simulation>, String>;
}

/// Number of threads of the machine, which the engines in Bevy share.
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
