//! Push a box about and compare numerical integrators live: speed against error.
//!
//! [`app::GamePlugin`] is the game without a window, [`app::build`] the game with its picture. The panel is a
//! pure function of plain data ([`ui::panel`]). The comparison without a display is [`compare::headless`].

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

/// The programs of the README are compiled, and those without a window run.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// The code blocks of the guide are compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/guide.md")]
struct Guide;

/// The code blocks of the page for users of Avian or Rapier are compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/migration.md")]
struct Migration;
