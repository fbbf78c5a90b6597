//! Push a box about and compare numerical integrators live: speed against error.

pub mod action;
pub mod panel;
