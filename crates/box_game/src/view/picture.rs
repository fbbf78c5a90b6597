//! What a window or a picture adds to the game: renderer, cameras, panel.

use bevy::camera::{ClearColorConfig, RenderTarget};
use bevy::diagnostic::{FrameTimeDiagnosticsPlugin, SystemInformationDiagnosticsPlugin};
use bevy::prelude::*;
use bevy::window::{ExitCondition, PrimaryWindow, WindowResolution};
use bevy_egui::{
    EguiContexts, EguiGlobalSettings, EguiPlugin, EguiPrimaryContextPass, PrimaryEguiContext, egui,
};
use box_physics::prelude::GlobalIntegrator;

use crate::app::{GamePlugin, open_log};
use crate::apply::Asked;
use crate::camera::{OrbitCamera, move_camera};
use crate::cli::Cli;
use crate::input::keys::UiFocus;
use crate::interaction::mouse::{Hand, draw_hand, use_mouse};
use crate::record::film::record_film;
use crate::record::screenshot::{OffscreenTarget, PlotArea, take_screenshot};
use crate::scene::session::{Hero, Session};
use crate::ui::panel::{self, PanelMemory};
use crate::ui::panel_view::{self, Sources};
use crate::ui::preferences::{Preferences, PreferencesPlugin, UI_SCALES};
use crate::view::ghosts::GhostPlugin;
use crate::view::ghosts::views::{self, PictureArea, arrange_views, follow_main, spawn_views};
use crate::view::gizmos_plugin::{BodyGizmos, BodyGizmosPlugin, BodyGizmosSystems};
use crate::view::lattice::draw_lattice;
use crate::view::visuals;

/// Size of the window and of offscreen pictures \[pixels\].
pub const SIZE: (u32, u32) = (1280, 720);

/// Everything that needs a renderer: picture and panel, in a window or into an image.
pub struct PicturePlugin {
    /// Into an image instead of a window.
    pub offscreen: bool,
    /// Size of that image \[pixels\].
    pub size: (u32, u32),
}

/// The camera of the panel.
#[derive(Component)]
struct PanelCamera;

/// What the panel keeps between frames.
#[derive(Resource, Default)]
struct PanelState {
    memory: PanelMemory,
    /// The scale of the panel that it has by now.
    scale: Option<f32>,
}

impl Plugin for PicturePlugin {
    fn build(&self, app: &mut App) {
        let (offscreen, size) = (self.offscreen, self.size);
        app.insert_resource(ClearColor(Color::srgb(0.10, 0.115, 0.14)))
            .init_resource::<PanelState>()
            .init_resource::<Hand>()
            .init_resource::<PlotArea>()
            .init_resource::<PictureArea>()
            .add_plugins(BodyGizmosPlugin)
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
                            let image = images.add(offscreen_image(size));
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
                    (use_mouse, move_camera, draw_hand).chain(),
                    record_film,
                    follow_main.after(move_camera),
                    draw_lattice,
                    visuals::dress_boxes,
                    visuals::tint_hero,
                    visuals::place_floor,
                    switch_gizmos.before(BodyGizmosSystems),
                    take_screenshot,
                ),
            )
            .add_systems(EguiPrimaryContextPass, (show_panel, arrange_views).chain());
        #[cfg(feature = "gamepad")]
        app.add_systems(
            Update,
            crate::input::gamepad::turn_camera.before(move_camera),
        );
        if !offscreen {
            app.add_systems(Update, title);
        }
    }
}

/// The switches of the panel: boxes of all bodies, the rest of the hero alone.
fn switch_gizmos(
    session: Res<Session>,
    hero: Query<Entity, With<Hero>>,
    mut gizmos: ResMut<GizmoConfigStore>,
) {
    let hero = hero.iter().next();
    *gizmos.config_mut::<BodyGizmos>().1 = BodyGizmos {
        aabbs: session.show_aabb,
        axes: session.show_axes && hero.is_some(),
        contacts: session.show_contacts && hero.is_some(),
        only: hero,
    };
}

fn offscreen_image(size: (u32, u32)) -> Image {
    use bevy::render::render_resource::{TextureFormat, TextureUsages};
    let mut image = Image::new_target_texture(size.0, size.1, TextureFormat::Rgba8UnormSrgb, None);
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
    spawn_views(commands, target);
    commands.spawn((
        PanelCamera,
        PrimaryEguiContext,
        Camera2d,
        Camera {
            order: views::MOST as isize,
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
    mut sources: Sources,
    mut state: ResMut<PanelState>,
    mut asked: ResMut<Asked>,
    mut focus: ResMut<UiFocus>,
    mut picture: ResMut<PictureArea>,
    mut drawn: Local<f64>,
    window: Query<&Window, With<PrimaryWindow>>,
    (target, images): (Option<Res<OffscreenTarget>>, Res<Assets<Image>>),
    mut plot: ResMut<PlotArea>,
) -> Result {
    let start = std::time::Instant::now();
    let context = contexts.ctx_mut()?;
    follow_scale(context, &mut state.scale, &mut sources.kept);
    let mut ui = egui::Ui::new(
        context.clone(),
        "game".into(),
        egui::UiBuilder::new()
            .layer_id(egui::LayerId::background())
            .max_rect(context.viewport_rect()),
    );
    let state = &mut *state;
    let mut view = panel_view::view(&sources);
    view.compare.panel_ms = *drawn;
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
        .map(|w| (w.physical_width(), w.physical_height()))
        .or_else(|| {
            target
                .and_then(|t| images.get(&t.0))
                .map(|i| (i.width(), i.height()))
        })
        .unwrap_or(SIZE);
    let whole = UVec2::new(width, height);
    plot.0 = layout
        .plot
        .map_or_else(URect::default, |rect| pixels(rect, scale, whole));
    picture.0 = pixels(layout.central, scale, whole);
    *drawn = start.elapsed().as_secs_f64() * 1e3;
    Ok(())
}

/// A place on the panel in pixels of the picture, of which at least one is in it.
fn pixels(rect: egui::Rect, scale: f32, whole: UVec2) -> URect {
    let least = |at: f32, all: u32| ((at * scale) as u32).min(all.saturating_sub(1));
    let min = UVec2::new(least(rect.min.x, whole.x), least(rect.min.y, whole.y));
    let extent =
        |length: f32, from: u32, all: u32| ((length * scale) as u32).clamp(1, (all - from).max(1));
    let size = UVec2::new(
        extent(rect.width(), min.x, whole.x),
        extent(rect.height(), min.y, whole.y),
    );
    URect::from_corners(min, min + size)
}

/// Sets the panel's scale where it was asked for, and keeps the one that Ctrl and + or − made.
fn follow_scale(context: &egui::Context, shown: &mut Option<f32>, kept: &mut ResMut<Preferences>) {
    if *shown == Some(kept.ui_scale) {
        let zoomed = context.zoom_factor().clamp(UI_SCALES.0, UI_SCALES.1);
        if (zoomed - kept.ui_scale).abs() > 1e-3 {
            kept.ui_scale = zoomed;
        }
    }
    if *shown != Some(kept.ui_scale) {
        context.set_zoom_factor(kept.ui_scale);
        *shown = Some(kept.ui_scale);
    }
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
pub fn renderer(offscreen: bool, size: (u32, u32)) -> bevy::app::PluginGroupBuilder {
    let plugins = DefaultPlugins.set(crate::record::application_log::plugin());
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
                resolution: WindowResolution::from(size),
                ..default()
            }),
            ..default()
        })
    }
}

/// The game with its picture.
pub fn build(cli: &Cli) -> std::io::Result<App> {
    let mut app = App::new();
    app.add_plugins(renderer(cli.offscreen, cli.size));
    // A picture without a window shows what is asked for, not what somebody has set.
    if !(cli.no_settings || cli.offscreen) {
        app.add_plugins(PreferencesPlugin);
    }
    app.add_plugins((
        MeshPickingPlugin,
        EguiPlugin::default(),
        FrameTimeDiagnosticsPlugin::default(),
        SystemInformationDiagnosticsPlugin,
    ))
    .add_plugins((
        GamePlugin { cli: cli.clone() },
        PicturePlugin {
            offscreen: cli.offscreen,
            size: cli.size,
        },
        GhostPlugin,
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
