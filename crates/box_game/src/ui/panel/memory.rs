//! The panel's own state between frames; the game does not need it.

use super::view::PanelView;
use crate::parameters::Parameter;

/// Dismissed texts, what a hint shows, and a value in the middle of being dragged.
#[derive(Clone, Debug, Default)]
pub struct PanelMemory {
    /// Every section is open at first.
    pub(super) all_open: bool,
    /// The scene whose lesson was dismissed.
    pub(super) dismissed_lesson: Option<String>,
    /// Number of notices, the newest one, and since when it is shown \[s\]; −∞ once it was dismissed.
    pub(super) notice: Option<(usize, String, f64)>,
    /// Push buttons push at the edge of the face.
    pub(super) push_off_center: bool,
    /// Push buttons push along the world's axes.
    pub(super) push_world: bool,
    pub(super) search: String,
    /// The marked one of the scenes found.
    pub(super) picked: usize,
    /// "Reset everything" was pressed once.
    pub(super) sure: bool,
    /// A value that restarts the scene, while it is dragged.
    pub(super) draft: Option<(Parameter, f64)>,
    /// The parameter or figure that a hint shows, and the end of its mark \[s\].
    pub(super) marked: Option<(&'static str, f64)>,
    /// Work–precision shows the position error or the attitude's; what says more, if `None`.
    pub(super) sweep_position: Option<bool>,
    /// What the plots showed when the pointer came over them, and the end of that freeze \[s\].
    pub(super) frozen: Option<(PanelView, f64)>,
}
