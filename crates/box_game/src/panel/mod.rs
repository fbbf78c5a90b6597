//! The panel: a pure function of a [`PanelView`] that emits [`Action`](crate::action::Action)s.

mod view;

pub use view::{HeroView, HistoryView, LogView, PanelView, Parameters, SchemeTiming};
