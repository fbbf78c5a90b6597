//! A game where you push a box around and compare integrators by accuracy and cost.
//!
//! [`app::GamePlugin`] is the game without a window, [`app::build`] the game with its picture. The panel is a pure
//! function of plain data ([`ui::panel`]). The comparison without a display is [`compare::headless`].

pub mod action;
pub mod app;
pub mod camera;
pub mod cli;
pub mod compare;
pub mod demo_2012;
pub mod input;
pub mod interaction;
pub mod parameters;
pub mod platform;
pub mod preferences;
pub mod record;
pub mod scene;
pub mod ui;
pub mod view;

/// Compiles the programs of README, guide and migration page, and runs those without a window.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
#[doc = include_str!("../../../docs/guide.md")]
#[doc = include_str!("../../../docs/migration.md")]
struct Documents;
