//! The renderer: Bevy's plugins for a window or for an image, and the target of every camera.

use bevy::camera::RenderTarget;
use bevy::camera::visibility::VisibilitySystems;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::render::renderer::RenderAdapterInfo;
use bevy::render::view::window::screenshot::Screenshot;
use bevy::window::{ExitCondition, PrimaryWindow, WindowRef, WindowResolution};
use bevy_egui::EguiPostUpdateSet;
use box_physics::prelude::GlobalIntegrator;

use crate::camera::views::SplitView;
use crate::platform;
use crate::scene::session::Session;

/// Target of the cameras: the window, or an image.
#[derive(Resource, Clone, Debug)]
pub struct PictureTarget(pub RenderTarget);

impl PictureTarget {
    /// Returns `true` if a CPU draws the frames of a window. Offscreen images may be drawn by a CPU.
    pub fn is_slow(&self, adapter: Option<&RenderAdapterInfo>) -> bool {
        // Browsers do not always tell the type.
        let by_cpu = |adapter: &RenderAdapterInfo| {
            adapter.device_type == wgpu::DeviceType::Cpu || adapter.name.contains("Basic Render")
        };
        adapter.is_some_and(by_cpu) && matches!(self.0, RenderTarget::Window(_))
    }

    /// Four samples per pixel, or one without a GPU, where resolving four took almost half of a frame's time
    /// (docs/performance.md).
    pub fn antialiasing(&self, adapter: Option<&RenderAdapterInfo>) -> Msaa {
        match self.is_slow(adapter) {
            true => Msaa::Off,
            false => Msaa::Sample4,
        }
    }
}

/// Chooses the target and sets the title of the window. Add it after [`renderer`].
pub struct TargetPlugin {
    /// Renders into an image instead of a window.
    pub offscreen: bool,
    /// Size of that image \[pixels\].
    pub size: (u32, u32),
}

impl Plugin for TargetPlugin {
    fn build(&self, app: &mut App) {
        let target = if self.offscreen {
            let (width, height) = self.size;
            let format = TextureFormat::Rgba8UnormSrgb;
            let mut image = Image::new_target_texture(width, height, format, None);
            image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
            app.add_systems(
                PostUpdate,
                draw_pictures_alone
                    .after(EguiPostUpdateSet::EndPass)
                    .before(VisibilitySystems::CheckVisibility),
            );
            let mut images = app.world_mut().resource_mut::<Assets<Image>>();
            RenderTarget::Image(images.add(image).into())
        } else {
            app.add_systems(Update, title);
            RenderTarget::Window(WindowRef::Primary)
        };
        app.insert_resource(PictureTarget(target))
            .insert_resource(ClearColor(Color::srgb(0.10, 0.115, 0.14)));
    }
}

/// Draws only frames that become pictures, because a frame in software takes a second. Runs after the panel, which
/// activates the cameras of its layout.
fn draw_pictures_alone(
    pictures: Query<(), With<Screenshot>>,
    mut cameras: Query<(&mut Camera, Has<SplitView>)>,
) {
    for (mut camera, split) in &mut cameras {
        // Further views are switched on by the layout.
        let drawn = !pictures.is_empty() && (!split || camera.is_active);
        if camera.is_active != drawn {
            camera.is_active = drawn;
        }
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
    let plugins = DefaultPlugins.set(LogPlugin {
        // Notes of the libraries about the machine do not help a player.
        filter: "wgpu=error,naga=warn,bevy_egui=error,winit=error,bevy_asset=error,bevy_app=warn"
            .to_owned(),
        custom_layer: platform::log_layer,
        ..default()
    });
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
            primary_window: Some(platform::window(Window {
                title: "box_game".to_owned(),
                name: Some("box_game".to_owned()),
                resolution: WindowResolution::from(size),
                ..default()
            })),
            ..default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::render::renderer::WgpuWrapper;
    use wgpu::{AdapterInfo, Backend, DeviceType};

    #[test]
    fn only_a_window_without_a_gpu_goes_without_antialiasing() {
        let adapter = |name: &str, device_type| {
            RenderAdapterInfo(WgpuWrapper::new(AdapterInfo {
                name: name.to_owned(),
                vendor: 0,
                device: 0,
                device_type,
                device_pci_bus_id: String::new(),
                driver: String::new(),
                driver_info: String::new(),
                backend: Backend::Gl,
                subgroup_min_size: 0,
                subgroup_max_size: 0,
                transient_saves_memory: false,
            }))
        };
        let window = PictureTarget(RenderTarget::Window(WindowRef::Primary));
        let image = PictureTarget(RenderTarget::Image(Handle::<Image>::default().into()));
        let msaa = |target: &PictureTarget, device| target.antialiasing(Some(&adapter("", device)));
        assert_eq!(msaa(&window, DeviceType::Cpu), Msaa::Off);
        assert_eq!(msaa(&window, DeviceType::IntegratedGpu), Msaa::Sample4);
        assert_eq!(msaa(&image, DeviceType::Cpu), Msaa::Sample4);
        assert_eq!(window.antialiasing(None), Msaa::Sample4);
        let windows = adapter("ANGLE (Microsoft Basic Render Driver)", DeviceType::Other);
        assert_eq!(window.antialiasing(Some(&windows)), Msaa::Off);
    }
}
