//! Everything a person can ask of the game. Keys, the panel, the command line and scripts all emit
//! these; one system applies them, so a test of an action is a test of every way to trigger it.

use std::path::PathBuf;

use box_physics::prelude::{DVec3, Integrator};
use box_scenarios::SceneView;
use box_scenarios::dissertation::Stepper;
use serde::{Deserialize, Serialize};

use crate::interaction::grab::Hold;
use crate::record::film::Film;

use crate::compare::CompareAction;

/// One request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// Simulate every box with this integrator from the next step on; the state is carried over.
    SetIntegrator(#[serde(with = "by_id")] Integrator),
    /// Stop or resume the clock.
    TogglePause,
    /// This many steps while paused (pauses first).
    Step(u32),
    /// This many ticks back (pauses first).
    StepBack(u32),
    /// The scene from its start, with the present parameters.
    Restart,
    /// Target speed: simulated seconds per second, 0.01 to 4.
    SetSpeed(f64),
    /// One notch down the speed ladder.
    Slower,
    /// One notch up the speed ladder.
    Faster,
    /// Step size dt \[s\], 1/1920 to 0.5.
    SetStep(f64),
    /// Substeps per step, 1 to 64.
    SetSubsteps(u32),
    /// Gravity, downwards [m/s²].
    SetGravity(f64),
    /// Restitution of the floor, 0 to 1.
    SetRestitution(f64),
    /// Friction of the floor, ≥ 0.
    SetFriction(f64),
    /// Linear drag c₁ [N s/m].
    SetLinearDrag(f64),
    /// Angular damping γ [1/s].
    SetAngularDamping(f64),
    /// Size of the box: half-extents \[m\]. Restarts the scene.
    SetHalfExtents(DVec3),
    /// Mass of the box \[kg\]. Restarts the scene.
    SetMass(f64),
    /// Strength of a push \[N s\].
    SetImpulse(f64),
    /// Number of boxes. Restarts the scene.
    SetBoxes(u32),
    /// Every parameter back to the scene's own.
    ResetParameters,
    /// The game as it opens: first scene, its parameters, default integrator, step, speed, switches.
    ResetEverything,
    /// Take back the last change of a parameter, or the last reset.
    Undo,
    /// Do again what was taken back.
    Redo,
    /// This scene, by its id, or by the path of its file.
    SelectScene(String),
    /// The next scene of the list.
    NextScene,
    /// The previous scene of the list.
    PreviousScene,
    /// An impulse on the hero box.
    Push(Push),
    /// An impulse on the hero box at a point of its surface.
    Poke(Poke),
    /// Hold the hero box at a point, or let go.
    Grab(Option<Hold>),
    /// One frame that takes much longer than it may: time is dropped, counted and shown.
    Hitch,
    /// In the 2012 scene: this stepper of the dissertation's, or ours.
    SetDemo(#[serde(with = "stepper")] Option<Stepper>),
    /// Start or stop the dissertation's log of cycle times, a text file.
    ToggleDemoLog,
    /// Draw the re-fitted bounding boxes.
    ToggleAabb,
    /// Draw contact points, normals and impulses.
    ToggleContacts,
    /// Draw body axes and velocity.
    ToggleAxes,
    /// Start or stop the CSV log.
    ToggleLog,
    /// Save a PNG of the window.
    Screenshot,
    /// The same under this name.
    ScreenshotTo(PathBuf),
    /// Save a PNG of the open plot or table alone, under this name or the next free one.
    SavePlot(Option<PathBuf>),
    /// Film the picture, as animated PNG.
    Record(Film),
    /// The command line that brings this set-up back, to the clipboard.
    CopyCommandLine,
    /// Put the hero in the middle of the picture.
    FrameCamera,
    /// The scene's own camera.
    HomeCamera,
    /// Put the camera here.
    SetCamera(SceneView),
    /// Scale of the panel, 0.75 to 2.
    SetUiScale(f64),
    /// Show or hide the list of scenes to search in.
    TogglePicker,
    /// Show or hide the list of keys.
    ToggleHelp,
    /// Show or hide the panel; hidden leaves a one-line display.
    TogglePanel,
    /// Show or hide the drawer with the plots.
    TogglePlots,
    /// Choose the plot in the drawer.
    SelectPlot(Plot),
    /// Of the comparison of integrators.
    Compare(CompareAction),
    /// End the program.
    Quit,
}

/// A push along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Push {
    /// Direction: a unit vector along ±x, ±y or ±z.
    pub direction: DVec3,
    /// Along the world's axes instead of the box's own.
    #[serde(default)]
    pub world: bool,
    /// At the edge of the face instead of its middle, so that it spins.
    #[serde(default)]
    pub off_center: bool,
}

/// A push at a point of the surface, inwards.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Poke {
    /// Where, body axes from the center \[m\].
    pub body_point: DVec3,
    /// Outward normal of the face, body axes; the impulse is against it.
    pub normal: DVec3,
    /// In strengths of the panel.
    pub strength: f64,
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

/// What the drawer shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Plot {
    /// Distance and angle to the reference over time.
    Error,
    /// Energy and angular momentum that are not accounted for, over time.
    #[default]
    Energy,
    /// ns per body-step of every integrator over time.
    Timing,
    /// CPU use of the process and the system over time.
    Cpu,
    /// Error against cost.
    WorkPrecision,
    /// The figures of every integrator.
    Table,
}

/// An integrator in a file: by its id.
mod by_id {
    use super::Integrator;
    use serde::{Deserialize as _, Deserializer, Serializer, de::Error as _};

    pub(super) fn serialize<S: Serializer>(i: &Integrator, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(i.id())
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Integrator, D::Error> {
        String::deserialize(from)?.parse().map_err(D::Error::custom)
    }
}

/// A stepper of the dissertation's in a file: by its id.
mod stepper {
    use super::Stepper;
    use serde::{Deserialize as _, Deserializer, Serializer, de::Error as _};

    pub(super) fn serialize<S: Serializer>(s: &Option<Stepper>, to: S) -> Result<S::Ok, S::Error> {
        match s {
            Some(stepper) => to.serialize_some(stepper.id()),
            None => to.serialize_none(),
        }
    }

    pub(super) fn deserialize<'de, D>(from: D) -> Result<Option<Stepper>, D::Error>
    where
        D: Deserializer<'de>,
    {
        let Some(id) = Option::<String>::deserialize(from)? else {
            return Ok(None);
        };
        let found = Stepper::ALL.into_iter().find(|s| s.id() == id);
        found.map(Some).ok_or_else(|| {
            let ids = Stepper::ALL.map(Stepper::id).join(", ");
            D::Error::custom(format!("unknown stepper '{id}'; allowed: {ids}"))
        })
    }
}
