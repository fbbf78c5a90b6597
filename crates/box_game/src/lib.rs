//! Push a box about and compare numerical integrators live: speed against error.
//!
//! [`app::GamePlugin`] is the game without a window: scene, keys, actions, log, timing. What needs a
//! renderer is [`picture::PicturePlugin`]. The panel is a pure function of plain data ([`panel`]). The
//! comparison without a display is [`headless`].

pub mod action;
pub mod apng;
pub mod app;
pub mod apply;
pub mod camera;
pub mod cli;
pub mod command_line;
pub mod compare;
pub mod csv_log;
pub mod demo;
pub mod display;
#[cfg(feature = "gamepad")]
pub mod gamepad;
pub mod ghosts;
pub mod gizmos_plugin;
pub mod hands;
pub mod headless;
pub mod history;
pub mod input;
pub mod lane;
pub mod library;
pub mod logging;
pub mod opening;
pub mod panel;
pub mod panel_plugin;
pub mod panel_view;
pub mod picture;
pub mod preferences;
pub mod recorder;
pub mod row_log;
pub mod sampling;
pub mod screenshot;
pub mod script;
pub mod session;
pub mod style;
pub mod surroundings;
pub mod visuals;

/// The programs of the README are compiled, and those without a window run.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
