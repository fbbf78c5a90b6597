//! What can be said of a trajectory at one moment.

use core::fmt;

use box_physics::prelude::BodyState;

/// The state of a trajectory, for table, panel and log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Status {
    /// In free flight.
    #[default]
    Ok,
    /// At the floor.
    Contact,
    /// At the floor, without any motion.
    Resting,
    /// Frozen at its last valid state.
    Quarantined,
    /// Simulated up to this part of the clock's time, 0 to 1.
    CatchingUp(f64),
    /// Given up.
    Diverged(Divergence),
}

/// When and why a trajectory was given up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divergence {
    /// Simulated time \[s\].
    pub t: f64,
    /// What was wrong.
    pub reason: Reason,
}

/// What was wrong with a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// It is not finite, or beyond the limits of a valid state.
    Invalid,
    /// It has more than twice the energy that it could have been given.
    Energy,
    /// It is more than a thousand times faster than the reference has been.
    Speed,
}

impl Status {
    /// Of a body in `state` with `contacts` corners at the floor.
    pub fn of(state: &BodyState, contacts: u32, diverged: Option<Divergence>) -> Self {
        let still =
            state.velocity == glam::DVec3::ZERO && state.angular_momentum == glam::DVec3::ZERO;
        match diverged {
            Some(divergence) => Self::Diverged(divergence),
            None if contacts == 0 => Self::Ok,
            None if still => Self::Resting,
            None => Self::Contact,
        }
    }

    /// One word, as in the CSV log.
    pub const fn id(&self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Contact => "contact",
            Self::Resting => "resting",
            Self::Quarantined => "quarantined",
            Self::CatchingUp(_) => "catching up",
            Self::Diverged(_) => "diverged",
        }
    }

    /// Whether the trajectory was given up.
    pub const fn is_diverged(&self) -> bool {
        matches!(self, Self::Diverged(_))
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CatchingUp(part) => write!(f, "catching up, {:.0} %", 100.0 * part),
            Self::Diverged(d) => write!(f, "diverged at t = {:.2} s ({})", d.t, d.reason),
            other => f.write_str(other.id()),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Invalid => "invalid state",
            Self::Energy => "energy",
            Self::Speed => "speed",
        })
    }
}
