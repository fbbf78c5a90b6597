//! The game as a list of plugins: without a window, which tests drive, and with its picture.

use std::io;

use bevy::app::{PluginGroupBuilder, ScheduleRunnerPlugin};
use bevy::asset::AssetEventSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::diagnostic::FrameTimeDiagnosticsPlugin;
use bevy::input::InputPlugin;
use bevy::light::SimulationLightSystems;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_egui::{EguiPlugin, EguiPostUpdateSet};
use box_physics::prelude::PhysicsPlugins;

use crate::cli::{Cli, start};
use crate::compare::{self, sampling};
use crate::view::renderer::{TargetPlugin, renderer};
use crate::{
    action, camera, demo_2012, input, interaction, platform, preferences, record, scene, ui, view,
};

/// The whole game without window, picture and panel. Requires time and input; tests run it under `MinimalPlugins` and
/// `InputPlugin`.
pub struct GamePlugin {
    /// The command line.
    pub cli: Cli,
}

impl Plugin for GamePlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((
            PhysicsPlugins::default(),
            action::plugin,
            scene::plugin,
            input::plugin,
            interaction::plugin,
            demo_2012::plugin,
            compare::plugin::plugin,
            sampling::plugin,
            record::plugin,
            ui::switches_plugin,
        ));
        start::start(app, &self.cli);
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
/// An error of a file named on the command line.
pub fn build(cli: &Cli) -> io::Result<App> {
    assemble(cli, renderer(cli.offscreen, cli.size))
}

fn assemble(cli: &Cli, renderer: PluginGroupBuilder) -> io::Result<App> {
    let (offscreen, size) = (cli.offscreen, cli.size);
    let mut app = App::new();
    app.add_plugins(renderer);
    // An offscreen picture does not depend on settings of the user.
    if !(cli.no_settings || offscreen) {
        app.add_plugins(preferences::plugin);
    }
    app.add_plugins((
        EguiPlugin::default(),
        FrameTimeDiagnosticsPlugin::default(),
        platform::plugin,
        GamePlugin { cli: cli.clone() },
        TargetPlugin { offscreen, size },
        camera::plugin,
        view::plugin,
        interaction::mouse_plugin,
        ui::panel_plugin,
        record::pictures_plugin,
    ));
    // Labels follow the camera of this frame. The panel switches cameras on: then each needs its light to be visible, and
    // the light needs cascades. And a new glyph has to reach the screen in the frame that shows it, and so the picture of
    // that frame.
    app.configure_sets(
        PostUpdate,
        (
            EguiPostUpdateSet::EndPass
                .after(TransformSystems::Propagate)
                .before(VisibilitySystems::CheckVisibility)
                .before(SimulationLightSystems::UpdateDirectionalLightCascades),
            EguiPostUpdateSet::PostProcessOutput.before(AssetEventSystems),
        ),
    );
    if offscreen {
        // One step per frame, so that a picture shows a known time however slow the renderer is.
        app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
            .add_plugins(ScheduleRunnerPlugin::run_loop(core::time::Duration::ZERO));
    }
    start::open_files(&mut app, cli)?;
    Ok(app)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::action::compare::Layout;
    use crate::camera::views::MAX_VIEWS;
    use crate::compare::Comparison;
    use bevy::ecs::schedule::{InternedSystemSet, SystemKey};
    use bevy::light::Cascades;
    use bevy::log::LogPlugin;
    use bevy::render::RenderPlugin;
    use bevy::render::settings::{RenderCreation, WgpuSettings};
    use bevy::winit::WinitPlugin;
    use clap::Parser;

    /// Builds the game without display and GPU.
    fn unseen(arguments: &str) -> App {
        let cli = format!("box_game --no-settings {arguments}");
        let cli = Cli::try_parse_from(cli.split_whitespace()).expect("valid");
        let no_gpu = WgpuSettings {
            backends: None,
            ..default()
        };
        let renderer = renderer(cli.offscreen, cli.size)
            .set(RenderPlugin {
                render_creation: RenderCreation::from(no_gpu),
                ..default()
            })
            .disable::<LogPlugin>();
        let renderer = match cli.offscreen {
            true => renderer,
            false => renderer.disable::<WinitPlugin>(),
        };
        let mut app = assemble(&cli, renderer).expect("no files to open");
        app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
        app.finish();
        app.cleanup();
        app
    }

    /// Returns `true` if every system of `first` ends before any of `second` begins, for every executor.
    fn ordered(schedule: &Schedule, first: InternedSystemSet, second: InternedSystemSet) -> bool {
        let graph = schedule.graph();
        let of = |set: InternedSystemSet| {
            let systems = graph.systems_in_set(set).expect("a set");
            systems.iter().copied().collect::<Vec<SystemKey>>()
        };
        let order: Vec<_> = schedule.systems().expect("built").map(|s| s.0).collect();
        let place = |key: SystemKey| order.iter().position(|k| *k == key);
        let (first, second) = (of(first), of(second));
        assert!(!first.is_empty() && !second.is_empty());
        let free = &graph.conflicting_systems().0;
        let free = |a, b| {
            free.iter()
                .any(|(x, y, _)| [(a, b), (b, a)].contains(&(*x, *y)))
        };
        let mut pairs = first.iter().flat_map(|a| second.iter().map(|b| (*a, *b)));
        pairs.all(|(a, b)| place(a) < place(b) && !free(a, b))
    }

    /// The renderer panics if an active camera has no light cascades, and the panel activates cameras.
    #[test]
    fn lights_follow_the_cameras_that_the_panel_switches_on() {
        let mut app = unseen("--integrator split,rk4,exact,midpoint");
        app.world_mut()
            .schedule_scope(PostUpdate, |world, schedule| {
                schedule.initialize(world).expect("an order");
                let cascades = SimulationLightSystems::UpdateDirectionalLightCascades;
                let panel = EguiPostUpdateSet::EndPass.intern();
                assert!(ordered(schedule, panel, cascades.intern()));
                let visible = VisibilitySystems::CheckVisibility.intern();
                assert!(ordered(schedule, panel, visible));
            });
        for (layout, views) in [
            (Layout::Overlaid, 1),
            (Layout::Views, MAX_VIEWS),
            (Layout::Solo, 1),
        ] {
            app.world_mut().resource_mut::<Comparison>().settings.layout = layout;
            for _ in 0..3 {
                app.update();
                let world = app.world_mut();
                let mut cameras = world.query_filtered::<(Entity, &Camera), With<Camera3d>>();
                let on = cameras.iter(world).filter(|(_, camera)| camera.is_active);
                let on: Vec<_> = on.map(|(entity, _)| entity).collect();
                assert_eq!(on.len(), views, "{layout:?}");
                let mut lights = world.query::<&Cascades>();
                let lit = |c: &Cascades| on.iter().all(|view| c.cascades.contains_key(view));
                assert!(lights.iter(world).all(lit), "{layout:?}");
                assert_eq!(lights.iter(world).count(), MAX_VIEWS);
            }
        }
    }

    /// Offscreen, only frames that become pictures are drawn; otherwise a film of every scene would take minutes.
    #[test]
    fn offscreen_only_pictures_are_drawn() {
        let mut app = unseen("--offscreen --integrator split,rk4");
        let on = |app: &mut App| {
            let world = app.world_mut();
            let mut cameras = world.query::<&Camera>();
            cameras
                .iter(world)
                .filter(|camera| camera.is_active)
                .count()
        };
        for _ in 0..3 {
            app.update();
            assert_eq!(on(&mut app), 0);
        }
        let picture = record::screenshot::ScreenshotRequest {
            path: Some("never-written.png".into()),
            plot: false,
        };
        app.insert_resource(picture);
        app.update();
        assert_eq!(on(&mut app), 2, "the picture's and the panel's");
    }
}
