//! A scene as a file stores it.

use box_physics::body::RigidBox;
use box_physics::error::InvalidValue;
use box_physics::state::BodyState;
use glam::{DQuat, DVec3};
use serde::de::{Deserializer, Error as _};
use serde::{Deserialize, Serialize};

use super::{check, intern};
use crate::forces::ForceSet;
use crate::limits;
use crate::scenario::Scenario;
use crate::setup::{FloorSpec, Setup, TimedImpulse};
use crate::view::SceneView;

/// The whole file. Fields without a default are required.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneForm {
    #[serde(deserialize_with = "check::id")]
    id: String,
    #[serde(deserialize_with = "check::title")]
    title: String,
    #[serde(default, deserialize_with = "check::line")]
    lesson: String,
    #[serde(default, deserialize_with = "check::hints")]
    hints: Vec<String>,
    #[serde(default, deserialize_with = "check::recommended")]
    recommended: Vec<String>,
    #[serde(default = "one", deserialize_with = "check::boxes")]
    boxes: u32,
    #[serde(deserialize_with = "check::duration")]
    duration: f64,
    #[serde(deserialize_with = "body")]
    body: BodyForm,
    #[serde(default, deserialize_with = "start")]
    start: StartForm,
    #[serde(default)]
    forces: ForceSet,
    #[serde(default)]
    floor: Option<FloorSpec>,
    #[serde(default, deserialize_with = "impulses")]
    impulses: Vec<TimedImpulse>,
    #[serde(default)]
    view: SceneView,
}

fn one() -> u32 {
    1
}

fn body<'de, D: Deserializer<'de>>(from: D) -> Result<BodyForm, D::Error> {
    let form = BodyForm::deserialize(from)?;
    form.build().map_err(D::Error::custom)?;
    Ok(form)
}

fn start<'de, D: Deserializer<'de>>(from: D) -> Result<StartForm, D::Error> {
    let form = StartForm::deserialize(from)?;
    let spins = [
        form.body_angular_velocity,
        form.world_angular_velocity,
        form.angular_momentum,
    ];
    if spins.iter().flatten().count() > 1 {
        return Err(D::Error::custom(
            "the spin is given twice; set only one of body_angular_velocity, world_angular_velocity and angular_momentum",
        ));
    }
    Ok(form)
}

fn impulses<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<TimedImpulse>, D::Error> {
    limits::at_most(from, limits::MAX_ITEMS)
}

/// The box.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BodyForm {
    #[serde(deserialize_with = "check::half_extents")]
    half_extents: DVec3,
    #[serde(deserialize_with = "check::mass")]
    mass: f64,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "limits::optional_vector"
    )]
    inertia: Option<DVec3>,
}

/// The state at t = 0. The spin is given as one of three quantities.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct StartForm {
    #[serde(deserialize_with = "limits::vector")]
    position: DVec3,
    #[serde(deserialize_with = "check::rotation")]
    rotation: DQuat,
    #[serde(deserialize_with = "limits::vector")]
    velocity: DVec3,
    // The alias is the name used in older files.
    #[serde(
        alias = "angular_velocity",
        skip_serializing_if = "Option::is_none",
        deserialize_with = "limits::optional_vector"
    )]
    body_angular_velocity: Option<DVec3>,
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "limits::optional_vector"
    )]
    world_angular_velocity: Option<DVec3>,
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "limits::optional_vector"
    )]
    angular_momentum: Option<DVec3>,
}

impl SceneForm {
    /// Converts `scene` so that it reads back bit for bit.
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
                body_angular_velocity: None,
                world_angular_velocity: None,
                angular_momentum: Some(setup.initial.angular_momentum),
            },
            forces: setup.forces.clone(),
            floor: setup.floor,
            impulses: setup.impulses.clone(),
            view: scene.view,
        }
    }

    /// Converts to a scene.
    ///
    /// # Errors
    /// A description of the error, if the scene as a whole is invalid.
    pub(super) fn into_scenario(self) -> Result<Scenario, String> {
        let body = self.body.build().map_err(|e| e.to_string())?;
        let setup = Setup {
            initial: self.start.build(&body),
            body,
            forces: self.forces,
            floor: self.floor,
            impulses: self.impulses,
            duration: self.duration,
        };
        check::setup(&setup)?;
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
    fn build(&self) -> Result<RigidBox, InvalidValue> {
        let body = RigidBox::new(self.half_extents, self.mass)?;
        self.inertia.map_or(Ok(body), |i| body.with_inertia(i))
    }
}

impl StartForm {
    fn build(&self, body: &RigidBox) -> BodyState {
        let mut state = BodyState::at(self.position).with_velocity(self.velocity);
        state.rotation = self.rotation;
        state.angular_momentum = self.angular_momentum.unwrap_or_default();
        match (self.body_angular_velocity, self.world_angular_velocity) {
            (Some(spin), _) => state.with_body_angular_velocity(body, spin),
            (_, Some(spin)) => state.with_angular_velocity(body, spin),
            _ => state,
        }
    }
}
