//! The 24 hard cases of free motion on which integrators fail, as named setups with a check.
//!
//! Each case has a body, a start, forces and step sizes. For any integrator and each step size it measures a quantity
//! and returns a verdict: **ok** (within the case's bound), **degraded** (inaccurate but bounded) or **diverged** (not
//! finite, or beyond the sane range).

mod checks;
mod list;

use core::fmt;

use box_physics::integrators::Integrator;

use crate::setup::Setup;
pub use list::hard_cases;

/// A motion on which some integrators fail.
#[derive(Clone, Debug, PartialEq)]
pub struct HardCase {
    /// Number of the case, 1 to 24; some cases have several variants.
    pub number: u8,
    /// Identifier: lower case with hyphens.
    pub id: &'static str,
    /// The difficulty of the case.
    pub title: &'static str,
    /// Body, start, forces, impulses. The duration applies unless the check has its own number of steps.
    pub setup: Setup,
    /// Step sizes \[s\].
    pub steps: Vec<f64>,
    /// The quantity to measure.
    pub check: Check,
}

/// The measured quantity, and the bound up to which it is ok.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Check {
    /// Largest position error \[m\] against the reference.
    Position(f64),
    /// Largest attitude error \[rad\] against the reference.
    Attitude(f64),
    /// Largest relative energy error.
    Energy(f64),
    /// Free rotation must conserve |L|, and its energy must stay in [L²/2I_max, L²/2I_min]: the largest relative
    /// violation over this number of steps.
    Bounded {
        /// Number of steps.
        steps: u64,
        /// Largest value that is ok.
        bound: f64,
    },
    /// Relative energy trend over this number of steps.
    Trend {
        /// Number of steps.
        steps: u64,
        /// Largest value that is ok.
        bound: f64,
    },
    /// Attitude difference \[rad\] after this number of steps forward and backward.
    Return {
        /// Number of steps.
        steps: u64,
        /// Largest value that is ok.
        bound: f64,
    },
    /// | |q|² − 1 | after this number of steps.
    UnitLength {
        /// Number of steps.
        steps: u64,
        /// Largest value that is ok.
        bound: f64,
    },
    /// Drag must never reverse a velocity: the largest reversed part of v_x, divided by the initial v_x.
    NoReversal(f64),
    /// A step of length zero must not change anything: the number of changed components.
    Unchanged,
    /// Every hundredth step lasts 0.5 s: relative error of the world angular momentum after 1000 steps.
    Spikes(f64),
    /// All impulses at one instant cancel: relative change of velocity and L.
    Restored(f64),
}

/// Result of a check at one step size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// The step \[s\].
    pub h: f64,
    /// The measured quantity, with its unit.
    pub quantity: &'static str,
    /// The value.
    pub value: f64,
    /// Largest value that is ok.
    pub bound: f64,
    /// `true` if the motion stayed finite and within the sane range.
    pub sane: bool,
}

/// The verdict on a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Within the bound.
    Ok,
    /// Beyond the bound, but bounded.
    Degraded,
    /// Not finite, or outside the plausible range.
    Diverged,
}

impl Finding {
    /// Returns the verdict on the value.
    pub fn verdict(&self) -> Verdict {
        if !self.sane || !self.value.is_finite() {
            Verdict::Diverged
        } else if self.value <= self.bound {
            Verdict::Ok
        } else {
            Verdict::Degraded
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Ok => "ok",
            Self::Degraded => "degraded",
            Self::Diverged => "diverged",
        })
    }
}

impl HardCase {
    /// Examines `integrator` and returns one finding per step size.
    pub fn examine(&self, integrator: Integrator) -> Vec<Finding> {
        let reference = match self.check {
            Check::Position(_) | Check::Attitude(_) | Check::Energy(_) => self.setup.reference(),
            _ => crate::ReferenceSolution::none(),
        };
        let one = |&h| checks::examine(self, &reference, integrator, h);
        self.steps.iter().map(one).collect()
    }
}
