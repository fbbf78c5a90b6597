//! The Bevy plugin.
use bevy::ecs::component::Component;
/// Bits of the `Transform` last written.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct WrittenTransform;
