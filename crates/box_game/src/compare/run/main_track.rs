//! The main box as the comparison sees it, and the vertical lines in the plots.

use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::{Balance, Divergence, Model, Status};

use crate::compare::track::Track;

/// What a vertical line in the plots stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RuleKind {
    /// The main box met the floor.
    Contact,
    /// A push, a changed parameter, a placing by hand.
    Input,
    /// Another step size.
    Step,
    /// The main box got another integrator.
    Integrator,
}

/// A vertical line in the plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Simulated time \[s\].
    pub t: f64,
    /// What happened.
    pub kind: RuleKind,
}

/// The main box as the comparison sees it: a body of the plugin, looked at before and after each step.
#[derive(Clone, Debug)]
pub struct MainTrack {
    /// Its integrator.
    pub integrator: Integrator,
    /// What its energy and angular momentum should be.
    pub balance: Balance,
    /// When and why it diverged, although the plugin goes on with it.
    pub diverged: Option<Divergence>,
    /// Past and present.
    pub track: Track,
    /// At the end of its last step.
    pub state: BodyState,
    /// Corners at the floor, then.
    pub contacts: u32,
    pub(super) before: BodyState,
    pub(super) reference: Option<BodyState>,
    pub(super) next_impulse: usize,
    /// The step began with one of the scene's impulses.
    pub(super) kicked: bool,
}

impl MainTrack {
    /// A main box in `state` at the start of a run.
    pub(super) fn new(integrator: Integrator, law: &Model, state: BodyState) -> Self {
        let balance = Balance::new(law, &state);
        Self {
            integrator,
            track: Track::new(law, &balance, &state, 0.0),
            balance,
            diverged: None,
            state,
            contacts: 0,
            before: state,
            reference: Some(state),
            next_impulse: 0,
            kicked: false,
        }
    }

    /// What can be said of it.
    pub fn status(&self) -> Status {
        Status::of(&self.state, self.contacts, self.diverged)
    }
}
