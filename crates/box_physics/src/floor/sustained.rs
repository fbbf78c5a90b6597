//! Sustained contact: the floor's force acts *during* a segment of the step, as a force, so that sliding
//! and pivoting keep second order whatever the integrator.
//!
//! The contact force is constant over the segment and is found from the **mean** motion of the corners,
//! in the attitude at its middle. With d_k the mean velocity of corner k without contact (displacement
//! over time by the midpoint formula, under a wrench or drag by `impulse_step`, so that the force does not depend on
//! the integrator),
//!
//! ```text
//! ū_k = d_k + ½ W p,   0 ≤ p_n ⊥ ū_n ≥ 0,   friction in the cone against ū_t,
//! ```
//!
//! since a constant force p/τ moves a body by half of what the impulse p at the start would. The
//! same W on both sides makes the contact's work Σ p·ū ≤ 0 (θ = ½ of Moreau–Jean: Acary, Brogliato 2008,
//! §10). The integrator then makes the segment with that force, and what its own error leaves is projected
//! away: positions of the held corners onto the floor, velocities onto what the contact allows (as
//! RATTLE does, Andersen 1983).

use glam::{DMat3, DQuat, DVec3};

use super::FloorContext;
use super::cone::{Cone, ConeSolution};
use super::frame::Method;
use super::geometry::{Corner3, Corners, DelassusOperator, has, levers, mask, spans_face};
use super::projection::{HeldNormals, cancel, project_positions, recover_penetration};
use super::slips::{STOPPED, Slips};
use crate::body::RigidBox;
use crate::force::{Damping, Dissipation, ForceModel, Wrench};
use crate::integrators::{IntegratorMemory, StepOutcome, impulse_step};
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// The force model plus the floor's constant force and torque, world axes.
pub(super) struct Supported<'a, F> {
    pub(super) inner: &'a F,
    /// Contact force over mass [m/s²].
    pub(super) acceleration: DVec3,
    /// Contact torque about the center \[N m\], world axes.
    pub(super) torque: DVec3,
}

impl<F: ForceModel> Supported<'_, F> {
    fn torque_in_body(&self, state: &BodyState) -> Wrench {
        Wrench {
            force: DVec3::ZERO,
            torque: state.rotation.inverse() * self.torque,
        }
    }
}

impl<F: ForceModel> ForceModel for Supported<'_, F> {
    fn acceleration(&self) -> DVec3 {
        self.inner.acceleration() + self.acceleration
    }

    fn dissipation(&self) -> Dissipation {
        self.inner.dissipation()
    }

    fn has_wrench(&self) -> bool {
        self.inner.has_wrench() || self.torque != DVec3::ZERO
    }

    fn wrench(&self, body: &RigidBox, state: &BodyState) -> Wrench {
        let mut total = self.torque_in_body(state);
        if self.inner.has_wrench() {
            total += self.inner.wrench(body, state);
        }
        total
    }

    fn elastic_wrench(&self, body: &RigidBox, state: &BodyState) -> Wrench {
        let mut total = self.torque_in_body(state);
        if self.inner.has_wrench() {
            total += self.inner.elastic_wrench(body, state);
        }
        total
    }

    fn damping(&self) -> Damping {
        self.inner.damping()
    }
}

/// What a segment needs to know besides the floor and the body.
pub(super) struct Start<'a, F> {
    pub(super) context: &'a FloorContext<'a, F>,
    pub(super) method: &'a Method<F>,
    pub(super) state: BodyState,
    /// Since the beginning of the step \[s\].
    pub(super) elapsed: f64,
    pub(super) memory: &'a IntegratorMemory,
    pub(super) corners: &'a Corners,
    /// The corners' velocities upwards [m/s].
    pub(super) normal: [f64; 8],
    /// The corners that may be held: touching, with no normal velocity to speak of.
    pub(super) candidates: u8,
    /// Slower than this is not moving [m/s].
    pub(super) still_speed: f64,
    /// Bound of the acceleration that acts [m/s²].
    pub(super) acceleration: f64,
    /// Shortest segment \[s\] that is tried for the moment at which a slip vanishes.
    pub(super) shortest: f64,
}

/// A segment of sustained motion.
pub(super) struct Segment {
    pub(super) state: BodyState,
    pub(super) memory: IntegratorMemory,
    pub(super) corners: Corners,
    /// Impulses over the segment, by corner index \[N s\].
    pub(super) impulse: Corner3,
    pub(super) slips: Slips,
    /// The box is at rest on a face: the state equals that at the start.
    pub(super) still: bool,
    pub(super) outcome: StepOutcome,
    pub(super) iterations: u32,
    pub(super) capped: bool,
    /// Energy taken because the errors of integrator and projection had added it \[J\].
    pub(super) repaired: Option<f64>,
}

impl Segment {
    /// Yet to be made, with this memory to write to.
    pub(super) fn new(memory: IntegratorMemory) -> Self {
        Self {
            state: BodyState::default(),
            memory,
            corners: Corners::default(),
            impulse: [DVec3::ZERO; 8],
            slips: Slips::NONE,
            still: false,
            outcome: StepOutcome::default(),
            iterations: 0,
            capped: false,
            repaired: None,
        }
    }

    /// Forgets what was reported of it.
    pub(super) fn clear(&mut self) {
        self.impulse = [DVec3::ZERO; 8];
        self.slips = Slips::NONE;
        self.still = false;
        self.iterations = 0;
        self.capped = false;
        self.repaired = None;
    }
}

impl<F: ForceModel> Start<'_, F> {
    /// The motion over `tau` \[s\], from the memory that `segment` holds.
    pub(super) fn advance(&self, tau: f64, segment: &mut Segment) {
        let &FloorContext {
            floor,
            settings,
            body,
            ..
        } = self.context;
        let start = &self.state;
        let (middle, motion) = self.context.free_motion(start, self.elapsed, tau);
        let levers = levers(body, middle, self.candidates);
        let operator = DelassusOperator::new(body, middle, &levers, self.candidates);

        let d = operator.velocities(motion);
        let rate = 1.0 / tau;
        let still = 1e-9 * operator.largest(&d);
        let slips = |w: DVec3| w.x.abs().max(w.z.abs()) > still;
        let solve = |friction| {
            let cone = Cone::new(&operator, friction, settings);
            let mut solution = cone.solve(&d, &[DVec3::ZERO; 8]);
            let mean = cone.velocities(&d, &solution.p);
            // What was found is ½ p.
            solution.p.iter_mut().for_each(|p| *p *= 2.0);
            (solution, mean)
        };
        // Static friction holds where no corner slips, before or after.
        let holds = |(solution, mean): &(ConeSolution, Corner3)| {
            let mut corners = (0..operator.count).filter(|&i| solution.p[i].y > 0.0);
            solution.converged && corners.all(|i| !slips(mean[i]))
        };
        let held = floor.static_friction.filter(|_| !self.slips());
        let (solution, mean) = held
            .map(solve)
            .filter(holds)
            .unwrap_or_else(|| solve(floor.friction));
        segment.clear();
        segment.state = *start;
        segment.iterations = solution.iterations;
        segment.capped = !solution.converged;
        for i in 0..operator.count {
            segment.impulse[usize::from(operator.corner[i])] = solution.p[i];
        }
        let at_rest = start.velocity == DVec3::ZERO && start.angular_momentum == DVec3::ZERO;
        if at_rest && spans_face(self.candidates) && operator.largest(&mean) <= still {
            segment.corners = *self.corners;
            segment.outcome = StepOutcome::plain(1);
            segment.still = true;
            return;
        }

        let (force, torque) = operator.resultant(&solution.p);
        if self.context.is_uniform() && !self.method.errs_in_gravity {
            let (v, omega) = operator.twist(&solution.p);
            let twist = (motion.0 + 0.5 * v, motion.1 + 0.5 * omega);
            self.context
                .carry(&mut segment.state, tau, twist, v, torque);
            segment.outcome = StepOutcome::plain(1);
        } else {
            let law = Supported {
                inner: self.context.force,
                acceleration: force * (rate * body.inverse_mass()),
                torque: torque * rate,
            };
            let (state, memory) = (&mut segment.state, &mut segment.memory);
            segment.outcome = self.context.in_world(state, self.elapsed, tau, |state| {
                (self.method.supported)(body, state, &law, tau, memory)
            });
        }

        let held = mask(|k| segment.impulse[k].y > 0.0);
        if held != 0 {
            let sticking = (0..operator.count).filter(|&i| !slips(mean[i]));
            let stuck = sticking.fold(0, |m, i| m | 1 << operator.corner[i]);
            self.settle(segment, held, stuck, tau);
        } else {
            segment.corners = Corners::at(floor, body, &segment.state);
        }
    }

    /// Whether a corner that may be held slips.
    fn slips(&self) -> bool {
        let state = &self.state;
        let omega = state.angular_velocity(self.context.body);
        (0..8).any(|k| {
            let u = state.velocity + omega.cross(self.corners.lever[k]);
            has(self.candidates, k) && u.with_y(0.0).length() > self.still_speed
        })
    }

    /// Projects the end of a segment onto what the held corners allow; those in `stuck` have no mean slip.
    fn settle(&self, segment: &mut Segment, held: u8, stuck: u8, tau: f64) {
        let (floor, body) = (self.context.floor, self.context.body);
        let twist = |s: &BodyState| (s.velocity, s.angular_velocity(body));
        let mut normals = HeldNormals::new(body, held);
        segment.corners = project_positions(floor, body, &mut segment.state, held, &mut normals);
        let (velocity_after, omega_after) = twist(&segment.state);
        let (velocity, omega) = twist(&self.state);

        // Which corners stick, and when the first slip vanishes.
        let grip = floor.static_friction.unwrap_or(floor.friction);
        let (mut components, mut after) = ([DVec3::Y; 8], [DVec3::ZERO; 8]);
        for i in 0..held.count_ones() as usize {
            let k = usize::from(normals.corner[i]);
            after[i] = velocity_after + omega_after.cross(segment.corners.lever[k]);
            let p = segment.impulse[k];
            let limit = floor.friction * p.y;
            let used = (p.x * p.x + p.z * p.z).sqrt();
            let sticks = grip > 0.0 && has(stuck, k);
            let slip_before = (velocity + omega.cross(self.corners.lever[k])).with_y(0.0);
            let slip = after[i].with_y(0.0);
            let speed = slip_before.length();
            if speed > self.still_speed {
                let along = slip_before.dot(slip) / speed;
                if sticks {
                    components[i] = DVec3::ONE; // where it ends if no better moment is found
                    // Unless it stops within no distance to speak of.
                    if speed * tau > 1e-9 * body.radius() {
                        segment.slips.sticks(k, used / limit);
                    }
                } else {
                    segment.slips.slides(k, slip, along, speed);
                }
                // Friction does not turn a slip round: one that changed its way in no time has stopped.
                let reversed = tau <= self.shortest && segment.slips.reversed(k);
                if reversed || slip.length() <= STOPPED * speed {
                    components[i] = DVec3::ONE;
                }
            } else if sticks {
                components[i] = DVec3::ONE;
            }
        }
        let sliding = components == [DVec3::Y; 8];
        let stopped = sliding.then(|| normals.stop(body, &after.map(|u| u.y)));
        if let Some((p, sum, torque)) = stopped.flatten() {
            segment.state.velocity.y += sum * body.inverse_mass();
            segment.state.angular_momentum += torque;
            for i in 0..held.count_ones() as usize {
                segment.impulse[usize::from(normals.corner[i])].y += p[i];
            }
        } else {
            let attitude = DMat3::from_quat(segment.state.rotation);
            let operator = DelassusOperator::new(body, attitude, &segment.corners.lever, held);
            let correction = cancel(&operator, &after, &components);
            operator.apply(body, &mut segment.state, &correction);
            for i in 0..operator.count {
                segment.impulse[usize::from(operator.corner[i])] += correction[i];
            }
        }
        let speed = |s: &BodyState| {
            s.velocity.length() + s.body_angular_velocity(body).length() * body.radius()
        };
        if spans_face(held) && speed(&segment.state) <= 1e-11 * self.acceleration * tau {
            segment.state.velocity = DVec3::ZERO;
            segment.state.angular_momentum = DVec3::ZERO;
        }
    }

    /// The end of an accepted segment: a corner that was let go and yet ended below the floor (by the error
    /// of a segment) is lifted out. A contact only takes energy: what the errors of integrator and projection
    /// have added is taken from the speed. That counts kinetic energy and that of the uniform
    /// acceleration; under a wrench or in wind, whose work is not known, it is not applied.
    pub(super) fn finish(&self, segment: &mut Segment) {
        let context = self.context;
        recover_penetration(context.floor, &mut segment.state, &mut segment.corners);
        if context.bounds_energy() {
            let pull = context.force.acceleration();
            let height = segment.state.position.y;
            segment.repaired = limit_energy(context.body, &self.state, &mut segment.state, pull);
            if segment.state.position.y != height {
                segment.corners = *self.corners; // it was put back to where it was
            }
        }
    }
}

impl<F: ForceModel> FloorContext<'_, F> {
    /// Whether nothing but a uniform acceleration acts besides the floor.
    pub(super) fn is_uniform(&self) -> bool {
        !self.force.has_wrench() && !self.force.has_dissipation()
    }

    /// Moves `state` by the mean velocities (v̄, ω̄) in the sense of [`FloorContext::free_motion`], with the contact's changes of
    /// the velocity and of the angular momentum (world axes): the midpoint rule, of which the turn has the sine τω̄/2.
    pub(super) fn carry(
        &self,
        state: &mut BodyState,
        tau: f64,
        mean: (DVec3, DVec3),
        velocity: DVec3,
        torque: DVec3,
    ) {
        let momentum = state.rotation * state.angular_momentum + torque;
        let mut sine = 0.5 * tau * mean.1;
        let square = sine.length_squared();
        if square > 1.0 {
            sine /= square.sqrt(); // the rule knows no larger turn than π
        }
        let cosine = (1.0 - square).max(0.0).sqrt();
        let turn = DQuat::from_xyzw(sine.x, sine.y, sine.z, cosine);
        state.position += tau * mean.0;
        state.velocity += tau * self.force.acceleration() + velocity;
        state.rotation = compose(turn, state.rotation);
        state.renormalize();
        state.angular_momentum = state.rotation.inverse() * momentum;
    }

    /// The motion over `tau` \[s\] without contact: the attitude halfway, and the mean velocities of the center and of
    /// turning there, such that a corner moves by τ(v̄ + ω̄ × r): from velocities where that is as good as it gets, since
    /// displacements over a short time, or far from the origin, are mostly rounding.
    /// `start` is in the frame of the floor `elapsed` \[s\] after the two coincided.
    pub(super) fn free_motion(
        &self,
        start: &BodyState,
        elapsed: f64,
        tau: f64,
    ) -> (DMat3, (DVec3, DVec3)) {
        let (body, force) = (self.body, self.force);
        if self.is_uniform() {
            // The midpoint formula, from dL/dt = L × ω; the chord of a turn by 2θ is shorter than it by sin θ/θ.
            let l = start.angular_momentum;
            let first = l * body.inverse_inertia();
            let omega = (l + (0.5 * tau) * l.cross(first)) * body.inverse_inertia();
            let half = exponential_map((0.25 * tau) * (first + omega));
            let middle = DMat3::from_quat(compose(start.rotation, half));
            let square = 0.25 * tau * tau * omega.length_squared();
            let chord = 1.0 - square / 6.0 * (1.0 - square / 20.0);
            let center = start.velocity + 0.5 * tau * force.acceleration();
            return (middle, (center, middle * (omega * chord)));
        }
        let mut free = *start;
        self.to_world(&mut free, elapsed);
        if force.dissipation() == Dissipation::NONE {
            impulse_step(body, &mut free, force, tau);
        } else {
            // The air resists what moves already. What the floor is going to prevent it does not resist.
            let pull = force.acceleration();
            let law = Supported {
                inner: force,
                acceleration: -pull,
                torque: DVec3::ZERO,
            };
            impulse_step(body, &mut free, &law, tau);
            free.velocity += pull * tau;
            free.position += pull * (0.5 * tau * tau);
        }
        self.to_floor(&mut free, elapsed + tau);
        let rate = 1.0 / tau;
        let mut center = 0.5 * (start.velocity + free.velocity);
        let path = (free.position - start.position) * rate;
        if (path - center).length() > 1e-6 * (free.velocity - start.velocity).length() {
            center = path;
        }
        let mut omega = 0.5 * (start.angular_velocity(body) + free.angular_velocity(body));
        if omega.length() * tau >= 0.01 {
            let turn = compose(free.rotation, start.rotation.inverse());
            omega = turn.xyz() * (2.0 * rate * turn.w.signum());
        }
        (middle_attitude(start, &free), (center, omega))
    }
}

/// Scales the velocities of `state` so that its energy does not exceed that of `start`; what that took \[J\], if
/// it was more than rounding.
pub(super) fn limit_energy(
    body: &RigidBox,
    start: &BodyState,
    state: &mut BodyState,
    acceleration: DVec3,
) -> Option<f64> {
    let fall = body.mass() * acceleration.dot(state.position - start.position);
    // Positions are rounded, and the height's last bit is worth this much: it must not stop a box that
    // has just begun to fall off its edge.
    let size = start.position.abs() + DVec3::splat(body.radius());
    let rounding = 4.0 * f64::EPSILON * body.mass() * acceleration.abs().dot(size);
    let allowed = start.kinetic_energy(body) + fall + rounding;
    let kinetic = state.kinetic_energy(body);
    if kinetic <= allowed * (1.0 + 1e-14) {
        return None;
    }
    if allowed < 0.0 {
        // Not even at rest may it be where it is: it stays where it was.
        *state = BodyState {
            velocity: DVec3::ZERO,
            angular_momentum: DVec3::ZERO,
            ..*start
        };
        return Some(kinetic);
    }
    let scale = (allowed / kinetic).sqrt();
    state.velocity *= scale;
    state.angular_momentum *= scale;
    (scale < 1.0 - 1e-9).then_some(kinetic - allowed)
}

/// The attitude halfway between two states.
fn middle_attitude(start: &BodyState, end: &BodyState) -> DMat3 {
    let aligned = if start.rotation.dot(end.rotation) < 0.0 {
        -end.rotation
    } else {
        end.rotation
    };
    let sum: DQuat = start.rotation + aligned;
    DMat3::from_quat(BodyState::at_pose(start.position, sum).rotation)
}

/// Longest segment over which the sustained law is trusted \[s\]: a quarter of a radian of turning, and so
/// short that the acceleration from rest turns the box as little.
pub(super) fn longest_segment(body: &RigidBox, state: &BodyState, acceleration: f64) -> f64 {
    let omega = state.body_angular_velocity(body).length();
    let turning = if omega > 0.0 {
        0.25 / omega
    } else {
        f64::INFINITY
    };
    let falling = if acceleration > 0.0 {
        0.35 * (body.radius() / acceleration).sqrt()
    } else {
        f64::INFINITY
    };
    turning.min(falling)
}

/// The corners a segment holds or may hold.
pub(super) fn candidates(touching: u8, normal: &[f64; 8], hold_speed: f64) -> u8 {
    mask(|k| has(touching, k) && normal[k] <= hold_speed)
}
