//! The reference trajectory for comparisons while inputs arrive. It has the same start and receives the same inputs,
//! each at its exact time.
//!
//! The reference is a closed form where there is one; an impulse starts a new one from the state after it. Otherwise
//! (torques, tumbling contact) the motion is simulated in steps 64 times finer than the clock's, by the integrator that
//! is best for the forces, and again in steps of half that size. The difference between the two is the reference's
//! [`uncertainty`](LiveReference::uncertainty): smaller errors are not significant. When it exceeds [`AGREEMENT`], the
//! motion is chaotic and the reference ends at its [`horizon`](LiveReference::horizon).

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

/// Ratio of the clock's step to the reference's step.
pub const FINER: f64 = 64.0;
/// Largest difference between the reference and the same in half its steps: attitude \[rad\], and position divided by
/// the radius of the box. It is a twentieth of a visible difference.
pub const AGREEMENT: f64 = 1e-3;
/// Shortest step of the reference \[s\]. At the shortest steps of the clock, a step 64 times finer would cost more than
/// a frame. The integrators used are of fourth order or exact.
const MIN_STEP: f64 = 1.0 / 30_720.0;
/// Number of segments kept, so that the errors of a lagging comparison can still be computed.
const MAX_SEGMENTS: usize = 256;
/// Maximum duration of a stored numerical reference \[s\].
const MAX_STORED_DURATION: f64 = 120.0;
/// Duration for which a closed form is requested \[s\].
const CLOSED_FORM_DURATION: f64 = 3600.0;

/// A change to the box or its model.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// An impulse J \[N s\], world axes, at a point in body axes from the center \[m\].
    Impulse {
        /// J \[N s\], world axes.
        impulse: DVec3,
        /// Point of application, body axes \[m\].
        body_point: DVec3,
    },
    /// A different model from now on.
    Model(Arc<Model>),
    /// A state set by the user.
    Place(BodyState),
}

/// The reference trajectory while inputs arrive; see the [module](self).
#[derive(Clone, Debug)]
pub struct LiveReference {
    segments: VecDeque<Segment>,
    model: Arc<Model>,
    impulses: Arc<[TimedImpulse]>,
    /// Step of the fine simulation \[s\].
    h: f64,
    /// Time and state of the last result.
    last: (f64, BodyState),
    horizon: Option<f64>,
    uncertainty: Uncertainty,
}

/// Estimated error of a reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Uncertainty {
    /// Position \[m\].
    pub position: f64,
    /// Attitude \[rad\].
    pub attitude: f64,
}

#[derive(Clone, Debug)]
struct Segment {
    from: f64,
    source: Source,
}

#[derive(Clone, Debug)]
enum Source {
    Trusted(Arc<ReferenceSolution>),
    /// The simulation, and the same in half its steps as long as they agree.
    Fine(Box<Fine>, Option<Box<Fine>>),
}

impl LiveReference {
    /// Creates a reference from `start` at time 0. `known` is the scene's reference, if it has one. `step` \[s\] is the
    /// clock's step.
    pub fn new(
        model: &Arc<Model>,
        start: BodyState,
        impulses: &[TimedImpulse],
        known: Option<ReferenceSolution>,
        step: f64,
    ) -> Self {
        let mut reference = Self {
            segments: VecDeque::new(),
            model: model.clone(),
            impulses: impulses.into(),
            h: MIN_STEP,
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
        reference.segments.push_back(Segment { from: 0.0, source });
        reference
    }

    /// Creates the reference of a setup with all its impulses, for a clock with steps of `step` \[s\].
    pub fn of(setup: &Setup, step: f64) -> Self {
        let model = Arc::new(Model::of(setup));
        let known = ReferenceSolution::closed_form(setup).unwrap_or_else(|| {
            // A numerical reference stores its states. Beyond this duration, a longer scene is simulated.
            let mut beginning = setup.clone();
            beginning.duration = beginning.duration.min(MAX_STORED_DURATION);
            beginning.reference()
        });
        Self::new(&model, setup.initial, &setup.impulses, Some(known), step)
    }

    /// Sets the clock's step \[s\].
    pub fn set_clock_step(&mut self, step: f64) {
        if step > 0.0 && step.is_finite() {
            self.h = (step / FINER).max(MIN_STEP);
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

    /// The last time \[s\] at which the reference agreed with itself at half its step; `None` while it agrees. After
    /// this time the motion is chaotic, and errors have no meaning.
    pub fn horizon(&self) -> Option<f64> {
        self.horizon
    }

    /// The largest difference so far between the reference and itself at half its step; 0 for a closed form.
    pub fn uncertainty(&self) -> Uncertainty {
        self.uncertainty
    }

    /// The reference at `t` \[s\], after the inputs at that time. `None` if it is not available: after the horizon,
    /// before the stored segments, or in the past of a fine simulation.
    pub fn at(&mut self, t: f64) -> Option<BodyState> {
        let margin = 1e-9 * self.h;
        if self.horizon.is_some_and(|end| t > end + margin) {
            return None;
        }
        let state = self.follow(t);
        state.filter(|_| self.horizon.is_none_or(|end| t <= end + margin))
    }

    /// Like [`at`](Self::at), but continues after the horizon with one of the possible motions.
    pub fn follow(&mut self, t: f64) -> Option<BodyState> {
        let margin = 1e-9 * self.h;
        let k = self.segments.iter().rposition(|p| p.from <= t + margin)?;
        let newest = k + 1 == self.segments.len();
        let from = self.segments[k].from;
        let (state, finer) = match &mut self.segments[k].source {
            Source::Trusted(solution) => (solution.at((t - from).max(0.0)), None),
            Source::Fine(fine, check) => {
                let finer = check.as_mut().map(|c| c.at(t, 0.5 * self.h));
                (fine.at(t, self.h), finer)
            }
        };
        if newest && state.is_none() && self.is_trusted() {
            // A numerical reference ends with its scene. Continue from the last known state.
            let (from, start) = self.last;
            let source = self.fine(from, start, Some(start));
            self.segments.push_back(Segment { from, source });
            return self.follow(t);
        }
        if let (Some(state), Some(finer)) = (&state, &finer) {
            // An invalid check has an infinite difference.
            let e = finer.map_or(StateError::INFINITE, |finer| {
                StateError::between(state, &finer)
            });
            if e.position <= AGREEMENT * self.model.body.radius() && e.attitude <= AGREEMENT {
                self.widen(e.position, e.attitude);
            } else {
                self.horizon = Some(self.last.0);
                if let Source::Fine(_, check) = &mut self.segments[k].source {
                    *check = None;
                }
            }
        }
        if let (true, Some(state)) = (newest, state) {
            self.last = (t, state);
        }
        state
    }

    /// Applies an input at `t` \[s\], which must not be earlier than any previous one.
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
        // Requested only if it is cheap, because springs change in every frame of a grab.
        let closed = (!self.model.forces.has_wrench()).then(|| {
            let mut setup = self.model.setup(state, CLOSED_FORM_DURATION);
            setup.impulses = self.waiting(t).into();
            setup.impulses.iter_mut().for_each(|i| i.t -= t);
            ReferenceSolution::closed_form(&setup)
        });
        let source = match closed.flatten() {
            Some(solution) => Source::Trusted(Arc::new(solution)),
            None => self.fine(t, state, check),
        };
        self.last = (t, state);
        // Several inputs at the same time form one segment.
        self.segments.retain(|p| p.from < t - 1e-9 * self.h);
        // The past of a fine simulation is no longer available.
        self.segments
            .retain(|p| matches!(p.source, Source::Trusted(_)));
        self.segments.push_back(Segment { from: t, source });
        if self.segments.len() > MAX_SEGMENTS {
            self.segments.pop_front();
        }
    }

    /// The current state of the simulation in half the steps.
    fn finer(&self) -> Option<BodyState> {
        match self.segments.back().map(|p| &p.source) {
            Some(Source::Fine(_, Some(check))) => Some(check.driver.state),
            _ => None,
        }
    }

    /// Source of the current reference, in words.
    pub fn description(&self) -> String {
        match self.segments.back().map(|p| &p.source) {
            Some(Source::Trusted(solution)) => solution.description().to_owned(),
            Some(Source::Fine(fine, _)) => format!(
                "{} in steps of 1/{:.0} s",
                fine.driver.integrator,
                1.0 / self.h
            ),
            None => "none".to_owned(),
        }
    }

    /// Returns `true` if the current reference is a closed form or a stored numerical solution, not a fine simulation.
    pub fn is_trusted(&self) -> bool {
        matches!(
            self.segments.back().map(|p| &p.source),
            Some(Source::Trusted(_))
        )
    }
}

#[cfg(test)]
mod tests;
