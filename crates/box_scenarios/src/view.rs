//! The view of a scene: camera and plot.

use glam::DVec3;
use serde::de::{Deserializer, Error};
use serde::{Deserialize, Serialize};

use crate::limits;

/// The camera when the scene opens, and the plot that is open. Every field has a default.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SceneView {
    /// Angle about the vertical \[degrees\]; 0 looks along −z, positive is to the right.
    #[serde(deserialize_with = "yaw")]
    pub yaw: f64,
    /// Angle above the horizon \[degrees\], −85 to 85.
    #[serde(deserialize_with = "pitch")]
    pub pitch: f64,
    /// Distance from the target \[m\]; by default one that shows the box and the floor below it.
    #[serde(deserialize_with = "distance")]
    pub distance: Option<f64>,
    /// The target of the camera \[m\]; by default the box, or between box and floor.
    #[serde(deserialize_with = "limits::optional_vector")]
    pub target: Option<DVec3>,
    /// The plot worth watching.
    pub plot: PlotPreset,
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
            plot: PlotPreset::Energy,
        }
    }
}

impl SceneView {
    /// From `yaw` and `pitch` \[degrees\].
    pub const fn from(yaw: f64, pitch: f64) -> Self {
        Self {
            yaw,
            pitch,
            distance: None,
            target: None,
            plot: PlotPreset::Energy,
        }
    }

    /// The same at `target` \[m\] from `distance` \[m\].
    #[must_use]
    pub const fn at(mut self, target: [f64; 3], distance: f64) -> Self {
        self.target = Some(DVec3::from_array(target));
        self.distance = Some(distance);
        self
    }

    /// The same with another plot.
    #[must_use]
    pub const fn with_plot(mut self, plot: PlotPreset) -> Self {
        self.plot = plot;
        self
    }
}

/// The plots there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlotPreset {
    /// Position and attitude error against the reference.
    Error,
    /// Energy and angular momentum.
    #[default]
    Energy,
    /// What a step costs.
    Timing,
    /// Use of the processor.
    Cpu,
    /// Error against cost.
    WorkPrecision,
    /// The figures of every integrator.
    Table,
}
