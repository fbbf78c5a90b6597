//! Keyboard, gamepad and scripts: sources of [`Action`](crate::action::Action)s.

#[cfg(feature = "gamepad")]
pub mod gamepad;
pub mod keys;
pub mod script;
