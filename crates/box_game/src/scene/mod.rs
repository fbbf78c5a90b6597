//! The scene: which one is played, with which parameters, and the files that it comes from.

pub mod library;
pub mod opening;
pub mod session;
