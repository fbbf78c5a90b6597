//! The picture: renderer, boxes, floor, comparisons, labels.

pub mod ghosts;
pub mod gizmos_plugin;
pub mod lattice;
pub mod picture;
pub mod style;
pub mod visuals;
