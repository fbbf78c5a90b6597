//! All actions of the game. Keys, panel, mouse, command line and scripts request them; each feature
//! observes its own actions, so a test of an action covers every way to trigger it.

pub mod compare;

use std::path::PathBuf;

use bevy::input::InputSystems;
use bevy::prelude::*;
use box_physics::prelude::{DVec3, Integrator};
use box_scenarios::SceneView;
use box_scenarios::dissertation::Stepper;
use serde::{Deserialize, Serialize};

pub use box_scenarios::Plot;

use crate::parameters::Parameter;
use compare::CompareAction;

/// The actions requested since the last frame, in order.
#[derive(Resource, Clone, Debug, Default)]
pub struct Actions(pub Vec<Action>);

/// The two stages of actions, in `PreUpdate`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ActionSystems {
    /// Keys, gamepads and scripts add to [`Actions`].
    Request,
    /// Each action is triggered as an event.
    Trigger,
}

/// Triggers the requested actions one by one.
pub fn plugin(app: &mut App) {
    app.init_resource::<Actions>()
        .configure_sets(
            PreUpdate,
            (ActionSystems::Request, ActionSystems::Trigger)
                .chain()
                .after(InputSystems),
        )
        .add_systems(PreUpdate, trigger_actions.in_set(ActionSystems::Trigger));
}

/// Triggers the requested actions.
pub fn trigger_actions(world: &mut World) {
    for action in core::mem::take(&mut world.resource_mut::<Actions>().0) {
        world.trigger(action);
        world.flush();
    }
}

/// An action, as requested by keys, panel and scripts.
#[derive(Event, Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// Simulate every box with this integrator from the next step on; the state is unchanged.
    SetIntegrator(Integrator),
    /// Pause or resume.
    TogglePause,
    /// Take this many steps (pauses first).
    Step(u32),
    /// Step back by this many ticks (pauses first).
    StepBack(u32),
    /// Restart the scene with the current parameters.
    Restart,
    /// Target speed: simulated seconds per second, 0.01 to 4.
    SetSpeed(f64),
    /// The next lower speed.
    Slower,
    /// The next higher speed.
    Faster,
    /// Set a parameter.
    Set(Parameter, f64),
    /// Restore the scene's parameters.
    ResetParameters,
    /// Restore the first scene and every default.
    ResetEverything,
    /// Undo the last change of a parameter, or the last restart.
    Undo,
    /// Redo the last undone change.
    Redo,
    /// Open the scene with this id or in this file.
    SelectScene(String),
    /// Open the next scene of the list.
    NextScene,
    /// Open the previous scene of the list.
    PreviousScene,
    /// Apply an impulse to the main box.
    Push(Push),
    /// Apply an impulse to the main box at a point of its surface.
    Poke(Poke),
    /// Grab the main box at a point, or release it.
    Grab(Option<Hold>),
    /// In the 2012 scene: use an integrator of the dissertation, or the plugin.
    SetDemo(#[serde(with = "stepper")] Option<Stepper>),
    /// Start or stop the dissertation's log of cycle times, a text file.
    ToggleDemoLog,
    /// Show or hide the bounding boxes.
    ToggleAabb,
    /// Show or hide contact points, impulses and friction cones.
    ToggleContacts,
    /// Show or hide body axes and velocity.
    ToggleAxes,
    /// Start or stop the CSV log.
    ToggleLog,
    /// Save a PNG of the window.
    Screenshot,
    /// Save a PNG of the window under this name.
    ScreenshotTo(PathBuf),
    /// Save a PNG of the open plot or table alone, under this name or the next free one.
    SavePlot(Option<PathBuf>),
    /// Save a series of numbered screenshots.
    Record(Film),
    /// Copy the command line that restores this session to the clipboard.
    CopyCommandLine,
    /// Center the view on the main box.
    FrameCamera,
    /// Reset the view to that of the scene.
    HomeCamera,
    /// Place the camera.
    SetCamera(SceneView),
    /// Set the scale of the panel, 0.75 to 2.
    SetUiScale(f64),
    /// Show or hide the scene menu.
    TogglePicker,
    /// Show or hide the list of keys.
    ToggleHelp,
    /// Show or hide the panel; when hidden, one line remains.
    TogglePanel,
    /// Show or hide the drawer with the plots.
    TogglePlots,
    /// Switch between dark and light panel.
    ToggleTheme,
    /// Choose the plot in the drawer.
    SelectPlot(Plot),
    /// Control the comparison.
    Compare(CompareAction),
    /// End the program.
    Quit,
}

impl From<CompareAction> for Action {
    fn from(action: CompareAction) -> Self {
        Self::Compare(action)
    }
}

/// A push along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Push {
    /// Direction: a unit vector along ±x, ±y or ±z.
    pub direction: DVec3,
    /// Direction in world axes instead of body axes.
    #[serde(default)]
    pub world: bool,
    /// At the edge of the face instead of its center, so that the box spins.
    #[serde(default)]
    pub off_center: bool,
}

/// An inward push at a point of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Poke {
    /// Point in body axes, from the center \[m\].
    pub body_point: DVec3,
    /// Outward normal of the face, body axes; the impulse is opposite to it.
    pub normal: DVec3,
    /// Impulse as a multiple of the panel's strength.
    pub strength: f64,
}

/// A grab.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hold {
    /// Held point in body axes, from the center \[m\].
    pub body_point: DVec3,
    /// Target of that point, world axes \[m\].
    pub anchor: DVec3,
}

/// A series of numbered screenshots.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Film {
    /// Folder of the screenshots `0001.png`, `0002.png`, …; created if it does not exist.
    pub folder: PathBuf,
    /// Number of screenshots.
    pub pictures: u32,
    /// Screenshots per second of the program's clock.
    pub rate: f64,
}

/// Serialization of an integrator of the dissertation by its id.
mod stepper {
    use super::Stepper;
    use serde::{Deserialize as _, Deserializer, Serialize as _, Serializer, de::Error as _};

    pub(super) fn serialize<S: Serializer>(s: &Option<Stepper>, to: S) -> Result<S::Ok, S::Error> {
        s.map(Stepper::id).serialize(to)
    }

    pub(super) fn deserialize<'de, D>(from: D) -> Result<Option<Stepper>, D::Error>
    where
        D: Deserializer<'de>,
    {
        let known = |id: String| {
            let found = Stepper::ALL.into_iter().find(|s| s.id() == id);
            found.ok_or_else(|| {
                let ids = Stepper::ALL.map(Stepper::id).join(", ");
                D::Error::custom(format!("unknown 2012 integrator '{id}'; allowed: {ids}"))
            })
        };
        let id = Option::<String>::deserialize(from)?;
        id.map(known).transpose()
    }
}
