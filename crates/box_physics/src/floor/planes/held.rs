//! Sustained contact at several planes: as at the floor (`sustained`), with a force for each contact. From the mean
//! velocities d without contact and those of the planes,
//!
//! ```text
//! ū = d + ½Wp,   0 ≤ p_n ⊥ ū_n ≥ 0,   friction in the cone against ū_t,
//! ```
//!
//! then the segment with these forces, and the corrections that the integrator's error asks for.

use glam::{DMat3, DVec3};

use super::contacts::{Contacts, Each, Gaps, NONE, PAIRS, each, pairs};
use super::law::{Law, Solution};
use super::step::{Among, Segment};
use crate::floor::slips::STOPPED;
use crate::floor::sustained::{Supported, limit_energy};
use crate::force::ForceModel;
use crate::integrators::{IntegratorMemory, StepOutcome};
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// What a segment needs to know besides.
pub(super) struct Start<'a, F> {
    pub(super) among: &'a Among<'a, F>,
    pub(super) state: BodyState,
    /// Since the beginning of the step \[s\].
    pub(super) elapsed: f64,
    pub(super) memory: &'a IntegratorMemory,
    pub(super) gaps: &'a Gaps,
    /// The velocities of all pairs along their normals [m/s].
    pub(super) normal: [f64; PAIRS],
    /// The pairs that may be held: touching, with no velocity along the normal to speak of.
    pub(super) candidates: u64,
    /// Slower than this is not moving [m/s].
    pub(super) still_speed: f64,
    /// Bound of the acceleration that acts [m/s²].
    pub(super) acceleration: f64,
    /// Shortest segment \[s\] that is tried for the moment at which a slip vanishes.
    pub(super) shortest: f64,
}

impl<F: ForceModel> Start<'_, F> {
    /// The motion over `tau` \[s\], from the memory that `segment` holds.
    pub(super) fn advance(&self, tau: f64, segment: &mut Segment) {
        let (among, start) = (self.among, &self.state);
        let (body, settings, planes) = (among.world.body, among.world.settings, among.planes);
        let (middle, motion) = among.world.free_motion(start, 0.0, tau);
        let lever = crate::floor::geometry::levers(body, middle, 0xff);
        let contacts = Contacts::new(planes, body, middle, &lever, self.candidates);
        let d = contacts.slips(motion);
        let still = 1e-9 * contacts.largest(&d);
        let slips = |i: usize, w: &Each| contacts.along(i, w[i]).length() > still;
        let coefficient = |of: fn(&super::Plane) -> f64| {
            let mut friction = [0.0; PAIRS];
            for i in 0..contacts.count {
                friction[i] = of(&planes[usize::from(contacts.pair[i]) / 8]);
            }
            friction
        };
        let solve = |friction: [f64; PAIRS]| {
            let law = Law::new(&contacts, 0.5, friction, settings);
            let solution = law.solve(&d);
            let mean = law.velocities(&d, &solution.p);
            (solution, mean)
        };
        // Static friction holds where no corner slips, before or after.
        let holds = |(solution, mean): &(Solution, Each)| {
            let mut loaded =
                (0..contacts.count).filter(|&i| contacts.normal[i].dot(solution.p[i]) > 0.0);
            solution.converged && loaded.all(|i| !slips(i, mean))
        };
        let is_static = planes.iter().any(|p| p.surface.static_friction.is_some());
        let (solution, mean) = (is_static && !self.slips())
            .then(|| solve(coefficient(super::Plane::grip)))
            .filter(holds)
            .unwrap_or_else(|| solve(coefficient(|plane| plane.surface.friction)));
        segment.clear();
        segment.state = *start;
        segment.iterations = solution.iterations;
        segment.capped = !solution.converged;
        for i in 0..contacts.count {
            segment.impulse[usize::from(contacts.pair[i])] = solution.p[i];
        }
        let (v, omega) = contacts.twist(&solution.p);
        let twist = (motion.0 + 0.5 * v, motion.1 + 0.5 * omega);
        let at_rest = start.velocity == DVec3::ZERO && start.angular_momentum == DVec3::ZERO;
        let speed = twist.0.length() + twist.1.length() * body.radius();
        if at_rest && among.may_rest() && contacts.support() && speed <= still {
            segment.gaps = *self.gaps;
            segment.outcome = StepOutcome::plain(1);
            segment.still = true;
            return;
        }

        let (force, torque) = contacts.resultant(&solution.p);
        if among.world.is_uniform() && !among.method.errs_in_gravity {
            among.world.carry(&mut segment.state, tau, twist, v, torque);
            segment.outcome = StepOutcome::plain(1);
        } else {
            let rate = 1.0 / tau;
            let law = Supported {
                inner: among.world.force,
                acceleration: force * (rate * body.inverse_mass()),
                torque: torque * rate,
            };
            let (state, memory) = (&mut segment.state, &mut segment.memory);
            segment.outcome = (among.method.supported)(body, state, &law, tau, memory);
        }
        let held = pairs(|i| self.loaded(segment, i));
        let stuck = (0..contacts.count).filter(|&i| !slips(i, &mean));
        let stuck = stuck.fold(0, |set, i| set | 1 << contacts.pair[i]);
        self.settle(segment, held, stuck, tau);
    }

    /// Whether the contact of a pair pushes.
    fn loaded(&self, segment: &Segment, pair: usize) -> bool {
        let normal = || self.among.planes[pair / 8].shape.normal;
        segment.impulse[pair] != DVec3::ZERO && normal().dot(segment.impulse[pair]) > 0.0
    }

    /// Whether a corner that may be held slips.
    fn slips(&self) -> bool {
        let (state, body) = (&self.state, self.among.world.body);
        let attitude = DMat3::from_quat(state.rotation);
        let (planes, lever) = (self.among.planes, &self.gaps.lever);
        let contacts = Contacts::new(planes, body, attitude, lever, self.candidates);
        let u = contacts.slips((state.velocity, state.angular_velocity(body)));
        (0..contacts.count).any(|i| contacts.along(i, u[i]).length() > self.still_speed)
    }

    /// Projects the end of a segment onto what the held contacts allow; those in `stuck` have no mean slip.
    fn settle(&self, segment: &mut Segment, held: u64, stuck: u64, tau: f64) {
        let (among, body) = (self.among, self.among.world.body);
        let planes = among.planes;
        let end = self.elapsed + tau;
        segment.gaps = self.project_positions(&mut segment.state, held, end);
        if held == 0 {
            return;
        }
        let twist = |s: &BodyState| (s.velocity, s.angular_velocity(body));
        let at = |s: &BodyState, gaps: &Gaps| {
            let attitude = DMat3::from_quat(s.rotation);
            Contacts::new(planes, body, attitude, &gaps.lever, held)
        };
        let contacts = at(&segment.state, &segment.gaps);
        let after = contacts.slips(twist(&segment.state));
        let before = at(&self.state, self.gaps).slips(twist(&self.state));

        // Which contacts stick, and when the first slip vanishes.
        let mut whole = 0_u64;
        for i in 0..contacts.count {
            let pair = usize::from(contacts.pair[i]);
            let plane = &planes[pair / 8];
            let p = segment.impulse[pair];
            let limit = plane.surface.friction * contacts.normal[i].dot(p);
            let used = contacts.along(i, p).length();
            let sticks = plane.grip() > 0.0 && stuck >> pair & 1 == 1;
            let (slip_before, slip) = (contacts.along(i, before[i]), contacts.along(i, after[i]));
            let speed = slip_before.length();
            if speed > self.still_speed {
                let along = slip_before.dot(slip) / speed;
                if sticks {
                    whole |= 1 << i; // where it ends if no better moment is found
                    // Unless it stops within no distance to speak of.
                    if speed * tau > 1e-9 * body.radius() {
                        segment.slips.sticks(pair, used / limit);
                    }
                } else {
                    segment.slips.slides(pair, slip, along, speed);
                }
                // Friction does not turn a slip round: one that changed its way in no time has stopped.
                let reversed = tau <= self.shortest && segment.slips.reversed(pair);
                if reversed || slip.length() <= STOPPED * speed {
                    whole |= 1 << i;
                }
            } else if sticks {
                whole |= 1 << i;
            }
        }
        let correction = contacts.cancel(&after, whole);
        contacts.apply(&mut segment.state, &correction);
        for i in 0..contacts.count {
            segment.impulse[usize::from(contacts.pair[i])] += correction[i];
        }
        let speed = segment.state.velocity.length()
            + segment.state.body_angular_velocity(body).length() * body.radius();
        if among.may_rest() && contacts.support() && speed <= 1e-11 * self.acceleration * tau {
            segment.state.velocity = DVec3::ZERO;
            segment.state.angular_momentum = DVec3::ZERO;
        }
    }

    /// Moves and turns the body so that the corners of the pairs `held` lie on their planes: Newton's method on their
    /// heights.
    fn project_positions(&self, state: &mut BodyState, held: u64, elapsed: f64) -> Gaps {
        let (planes, body) = (self.among.planes, self.among.world.body);
        let mut gaps = Gaps::at(planes, body, state, elapsed);
        let scale = body.radius() + state.position.abs().max_element();
        for _ in 0..3 {
            let worst = each(held).fold(0.0, |a: f64, i| a.max(gaps.gap[i].abs()));
            if worst <= 4.0 * f64::EPSILON * scale {
                break;
            }
            let attitude = DMat3::from_quat(state.rotation);
            let contacts = Contacts::new(planes, body, attitude, &gaps.lever, held);
            let mut gap = NONE;
            for i in 0..contacts.count {
                gap[i] = contacts.normal[i] * gaps.gap[usize::from(contacts.pair[i])];
            }
            let (shift, turn) = contacts.twist(&contacts.cancel(&gap, 0));
            state.position += shift;
            if turn != DVec3::ZERO {
                // World turn: q ← exp(turn)∘q. The angular momentum keeps its body components.
                state.rotation = compose(exponential_map(turn), state.rotation);
                state.renormalize();
            }
            gaps = Gaps::at(planes, body, state, elapsed);
        }
        gaps
    }

    /// The end of an accepted segment, as at the floor: out of the planes, and without energy that its errors added.
    pub(super) fn finish(&self, segment: &mut Segment, tau: f64) {
        let among = self.among;
        let end = self.elapsed + tau;
        let state = &mut segment.state;
        segment.gaps.recover(among.planes, state, end);
        if among.bounds_energy() {
            let pull = among.world.force.acceleration();
            segment.repaired = limit_energy(among.world.body, &self.state, state, pull);
            if state.position == self.state.position {
                segment.gaps = *self.gaps; // it may have been put back to where it was
            }
        }
    }
}
