//! Contact with the floor and with planes.
//!
//! ```text
//! may_touch?  no  → the integrator's plain step, without contact work
//!             yes → step_on_floor: impact | motion until the next event | rest, to the end of the step
//! ```
//!
//! Contact acts at the eight corners. An impact is located in time by re-running the integrator over part of the step.
//! All touching corners are solved together, with Newton's restitution and a round friction cone. During a segment of
//! motion, a force holds each corner that stays in contact. A box at rest keeps its state bit for bit.
//!
//! | modules, from top to bottom | task |
//! |---|---|
//! | `step`, `memory`, `flight`, `slide` | a step, and its shortcuts: rest, free flight, sliding on a face |
//! | `planes` | walls and ramps: a step in the axes of one plane, or among several |
//! | `events`, `impact`, `sustained`, `slips`, `search` | the events of a step, for one floor or several planes |
//! | `ground` | their interface to the floor (`level`) and to several planes (`planes::among`) |
//! | `law`, `newton`, `cone` | solvers of Coulomb's law: Newton's method, and direct solutions at one floor |
//! | `projection`, `motion`, `frame`, `bounds`, `operator`, `geometry` | corrections, motion, corners |
//!
//! Literature: J. J. Moreau 1988; V. Acary, B. Brogliato, *Numerical Methods for Nonsmooth Dynamical
//! Systems*, Springer 2008.

#![expect(clippy::doc_markdown, reason = "the formulas' subscripts are not code")]
#![expect(
    clippy::needless_range_loop,
    reason = "one index runs over several arrays, of which only the first `count` entries are in use"
)]

mod bounds;
mod cone;
mod events;
mod flight;
mod frame;
mod geometry;
mod ground;
mod impact;
mod law;
mod level;
mod material;
mod memory;
mod motion;
mod newton;
mod operator;
mod planes;
mod projection;
mod search;
mod slide;
mod slips;
mod step;
mod sustained;

#[cfg(test)]
mod tests;

pub use flight::{FloorBelow, may_touch};
pub use material::{CoefficientCombine, Friction, Restitution};
pub use memory::{ContactReport, ContactState};
pub use planes::{Plane, PlanesContext, StaticPlane, may_touch_planes, step_on_planes};
pub use step::step_on_floor;

use glam::DVec3;

use crate::body::RigidBox;
#[cfg(feature = "bevy")]
use crate::ecs::*;
use crate::error::InvalidValue;
use crate::integrators::StepOutcome;

/// The plane y = `height` with its restitution and friction. A resource; without it there is no floor.
///
/// A floor with a `velocity` is an elevator or a conveyor belt: impacts, friction and rest are relative to it. The
/// plugin advances `height` by it in every step. Changing it wakes all bodies. Walls and ramps are [`StaticPlane`]s.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Resource, Reflect),
    reflect(Resource, Default, Clone, PartialEq)
)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Floor {
    /// Height of the plane \[m\].
    pub height: f64,
    /// Coefficient of restitution e, 0 to 1.
    pub restitution: f64,
    /// Coulomb's coefficient of kinetic friction µ, ≥ 0.
    pub friction: f64,
    /// Coefficient of static friction, at least `friction`: holds a box if no corner slips. Impacts use kinetic
    /// friction. Default `None`: the same as `friction`.
    #[cfg_attr(feature = "serde", serde(default))]
    pub static_friction: Option<f64>,
    /// Velocity of the floor [m/s], world axes. Default 0.
    #[cfg_attr(feature = "serde", serde(default))]
    pub velocity: DVec3,
}

impl Default for Floor {
    /// y = 0, e = 0.3, µ = 0.5: wood on wood.
    fn default() -> Self {
        Self {
            height: 0.0,
            restitution: 0.3,
            friction: 0.5,
            static_friction: None,
            velocity: DVec3::ZERO,
        }
    }
}

impl Floor {
    /// A floor at `height` \[m\] with restitution 0 to 1 and friction ≥ 0.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first field out of range.
    ///
    /// ```
    /// use box_physics::floor::Floor;
    /// let error = Floor::new(0.0, 1.5, 0.5).unwrap_err().to_string();
    /// assert_eq!(error, "restitution must be between 0 and 1, but is 1.5");
    /// ```
    pub fn new(height: f64, restitution: f64, friction: f64) -> Result<Self, InvalidValue> {
        let floor = Self {
            height,
            restitution,
            friction,
            ..Self::default()
        };
        floor.validate().map(|()| floor)
    }

    /// Sets the velocity [m/s], world axes.
    ///
    /// ```
    /// use box_physics::prelude::*;
    /// let elevator = Floor::default().with_velocity(DVec3::Y * 2.0);
    /// let conveyor = Floor::default().with_velocity(DVec3::X * 0.5);
    /// ```
    pub fn with_velocity(self, velocity: impl Into<DVec3>) -> Self {
        Self {
            velocity: velocity.into(),
            ..self
        }
    }

    /// Moves the plane to its place after a step of `h` \[s\]. The plugin does this; users of the core do it after each
    /// step of all bodies.
    pub fn advance(&mut self, h: f64) {
        self.height += self.velocity.y * h;
    }

    /// The coefficient of static friction.
    fn grip(&self) -> f64 {
        self.static_friction.unwrap_or(self.friction)
    }

    /// Checks the fields.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first field out of range.
    pub fn validate(&self) -> Result<(), InvalidValue> {
        InvalidValue::check(self.height.is_finite(), "height", self.height, "finite")?;
        let e = self.restitution;
        InvalidValue::check_between((0.0, 1.0), "restitution", e, "between 0 and 1")?;
        InvalidValue::check_coefficient("friction", self.friction)?;
        if let Some(holds) = self.static_friction {
            let in_range = holds.is_finite() && holds >= self.friction;
            let allowed = "finite and not less than friction";
            InvalidValue::check(in_range, "static_friction", holds, allowed)?;
        }
        let fields = ["velocity.x", "velocity.y", "velocity.z"].into_iter();
        for (field, v) in fields.zip(self.velocity.to_array()) {
            InvalidValue::check(v.is_finite(), field, v, "finite")?;
        }
        Ok(())
    }
}

/// The energy limit of an impact with restitution e. If one corner strikes without friction, both variants are Newton's
/// law u⁺_n = −e u⁻_n.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Default, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RestitutionLaw {
    /// At most the part e² of the energy lost in a plastic impact is returned: T⁺ ≤ T₀ + e² (T⁻ − T₀), with T₀ the
    /// energy after the impact with e = 0 (W. J. Stronge, Proc. R. Soc. A 431 (1990) 169, for the impact as a whole).
    /// Energy never grows.
    #[default]
    Energetic,
    /// Newton's law alone. An impact that would gain energy is scaled to conserve it, and counted in
    /// [`FloorOutcome::energy_repairs`].
    Newton,
}

/// Settings of the contact solver. The defaults suit boxes from millimeters to hundreds of meters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Resource, Reflect),
    reflect(Resource, Default, Clone, PartialEq)
)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactSettings {
    /// Approach speed [m/s] below which nothing bounces. It ends a Zeno sequence of ever smaller bounces. Default 0.01:
    /// an invisible bounce of 5 µm. Slower ones would exceed [`ContactSettings::max_impacts`] at 60 Hz on Earth.
    pub restitution_threshold: f64,
    /// Maximum number of impacts in one step, ≥ 1. Further ones stop the touching corners and are counted. Default 16.
    pub max_impacts: u32,
    /// Maximum number of iterations for one problem, ≥ 1. Default 2000; 99 of 100 random impacts need
    /// fewer than 200.
    pub max_iterations: u32,
    /// Tolerance of velocities, relative to the fastest corner, and of heights, relative to the circumradius of the box
    /// plus |height of the floor|. 1e-15 to 1e-3; default 1e-12.
    pub tolerance: f64,
    /// Energy limit of impacts. Default [`RestitutionLaw::Energetic`].
    pub restitution: RestitutionLaw,
}

impl ContactSettings {
    /// The defaults.
    pub const DEFAULT: Self = Self {
        restitution_threshold: 0.01,
        max_impacts: 16,
        max_iterations: 2000,
        tolerance: 1e-12,
        restitution: RestitutionLaw::Energetic,
    };

    /// Checks the fields.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first field out of range.
    pub fn validate(&self) -> Result<(), InvalidValue> {
        InvalidValue::check_coefficient("restitution_threshold", self.restitution_threshold)?;
        for (field, count) in [
            ("max_impacts", self.max_impacts),
            ("max_iterations", self.max_iterations),
        ] {
            InvalidValue::check(count > 0, field, count.into(), "at least 1")?;
        }
        let (limits, allowed) = ((1e-15, 1e-3), "between 1e-15 and 1e-3");
        InvalidValue::check_between(limits, "tolerance", self.tolerance, allowed)
    }
}

impl Default for ContactSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The inputs of a step over the floor.
#[derive(Clone, Copy, Debug)]
pub struct FloorContext<'a, F> {
    /// The floor.
    pub floor: &'a Floor,
    /// The contact settings.
    pub settings: &'a ContactSettings,
    /// The box.
    pub body: &'a RigidBox,
    /// The force model of the box, without contact.
    pub force: &'a F,
}

impl<F> FloorContext<'_, F> {
    /// Largest height of a touching corner \[m\].
    fn tolerated_height(&self) -> f64 {
        self.settings.tolerance * (self.body.radius() + self.floor.height.abs())
    }
}

/// Cost of a step over the floor, and every limit that it reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Default, Clone, PartialEq))]
pub struct FloorOutcome {
    /// Outcome of the integrator, over all segments.
    pub step: StepOutcome,
    /// Impacts resolved.
    pub impacts: u32,
    /// Impacts beyond [`ContactSettings::max_impacts`], treated as resting.
    pub impacts_capped: u32,
    /// Solves or event searches that ended at their cap.
    pub solves_capped: u32,
    /// Segments, and impacts under [`RestitutionLaw::Newton`], whose gain of energy was removed.
    pub energy_repairs: u32,
    /// The removed energy \[J\].
    pub energy_repaired: f64,
    /// `true` if the box is at rest. For a sum: if at least one is.
    pub resting: bool,
}

impl FloorOutcome {
    /// Counts fallbacks and unconverged iterations once per step, not per segment.
    fn count_once(&mut self) {
        self.step.fallbacks = self.step.fallbacks.min(1);
        self.step.unconverged = self.step.unconverged.min(1);
    }

    /// Counts a repair that removed this energy \[J\].
    fn repair(&mut self, taken: Option<f64>) {
        if let Some(energy) = taken {
            self.energy_repairs += 1;
            self.energy_repaired += energy;
        }
    }
}

impl core::ops::AddAssign for FloorOutcome {
    fn add_assign(&mut self, other: Self) {
        self.step += other.step;
        self.impacts += other.impacts;
        self.impacts_capped += other.impacts_capped;
        self.solves_capped += other.solves_capped;
        self.energy_repairs += other.energy_repairs;
        self.energy_repaired += other.energy_repaired;
        self.resting |= other.resting;
    }
}
