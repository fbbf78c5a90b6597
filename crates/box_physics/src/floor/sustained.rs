//! Sustained contact: a force acts during a segment of the step, so that sliding and pivoting have order 2 with any
//! integrator.
//!
//! The force is constant over the segment. It follows from the **mean** motion of the corners, at the middle attitude.
//! With d_k the mean velocity of corner k without contact (by the midpoint formula, under a wrench or drag by
//! `impulse_step`, so that the force does not depend on the integrator),
//!
//! ```text
//! ū_k = d_k + ½ W p,   0 ≤ p_n ⊥ ū_n ≥ 0,   friction in the cone against ū_t,
//! ```
//!
//! because a constant force p/τ moves a body half as far as the impulse p at the start. The same W on both sides makes the
//! work Σ p·ū ≤ 0 (θ = ½ of Moreau–Jean: Acary, Brogliato 2008, §10). The integrator then steps the segment with that
//! force. Position projection moves the held corners onto the floor, and their velocities are corrected likewise (as in
//! RATTLE, Andersen 1983).

use glam::{DMat3, DVec3};

use super::geometry::{each, has};
use super::ground::{Ground, Segment, Start};
use super::law::{Law, Solution};
use super::motion::{Supported, limit_energy};
use super::operator::DelassusOperator;
use super::slips::{NEGLIGIBLE, STOPPED};
use crate::integrators::StepOutcome;
use crate::state::BodyState;

impl<G: Ground<N>, const N: usize> Start<'_, G, N> {
    /// Computes the motion over `tau` \[s\], starting from the memory in `segment`.
    pub(super) fn advance(&self, tau: f64, segment: &mut Segment<N>) {
        let (ground, start) = (self.ground, &self.state);
        let level = ground.level();
        let body = level.context.body;
        let (middle, motion) = level.free_motion(start, self.elapsed, tau);
        let operator = DelassusOperator::at(body, middle, self.order);
        let place = |i: usize| usize::from(operator.place[i]);

        let d = ground.velocities(&operator, motion);
        let still = 1e-9 * operator.largest(&d);
        let slips = |i: usize, mean: &[DVec3; N]| {
            ground.along(place(i), mean[i]).length_squared() > still * still
        };
        let solve = |grips| Law::new(ground, &operator, grips).solve(&d, &[DVec3::ZERO; N]);
        // Static friction acts if no corner slips, before or after.
        let pushes = |i: usize, p: DVec3| ground.normal(place(i)).dot(p) > 0.0;
        let holds = |solution: &Solution<N>| {
            let mean = operator.after(&d, &solution.p);
            let mut loaded = (0..operator.count).filter(|&i| pushes(i, solution.p[i]));
            solution.converged && loaded.all(|i| !slips(i, &mean))
        };
        let grips = |k| ground.surface(k).static_friction.is_some();
        let solution = (each(self.candidates).any(grips) && !self.slips())
            .then(|| solve(true))
            .filter(holds)
            .unwrap_or_else(|| solve(false));
        let half = operator.resultant(&solution.p);
        let change = operator.twist_of(half);
        let mean = operator.moved(&d, change);
        segment.clear();
        segment.state = *start;
        segment.iterations = solution.iterations;
        segment.capped = !solution.converged;
        // The solution is half of the impulses.
        for i in 0..operator.count {
            segment.impulse[place(i)] += 2.0 * solution.p[i];
        }
        let (force, torque) = (2.0 * half.0, 2.0 * half.1);
        let at_rest = start.velocity == DVec3::ZERO && start.angular_momentum == DVec3::ZERO;
        if at_rest
            && operator.largest(&mean) <= still
            && ground.supports(self.places, self.candidates)
        {
            segment.places = *self.places;
            segment.outcome = StepOutcome::plain(1);
            segment.still = true;
            return;
        }

        if level.is_uniform() && !level.method.errs_in_gravity {
            let twist = (motion.0 + change.0, motion.1 + change.1);
            level.carry(&mut segment.state, tau, twist, 2.0 * change.0, torque);
            segment.outcome = StepOutcome::plain(1);
        } else {
            let rate = 1.0 / tau;
            let law = Supported {
                inner: level.context.force,
                acceleration: level.frame.vector(force * (rate * body.inverse_mass())),
                torque: level.frame.vector(torque * rate),
            };
            let (state, memory) = (&mut segment.state, &mut segment.memory);
            segment.outcome = level.in_world(state, self.elapsed, tau, |state| {
                (level.method.supported)(body, state, &law, tau, memory)
            });
        }

        let (mut held, mut stuck) = (0, 0);
        for i in 0..operator.count {
            held |= u64::from(pushes(i, solution.p[i])) << place(i);
            stuck |= u64::from(!slips(i, &mean)) << place(i);
        }
        self.settle(segment, held, stuck, tau);
    }

    /// Returns `true` if a corner that may be held slips.
    fn slips(&self) -> bool {
        each(self.candidates).any(|k| {
            let slip = self.ground.relative(k, self.places, self.twist);
            self.ground.along(k, slip).length() > self.still_speed
        })
    }

    /// Projects positions and velocities at the end of a segment. The corners in `stuck` have no mean slip.
    fn settle(&self, segment: &mut Segment<N>, held: u64, stuck: u64, tau: f64) {
        let (ground, end) = (self.ground, self.elapsed + tau);
        let body = ground.level().context.body;
        if held == 0 {
            segment.places = ground.places(&segment.state, end);
            return;
        }
        let (places, contacts) = ground.project(&mut segment.state, held, end);
        segment.places = places;
        let (old, new) = (self.twist, ground.twist(&segment.state));
        let (mut whole, mut after) = (0, [DVec3::ZERO; N]);
        for k in each(held) {
            after[k] = ground.relative(k, &segment.places, new);
            let before = ground.relative(k, self.places, old);
            let slip = [before, after[k]].map(|u| ground.along(k, u));
            let stops = self.stops(segment, k, has(stuck, k), slip, tau);
            whole |= u64::from(stops) << k;
        }
        if whole != 0 || !ground.stop(segment, &contacts, &after) {
            let operator = ground.operator(DMat3::from_quat(segment.state.rotation), held);
            let u = operator.place.map(|place| after[usize::from(place)]);
            let correction = ground.cancel(&operator, &u, whole);
            operator.apply(&mut segment.state, &correction);
            operator.add_to(&mut segment.impulse, &correction);
        }
        let speed = |s: &BodyState| {
            s.velocity.length() + s.body_angular_velocity(body).length() * ground.level().radius
        };
        if speed(&segment.state) <= 1e-11 * self.acceleration * tau
            && ground.supports(&segment.places, held)
        {
            segment.state.velocity = DVec3::ZERO;
            segment.state.angular_momentum = DVec3::ZERO;
        }
    }

    /// Returns `true` if the slip of the held corner `k`, given at both ends, ends with the segment. Records the time
    /// at which it vanishes.
    fn stops(
        &self,
        segment: &mut Segment<N>,
        k: usize,
        stuck: bool,
        [before, after]: [DVec3; 2],
        tau: f64,
    ) -> bool {
        let (ground, surface) = (self.ground, self.ground.surface(k));
        let sticks = stuck && surface.grip() > 0.0;
        let speed = before.length();
        if speed.is_nan() || speed <= self.still_speed {
            return sticks;
        }
        if sticks {
            let p = segment.impulse[k];
            let limit = surface.friction * ground.normal(k).dot(p);
            let used = (ground.along(k, p).length() / limit).min(1.0);
            // The slip distance under a constant deceleration.
            if 0.25 * speed * used * tau > NEGLIGIBLE * ground.level().radius {
                segment.slips.sticks(k, used);
            }
        } else {
            let along = before.dot(after) / speed;
            segment.slips.slides(k, after, along, speed);
        }
        // Friction does not reverse a slip: a slip that reverses within the shortest segment has stopped.
        let reversed = tau <= self.shortest && segment.slips.reversed(k);
        sticks || reversed || after.length() <= STOPPED * speed
    }

    /// Ends an accepted segment of `tau` \[s\]: penetration recovery, and removal of energy that integrator and projection
    /// errors have added. The latter is not applied under a wrench or in wind, whose work is unknown.
    pub(super) fn finish(&self, segment: &mut Segment<N>, tau: f64) {
        let (ground, level) = (self.ground, self.ground.level());
        ground.recover(&mut segment.state, &mut segment.places, self.elapsed + tau);
        if ground.is_fixed() && level.bounds_energy() {
            let (start, end) = (&self.state, &mut segment.state);
            segment.repaired = limit_energy(level.context.body, start, end, level.pull);
            if (end.position, end.rotation) == (start.position, start.rotation) {
                segment.places = *self.places; // the pose may have been reset
            }
        }
    }
}
