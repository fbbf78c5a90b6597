//! Drawing of the comparisons: edges over the main box or solid boxes beside it, the reference as a dashed white frame,
//! pins, fading trails, labels at the boxes, and marks of events.
//!
//! Nothing here is simulated or read back: side by side, only the picture is shifted.

mod acting;
mod beside;
mod events;
mod frames;
mod labels;
mod shown;

use bevy::prelude::*;
use bevy_egui::{EguiContexts, EguiPrimaryContextPass};

use crate::camera::views::{PictureArea, SplitView};
use crate::compare::Comparison;
use crate::demo_2012::Demo2012;
use crate::scene::session::Session;

/// Draws the comparisons of a [`Comparison`] over the picture of the first 3-D camera.
pub(super) fn plugin(app: &mut App) {
    app.init_resource::<frames::Trails>()
        .add_systems(
            Update,
            (
                beside::place_pieces,
                beside::step_back,
                frames::lengthen_trails,
                frames::draw_frames,
                acting::draw_cones,
            )
                .chain(),
        )
        .add_systems(EguiPrimaryContextPass, draw_overlay);
}

/// Draws labels, rings and the strip of flips over the picture.
fn draw_overlay(
    comparison: Res<Comparison>,
    (session, demo): (Res<Session>, Res<Demo2012>),
    mut contexts: EguiContexts,
    camera: Query<(&Camera, &GlobalTransform), (With<Camera3d>, Without<SplitView>)>,
    window: Query<&Window>,
    area: Res<PictureArea>,
) -> Result {
    let Some(run) = &comparison.run else {
        return Ok(());
    };
    let context = contexts.ctx_mut()?;
    let layout = comparison.settings.layout;
    let scale = window.iter().next().map_or(1.0, Window::scale_factor) / context.pixels_per_point();
    let seen = camera.iter().next().and_then(|(camera, eye)| {
        let view = camera.logical_viewport_rect()?;
        Some(shown::Seen {
            run,
            layout,
            trajectories: shown::shown(run, layout),
            tip: shown::tip(run),
            camera,
            eye,
            scale,
            view: shown::points(view, scale),
        })
    });
    if let Some(seen) = seen {
        labels::draw(context, &seen, &area, demo.active(&session));
        events::draw(context, &seen);
    }
    Ok(())
}
