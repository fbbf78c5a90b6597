//! Actions of the comparison.

use box_physics::prelude::Integrator;
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// One action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum CompareAction {
    /// Compare with this integrator, or stop.
    ToggleComparison(#[serde(with = "integrator_id")] Integrator),
    /// Compare with every integrator.
    CompareAll,
    /// Compare with none.
    CompareNone,
    /// Layout of the comparisons.
    SetLayout(Layout),
    /// The next layout of [`Layout::ALL`].
    NextLayout,
    /// Show or hide the comparisons.
    ToggleComparisons,
    /// Quantity that is equal for all integrators.
    SetFairness(Fairness),
    /// Move everything to the reference's state.
    Resync,
    /// Time span of the plots.
    SetWindow(Window),
    /// Errors on a logarithmic or a linear axis.
    ToggleLogarithmic,
    /// Energy and angular momentum on a logarithmic or a linear axis.
    ToggleLogarithmicEnergy,
    /// Error since the start, or of each step alone.
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
    /// The main box alone.
    Solo,
    /// All in one place: the main box solid, comparisons translucent.
    #[default]
    Overlaid,
    /// Side by side; only the picture is shifted.
    SideBySide,
    /// The main box and the first three comparisons in one view each, from the same place.
    Views,
}

impl Layout {
    /// In the order of the key.
    pub const ALL: [Self; 4] = [Self::Solo, Self::Overlaid, Self::SideBySide, Self::Views];

    /// Text of its button.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Solo => "Solo",
            Self::Overlaid => "Overlaid",
            Self::SideBySide => "Side by side",
            Self::Views => "Views",
        }
    }

    /// The one after it.
    pub fn next(self) -> Self {
        Self::ALL[(self as usize + 1) % Self::ALL.len()]
    }
}

/// Quantity that is equal for all integrators.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fairness {
    /// The step.
    #[default]
    Step,
    /// Force evaluations per simulated second: an integrator with four a step takes steps four times as long.
    Evaluations,
    /// Measured cost per simulated second.
    Cost,
}

impl Fairness {
    /// In the order of the panel.
    pub const ALL: [Self; 3] = [Self::Step, Self::Evaluations, Self::Cost];

    /// Text of its button.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Step => "equal dt",
            Self::Evaluations => "equal evaluations",
            Self::Cost => "equal cost",
        }
    }
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
    /// In the order of the panel.
    pub const ALL: [Self; 3] = [Self::Ten, Self::Minute, Self::All];

    /// Text of its button.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ten => "10 s",
            Self::Minute => "60 s",
            Self::All => "all",
        }
    }

    /// Length of the window \[s\].
    pub const fn seconds(self) -> Option<f64> {
        match self {
            Self::Ten => Some(10.0),
            Self::Minute => Some(60.0),
            Self::All => None,
        }
    }
}

/// An integrator in a file: by its id.
pub(super) mod integrator_id {
    use super::Integrator;
    use serde::{Deserialize as _, Deserializer, Serializer, de::Error as _};

    pub(crate) fn serialize<S: Serializer>(i: &Integrator, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(i.id())
    }

    /// An unknown id is an error that lists the known ones.
    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Integrator, D::Error> {
        String::deserialize(from)?.parse().map_err(D::Error::custom)
    }
}
