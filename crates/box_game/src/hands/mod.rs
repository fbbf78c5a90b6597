//! What hands can do: poke a face, drag the box on a spring, go back in time, take back a change.
//!
//! [`pick`]: where a ray meets the box; [`grab`]: the spring; [`rewind`]: the ring of past states;
//! [`undo`]: parameters and resets; [`mouse`]: gestures to actions (needs a camera).

pub mod grab;
pub mod mouse;
pub mod pick;
pub mod rewind;
pub mod undo;

use bevy::prelude::*;

/// Everything but the mouse: runs without a window.
pub struct HandsPlugin;

impl Plugin for HandsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<grab::Grip>()
            .init_resource::<rewind::Rewind>()
            .init_resource::<undo::UndoStack>()
            .add_systems(FixedUpdate, (rewind::record, grab::pull).chain());
    }
}
