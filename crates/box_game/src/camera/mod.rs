//! The cameras: an orbit camera, and up to three cameras that follow it in the layout of views.

pub mod orbit;
pub mod views;

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy_egui::EguiPrimaryContextPass;

use crate::interaction::mouse::use_mouse;

/// A mapping without look-up tables, which would add half a megabyte to the download. `view/sky.wgsl` uses the same.
const TONEMAPPING: Tonemapping = Tonemapping::SomewhatBoringDisplayTransform;

/// Spawns and moves the cameras. Needs a renderer and its
/// [`PictureTarget`](crate::view::renderer::PictureTarget).
pub fn plugin(app: &mut App) {
    views::add_gizmos(app);
    app.init_resource::<views::PictureArea>()
        .add_observer(orbit::on_action)
        .add_observer(orbit::go_home)
        .add_systems(Startup, (orbit::spawn_camera, views::spawn_views))
        .add_systems(
            Update,
            (orbit::move_camera.after(use_mouse), views::follow_main).chain(),
        )
        .add_systems(EguiPrimaryContextPass, views::arrange_views);
    #[cfg(feature = "gamepad")]
    app.add_systems(Update, orbit::turn_camera.before(orbit::move_camera));
}
