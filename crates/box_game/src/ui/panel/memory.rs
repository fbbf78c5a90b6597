//! The panel's own state between frames; the game does not need it.

use super::view::PanelView;
use crate::parameters::Parameter;

/// Dismissed texts, the control highlighted by a hint, and a value being dragged.
#[derive(Clone, Debug, Default)]
pub struct PanelMemory {
    /// Every section is open at first.
    pub(super) all_open: bool,
    /// The scene whose lesson was dismissed.
    pub(super) dismissed_lesson: Option<String>,
    /// Number of notices, the newest one, and the time when it appeared \[s\]; −∞ once dismissed.
    pub(super) notice: Option<(usize, String, f64)>,
    /// Push buttons push at the edge of the face.
    pub(super) push_off_center: bool,
    /// Push buttons push along the world's axes.
    pub(super) push_world: bool,
    pub(super) search: String,
    /// Index of the selected scene among those found.
    pub(super) picked: usize,
    /// "Reset everything" was pressed once.
    pub(super) sure: bool,
    /// A value that restarts the scene, while it is dragged.
    pub(super) draft: Option<(Parameter, f64)>,
    /// The parameter or figure that a hint highlights, and the end of the highlight \[s\].
    pub(super) marked: Option<(&'static str, f64)>,
    /// Work–precision shows the position error if `true`, else the attitude error; `None` is automatic.
    pub(super) sweep_position: Option<bool>,
    /// Contents of the plots when the pointer entered them, and the end of the freeze \[s\].
    pub(super) frozen: Option<(PanelView, f64)>,
}
