//! Names that Bevy's derives need on the core types. The core uses nothing else of Bevy, and nothing at all
//! without the feature `bevy`.

pub(crate) use bevy::ecs::VariantDefaults;
pub(crate) use bevy::ecs::component::Component;
pub(crate) use bevy::ecs::reflect::{ReflectComponent, ReflectResource};
pub(crate) use bevy::ecs::resource::Resource;
pub(crate) use bevy::reflect::{Reflect, std_traits::ReflectDefault};
#[cfg(feature = "serde")]
pub(crate) use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
