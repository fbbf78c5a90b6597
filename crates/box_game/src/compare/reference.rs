//! The trusted trajectory that the lanes are measured against: from the scene's start, through the same
//! inputs, each at its exact time.
//!
//! While there is a closed form it is that; an impulse begins a new one from the state it leaves. Where
//! there is none (torques, tumbling contact) the motion is simulated in steps 64 times finer than the
//! clock's, by the integrator that is best for the law.

use std::collections::VecDeque;
use std::sync::Arc;

use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::{ReferenceKind, ReferenceSolution, TimedImpulse};

use super::input::Change;
use crate::compare::lane::{Lane, Law};

/// How much finer the reference steps than the clock.
pub const FINER: f64 = 64.0;
/// Its shortest step \[s\]: at the shortest steps of the clock 64 times finer would cost more than a
/// frame has, and the integrators used are of fourth order or exact.
const SHORTEST: f64 = 1.0 / 30_720.0;
/// Stretches kept, so that a lane that is behind can still be measured.
const PIECES: usize = 256;
/// For how long a closed form is asked \[s\].
const LONG: f64 = 3600.0;

/// The integrator that is closest to the truth under `law`, in fine steps.
pub fn best_integrator(law: &Law) -> Integrator {
    let d = law.forces.dissipation();
    if d.quadratic_drag != 0.0 || d.angular_drag != 0.0 {
        Integrator::Rk4
    } else if law.forces.has_wrench() {
        Integrator::Split4
    } else {
        Integrator::Exact
    }
}

/// See the module.
#[derive(Clone, Debug)]
pub struct Reference {
    pieces: VecDeque<Piece>,
    law: Arc<Law>,
    impulses: Arc<[TimedImpulse]>,
    /// Step of the fine simulation \[s\].
    h: f64,
    /// The latest answer.
    last: (f64, BodyState),
}

#[derive(Clone, Debug)]
struct Piece {
    from: f64,
    source: Source,
}

#[derive(Clone, Debug)]
enum Source {
    Trusted(Arc<ReferenceSolution>),
    Fine(Box<Fine>),
}

/// A simulation that only goes forward.
#[derive(Clone, Debug)]
struct Fine {
    lane: Lane,
    law: Arc<Law>,
    /// The scene's impulses that are still to come.
    waiting: VecDeque<TimedImpulse>,
    lost: bool,
}

impl Fine {
    fn new(state: BodyState, from: f64, law: &Arc<Law>, waiting: VecDeque<TimedImpulse>) -> Self {
        Self {
            lane: Lane::new(state, best_integrator(law)).at_time(from),
            law: law.clone(),
            waiting,
            lost: false,
        }
    }

    fn at(&mut self, t: f64, h: f64) -> Option<BodyState> {
        while let Some(i) = self.waiting.front().filter(|i| i.t < t) {
            let i = *i;
            self.run(i.t, h);
            self.waiting.pop_front();
            self.lane
                .state
                .apply_impulse_at_body_point(&self.law.body, i.impulse, i.body_point);
        }
        self.run(t, h);
        let here = (self.lane.time - t).abs() <= 1e-9 * h;
        (here && !self.lost).then_some(self.lane.state)
    }

    /// On to exactly `t` in equal steps of at most `h`.
    fn run(&mut self, t: f64, h: f64) {
        let way = t - self.lane.time;
        if way <= 1e-9 * h || self.lost {
            return;
        }
        let n = (way / h - 1e-6).ceil().max(1.0);
        for _ in 0..n as u64 {
            self.lost |= !self.lane.step(&self.law, way / n).sound;
        }
        self.lane.time = t;
    }
}

impl Reference {
    /// From `start` at time 0; `truth` is the scene's, if it is known. `step` \[s\] is the clock's.
    pub fn new(
        law: &Arc<Law>,
        start: BodyState,
        impulses: &[TimedImpulse],
        truth: Option<ReferenceSolution>,
        step: f64,
    ) -> Self {
        let mut reference = Self {
            pieces: VecDeque::new(),
            law: law.clone(),
            impulses: impulses.into(),
            h: SHORTEST,
            last: (0.0, start),
        };
        reference.set_clock_step(step);
        let source = match truth.filter(|t| t.kind() != ReferenceKind::None) {
            Some(truth) => Source::Trusted(Arc::new(truth)),
            None => Source::Fine(Box::new(Fine::new(start, 0.0, law, reference.waiting(0.0)))),
        };
        reference.pieces.push_back(Piece { from: 0.0, source });
        reference
    }

    /// The clock's step \[s\] is another.
    pub fn set_clock_step(&mut self, step: f64) {
        if step > 0.0 && step.is_finite() {
            self.h = (step / FINER).max(SHORTEST);
        }
    }

    fn waiting(&self, from: f64) -> VecDeque<TimedImpulse> {
        let to_come = |i: &&TimedImpulse| i.t >= from - 1e-9;
        self.impulses.iter().filter(to_come).copied().collect()
    }

    /// The trusted state at `t` \[s\], after the inputs at that time. `None` where it cannot be had (any
    /// more): before the stretches that are kept, or in the past of a fine simulation.
    pub fn at(&mut self, t: f64) -> Option<BodyState> {
        let margin = 1e-9 * self.h;
        let k = self.pieces.iter().rposition(|p| p.from <= t + margin)?;
        let newest = k + 1 == self.pieces.len();
        let piece = &mut self.pieces[k];
        let state = match &mut piece.source {
            Source::Trusted(truth) => truth.at((t - piece.from).max(0.0)),
            Source::Fine(fine) => fine.at(t, self.h),
        };
        if let (true, None, Source::Trusted(_)) = (newest, &state, &piece.source) {
            // A numerical answer ends with its scene: go on from the last state known.
            let (from, start) = self.last;
            let fine = Fine::new(start, from, &self.law, self.waiting(from));
            self.pieces.push_back(Piece {
                from,
                source: Source::Fine(Box::new(fine)),
            });
            return self.at(t);
        }
        if let (true, Some(state)) = (newest, state) {
            self.last = (t, state);
        }
        state
    }

    /// Takes an input at `t` \[s\], at or after every earlier one.
    pub fn push(&mut self, t: f64, change: &Change) {
        let known = match change {
            Change::Place(state) => Some(*state),
            _ => self.at(t),
        };
        let Some(mut state) = known else {
            return;
        };
        match change {
            Change::Impulse {
                impulse,
                body_point,
            } => state.apply_impulse_at_body_point(&self.law.body, *impulse, *body_point),
            Change::Law(law) => self.law = law.clone(),
            Change::Place(_) => {}
        }
        let waiting = self.waiting(t);
        // Asked for only where the answer is quick: springs change with every frame of a grab.
        let closed = (!self.law.forces.has_wrench()).then(|| {
            let mut setup = self.law.setup(state, LONG);
            setup.impulses = waiting.iter().copied().collect();
            setup.impulses.iter_mut().for_each(|i| i.t -= t);
            ReferenceSolution::closed_form(&setup)
        });
        let source = match closed.flatten() {
            Some(truth) => Source::Trusted(Arc::new(truth)),
            None => Source::Fine(Box::new(Fine::new(state, t, &self.law, waiting))),
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

    /// Where the present answer comes from, in words.
    pub fn description(&self) -> String {
        match self.pieces.back().map(|p| &p.source) {
            Some(Source::Trusted(truth)) => truth.description().to_owned(),
            Some(Source::Fine(fine)) => format!(
                "{} in steps of 1/{:.0} s",
                fine.lane.integrator,
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
    use box_physics::prelude::DVec3;
    use box_scenarios::{Scenario, StateError};

    fn of(id: &str) -> (Reference, Arc<Law>) {
        let s = Scenario::find(id).expect("a scene");
        let law = Arc::new(Law::of(&s.setup));
        let truth = s.reference();
        (
            Reference::new(&law, s.setup.initial, &[], Some(truth), 1.0 / 60.0),
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
        let mut finer = Lane::new(start, Integrator::Split4);
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
