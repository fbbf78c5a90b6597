//! The app: the game without a window, which tests drive, and what a window or a picture adds.

use std::path::PathBuf;

use bevy::app::AppExit;
use bevy::camera::{ClearColorConfig, RenderTarget, Viewport};
use bevy::diagnostic::{FrameTimeDiagnosticsPlugin, SystemInformationDiagnosticsPlugin};
use bevy::prelude::*;
use bevy::window::{ExitCondition, PrimaryWindow, WindowResolution};
use bevy_egui::{
    EguiContexts, EguiGlobalSettings, EguiPlugin, EguiPrimaryContextPass, PrimaryEguiContext, egui,
};
use box_physics::prelude::{
    BodyQuarantined, BodyState, GlobalIntegrator, PhysicsClock, PhysicsPlugins, PhysicsSchedule,
    PhysicsSystems, RigidBox,
};
use box_scenarios::Scenario;

use crate::apply::{Asked, apply_actions, set_step};
use crate::camera::{OrbitCamera, move_camera};
use crate::cli::Cli;
use crate::csv_log::CsvLog;
use crate::history::{History, count_dropped, record};
use crate::input::{UiFocus, read_keys};
use crate::panel::{self, PanelMemory};
use crate::panel_view::{self, Sources};
use crate::sampling::{SchemeSamples, sample_schemes};
use crate::screenshot::{OffscreenTarget, ScreenshotRequest, take_screenshot};
use crate::session::{LONGEST_FRAME, SceneEntity, Session, choose, start_scene};
use crate::{row_log, visuals};

/// Size of the window and of offscreen pictures \[pixels\].
pub const SIZE: (u32, u32) = (1280, 720);

/// When to end by itself.
#[derive(Resource, Clone, Debug, Default)]
pub struct Ending {
    /// After this much simulated time \[s\].
    pub duration: Option<f64>,
    /// After this many frames.
    pub frames: Option<u32>,
    /// With a picture of the last frame.
    pub screenshot: Option<PathBuf>,
    /// With exit code 3 if a body was quarantined.
    pub fail_on_divergence: bool,
}

/// The whole game but window, picture and panel: physics, scene, keys, actions, log, sampling.
/// Needs time and input; runs in a test under `MinimalPlugins` and `InputPlugin`.
pub struct GamePlugin {
    /// The command line.
    pub cli: Cli,
}

impl Plugin for GamePlugin {
    fn build(&self, app: &mut App) {
        let cli = &self.cli;
        let id = cli.scene.as_deref().unwrap_or(Scenario::ALL[0]().id);
        // The command line has checked it.
        let scenario = Scenario::find(id).unwrap_or_else(|_| Scenario::ALL[0]());
        let mut session = Session::new(scenario, cli.seed);
        if let Some(boxes) = cli.boxes {
            session.parameters.boxes = boxes;
        }
        app.add_plugins(PhysicsPlugins::default())
            .insert_resource(session)
            .init_resource::<Asked>()
            .init_resource::<UiFocus>()
            .init_resource::<History>()
            .init_resource::<SchemeSamples>()
            .insert_resource(Ending {
                duration: cli.duration,
                frames: cli.frames,
                screenshot: cli.screenshot.clone(),
                fail_on_divergence: cli.fail_on_divergence,
            });
        if let Some(&integrator) = cli.integrator.first() {
            choose(app.world_mut(), integrator);
        }
        set_step(app.world_mut(), cli.dt);
        app.world_mut().resource_mut::<PhysicsClock>().substeps = cli.substeps;
        app.world_mut()
            .resource_mut::<Time<Virtual>>()
            .set_max_delta(core::time::Duration::from_secs_f64(LONGEST_FRAME));
        start_scene(app.world_mut());
        app.add_systems(
            PreUpdate,
            (read_keys, apply_actions)
                .chain()
                .after(bevy::input::InputSystems),
        )
        .add_systems(
            PhysicsSchedule,
            (
                timed_impulses.in_set(PhysicsSystems::First),
                row_log::write_row.in_set(PhysicsSystems::Last),
            ),
        )
        .add_systems(Update, (count_dropped, record, sample_schemes, end).chain());
        #[cfg(feature = "gamepad")]
        app.add_systems(
            PreUpdate,
            crate::gamepad::read_buttons
                .after(read_keys)
                .before(apply_actions),
        );
    }
}

/// The scene's own impulses, on every box, at the first step boundary at or after their time.
fn timed_impulses(
    mut session: ResMut<Session>,
    clock: Res<PhysicsClock>,
    mut boxes: Query<(&RigidBox, &mut BodyState), With<SceneEntity>>,
) {
    let start = clock.time() - clock.step();
    let impulses = &session.scenario.setup.impulses;
    let mut next = session.next_impulse;
    while let Some(i) = impulses
        .get(next)
        .filter(|i| i.t <= start + 1e-9 * clock.step())
    {
        for (body, mut state) in &mut boxes {
            state.apply_impulse_at_body_point(body, i.impulse, i.body_point);
        }
        next += 1;
    }
    if next != session.next_impulse {
        session.next_impulse = next;
    }
}

/// Opens the log that the command line asks for.
///
/// # Errors
/// What the file system says.
pub fn open_log(app: &mut App, cli: &Cli) -> std::io::Result<()> {
    if let Some(path) = &cli.log {
        let session = app.world().resource::<Session>();
        let log = CsvLog::create(path, session.scenario.id, session.seed)?;
        app.insert_resource(log);
    }
    Ok(())
}

/// Ends the program when it is time; with a picture, once that is on disk.
fn end(
    ending: Res<Ending>,
    clock: Res<PhysicsClock>,
    mut quarantined: MessageReader<BodyQuarantined>,
    mut frames: Local<u32>,
    mut asked: Local<Option<u32>>,
    mut diverged: Local<bool>,
    mut commands: Commands,
    mut exit: MessageWriter<AppExit>,
) {
    *frames += 1;
    *diverged |= quarantined.read().next().is_some();
    let code = if *diverged && ending.fail_on_divergence {
        AppExit::from_code(3)
    } else {
        AppExit::Success
    };
    let timed_out = ending
        .duration
        .is_some_and(|d| clock.elapsed().as_secs_f64() >= d - 1e-9);
    let frame_limit = match (&ending.screenshot, ending.frames, ending.duration) {
        (_, Some(n), _) => Some(n),
        (Some(_), None, None) => Some(60),
        _ => None,
    };
    let done = timed_out || frame_limit.is_some_and(|n| *frames >= n);
    if !done {
        return;
    }
    let Some(path) = &ending.screenshot else {
        exit.write(code);
        return;
    };
    match *asked {
        None => {
            // A picture left from an earlier run must not pass for this one's.
            let _ = std::fs::remove_file(path);
            commands.insert_resource(ScreenshotRequest(Some(path.clone())));
            *asked = Some(*frames);
        }
        Some(_) if path.exists() => {
            exit.write(code);
        }
        Some(since) if *frames > since + 600 => {
            error!("the picture {} was not written", path.display());
            exit.write(AppExit::from_code(1));
        }
        Some(_) => {}
    }
}

/// Everything that needs a renderer: picture and panel, in a window or into an image.
pub struct PicturePlugin {
    /// Into an image instead of a window.
    pub offscreen: bool,
}

/// The camera of the panel.
#[derive(Component)]
struct PanelCamera;

/// What the panel keeps between frames.
#[derive(Resource, Default)]
struct PanelState {
    memory: PanelMemory,
    scenes: Vec<(String, String)>,
}

impl Plugin for PicturePlugin {
    fn build(&self, app: &mut App) {
        let offscreen = self.offscreen;
        app.insert_resource(ClearColor(Color::srgb(0.10, 0.115, 0.14)))
            .insert_resource(PanelState {
                scenes: panel_view::scenes(),
                ..default()
            })
            .add_systems(
                Startup,
                (
                    visuals::set_up,
                    move |mut commands: Commands,
                          mut images: ResMut<Assets<Image>>,
                          mut egui: ResMut<EguiGlobalSettings>,
                          session: Res<Session>| {
                        egui.auto_create_primary_context = false;
                        let target = if offscreen {
                            let image = images.add(offscreen_image());
                            commands.insert_resource(OffscreenTarget(image.clone()));
                            RenderTarget::Image(image.into())
                        } else {
                            RenderTarget::default()
                        };
                        spawn_cameras(&mut commands, &session, &target);
                    },
                )
                    .chain(),
            )
            .add_systems(
                Update,
                (
                    move_camera,
                    visuals::dress_boxes,
                    visuals::place_floor,
                    visuals::draw_aabbs,
                    visuals::draw_axes,
                    visuals::draw_contacts,
                    take_screenshot,
                ),
            )
            .add_systems(EguiPrimaryContextPass, show_panel);
        #[cfg(feature = "gamepad")]
        app.add_systems(Update, crate::gamepad::turn_camera.before(move_camera));
        if !offscreen {
            app.add_systems(Update, title);
        }
    }
}

fn offscreen_image() -> Image {
    use bevy::render::render_resource::{TextureFormat, TextureUsages};
    let mut image = Image::new_target_texture(SIZE.0, SIZE.1, TextureFormat::Rgba8UnormSrgb, None);
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    image
}

fn spawn_cameras(commands: &mut Commands, session: &Session, target: &RenderTarget) {
    let orbit = OrbitCamera::home(session);
    commands.spawn((
        Camera3d::default(),
        orbit,
        orbit.transform(),
        target.clone(),
        Msaa::Sample4,
    ));
    commands.spawn((
        PanelCamera,
        PrimaryEguiContext,
        Camera2d,
        Camera {
            order: 1,
            clear_color: ClearColorConfig::None,
            ..default()
        },
        target.clone(),
        bevy::camera::visibility::RenderLayers::none(),
    ));
}

/// Draws the panel, takes its requests, and gives the picture the room that is left.
fn show_panel(
    mut contexts: EguiContexts,
    sources: Sources,
    mut state: ResMut<PanelState>,
    mut asked: ResMut<Asked>,
    mut focus: ResMut<UiFocus>,
    mut camera: Single<&mut Camera, With<OrbitCamera>>,
    window: Query<&Window, With<PrimaryWindow>>,
) -> Result {
    let context = contexts.ctx_mut()?;
    let mut ui = egui::Ui::new(
        context.clone(),
        "game".into(),
        egui::UiBuilder::new()
            .layer_id(egui::LayerId::background())
            .max_rect(context.viewport_rect()),
    );
    let state = &mut *state;
    let view = panel_view::view(&sources, &state.scenes);
    let layout = panel::show(&mut ui, &view, &mut state.memory, &mut asked.0);
    *focus = UiFocus {
        text: context.text_edit_focused(),
        widget: context.egui_wants_keyboard_input(),
        pointer: context.egui_wants_pointer_input()
            || context
                .pointer_latest_pos()
                .is_some_and(|p| !layout.central.contains(p)),
    };
    let scale = context.pixels_per_point();
    let (width, height) = window
        .iter()
        .next()
        .map_or(SIZE, |w| (w.physical_width(), w.physical_height()));
    let at = UVec2::new(
        ((layout.central.min.x * scale) as u32).min(width.saturating_sub(1)),
        ((layout.central.min.y * scale) as u32).min(height.saturating_sub(1)),
    );
    let size = UVec2::new(
        ((layout.central.width() * scale) as u32).clamp(1, (width - at.x).max(1)),
        ((layout.central.height() * scale) as u32).clamp(1, (height - at.y).max(1)),
    );
    let viewport = Viewport {
        physical_position: at,
        physical_size: size,
        ..default()
    };
    let same = camera.viewport.as_ref().is_some_and(|v| {
        v.physical_position == viewport.physical_position
            && v.physical_size == viewport.physical_size
    });
    if !same {
        camera.viewport = Some(viewport);
    }
    Ok(())
}

fn title(
    mut window: Single<&mut Window, With<PrimaryWindow>>,
    session: Res<Session>,
    integrator: Res<GlobalIntegrator>,
) {
    let title = format!(
        "box_game – {} – {} – f64",
        session.scenario.title, integrator.0
    );
    if window.title != title {
        window.title = title;
    }
}

/// Bevy's plugins for a window, or for pictures without one.
pub fn renderer(offscreen: bool) -> bevy::app::PluginGroupBuilder {
    let plugins = DefaultPlugins.set(crate::logging::plugin());
    if offscreen {
        plugins
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .set(bevy::render::RenderPlugin {
                synchronous_pipeline_compilation: true,
                ..default()
            })
            .disable::<bevy::winit::WinitPlugin>()
    } else {
        plugins.set(WindowPlugin {
            primary_window: Some(Window {
                title: "box_game".to_owned(),
                name: Some("box_game".to_owned()),
                resolution: WindowResolution::from(SIZE),
                ..default()
            }),
            ..default()
        })
    }
}

/// The game with its picture.
pub fn build(cli: &Cli) -> std::io::Result<App> {
    let mut app = App::new();
    app.add_plugins(renderer(cli.offscreen))
        .add_plugins((
            MeshPickingPlugin,
            EguiPlugin::default(),
            FrameTimeDiagnosticsPlugin::default(),
            SystemInformationDiagnosticsPlugin,
        ))
        .add_plugins((
            GamePlugin { cli: cli.clone() },
            PicturePlugin {
                offscreen: cli.offscreen,
            },
        ));
    if cli.offscreen {
        // One step a frame, so that a picture shows a known time however slow the renderer is.
        app.insert_resource(bevy::time::TimeUpdateStrategy::FixedTimesteps(1));
        app.add_plugins(bevy::app::ScheduleRunnerPlugin::run_loop(
            core::time::Duration::ZERO,
        ));
    }
    open_log(&mut app, cli)?;
    Ok(app)
}
