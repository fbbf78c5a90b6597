//! What the panel takes of keyboard and mouse.

use bevy::prelude::*;

/// What the panel has of the keyboard and the mouse.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UiFocus {
    /// A text field is being typed into: letters belong to it.
    pub text: bool,
    /// Some widget has the focus: Space, Enter and arrows belong to it.
    pub widget: bool,
    /// The pointer is over the panel, or the panel holds it.
    pub pointer: bool,
}
