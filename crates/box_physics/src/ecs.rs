//! Names that Bevy's derives on the core's types need. The core uses nothing else of Bevy, and not even this
//! without the feature `bevy`.

pub(crate) use bevy::ecs::VariantDefaults;
pub(crate) use bevy::ecs::component::Component;
pub(crate) use bevy::ecs::reflect::{ReflectComponent, ReflectResource};
pub(crate) use bevy::ecs::resource::Resource;
pub(crate) use bevy::reflect::{Reflect, std_traits::ReflectDefault};
#[cfg(feature = "serde")]
pub(crate) use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
