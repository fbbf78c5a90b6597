//! What the plots mark on their time axes.

/// What a mark in the plots stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RuleKind {
    /// The main box met the floor.
    Contact,
    /// The reference turned over.
    Flip,
    /// A push, a changed parameter, a placing by hand.
    Input,
    /// Another step size.
    Step,
    /// The main box got another integrator.
    Integrator,
    /// The comparisons were put into the reference's state.
    Resync,
}

/// A mark in the plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Simulated time \[s\].
    pub t: f64,
    /// What happened.
    pub kind: RuleKind,
}
