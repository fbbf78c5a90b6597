//! Everything a person can request. Keys, panel, mouse, command line and scripts all request these; each
//! feature observes those that are its own, so a test of an action is a test of every way to trigger it.

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

/// Triggers the requested actions, one after the other.
pub struct ActionPlugin;

impl Plugin for ActionPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Actions>()
            .configure_sets(
                PreUpdate,
                (ActionSystems::Request, ActionSystems::Trigger)
                    .chain()
                    .after(InputSystems),
            )
            .add_systems(PreUpdate, trigger_actions.in_set(ActionSystems::Trigger))
            .add_observer(quit);
    }
}

/// Triggers the requested actions.
pub fn trigger_actions(world: &mut World) {
    for action in core::mem::take(&mut world.resource_mut::<Actions>().0) {
        world.trigger(action);
        world.flush();
    }
}

fn quit(action: On<Action>, mut exit: MessageWriter<AppExit>) {
    if *action == Action::Quit {
        exit.write(AppExit::Success);
    }
}

/// One request.
#[derive(Event, Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// Simulate every box with this integrator from the next step on; the state is carried over.
    SetIntegrator(Integrator),
    /// Pause or resume.
    TogglePause,
    /// Take this many steps (pauses first).
    Step(u32),
    /// Step this many ticks back (pauses first).
    StepBack(u32),
    /// Restart the scene with the current parameters.
    Restart,
    /// Target speed: simulated seconds per second, 0.01 to 4.
    SetSpeed(f64),
    /// One notch down the speed ladder.
    Slower,
    /// One notch up the speed ladder.
    Faster,
    /// Sets a parameter.
    Set(Parameter, f64),
    /// Restore the scene's own parameters.
    ResetParameters,
    /// Restore the first scene and every default.
    ResetEverything,
    /// Undo the last change of a parameter, or the last restart.
    Undo,
    /// Redo the last undone change.
    Redo,
    /// This scene, by its id, or by the path of its file.
    SelectScene(String),
    /// The next scene of the list.
    NextScene,
    /// The previous scene of the list.
    PreviousScene,
    /// An impulse on the main box.
    Push(Push),
    /// An impulse on the main box at a point of its surface.
    Poke(Poke),
    /// Grab the main box at a point, or release it.
    Grab(Option<Hold>),
    /// In the 2012 scene: a stepper of the dissertation, or the plugin.
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
    /// Save it under this name.
    ScreenshotTo(PathBuf),
    /// Save a PNG of the open plot or table alone, under this name or the next free one.
    SavePlot(Option<PathBuf>),
    /// Film the picture, as animated PNG.
    Record(Film),
    /// Copy the command line that restores this session to the clipboard.
    CopyCommandLine,
    /// Center the view on the main box.
    FrameCamera,
    /// Reset the view to the scene's own.
    HomeCamera,
    /// Place the camera.
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
    /// Dark or light panel.
    ToggleTheme,
    /// Choose the plot in the drawer.
    SelectPlot(Plot),
    /// An action of the comparison.
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

/// A grab.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hold {
    /// The held point, body axes from the center \[m\].
    pub body_point: DVec3,
    /// The target of that point \[m\].
    pub anchor: DVec3,
}

/// A series of numbered pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Film {
    /// The folder of the pictures `0001.png`, `0002.png`, …; created where it is missing.
    pub folder: PathBuf,
    /// Number of pictures.
    pub pictures: u32,
    /// Pictures per second of the program's clock.
    pub rate: f64,
}

/// A stepper of the dissertation's in a file: by its id.
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
