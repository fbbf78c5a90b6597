//! A setup: a body, its start, forces, floor and impulses, and a duration.

use box_physics::body::RigidBox;
use box_physics::error::InvalidValue;
use box_physics::floor::{RestitutionLaw, StaticPlane};
use box_physics::state::BodyState;
use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::forces::{ForceSet, coefficient};
use crate::limits;

/// The floor of a scene: the plane y = `height`, optionally with walls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FloorSpec {
    /// Height of the plane, y \[m\].
    #[serde(deserialize_with = "limits::any")]
    pub height: f64,
    /// Newton's restitution e, 0 to 1: speed after over speed before.
    #[serde(deserialize_with = "limits::share")]
    pub restitution: f64,
    /// The restitution law, which limits the energy of an impact.
    #[serde(default, skip_serializing_if = "is_default")]
    pub restitution_law: RestitutionLaw,
    /// Coulomb's friction µ, ≥ 0.
    #[serde(deserialize_with = "limits::coefficient")]
    pub friction: f64,
    /// Half-width of a tray \[m\]: four walls of the same surface at x and z = ± this value; 0 for no walls.
    #[serde(
        default,
        skip_serializing_if = "is_zero",
        deserialize_with = "limits::coefficient"
    )]
    pub tray: f64,
}

fn is_zero(tray: &f64) -> bool {
    *tray == 0.0
}

fn is_default(law: &RestitutionLaw) -> bool {
    *law == RestitutionLaw::default()
}

impl FloorSpec {
    /// The plane y = 0 with restitution `restitution` and friction `friction`.
    pub const fn at_zero(restitution: f64, friction: f64) -> Self {
        Self {
            height: 0.0,
            restitution,
            restitution_law: RestitutionLaw::Energetic,
            friction,
            tray: 0.0,
        }
    }

    /// Adds a tray with walls at the distance `tray` \[m\] from its middle.
    pub const fn in_tray(self, tray: f64) -> Self {
        Self { tray, ..self }
    }

    /// The walls of the tray.
    pub fn walls(&self) -> Vec<StaticPlane> {
        let sides = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z];
        let wall = |normal: DVec3| {
            let foot = DVec3::Y * self.height - self.tray * normal;
            StaticPlane::new(foot, normal).ok()
        };
        let sides = sides.into_iter().filter(|_| self.tray > 0.0);
        sides.filter_map(wall).collect()
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first field out of range.
    pub fn validate(&self) -> Result<(), InvalidValue> {
        for (ok, field, value, allowed) in [
            (
                self.height.is_finite(),
                "floor.height",
                self.height,
                "finite",
            ),
            (
                (0.0..=1.0).contains(&self.restitution),
                "floor.restitution",
                self.restitution,
                "between 0 and 1",
            ),
        ] {
            if !ok {
                return Err(InvalidValue {
                    field,
                    value,
                    allowed,
                });
            }
        }
        coefficient("floor.tray", self.tray)?;
        coefficient("floor.friction", self.friction)
    }
}

/// An impulse at a known time, at a point that moves with the body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimedImpulse {
    /// Time \[s\].
    #[serde(deserialize_with = "limits::coefficient")]
    pub t: f64,
    /// Impulse J \[N s\], world axes.
    #[serde(deserialize_with = "limits::vector")]
    pub impulse: DVec3,
    /// Point of application, body axes from the center of mass \[m\].
    #[serde(deserialize_with = "limits::vector")]
    pub body_point: DVec3,
}

/// All data that determine a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// The box.
    pub body: RigidBox,
    /// State of the box at t = 0.
    pub initial: BodyState,
    /// The forces on it.
    pub forces: ForceSet,
    /// The floor, if there is one.
    pub floor: Option<FloorSpec>,
    /// Impulses, in order of time.
    pub impulses: Vec<TimedImpulse>,
    /// Duration of the scene \[s\].
    pub duration: f64,
}

impl Setup {
    /// A body in free flight for `duration` \[s\] under `forces`, without floor and impulses.
    pub fn new(body: RigidBox, initial: BodyState, forces: ForceSet, duration: f64) -> Self {
        Self {
            body,
            initial,
            forces,
            floor: None,
            impulses: Vec::new(),
            duration,
        }
    }

    /// Adds a floor.
    #[must_use]
    pub fn with_floor(mut self, floor: FloorSpec) -> Self {
        self.floor = Some(floor);
        self
    }

    /// Sets the impulses.
    #[must_use]
    pub fn with_impulses(mut self, impulses: Vec<TimedImpulse>) -> Self {
        self.impulses = impulses;
        self
    }

    /// Kinetic plus potential energy of `state` under these forces \[J\].
    pub fn energy(&self, state: &BodyState) -> f64 {
        box_physics::energy::total_energy(&self.body, state, &self.forces.forces(&self.body))
    }

    /// Returns `true` if the energy is constant: conservative forces, no impulses, and no floor or one without losses
    /// (e = 1, µ = 0).
    pub fn conserves_energy(&self) -> bool {
        box_physics::energy::is_conservative(&self.forces.forces(&self.body))
            && self.impulses.is_empty()
            && self
                .floor
                .is_none_or(|f| f.restitution >= 1.0 && f.friction <= 0.0)
    }

    /// The constant energy \[J\], if it is conserved.
    pub fn conserved_energy(&self) -> Option<f64> {
        self.conserves_energy().then(|| self.energy(&self.initial))
    }

    /// Returns `true` if the angular momentum about the center is constant in the world: no torque, impulse or floor
    /// acts.
    pub fn conserves_angular_momentum(&self) -> bool {
        let d = self.forces.dissipation();
        !self.forces.has_wrench()
            && d.angular_damping == 0.0
            && d.angular_drag == 0.0
            && self.impulses.is_empty()
            && self.floor.is_none()
    }

    /// Checks forces, floor, impulses and duration. Body and state are checked on construction.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first field out of range.
    pub fn validate(&self) -> Result<(), InvalidValue> {
        self.forces.validate()?;
        self.floor.map_or(Ok(()), |f| f.validate())?;
        let bad = |field, value, allowed| {
            Err(InvalidValue {
                field,
                value,
                allowed,
            })
        };
        let (tray, thinnest) = (
            self.floor.map_or(0.0, |floor| floor.tray),
            self.body.half_extents().min_element(),
        );
        if tray > 0.0 && tray < thinnest {
            return bad(
                "floor.tray",
                tray,
                "0 or at least the smallest half-extent of the box",
            );
        }
        if !(self.duration.is_finite() && self.duration > 0.0) {
            return bad("duration", self.duration, "finite and positive");
        }
        if !self.initial.is_finite() {
            return bad("initial", f64::NAN, "finite in every component");
        }
        let mut last = 0.0;
        for i in &self.impulses {
            if !(i.t.is_finite() && i.t >= last) {
                return bad("impulses.t", i.t, "finite, not negative and in order");
            }
            if !(i.impulse.is_finite() && i.body_point.is_finite()) {
                return bad("impulses", f64::NAN, "finite in every component");
            }
            last = i.t;
        }
        Ok(())
    }
}
