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
    /// The floor of the setup, if it is valid.
    pub(crate) floor: Option<Floor>,
    floor_spec: Option<FloorSpec>,
    /// Floor and walls of a tray; empty without walls.
    pub(crate) planes: Vec<Plane>,
    /// Limits of the contact solver.
    pub settings: ContactSettings,
}

impl Model {
    /// The model of `setup`. A floor with invalid values is omitted; [`Setup::validate`] rejects it.
    pub fn of(setup: &Setup) -> Self {
        let floor = setup.floor.and_then(|spec| {
            let floor = Floor::new(spec.height, spec.restitution, spec.friction).ok()?;
            Some((spec, floor))
        });
        Self {
            body: setup.body,
            forces: setup.forces.clone(),
            floor: floor.map(|(_, floor)| floor),
            floor_spec: floor.map(|(spec, _)| spec),
            planes: floor.map_or_else(Vec::new, planes),
            settings: ContactSettings {
                restitution: setup.floor.map(|f| f.restitution_law).unwrap_or_default(),
                ..ContactSettings::default()
            },
        }
    }

    /// A model of `body` under `forces`, without a floor.
    pub fn without_floor(body: RigidBox, forces: ForceSet) -> Self {
        Self::of(&Setup::new(body, BodyState::default(), forces, 0.0))
    }

    /// The floor, if there is one.
    pub fn floor(&self) -> Option<Floor> {
        self.floor
    }

    /// A setup with this model that starts in `state` and lasts `duration` \[s\], without impulses.
    pub fn setup(&self, state: BodyState, duration: f64) -> Setup {
        Setup {
            floor: self.floor_spec,
            ..Setup::new(self.body, state, self.forces.clone(), duration)
        }
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
        may_touch_planes(&self.planes, &self.body, state, &forces, h)
            || self
                .floor
                .is_some_and(|floor| may_touch(&floor, &self.body, state, &forces, h))
    }

    /// Returns `true` if only a uniform acceleration acts in flight.
    pub fn is_uniform_acceleration(&self) -> bool {
        !self.forces.has_wrench() && self.forces.dissipation() == Dissipation::NONE
    }
}

fn planes((spec, floor): (FloorSpec, Floor)) -> Vec<Plane> {
    let wall = |shape| Plane::new(shape, floor.restitution, floor.friction).ok();
    let walls = spec.walls().into_iter().filter_map(wall);
    let floor = Some(Plane::from(floor)).filter(|_| spec.tray > 0.0);
    floor.into_iter().chain(walls).collect()
}
