//! The trajectory that others are measured against, while inputs come: from a start, through the same inputs, each at
//! its exact time.
//!
//! While there is a closed form it is that; an impulse begins a new one from the state it leaves. Where there is none
//! (torques, tumbling contact) the motion is simulated in steps 64 times finer than the clock's, by the integrator that
//! is best for the forces, and once more in steps of half that size. What the two differ by is the reference's
//! [`uncertainty`](LiveReference::uncertainty): a smaller error says nothing. When they differ by more than
//! [`AGREEMENT`] the motion is chaotic and the reference ends: that moment is its
//! [`horizon`](LiveReference::horizon).

use std::collections::VecDeque;
use std::sync::Arc;

use box_physics::prelude::{BodyState, DVec3, Integrator};

use crate::driver::Driver;
use crate::driver::Model;
use crate::metrics::StateError;
use crate::reference::{ReferenceKind, ReferenceSolution};
use crate::setup::{Setup, TimedImpulse};

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

/// The integrator that is closest to the truth under `model`, in fine steps.
pub fn best_integrator(model: &Model) -> Integrator {
    let d = model.forces.dissipation();
    if d.quadratic_drag != 0.0 || d.angular_drag != 0.0 {
        Integrator::Rk4
    } else if model.forces.has_wrench() {
        Integrator::Split4
    } else {
        Integrator::Exact
    }
}

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

/// A simulation that only goes forward.
#[derive(Clone, Debug)]
struct Fine {
    driver: Driver,
    model: Arc<Model>,
    /// The scene's impulses that are still to come.
    waiting: VecDeque<TimedImpulse>,
    lost: bool,
}

impl Fine {
    fn new(
        state: BodyState,
        from: f64,
        model: &Arc<Model>,
        waiting: VecDeque<TimedImpulse>,
    ) -> Self {
        Self {
            driver: Driver::new(state, best_integrator(model)).at_time(from),
            model: model.clone(),
            waiting,
            lost: false,
        }
    }

    fn at(&mut self, t: f64, h: f64) -> Option<BodyState> {
        while let Some(i) = self.waiting.front().filter(|i| i.t < t) {
            let i = *i;
            self.run(i.t, h);
            self.waiting.pop_front();
            self.driver.state.apply_impulse_at_body_point(
                &self.model.body,
                i.impulse,
                i.body_point,
            );
        }
        self.run(t, h);
        let here = (self.driver.time - t).abs() <= 1e-9 * h;
        (here && !self.lost).then_some(self.driver.state)
    }

    /// On to exactly `t` in equal steps of at most `h`.
    fn run(&mut self, t: f64, h: f64) {
        let way = t - self.driver.time;
        if way <= 1e-9 * h || self.lost {
            return;
        }
        let n = (way / h - 1e-6).ceil().max(1.0);
        for _ in 0..n as u64 {
            self.lost |= self.driver.step(&self.model, way / n).is_none();
        }
        self.driver.time = t;
    }
}

impl LiveReference {
    /// From `start` at time 0; `truth` is the scene's, if it is known. `step` \[s\] is the clock's.
    pub fn new(
        model: &Arc<Model>,
        start: BodyState,
        impulses: &[TimedImpulse],
        truth: Option<ReferenceSolution>,
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
        let source = match truth.filter(|t| t.kind() != ReferenceKind::None) {
            Some(truth) => {
                if let ReferenceKind::Numerical { agreement } = truth.kind() {
                    reference.widen(agreement, agreement);
                }
                Source::Trusted(Arc::new(truth))
            }
            None => reference.fine(0.0, start, Some(start)),
        };
        reference.pieces.push_back(Piece { from: 0.0, source });
        reference
    }

    /// That of a setup, through all its impulses, for a clock of steps of `step` \[s\].
    pub fn of(setup: &Setup, step: f64) -> Self {
        let model = Arc::new(Model::of(setup));
        let truth = ReferenceSolution::closed_form(setup).unwrap_or_else(|| {
            // Its states are kept: of a longer scene the rest is simulated.
            let mut beginning = setup.clone();
            beginning.duration = beginning.duration.min(STORED);
            beginning.reference()
        });
        Self::new(&model, setup.initial, &setup.impulses, Some(truth), step)
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
            Source::Trusted(truth) => (truth.at((t - from).max(0.0)), None),
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
            Some(truth) => Source::Trusted(Arc::new(truth)),
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
            Some(Source::Trusted(truth)) => truth.description().to_owned(),
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
mod tests {
    use super::*;
    use crate::{Scenario, StateError};

    fn of(id: &str) -> (LiveReference, Arc<Model>) {
        let s = Scenario::find(id).expect("a scene");
        let law = Arc::new(Model::of(&s.setup));
        let truth = s.reference();
        (
            LiveReference::new(&law, s.setup.initial, &[], Some(truth), 1.0 / 60.0),
            law,
        )
    }

    /// After pushes in flight the closed form goes on; the answer is that of a setup which knew of the
    /// pushes from the start.
    #[test]
    fn a_push_starts_a_new_closed_form() {
        let s = Scenario::find("throw").expect("a scene");
        let (mut reference, _) = of("throw");
        let kick = |t: f64| TimedImpulse {
            t,
            impulse: DVec3::new(0.5, 1.0, -0.25),
            body_point: DVec3::new(0.1, 0.0, 0.2),
        };
        for t in [0.4, 0.7] {
            let k = kick(t);
            reference.push(
                t,
                &Change::Impulse {
                    impulse: k.impulse,
                    body_point: k.body_point,
                },
            );
            assert!(reference.is_trusted());
        }
        let truth = s.setup.clone().with_impulses(vec![kick(0.4), kick(0.7)]);
        let truth = truth.reference();
        for t in [0.2, 0.55, 1.3] {
            let (a, b) = (reference.at(t), truth.at(t));
            let e = StateError::between(&a.expect("kept"), &b.expect("closed"));
            assert!(e.position < 1e-12 && e.attitude < 1e-9, "{t}: {e:?}");
        }
    }

    /// Where there is no closed form: the simulation is as fine as it says, and close to a finer one.
    #[test]
    fn a_fine_simulation_where_there_is_no_formula() {
        let (mut reference, law) = of("heavy-top");
        assert!(reference.is_trusted());
        reference.push(
            0.5,
            &Change::Impulse {
                impulse: DVec3::X,
                body_point: DVec3::Y * 0.3,
            },
        );
        assert!(!reference.is_trusted());
        assert!(reference.description().contains("1/3840 s"));
        let start = reference.at(0.5).expect("here");
        let mut finer = Driver::new(start, Integrator::Split4);
        (0..20_000).for_each(|_| {
            finer.step(&law, 2.0 / 20_000.0);
        });
        let end = reference.at(2.5).expect("ahead");
        let e = StateError::between(&end, &finer.state);
        assert!(e.position < 1e-9 && e.attitude < 1e-8, "{e:?}");
        assert!(reference.at(1.0).is_none(), "its past is gone");
    }

    #[test]
    fn it_outlives_a_numerical_answer() {
        let s = Scenario::find("heavy-top").expect("a scene");
        let (mut reference, _) = of("heavy-top");
        let end = s.setup.duration;
        let before = reference.at(end - 0.01).expect("inside");
        let after = reference.at(end + 0.01).expect("goes on");
        assert!((after.position - before.position).length() < 0.1);
        assert!(!reference.is_trusted());
    }
}
