//! The panel's own state between frames; the game does not need it.

use super::view::HistoryView;
use crate::action::Plot;
use crate::compare::CompareView;
use crate::parameters::Parameter;

/// Folded sections, dismissed texts, and a value in the middle of being dragged.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelMemory {
    /// Open sections of the side panel, in the order of [`Section::ALL`].
    pub open: [bool; Section::ALL.len()],
    /// The list of every integrator is open.
    pub all_integrators: bool,
    /// The scene whose lesson was dismissed.
    pub dismissed_lesson: Option<String>,
    /// Number of notices and the newest one when it was dismissed.
    pub dismissed_notice: Option<(usize, String)>,
    /// Push buttons push at the edge of the face.
    pub push_off_center: bool,
    /// Push buttons push along the world's axes.
    pub push_world: bool,
    /// The notice that is shown, and since when \[s\].
    pub(super) shown_notice: Option<((usize, String), f64)>,
    /// Text of the scene search.
    pub(super) search: String,
    /// The marked one of the scenes found.
    pub(super) picked: usize,
    /// "Reset everything" was pressed once.
    pub(super) sure: bool,
    /// A value that restarts the scene, while it is dragged.
    pub(super) draft: Option<(Parameter, f64)>,
    /// Work–precision shows the position error or the attitude's; what says more, if `None`.
    pub sweep_position: Option<bool>,
    /// The plots as they stood when the pointer came over them.
    pub(super) frozen: Option<Frozen>,
}

/// Plots that stand still while they are looked at.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Frozen {
    pub(super) plot: Plot,
    pub(super) compare: CompareView,
    pub(super) history: HistoryView,
    /// End of the freeze \[s\].
    pub(super) until: f64,
}

impl Default for PanelMemory {
    fn default() -> Self {
        let folded = [Section::Box, Section::Load, Section::Now, Section::Log];
        Self {
            open: Section::ALL.map(|section| !folded.contains(&section)),
            all_integrators: false,
            dismissed_lesson: None,
            dismissed_notice: None,
            push_off_center: false,
            push_world: false,
            shown_notice: None,
            search: String::new(),
            picked: 0,
            sure: false,
            draft: None,
            sweep_position: None,
            frozen: None,
        }
    }
}

impl PanelMemory {
    /// A state with every section open.
    pub fn all_open() -> Self {
        Self {
            open: [true; Section::ALL.len()],
            all_integrators: true,
            ..Self::default()
        }
    }
}

/// A section of the side panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// The integrators.
    Integrator,
    /// Switches of the view.
    View,
    /// Impulses by button.
    Push,
    /// Gravity, floor, drag.
    World,
    /// Size and mass.
    Box,
    /// dt and substeps.
    Step,
    /// Number of boxes.
    Load,
    /// Read-outs.
    Now,
    /// The CSV log.
    Log,
}

impl Section {
    /// Every section, from top to bottom.
    pub const ALL: [Self; 9] = [
        Self::Integrator,
        Self::View,
        Self::Push,
        Self::World,
        Self::Box,
        Self::Step,
        Self::Load,
        Self::Now,
        Self::Log,
    ];

    /// Heading of the section.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Integrator => "INTEGRATORS",
            Self::Step => "STEP",
            Self::World => "WORLD",
            Self::Box => "BOX",
            Self::Push => "PUSH",
            Self::View => "VIEW",
            Self::Load => "LOAD",
            Self::Now => "NOW",
            Self::Log => "LOG",
        }
    }
}
