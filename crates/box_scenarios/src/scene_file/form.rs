//! A scene as it stands in a file.

use box_physics::body::RigidBox;
use box_physics::state::BodyState;
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::check::{self, BadValue};
use super::intern;
use crate::forces::ForceSet;
use crate::scenario::Scenario;
use crate::setup::{FloorSpec, Setup, TimedImpulse};
use crate::view::SceneView;

/// The whole file. Fields without a default are required.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneForm {
    pub(super) id: String,
    pub(super) title: String,
    #[serde(default)]
    pub(super) lesson: String,
    #[serde(default)]
    pub(super) hints: Vec<String>,
    #[serde(default)]
    pub(super) recommended: Vec<String>,
    #[serde(default = "one")]
    pub(super) boxes: u32,
    pub(super) duration: f64,
    pub(super) body: BodyForm,
    #[serde(default)]
    pub(super) start: StartForm,
    #[serde(default)]
    pub(super) forces: ForceSet,
    #[serde(default)]
    pub(super) floor: Option<FloorSpec>,
    #[serde(default)]
    pub(super) impulses: Vec<TimedImpulse>,
    #[serde(default)]
    pub(super) view: SceneView,
}

fn one() -> u32 {
    1
}

/// The box.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BodyForm {
    half_extents: DVec3,
    mass: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    inertia: Option<DVec3>,
}

/// Its state at t = 0. The spin is given as one of two quantities.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct StartForm {
    position: DVec3,
    rotation: DQuat,
    velocity: DVec3,
    #[serde(skip_serializing_if = "Option::is_none")]
    angular_velocity: Option<DVec3>,
    #[serde(skip_serializing_if = "Option::is_none")]
    angular_momentum: Option<DVec3>,
}

impl SceneForm {
    /// `scene`, so that it reads back bit for bit.
    pub(super) fn of(scene: &Scenario) -> Self {
        let (setup, body) = (&scene.setup, &scene.setup.body);
        let solid = RigidBox::new(body.half_extents(), body.mass());
        let inertia = (solid.map(|b| b.inertia()) != Ok(body.inertia())).then(|| body.inertia());
        Self {
            id: scene.id.to_owned(),
            title: scene.title.to_owned(),
            lesson: scene.lesson.to_owned(),
            hints: scene.hints.map(str::to_owned).into(),
            recommended: scene.recommended.iter().map(|&s| s.to_owned()).collect(),
            boxes: scene.boxes,
            duration: setup.duration,
            body: BodyForm {
                half_extents: body.half_extents(),
                mass: body.mass(),
                inertia,
            },
            start: StartForm {
                position: setup.initial.position,
                rotation: setup.initial.rotation,
                velocity: setup.initial.velocity,
                angular_velocity: None,
                angular_momentum: Some(setup.initial.angular_momentum),
            },
            forces: setup.forces.clone(),
            floor: setup.floor,
            impulses: setup.impulses.clone(),
            view: scene.view,
        }
    }

    /// The scene, checked.
    pub(super) fn into_scenario(self) -> Result<Scenario, BadValue> {
        check::texts(&self)?;
        let body = self.body.build()?;
        let setup = Setup {
            initial: self.start.build(&body)?,
            body,
            forces: self.forces,
            floor: self.floor,
            impulses: self.impulses,
            duration: self.duration,
        };
        check::setup(&setup)?;
        check::view(&self.view)?;
        let mut hints = self.hints.into_iter();
        let mut hint = || intern::text(hints.next().unwrap_or_default());
        Ok(Scenario {
            id: intern::text(self.id),
            title: intern::text(self.title),
            lesson: intern::text(self.lesson),
            hints: [hint(), hint()],
            recommended: intern::list(self.recommended),
            setup,
            boxes: self.boxes,
            view: self.view,
        })
    }
}

impl BodyForm {
    fn build(self) -> Result<RigidBox, BadValue> {
        let in_body = |e: box_physics::error::InvalidValue| BadValue::of("body", &e);
        check::size(self.half_extents, self.mass)?;
        let body = RigidBox::new(self.half_extents, self.mass).map_err(in_body)?;
        match self.inertia {
            Some(inertia) => body.with_inertia(inertia).map_err(in_body),
            None => Ok(body),
        }
    }
}

impl StartForm {
    fn build(self, body: &RigidBox) -> Result<BodyState, BadValue> {
        let mut state = BodyState::at(self.position).with_velocity(self.velocity);
        let norm = self.rotation.length();
        if !(norm.is_finite() && (0.5..2.0).contains(&norm)) {
            return Err(BadValue::new(
                "start.rotation",
                "must be a quaternion (x, y, z, w) of length 1",
            ));
        }
        // A unit quaternion keeps its bits.
        state.rotation = if (norm - 1.0).abs() < 1e-12 {
            self.rotation
        } else {
            self.rotation / norm
        };
        match (self.angular_velocity, self.angular_momentum) {
            (Some(_), Some(_)) => Err(BadValue::new(
                "start.angular_momentum",
                "is given twice: angular_velocity says the same",
            )),
            (Some(spin), None) => Ok(state.with_body_angular_velocity(body, spin)),
            (None, momentum) => {
                state.angular_momentum = momentum.unwrap_or_default();
                Ok(state)
            }
        }
    }
}
