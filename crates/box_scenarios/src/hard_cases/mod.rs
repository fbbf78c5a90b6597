//! Motions that break integrators: the 24 hard cases of free motion, as named setups with a check.
//!
//! Each case has a body, a start, forces and step sizes, and says of any integrator at each of its
//! steps what was measured and whether that is **ok** (within the case's bound), **degraded** (wrong
//! but bounded) or **diverged** (not finite, or beyond every sane range).

mod checks;
mod list;

use core::fmt;

use box_physics::integrators::Integrator;

use crate::setup::Setup;
pub use list::hard_cases;

/// A motion that some integrators cannot do.
#[derive(Clone, Debug, PartialEq)]
pub struct HardCase {
    /// Its number, 1 to 24; some come in several variants.
    pub number: u8,
    /// As typed: lower case, hyphens.
    pub id: &'static str,
    /// What is hard about it.
    pub title: &'static str,
    /// Body, start, forces, impulses; the duration counts where the check does not say otherwise.
    pub setup: Setup,
    /// Step sizes \[s\].
    pub steps: Vec<f64>,
    /// What is measured.
    pub check: Check,
}

/// What a case measures, and up to where that is ok.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Check {
    /// Largest position error \[m\] against the reference.
    Position(f64),
    /// Largest attitude error \[rad\] against the reference.
    Attitude(f64),
    /// Largest relative energy error.
    Energy(f64),
    /// Free rotation keeps |L|, and its energy stays in [L²/2I_max, L²/2I_min]: the largest relative
    /// violation over this many steps.
    Bounded {
        /// Steps.
        steps: u64,
        /// Ok up to.
        bound: f64,
    },
    /// Relative energy trend over this many steps.
    Trend {
        /// Steps.
        steps: u64,
        /// Ok up to.
        bound: f64,
    },
    /// Attitude difference \[rad\] after this many steps forwards and as many backwards.
    Return {
        /// Steps.
        steps: u64,
        /// Ok up to.
        bound: f64,
    },
    /// | |q|² − 1 | after this many steps.
    UnitLength {
        /// Steps.
        steps: u64,
        /// Ok up to.
        bound: f64,
    },
    /// Drag never reverses a velocity: the largest reversed part of v_x over the initial v_x.
    NoReversal(f64),
    /// A step of length zero changes nothing: the number of components that changed.
    Unchanged,
    /// Every hundredth step lasts 0.5 s: relative error of the world angular momentum after 1000.
    Spikes(f64),
    /// All impulses at one instant add up to nothing: relative change of velocity and L.
    Restored(f64),
}

/// What a check found at one step size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// The step \[s\].
    pub h: f64,
    /// What was measured, with its unit.
    pub quantity: &'static str,
    /// The value.
    pub value: f64,
    /// Ok up to.
    pub bound: f64,
    /// Whether the motion stayed finite and within every sane range.
    pub sane: bool,
}

/// The verdict on a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Within the bound.
    Ok,
    /// Beyond it, but bounded.
    Degraded,
    /// Not finite, or beyond every sane range.
    Diverged,
}

impl Finding {
    /// Ok, degraded or diverged.
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
    /// One finding for each step size.
    pub fn examine(&self, integrator: Integrator) -> Vec<Finding> {
        let reference = match self.check {
            Check::Position(_) | Check::Attitude(_) | Check::Energy(_) => self.setup.reference(),
            _ => crate::ReferenceSolution::none(),
        };
        let one = |&h| checks::examine(self, &reference, integrator, h);
        self.steps.iter().map(one).collect()
    }
}
