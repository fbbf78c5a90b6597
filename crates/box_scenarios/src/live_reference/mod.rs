//! The trajectory that others are measured against, while inputs come: from a start, through the same inputs, each at
//! its exact time.
//!
//! While there is a closed form it is that; an impulse begins a new one from the state it leaves. Where there is none
//! (torques, tumbling contact) the motion is simulated in steps 64 times finer than the clock's, by the integrator that
//! is best for the forces, and once more in steps of half that size. What the two differ by is the reference's
//! [`uncertainty`](LiveReference::uncertainty): a smaller error says nothing. When they differ by more than
//! [`AGREEMENT`] the motion is chaotic and the reference ends: that moment is its
//! [`horizon`](LiveReference::horizon).

mod fine;

pub use fine::best_integrator;

use std::collections::VecDeque;
use std::sync::Arc;

use box_physics::prelude::{BodyState, DVec3};

use crate::metrics::StateError;
use crate::model::Model;
use crate::reference::{ReferenceKind, ReferenceSolution};
use crate::setup::{Setup, TimedImpulse};
use fine::Fine;

/// How much finer the reference steps than the clock.
pub const FINER: f64 = 64.0;
/// Largest difference between the reference and the same in half its steps: attitude \[rad\], and position over the
/// radius of the box. Twenty times less than what can be seen.
pub const AGREEMENT: f64 = 1e-3;
/// Its shortest step \[s\]: at the shortest steps of the clock 64 times finer would cost more than a
/// frame has, and the integrators used are of fourth order or exact.
const SHORTEST: f64 = 1.0 / 30_720.0;
/// Stretches kept, so that a comparison that is behind can still be measured.
const PIECES: usize = 256;
/// For how long a stored numerical reference is made at most \[s\].
const STORED: f64 = 120.0;
/// For how long a closed form is asked \[s\].
const LONG: f64 = 3600.0;

/// Something done to the box.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// The impulse J \[N s\], world axes, at a point in body axes from the center \[m\].
    Impulse {
        /// J \[N s\], world axes.
        impulse: DVec3,
        /// Where, body axes \[m\].
        body_point: DVec3,
    },
    /// What acts is another from here on.
    Model(Arc<Model>),
    /// The box was put there by hand.
    Place(BodyState),
}

/// See the module.
#[derive(Clone, Debug)]
pub struct LiveReference {
    pieces: VecDeque<Piece>,
    model: Arc<Model>,
    impulses: Arc<[TimedImpulse]>,
    /// Step of the fine simulation \[s\].
    h: f64,
    /// The latest answer.
    last: (f64, BodyState),
    horizon: Option<f64>,
    uncertainty: Uncertainty,
}

/// How far a reference may be from the motion that it stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Uncertainty {
    /// \[m\]
    pub position: f64,
    /// \[rad\]
    pub attitude: f64,
}

#[derive(Clone, Debug)]
struct Piece {
    from: f64,
    source: Source,
}

#[derive(Clone, Debug)]
enum Source {
    Trusted(Arc<ReferenceSolution>),
    /// The simulation, and the same in half its steps while they agree.
    Fine(Box<Fine>, Option<Box<Fine>>),
}

impl LiveReference {
    /// From `start` at time 0; `known` is the scene's reference, if it has one. `step` \[s\] is the clock's.
    pub fn new(
        model: &Arc<Model>,
        start: BodyState,
        impulses: &[TimedImpulse],
        known: Option<ReferenceSolution>,
        step: f64,
    ) -> Self {
        let mut reference = Self {
            pieces: VecDeque::new(),
            model: model.clone(),
            impulses: impulses.into(),
            h: SHORTEST,
            last: (0.0, start),
            horizon: None,
            uncertainty: Uncertainty::default(),
        };
        reference.set_clock_step(step);
        let source = match known.filter(|r| r.kind() != ReferenceKind::None) {
            Some(known) => {
                if let ReferenceKind::Numerical { agreement } = known.kind() {
                    reference.widen(agreement, agreement);
                }
                Source::Trusted(Arc::new(known))
            }
            None => reference.fine(0.0, start, Some(start)),
        };
        reference.pieces.push_back(Piece { from: 0.0, source });
        reference
    }

    /// That of a setup, through all its impulses, for a clock of steps of `step` \[s\].
    pub fn of(setup: &Setup, step: f64) -> Self {
        let model = Arc::new(Model::of(setup));
        let known = ReferenceSolution::closed_form(setup).unwrap_or_else(|| {
            // Its states are kept: of a longer scene the rest is simulated.
            let mut beginning = setup.clone();
            beginning.duration = beginning.duration.min(STORED);
            beginning.reference()
        });
        Self::new(&model, setup.initial, &setup.impulses, Some(known), step)
    }

    /// The clock's step \[s\] is another.
    pub fn set_clock_step(&mut self, step: f64) {
        if step > 0.0 && step.is_finite() {
            self.h = (step / FINER).max(SHORTEST);
        }
    }

    fn fine(&self, from: f64, state: BodyState, check: Option<BodyState>) -> Source {
        let fine = |state| Box::new(Fine::new(state, from, &self.model, self.waiting(from)));
        Source::Fine(fine(state), check.map(fine))
    }

    fn waiting(&self, from: f64) -> VecDeque<TimedImpulse> {
        let to_come = |i: &&TimedImpulse| i.t >= from - 1e-9;
        self.impulses.iter().filter(to_come).copied().collect()
    }

    fn widen(&mut self, position: f64, attitude: f64) {
        let u = &mut self.uncertainty;
        u.position = u.position.max(position);
        u.attitude = u.attitude.max(attitude);
    }

    /// The last time \[s\] at which the reference agreed with itself at half its step, once it no longer does: after
    /// that the motion is chaotic, and no error has a meaning.
    pub fn horizon(&self) -> Option<f64> {
        self.horizon
    }

    /// The largest difference so far between the reference and itself at half its step; 0 for a closed form.
    pub fn uncertainty(&self) -> Uncertainty {
        self.uncertainty
    }

    /// The reference at `t` \[s\], after the inputs at that time. `None` where it cannot be had (any more): after the
    /// horizon, before the stretches that are kept, or in the past of a fine simulation.
    pub fn at(&mut self, t: f64) -> Option<BodyState> {
        let margin = 1e-9 * self.h;
        if self.horizon.is_some_and(|end| t > end + margin) {
            return None;
        }
        let state = self.follow(t);
        state.filter(|_| self.horizon.is_none_or(|end| t <= end + margin))
    }

    /// The same after the horizon as well: one of the motions that are possible.
    pub fn follow(&mut self, t: f64) -> Option<BodyState> {
        let margin = 1e-9 * self.h;
        let k = self.pieces.iter().rposition(|p| p.from <= t + margin)?;
        let newest = k + 1 == self.pieces.len();
        let from = self.pieces[k].from;
        let (state, finer) = match &mut self.pieces[k].source {
            Source::Trusted(solution) => (solution.at((t - from).max(0.0)), None),
            Source::Fine(fine, check) => {
                let finer = check.as_mut().map(|c| c.at(t, 0.5 * self.h));
                (fine.at(t, self.h), finer)
            }
        };
        if newest && state.is_none() && self.is_trusted() {
            // A numerical answer ends with its scene: go on from the last state known.
            let (from, start) = self.last;
            let source = self.fine(from, start, Some(start));
            self.pieces.push_back(Piece { from, source });
            return self.follow(t);
        }
        if let (Some(state), Some(finer)) = (&state, &finer) {
            // One that is lost is infinitely far away.
            let e = finer.map_or(StateError::LOST, |finer| StateError::between(state, &finer));
            if e.position <= AGREEMENT * self.model.body.radius() && e.attitude <= AGREEMENT {
                self.widen(e.position, e.attitude);
            } else {
                self.horizon = Some(self.last.0);
                if let Source::Fine(_, check) = &mut self.pieces[k].source {
                    *check = None;
                }
            }
        }
        if let (true, Some(state)) = (newest, state) {
            self.last = (t, state);
        }
        state
    }

    /// Takes an input at `t` \[s\], at or after every earlier one.
    pub fn push(&mut self, t: f64, change: &Change) {
        let (known, finer) = match change {
            Change::Place(state) => {
                (self.horizon, self.uncertainty) = (None, Uncertainty::default());
                (Some(*state), Some(*state))
            }
            _ => (self.follow(t), self.finer()),
        };
        let Some(mut state) = known else {
            return;
        };
        let mut check = if self.horizon.is_some() {
            None
        } else {
            finer.or(known)
        };
        match change {
            Change::Impulse {
                impulse,
                body_point,
            } => {
                for state in [Some(&mut state), check.as_mut()].into_iter().flatten() {
                    state.apply_impulse_at_body_point(&self.model.body, *impulse, *body_point);
                }
            }
            Change::Model(model) => self.model = model.clone(),
            Change::Place(_) => {}
        }
        // Asked for only where the answer is quick: springs change with every frame of a grab.
        let closed = (!self.model.forces.has_wrench()).then(|| {
            let mut setup = self.model.setup(state, LONG);
            setup.impulses = self.waiting(t).into();
            setup.impulses.iter_mut().for_each(|i| i.t -= t);
            ReferenceSolution::closed_form(&setup)
        });
        let source = match closed.flatten() {
            Some(solution) => Source::Trusted(Arc::new(solution)),
            None => self.fine(t, state, check),
        };
        self.last = (t, state);
        // Several inputs at one time make one stretch.
        self.pieces.retain(|p| p.from < t - 1e-9 * self.h);
        // The past of a fine simulation cannot be asked any more.
        self.pieces
            .retain(|p| matches!(p.source, Source::Trusted(_)));
        self.pieces.push_back(Piece { from: t, source });
        if self.pieces.len() > PIECES {
            self.pieces.pop_front();
        }
    }

    /// The present state in half the steps.
    fn finer(&self) -> Option<BodyState> {
        match self.pieces.back().map(|p| &p.source) {
            Some(Source::Fine(_, Some(check))) => Some(check.driver.state),
            _ => None,
        }
    }

    /// Where the present answer comes from, in words.
    pub fn description(&self) -> String {
        match self.pieces.back().map(|p| &p.source) {
            Some(Source::Trusted(solution)) => solution.description().to_owned(),
            Some(Source::Fine(fine, _)) => format!(
                "{} in steps of 1/{:.0} s",
                fine.driver.integrator,
                1.0 / self.h
            ),
            None => "none".to_owned(),
        }
    }

    /// Whether it is a formula or a trusted quadrature, not a fine simulation.
    pub fn is_trusted(&self) -> bool {
        matches!(
            self.pieces.back().map(|p| &p.source),
            Some(Source::Trusted(_))
        )
    }
}

#[cfg(test)]
mod tests;
