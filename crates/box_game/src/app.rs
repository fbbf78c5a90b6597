//! The game as a list of plugins: without a window, which tests drive, and with its picture.

use bevy::app::ScheduleRunnerPlugin;
use bevy::asset::AssetEventSystems;
use bevy::diagnostic::FrameTimeDiagnosticsPlugin;
use bevy::input::InputPlugin;
use bevy::light::SimulationLightSystems;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_egui::{EguiPlugin, EguiPostUpdateSet};
use box_physics::prelude::PhysicsPlugins;

use crate::action::ActionPlugin;
use crate::camera::CameraPlugin;
use crate::cli::Cli;
use crate::cli::start::{CommandLinePlugin, open_files};
use crate::compare::ComparePlugin;
use crate::compare::sampling::SamplingPlugin;
use crate::demo_2012::Demo2012Plugin;
use crate::input::ControlsPlugin;
use crate::interaction::{InteractionPlugin, MousePlugin};
use crate::platform;
use crate::preferences::PreferencesPlugin;
use crate::record::{PicturesPlugin, RecordPlugin};
use crate::scene::ScenePlugin;
use crate::ui::{PanelPlugin, SwitchesPlugin};
use crate::view::ViewPlugin;
use crate::view::renderer::{TargetPlugin, renderer};

/// The whole game but window, picture and panel. Needs time and input; runs in a test under
/// `MinimalPlugins` and `InputPlugin`.
pub struct GamePlugin {
    /// The command line.
    pub cli: Cli,
}

impl Plugin for GamePlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((
            PhysicsPlugins::default(),
            ActionPlugin,
            ScenePlugin,
            ControlsPlugin,
            InteractionPlugin,
            Demo2012Plugin,
            ComparePlugin,
            SamplingPlugin,
            RecordPlugin,
            SwitchesPlugin,
            CommandLinePlugin {
                cli: self.cli.clone(),
            },
        ));
    }
}

/// The game without window, picture and panel, as tests and benchmarks run it: each update is one tick.
pub fn headless(cli: Cli) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, InputPlugin, GamePlugin { cli }))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app
}

/// The game with its picture, in a window or offscreen.
///
/// # Errors
/// An error of a file that the command line names.
pub fn build(cli: &Cli) -> std::io::Result<App> {
    let (offscreen, size) = (cli.offscreen, cli.size);
    let mut app = App::new();
    app.add_plugins(renderer(offscreen, size));
    // An offscreen picture does not depend on settings of the user.
    if !(cli.no_settings || offscreen) {
        app.add_plugins(PreferencesPlugin);
    }
    app.add_plugins((
        EguiPlugin::default(),
        FrameTimeDiagnosticsPlugin::default(),
        platform::plugin,
        GamePlugin { cli: cli.clone() },
        TargetPlugin { offscreen, size },
        CameraPlugin,
        ViewPlugin,
        MousePlugin,
        PanelPlugin,
        PicturesPlugin,
    ));
    // The panel switches cameras on, for which lights then need cascades. And a new glyph has to reach the screen in
    // the frame that shows it, and so the picture of that frame.
    app.configure_sets(
        PostUpdate,
        (
            EguiPostUpdateSet::EndPass
                .before(SimulationLightSystems::UpdateDirectionalLightCascades),
            EguiPostUpdateSet::PostProcessOutput.before(AssetEventSystems),
        ),
    );
    if offscreen {
        // One step per frame, so that a picture shows a known time however slow the renderer is.
        app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
            .add_plugins(ScheduleRunnerPlugin::run_loop(core::time::Duration::ZERO));
    }
    open_files(&mut app, cli)?;
    Ok(app)
}
