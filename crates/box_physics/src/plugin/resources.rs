//! Resources: settings of the world and the clock.

use core::time::Duration;

use bevy::ecs::reflect::ReflectResource;
use bevy::ecs::resource::Resource;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use glam::DVec3;

use crate::error::InvalidValue;
use crate::integrators::Integrator;

/// Gravitational acceleration of the world [m/s²], world axes. Default: 9.81 downward (−Y).
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

/// Velocity of the air [m/s], world axes. Without this resource the air is still.
///
/// [`LinearDrag`](super::LinearDrag) and [`QuadraticDrag`](super::QuadraticDrag) act on the velocity relative to the
/// air, by the same exact flows as in still air. [`BodyWind`](super::BodyWind) overrides it for one body. It may change
/// between steps, for example to model gusts.
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

/// The integrator of every body without a [`BodyIntegrator`](super::BodyIntegrator). It may be changed at any time. The
/// state carries over exactly, because all integrators advance the same variables.
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

/// The clock of the physics: pause, substeps, step count and simulated time.
///
/// The step size is that of the schedule in which the physics runs: `Time<Fixed>` by default. While paused, the
/// schedule does not run; queue [`StepPhysics`](super::StepPhysics) for a single step. For slow motion, run the
/// schedule less often with `Time<Virtual>::set_relative_speed`.
///
/// It is not a `Time<Physics>`, because a second relative speed would need steps of another size, which would change
/// the results.
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
    /// Pauses the physics.
    pub paused: bool,
    /// Number of equal steps into which each tick of the clock is divided, 1 to 1024; 0 counts as 1.
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
    /// Size of the current or last (sub)step \[s\].
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Number of (sub)steps taken, including the current one.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Simulated time at the end of the current or last (sub)step \[s\]. It is the current time for systems in
    /// [`PhysicsSystems::Last`](super::PhysicsSystems::Last). A copy of the clock and the bodies made there continues
    /// bit for bit.
    pub fn time(&self) -> f64 {
        self.elapsed.as_secs_f64() + f64::from(self.into_tick) * self.step
    }

    /// Exact sum of all ticks that are complete or whose last step is the current one.
    pub fn elapsed(&self) -> Duration {
        self.elapsed
    }

    /// Time that was not simulated because frames took longer than `Time<Virtual>::max_delta`. The simulation fell
    /// behind the wall clock by this much. With the default of 250 ms, a hitch never costs more than 16 ticks of 1/64
    /// s.
    pub fn dropped(&self) -> Duration {
        self.dropped
    }

    /// The reason why the physics is stopped although it is not paused: an invalid setting in [`WorldGravity`],
    /// [`Wind`], [`Floor`](crate::floor::Floor), [`ContactSettings`](crate::floor::ContactSettings) or
    /// [`PhysicsClock::substeps`]. The physics resumes when it is corrected.
    pub fn fault(&self) -> Option<InvalidValue> {
        self.fault
    }

    /// Advances by one of the `substeps` of a tick of `delta`. Called at the beginning of the step; all values refer to
    /// its end.
    pub(crate) fn begin_step(&mut self, delta: Duration, substeps: u32) {
        let step = delta.as_secs_f64() / f64::from(substeps);
        if self.into_tick > 0 && (step != self.step || self.into_tick >= substeps) {
            // The clock was restored from within a tick, and the number of substeps or the tick has changed since.
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

    /// Returns `true` if the current step is the last one of its tick.
    pub(crate) fn is_tick_over(&self) -> bool {
        self.into_tick == 0
    }

    /// Length of the last tick; zero before the first.
    pub(crate) fn tick(&self) -> Duration {
        self.tick
    }

    /// Continues from the time of `other`, and keeps the settings.
    pub(crate) fn continue_from(&mut self, other: &Self) {
        *self = Self {
            paused: self.paused,
            substeps: self.substeps,
            fault: self.fault,
            ..*other
        };
    }

    /// Resets the time to zero, to restart a scene. Does not change bodies.
    pub fn reset(&mut self) {
        self.steps = 0;
        self.into_tick = 0;
        self.elapsed = Duration::ZERO;
        self.dropped = Duration::ZERO;
    }
}
