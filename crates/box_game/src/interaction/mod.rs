//! Interaction with the box: pushes, pokes, grabs, stepping back, undo.
//!
//! `push`: impulses; [`grab`]: the spring; `pick`: ray and box; `mouse`: gestures of mouse or finger (`pointer`) to
//! actions (needs a camera); [`rewind`]: past states; [`undo`]: parameters and restarts.

pub mod grab;
pub(crate) mod mouse;
mod pick;
pub(crate) mod pointer;
mod push;
pub mod rewind;
pub mod undo;

use bevy::input::InputSystems;
use bevy::prelude::*;

use crate::action::ActionSystems;

/// Adds everything except the mouse; runs without a window.
pub fn plugin(app: &mut App) {
    app.init_resource::<grab::Grip>()
        .init_resource::<rewind::Rewind>()
        .init_resource::<undo::UndoStack>()
        .add_observer(push::on_action)
        .add_observer(grab::on_action)
        .add_observer(grab::release)
        .add_observer(rewind::on_action)
        .add_observer(rewind::forget)
        .add_observer(undo::on_action)
        .add_observer(undo::forget)
        .add_systems(
            PreUpdate,
            (
                undo::remember
                    .after(ActionSystems::Request)
                    .before(ActionSystems::Trigger),
                undo::keep.after(ActionSystems::Trigger),
            ),
        )
        .add_systems(FixedUpdate, (rewind::record, grab::pull).chain());
}

/// Adds the mouse on the box, with its arrow and line. Needs a camera and gizmos.
pub fn mouse_plugin(app: &mut App) {
    app.init_resource::<mouse::Hand>()
        .init_resource::<pointer::Pointer>()
        .add_systems(PreUpdate, pointer::read.after(InputSystems))
        .add_systems(Update, (mouse::use_mouse, mouse::draw_hand).chain());
}
