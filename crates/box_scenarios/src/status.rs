//! Status of a trajectory at one time.

use core::fmt;

use box_physics::prelude::BodyState;

/// Status of a trajectory, for table, panel and log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Status {
    /// The box is in free flight.
    #[default]
    Ok,
    /// The box touches the floor.
    Contact,
    /// The box touches the floor and does not move.
    Resting,
    /// The box is frozen at its last valid state.
    Quarantined,
    /// The simulation has reached this fraction of the clock's time, 0 to 1.
    CatchingUp(f64),
    /// The run was stopped because it diverged.
    Diverged(Divergence),
}

/// Time and cause of a divergence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divergence {
    /// Simulated time \[s\].
    pub t: f64,
    /// The cause.
    pub reason: Reason,
}

/// Cause of a divergence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The state is not finite, or exceeds the limits of a valid state.
    Invalid,
    /// The kinetic energy exceeds what the body can have been given by more than its largest value so far.
    Energy,
    /// The state is more than a thousand times faster than the reference has been.
    Speed,
}

impl Status {
    /// The status of a body in `state` with `contacts` corners at the floor.
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

    /// Identifier of the status in the CSV log.
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

    /// Returns `true` if the trajectory was stopped.
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
