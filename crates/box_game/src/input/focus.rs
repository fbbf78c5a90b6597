//! Focus of keyboard and mouse on the panel.

use bevy::prelude::*;

/// Focus of keyboard and mouse on the panel.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UiFocus {
    /// A text field has the focus and takes letters.
    pub text: bool,
    /// A widget has the focus and takes Space, Enter and arrows.
    pub widget: bool,
    /// The pointer is over the panel, or the panel holds it.
    pub pointer: bool,
}
