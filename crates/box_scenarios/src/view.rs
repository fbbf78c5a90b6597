//! The view of a scene: camera and plot.

use glam::DVec3;
use serde::de::{Deserializer, Error};
use serde::{Deserialize, Serialize};

use crate::limits;

/// The initial camera and the open plot of a scene. Every field has a default.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SceneView {
    /// Angle about the vertical \[degrees\]; 0 looks along −z, positive is to the right.
    #[serde(deserialize_with = "yaw")]
    pub yaw: f64,
    /// Angle above the horizon \[degrees\], −85 to 85.
    #[serde(deserialize_with = "pitch")]
    pub pitch: f64,
    /// Distance from the target \[m\]; the default shows the box and the floor below it.
    #[serde(deserialize_with = "distance")]
    pub distance: Option<f64>,
    /// Target of the camera \[m\]; the default is the box, or a point between box and floor.
    #[serde(deserialize_with = "limits::optional_vector")]
    pub target: Option<DVec3>,
    /// The most interesting plot.
    pub plot: Plot,
}

fn yaw<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    limits::number(from, -360.0..=360.0, "between -360 and 360 degrees")
}

fn pitch<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    limits::number(from, -85.0..=85.0, "between -85 and 85 degrees")
}

fn distance<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    match Option::<f64>::deserialize(from)? {
        Some(d) if !(0.01..=1e4).contains(&d) => Err(Error::custom(format_args!(
            "must be between 0.01 and 10000 m, but is {d}"
        ))),
        distance => Ok(distance),
    }
}

impl Default for SceneView {
    fn default() -> Self {
        Self {
            yaw: 34.0,
            pitch: 20.0,
            distance: None,
            target: None,
            plot: Plot::Energy,
        }
    }
}

impl SceneView {
    /// A view from `yaw` and `pitch` \[degrees\].
    pub const fn from(yaw: f64, pitch: f64) -> Self {
        Self {
            yaw,
            pitch,
            distance: None,
            target: None,
            plot: Plot::Energy,
        }
    }

    /// Sets the target to `target` \[m\] and the distance to `distance` \[m\].
    #[must_use]
    pub const fn at(mut self, target: [f64; 3], distance: f64) -> Self {
        self.target = Some(DVec3::from_array(target));
        self.distance = Some(distance);
        self
    }

    /// Sets the plot.
    #[must_use]
    pub const fn with_plot(mut self, plot: Plot) -> Self {
        self.plot = plot;
        self
    }
}

/// Tabs of the drawer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Plot {
    /// Distance and angle to the reference over time.
    Error,
    /// Drift of energy and angular momentum over time.
    #[default]
    Energy,
    /// Time per body-step \[ns\] of every integrator over time.
    Timing,
    /// CPU use of the process and the system over time.
    Cpu,
    /// Errors against cost.
    WorkPrecision,
    /// A table of all values of every integrator.
    Table,
}

impl Plot {
    /// Every tab with its name on the command line.
    pub const ALL: [(Self, &str); 6] = [
        (Self::Error, "error"),
        (Self::Energy, "energy"),
        (Self::Timing, "timing"),
        (Self::Cpu, "cpu"),
        (Self::WorkPrecision, "work-precision"),
        (Self::Table, "table"),
    ];
}
