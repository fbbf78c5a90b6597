//! Resources: one concept each.

use core::time::Duration;

use bevy::ecs::reflect::ReflectResource;
use bevy::ecs::resource::Resource;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use glam::DVec3;

use crate::error::InvalidValue;
use crate::integrators::Integrator;

/// Gravity of the world [m/s²]. By default 9.81 downwards (−Y).
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
///     .insert_resource(WorldGravity(DVec3::new(0.0, -1.62, 0.0))); // the Moon
/// app.update();
/// ```
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WorldGravity(pub DVec3);

impl Default for WorldGravity {
    fn default() -> Self {
        Self(DVec3::new(0.0, -9.81, 0.0))
    }
}

/// Velocity of the air [m/s], world axes; without the resource the air is still. [`LinearDrag`](super::LinearDrag) and
/// [`QuadraticDrag`](super::QuadraticDrag) act on the velocity relative to it, by the same exact flows as in still air. A
/// body with a [`BodyWind`](super::BodyWind) has its own. It may change between steps: gusts.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
///     .insert_resource(Wind(DVec3::X * 8.0));
/// app.world_mut().spawn((RigidBox::default(), QuadraticDrag(0.5)));
/// app.update();
/// ```
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Wind(pub DVec3);

/// The integrator of every body without a [`BodyIntegrator`](super::BodyIntegrator). May be changed at
/// any time; the state is carried over exactly, because every integrator advances the same one.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn choose(keys: Res<ButtonInput<KeyCode>>, mut integrator: ResMut<GlobalIntegrator>) {
///     if keys.just_pressed(KeyCode::KeyE) {
///         integrator.0 = Integrator::Exact;
///     }
/// }
/// ```
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GlobalIntegrator(pub Integrator);

/// The clock of the physics: pause, substeps, and how far it is.
///
/// The step size is that of the schedule it runs in: `Time<Fixed>` by default. Pause means that the
/// schedule is not run; for a single step while paused queue [`StepPhysics`](super::StepPhysics).
/// Slow motion is running it less often: `Time<Virtual>::set_relative_speed`.
///
/// (It is a resource with a field `paused` and not a `Time<Physics>`: a clock of Bevy has a speed, but a physics that
/// ran at a speed other than its schedule's would need steps of another size, and its results would depend on it. What
/// has a speed is the clock of the schedule. Its time is counted in ticks and in f64, so that a replay hits the same
/// bits; `Time` counts nanoseconds.)
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn pause(keys: Res<ButtonInput<KeyCode>>, mut clock: ResMut<PhysicsClock>) {
///     if keys.just_pressed(KeyCode::KeyP) {
///         clock.paused = !clock.paused;
///     }
/// }
/// ```
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PhysicsClock {
    /// Whether the physics stands still.
    pub paused: bool,
    /// Into how many equal steps each tick of the clock is divided, 1 to 1024; 0 counts as 1.
    pub substeps: u32,
    step: f64,
    steps: u64,
    elapsed: Duration,
    into_tick: u32,
    tick: Duration,
    pub(crate) dropped: Duration,
    #[reflect(ignore)]
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) fault: Option<InvalidValue>,
}

impl Default for PhysicsClock {
    fn default() -> Self {
        Self {
            paused: false,
            substeps: 1,
            step: 0.0,
            steps: 0,
            elapsed: Duration::ZERO,
            into_tick: 0,
            tick: Duration::ZERO,
            dropped: Duration::ZERO,
            fault: None,
        }
    }
}

impl PhysicsClock {
    /// Size of the present or last (sub)step \[s\].
    pub fn step(&self) -> f64 {
        self.step
    }

    /// (Sub)steps taken, the present one included.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Simulated time at the end of the present or last (sub)step \[s\]: what a system in
    /// [`PhysicsSystems::Last`](super::PhysicsSystems::Last) calls now. A copy of the clock and of the bodies made there
    /// continues bit for bit.
    pub fn time(&self) -> f64 {
        self.elapsed.as_secs_f64() + f64::from(self.into_tick) * self.step
    }

    /// Simulated time of the ticks, their exact sum: those of which the last step is taken or is the present one.
    pub fn elapsed(&self) -> Duration {
        self.elapsed
    }

    /// Simulated time that was never simulated, because a frame took longer than
    /// `Time<Virtual>::max_delta` (by default 250 ms, so that a hitch never costs more than 16 ticks of
    /// 1/64 s): the simulation fell behind the wall clock by this much.
    pub fn dropped(&self) -> Duration {
        self.dropped
    }

    /// Why nothing moves although it is not paused: a setting of the world is out of its range
    /// ([`WorldGravity`], [`Floor`](crate::floor::Floor),
    /// [`ContactSettings`](crate::floor::ContactSettings), [`PhysicsClock::substeps`]). Put it right
    /// and the physics goes on.
    pub fn fault(&self) -> Option<InvalidValue> {
        self.fault
    }

    /// Moves on by one of the `substeps` of a tick of `delta`, at the beginning of that step: all that it says is of
    /// the step's end.
    pub(crate) fn begin_step(&mut self, delta: Duration, substeps: u32) {
        let step = delta.as_secs_f64() / f64::from(substeps);
        if self.into_tick > 0 && (step != self.step || self.into_tick >= substeps) {
            // Restored from within a tick, and then divided otherwise.
            let into = f64::from(self.into_tick) * self.step;
            self.elapsed += Duration::try_from_secs_f64(into).unwrap_or_default();
            self.into_tick = 0;
        }
        self.tick = delta;
        self.step = step;
        self.steps += 1;
        self.into_tick += 1;
        if self.into_tick == substeps {
            self.into_tick = 0;
            self.elapsed += delta;
        }
    }

    /// Whether the present step is the last one of its tick.
    pub(crate) fn is_tick_over(&self) -> bool {
        self.into_tick == 0
    }

    /// Size of the last tick; zero before the first.
    pub(crate) fn tick(&self) -> Duration {
        self.tick
    }

    /// Goes on from the time of `other`; what users set stays.
    pub(crate) fn continue_from(&mut self, other: &Self) {
        *self = Self {
            paused: self.paused,
            substeps: self.substeps,
            fault: self.fault,
            ..*other
        };
    }

    /// Back to time zero, for a restarted scene. Does not touch bodies.
    pub fn reset(&mut self) {
        self.steps = 0;
        self.into_tick = 0;
        self.elapsed = Duration::ZERO;
        self.dropped = Duration::ZERO;
    }
}
