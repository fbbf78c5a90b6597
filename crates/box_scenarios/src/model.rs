//! A box and everything that acts on it.

use box_physics::body::RigidBox;
use box_physics::floor::{ContactSettings, Floor, Plane, may_touch, may_touch_planes};
use box_physics::force::Dissipation;
use box_physics::state::BodyState;

use crate::forces::ForceSet;
use crate::setup::{FloorSpec, Setup};

/// A box and everything that acts on it, without its state.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The box.
    pub body: RigidBox,
    /// The forces.
    pub forces: ForceSet,
    /// The floor, if there is one.
    pub floor: Option<Floor>,
    /// Distance from the middle of a tray to its walls \[m\]; 0 without walls.
    pub tray: f64,
    /// Limits of the contact solver.
    pub settings: ContactSettings,
}

impl Model {
    /// The model of `setup`. A floor with invalid values is omitted; [`Setup::validate`] rejects it.
    pub fn of(setup: &Setup) -> Self {
        Self {
            body: setup.body,
            forces: setup.forces.clone(),
            floor: setup
                .floor
                .and_then(|f| Floor::new(f.height, f.restitution, f.friction).ok()),
            tray: setup.floor.map_or(0.0, |f| f.tray),
            settings: ContactSettings {
                restitution: setup.floor.map(|f| f.restitution_law).unwrap_or_default(),
                ..ContactSettings::default()
            },
        }
    }

    /// A model of `body` under `forces`, without a floor.
    pub fn without_floor(body: RigidBox, forces: ForceSet) -> Self {
        Self {
            body,
            forces,
            floor: None,
            tray: 0.0,
            settings: ContactSettings::default(),
        }
    }

    /// A setup with this model that starts in `state` and lasts `duration` \[s\], without impulses.
    pub fn setup(&self, state: BodyState, duration: f64) -> Setup {
        let setup = Setup::new(self.body, state, self.forces.clone(), duration);
        match &self.floor {
            Some(f) => setup.with_floor(self.floor_spec(f)),
            None => setup,
        }
    }

    fn floor_spec(&self, floor: &Floor) -> FloorSpec {
        FloorSpec {
            height: floor.height,
            restitution: floor.restitution,
            restitution_law: self.settings.restitution,
            friction: floor.friction,
            tray: self.tray,
        }
    }

    /// Floor and walls of a tray; empty without walls.
    pub(crate) fn planes(&self) -> Vec<Plane> {
        let Some(floor) = self.floor.filter(|_| self.tray > 0.0) else {
            return Vec::new();
        };
        let walls = self.floor_spec(&floor).walls().into_iter();
        let walls =
            walls.filter_map(|wall| Plane::new(wall, floor.restitution, floor.friction).ok());
        [Plane::from(floor)].into_iter().chain(walls).collect()
    }

    /// Kinetic plus potential energy \[J\].
    pub fn energy(&self, state: &BodyState) -> f64 {
        box_physics::energy::total_energy(&self.body, state, &self.forces.forces(&self.body))
    }

    /// Returns `true` if the forces conserve energy (not considering the floor).
    pub fn is_conservative(&self) -> bool {
        box_physics::energy::is_conservative(&self.forces.forces(&self.body))
    }

    /// Returns `true` if a box in this state may touch the floor within `h` \[s\].
    pub fn may_touch(&self, state: &BodyState, h: f64) -> bool {
        let forces = self.forces.forces(&self.body);
        may_touch_planes(&self.planes(), &self.body, state, &forces, h)
            || self
                .floor
                .is_some_and(|floor| may_touch(&floor, &self.body, state, &forces, h))
    }

    /// Returns `true` if only a uniform acceleration acts in flight.
    pub fn is_uniform_acceleration(&self) -> bool {
        !self.forces.has_wrench() && self.forces.dissipation() == Dissipation::NONE
    }
}
