//! The motion of a segment with and without the contact force, and its energy limit.

use glam::{DMat3, DQuat, DVec3};

use super::frame::Level;
use crate::body::RigidBox;
use crate::force::{Damping, Dissipation, ForceModel, Wrench};
use crate::integrators::impulse_step;
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// The force model plus a constant contact force and torque, world axes.
pub(super) struct Supported<'a, F> {
    pub(super) inner: &'a F,
    /// Contact force over mass [m/s²].
    pub(super) acceleration: DVec3,
    /// Contact torque about the center \[N m\], world axes.
    pub(super) torque: DVec3,
}

impl<F: ForceModel> Supported<'_, F> {
    /// Adds the contact torque to the inner wrench.
    fn add(&self, state: &BodyState, inner: impl FnOnce() -> Wrench) -> Wrench {
        let mut total = Wrench {
            force: DVec3::ZERO,
            torque: state.rotation.inverse() * self.torque,
        };
        if self.inner.has_wrench() {
            total += inner();
        }
        total
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
        self.add(state, || self.inner.wrench(body, state))
    }

    fn elastic_wrench(&self, body: &RigidBox, state: &BodyState) -> Wrench {
        self.add(state, || self.inner.elastic_wrench(body, state))
    }

    fn damping(&self) -> Damping {
        self.inner.damping()
    }
}

impl<F: ForceModel> Level<'_, F> {
    /// Returns `true` if only a uniform acceleration acts besides contact.
    pub(super) fn is_uniform(&self) -> bool {
        !self.context.force.has_wrench() && !self.context.force.has_dissipation()
    }

    /// Moves `state` by the mean velocities (v̄, ω̄) of [`Level::free_motion`], with the contact's changes of velocity
    /// and angular momentum (world axes). The midpoint rule gives the sine τω̄/2 of the half turn.
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
            sine /= square.sqrt(); // the rule has no turn larger than π
        }
        let cosine = (1.0 - square).max(0.0).sqrt();
        let turn = DQuat::from_xyzw(sine.x, sine.y, sine.z, cosine);
        state.position += tau * mean.0;
        state.velocity += tau * self.pull + velocity;
        state.rotation = compose(turn, state.rotation);
        state.renormalize();
        state.angular_momentum = state.rotation.inverse() * momentum;
    }

    /// The motion over `tau` \[s\] without contact: the attitude halfway, and the mean velocities there. A corner moves
    /// by τ(v̄ + ω̄ × r). The means use velocities if these suffice, because displacements are mostly rounding over a
    /// short time or far from the origin. `start` is `elapsed` \[s\] after the start of the step.
    pub(super) fn free_motion(
        &self,
        start: &BodyState,
        elapsed: f64,
        tau: f64,
    ) -> (DMat3, (DVec3, DVec3)) {
        let (body, force) = (self.context.body, self.context.force);
        if self.is_uniform() {
            // The midpoint formula, from dL/dt = L × ω; the chord of a turn by 2θ is shorter than it by sin θ/θ.
            let l = start.angular_momentum;
            let first = l * body.inverse_inertia();
            let omega = (l + (0.5 * tau) * l.cross(first)) * body.inverse_inertia();
            let half = exponential_map((0.25 * tau) * (first + omega));
            let middle = DMat3::from_quat(compose(start.rotation, half));
            let square = 0.25 * tau * tau * omega.length_squared();
            let chord = 1.0 - square / 6.0 * (1.0 - square / 20.0);
            let center = start.velocity + 0.5 * tau * self.pull;
            return (middle, (center, middle * (omega * chord)));
        }
        let mut free = *start;
        self.frame.to_world(&mut free, elapsed);
        if force.dissipation() == Dissipation::NONE {
            impulse_step(body, &mut free, force, tau);
        } else {
            // Drag acts on the present motion, not on motion that the floor will prevent.
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
        self.frame.to_surface(&mut free, elapsed + tau);
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

/// Scales the velocities of `state` so that its energy does not exceed that of `start`. Returns the removed energy
/// \[J\] if it is more than rounding.
pub(super) fn limit_energy(
    body: &RigidBox,
    start: &BodyState,
    state: &mut BodyState,
    acceleration: DVec3,
) -> Option<f64> {
    let fall = body.mass() * acceleration.dot(state.position - start.position);
    // Energy of the last bit of a height. Without it, a box that begins to tip over an edge would stop.
    let size = start.position.abs() + DVec3::splat(body.radius());
    let rounding = 4.0 * f64::EPSILON * body.mass() * acceleration.abs().dot(size);
    let allowed = start.kinetic_energy(body) + fall + rounding;
    let kinetic = state.kinetic_energy(body);
    if kinetic <= allowed * (1.0 + 1e-14) {
        return None;
    }
    if allowed < 0.0 {
        // The potential energy alone is too large: resets the pose.
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

/// The mean attitude of two states.
fn middle_attitude(start: &BodyState, end: &BodyState) -> DMat3 {
    let opposite = start.rotation.dot(end.rotation) < 0.0;
    let aligned = end.rotation * if opposite { -1.0 } else { 1.0 };
    let sum: DQuat = start.rotation + aligned;
    DMat3::from_quat(BodyState::at_pose(start.position, sum).rotation)
}

/// Longest segment over which the sustained-contact model is accurate \[s\]: a quarter of a radian of turning, also for
/// the acceleration from rest.
pub(super) fn longest_segment(body: &RigidBox, state: &BodyState, acceleration: f64) -> f64 {
    let omega = state.body_angular_velocity(body).length();
    (0.25 / omega).min(0.35 * (body.radius() / acceleration).sqrt())
}
