//! The panel and the preferences.

pub mod panel;
pub mod panel_plugin;
pub mod panel_view;
pub mod preferences;
