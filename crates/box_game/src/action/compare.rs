//! Actions of the comparison.

use box_physics::prelude::Integrator;
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// One action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum CompareAction {
    /// Compare with this integrator, or stop.
    ToggleComparison(Integrator),
    /// Compare with every integrator.
    CompareAll,
    /// Remove all comparisons.
    CompareNone,
    /// Layout of the comparisons.
    SetLayout(Layout),
    /// The next layout of [`Layout::ALL`].
    NextLayout,
    /// Show or hide the comparisons.
    ToggleComparisons,
    /// Quantity that is equal for all integrators.
    SetFairness(Fairness),
    /// Set the main box and all comparisons to the reference state.
    Resync,
    /// Time span of the plots.
    SetWindow(Window),
    /// Errors on a logarithmic or a linear axis.
    ToggleLogarithmic,
    /// Energy and angular momentum on a logarithmic or a linear axis.
    ToggleLogarithmicEnergy,
    /// Error since the start, or local error of each step.
    ToggleLocal,
    /// Start the work–precision sweep in the background.
    StartSweep,
    /// Cancel the sweep.
    CancelSweep,
    /// Copy the data of the open tab to the clipboard, as CSV.
    Copy,
}

/// Layout of the comparisons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Layout {
    /// Only the main box.
    Solo,
    /// All in one place: the main box solid, comparisons as wireframes.
    #[default]
    Overlaid,
    /// Side by side; only the drawing is shifted.
    SideBySide,
    /// One view each: the main box, then up to three comparisons, smallest error first.
    Views,
}

impl Layout {
    /// In the order of the key, with the text of the button and its tooltip.
    #[rustfmt::skip]
    pub const ALL: [(Self, &str, &str); 4] = [
        (Self::Solo, "Solo", "Show only the main box (G)."),
        (Self::Overlaid, "Overlaid", "All in one place, comparisons as wireframes (G)."),
        (Self::SideBySide, "Side by side", "Side by side; only the drawing is shifted (V)."),
        (Self::Views, "Views", "One view each: main box, then up to three comparisons, smallest error first (V)."),
    ];
}

/// Quantity that is equal for all integrators.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fairness {
    /// The step.
    #[default]
    Step,
    /// Force evaluations per simulated second: an integrator with four per step takes steps four times as long.
    Evaluations,
    /// Measured cost per simulated second.
    Cost,
}

impl Fairness {
    /// In the order of the panel, with the text of the button and its tooltip.
    #[rustfmt::skip]
    pub const ALL: [(Self, &str, &str); 3] = [
        (Self::Step, "equal dt", "Same step size for every integrator."),
        (Self::Evaluations, "equal evaluations", "Same force evaluations per simulated second."),
        (Self::Cost, "equal cost", "Same measured cost per simulated second."),
    ];
}

/// Time span of the plots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Window {
    /// Ten seconds.
    Ten,
    /// A minute.
    #[default]
    Minute,
    /// The whole run.
    All,
}

impl Window {
    /// In the order of the panel, with the text of the button.
    pub const ALL: [(Self, &str); 3] = [
        (Self::Ten, "10 s"),
        (Self::Minute, "60 s"),
        (Self::All, "all"),
    ];

    /// Length of the window \[s\].
    pub const fn seconds(self) -> Option<f64> {
        match self {
            Self::Ten => Some(10.0),
            Self::Minute => Some(60.0),
            Self::All => None,
        }
    }
}
