//! What a scheme may remember between steps.

use bevy::ecs::component::Component;

/// A scheme's memory of one body. Most schemes need none and never touch it. It is checked, not
/// trusted: a scheme drops it whenever state, body or forces are not bit for bit what it last left,
/// so teleports, impulses and live switching need no notice. An empty memory is always valid.
#[derive(Component, Clone, Debug, Default, PartialEq)]
pub struct SchemeMemory {}
