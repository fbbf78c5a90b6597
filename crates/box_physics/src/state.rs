//! Motion state of a body: position, attitude, velocity and angular momentum.

#[cfg(feature = "bevy")]
use crate::ecs::*;
use glam::{DQuat, DVec3};

use crate::body::RigidBox;
use crate::rotation::{compose, renormalize};

/// The state that the integrators advance, in f64.
///
/// The stored rotational quantity is the angular momentum in body axes, because every integrator is formulated in it.
/// Converting to the angular velocity and back in each step would bias the energy, since the product I·(1/I) is not
/// exactly 1. The angular velocity has an accessor and a setter, in world axes.
///
/// You may write to the state at any time. Change detection wakes a sleeping box, so do not bypass it. The
/// physics itself does not mark a state as changed when it moves a body; use `Changed<Transform>` for that.
///
/// ```
/// use box_physics::prelude::*;
/// let body = RigidBox::cube(1.0, 6.0)?;
/// let state = BodyState::at(DVec3::new(0.0, 5.0, 0.0))
///     .with_velocity(DVec3::X)
///     .with_angular_velocity(&body, DVec3::new(0.0, 0.0, 2.0));
/// assert_eq!(state.angular_momentum_world(), DVec3::new(0.0, 0.0, 2.0)); // I = 1 kg m²
/// assert_eq!(state.kinetic_energy(&body), 0.5 * 6.0 + 0.5 * 4.0);
/// # Ok::<(), InvalidValue>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Clone, PartialEq)
)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyState {
    /// Center of mass in the world \[m\].
    pub position: DVec3,
    /// Attitude: rotates body vectors into world vectors. A unit quaternion.
    pub rotation: DQuat,
    /// Velocity of the center of mass, world axes [m/s].
    pub velocity: DVec3,
    /// Angular momentum about the center of mass, **body** axes [kg m²/s].
    pub angular_momentum: DVec3,
}

/// The axes in which a vector is constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "bevy",
    derive(Reflect, VariantDefaults),
    reflect(Default, Clone, PartialEq)
)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Frame {
    /// World axes: wind, a magnetic field.
    #[default]
    World,
    /// Body axes: a thruster.
    Body,
}

impl Default for BodyState {
    fn default() -> Self {
        Self::at(DVec3::ZERO)
    }
}

impl BodyState {
    /// A body at rest at `position` \[m\], with its axes along the world's.
    pub fn at(position: impl Into<DVec3>) -> Self {
        Self {
            position: position.into(),
            rotation: DQuat::IDENTITY,
            velocity: DVec3::ZERO,
            angular_momentum: DVec3::ZERO,
        }
    }

    /// A body at rest at `position` \[m\] with attitude `rotation`.
    ///
    /// The quaternion is normalized here in f64. A zero or non-finite quaternion is kept unchanged, and the plugin
    /// quarantines the body.
    ///
    /// There is no `with_rotation`: the setters of the angular velocity depend on the attitude, so it comes first. Use
    /// [`turn_to`](Self::turn_to) to turn a spinning body.
    pub fn at_pose(position: impl Into<DVec3>, rotation: DQuat) -> Self {
        let norm = rotation.length();
        Self {
            rotation: if norm > 0.0 && norm.is_finite() {
                rotation / norm
            } else {
                rotation
            },
            ..Self::at(position)
        }
    }

    /// Turns the body to attitude `rotation`, normalized as by [`at_pose`](Self::at_pose). The angular
    /// velocity keeps its components in the frame `spin`: [`Frame::World`] keeps the world spin axis,
    /// [`Frame::Body`] keeps the body spin axis.
    ///
    /// ```
    /// use box_physics::prelude::*;
    /// let brick = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0)?;
    /// let spinning = BodyState::at(DVec3::Y).with_angular_velocity(&brick, DVec3::X);
    /// let quarter = DQuat::from_xyzw(0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()); // 90° about z
    /// let mut state = spinning;
    /// state.turn_to(&brick, quarter, Frame::World);
    /// assert!((state.angular_velocity(&brick) - DVec3::X).length() < 1e-15);
    /// let mut state = spinning;
    /// state.turn_to(&brick, quarter, Frame::Body);
    /// assert!((state.angular_velocity(&brick) - DVec3::Y).length() < 1e-15);
    /// # Ok::<(), InvalidValue>(())
    /// ```
    pub fn turn_to(&mut self, body: &RigidBox, rotation: DQuat, spin: Frame) {
        let world = self.angular_velocity(body);
        self.rotation = Self::at_pose(self.position, rotation).rotation;
        if spin == Frame::World && self.angular_momentum != DVec3::ZERO {
            self.set_angular_velocity(body, world);
        }
    }

    /// Sets the velocity [m/s], world axes.
    #[must_use]
    pub fn with_velocity(mut self, velocity: impl Into<DVec3>) -> Self {
        self.velocity = velocity.into();
        self
    }

    /// Sets the angular velocity [rad/s], **world** axes.
    #[must_use]
    pub fn with_angular_velocity(mut self, body: &RigidBox, world: impl Into<DVec3>) -> Self {
        self.set_angular_velocity(body, world.into());
        self
    }

    /// Sets the angular velocity [rad/s], **body** axes.
    #[must_use]
    pub fn with_body_angular_velocity(mut self, body: &RigidBox, local: impl Into<DVec3>) -> Self {
        self.angular_momentum = body.inertia() * local.into();
        self
    }

    /// Angular velocity in world axes [rad/s].
    pub fn angular_velocity(&self, body: &RigidBox) -> DVec3 {
        self.rotation * self.body_angular_velocity(body)
    }

    /// Angular velocity in body axes [rad/s].
    #[inline(always)]
    pub fn body_angular_velocity(&self, body: &RigidBox) -> DVec3 {
        body.inverse_inertia() * self.angular_momentum
    }

    /// Sets the angular velocity [rad/s], **world** axes.
    pub fn set_angular_velocity(&mut self, body: &RigidBox, world: DVec3) {
        self.angular_momentum = body.inertia() * (self.rotation.inverse() * world);
    }

    /// Linear momentum [kg m/s].
    pub fn momentum(&self, body: &RigidBox) -> DVec3 {
        body.mass() * self.velocity
    }

    /// Angular momentum about the center of mass in world axes [kg m²/s].
    pub fn angular_momentum_world(&self) -> DVec3 {
        self.rotation * self.angular_momentum
    }

    /// Translational kinetic energy ½ m v² \[J\].
    pub fn translational_energy(&self, body: &RigidBox) -> f64 {
        0.5 * body.mass() * self.velocity.length_squared()
    }

    /// Rotational kinetic energy ½ L·ω \[J\].
    pub fn rotational_energy(&self, body: &RigidBox) -> f64 {
        0.5 * self.angular_momentum.dot(self.body_angular_velocity(body))
    }

    /// Total kinetic energy \[J\].
    pub fn kinetic_energy(&self, body: &RigidBox) -> f64 {
        self.translational_energy(body) + self.rotational_energy(body)
    }

    /// World position of a point given in body axes from the center \[m\].
    #[inline(always)]
    pub fn point(&self, body_point: DVec3) -> DVec3 {
        self.position + self.rotation * body_point
    }

    /// World velocity of a material point given in body axes from the center [m/s].
    pub fn point_velocity(&self, body: &RigidBox, body_point: DVec3) -> DVec3 {
        self.velocity + self.rotation * self.body_angular_velocity(body).cross(body_point)
    }

    /// Applies `impulse` \[N s\] (world axes) at the world point `at` \[m\]: Δv = J/m, ΔL_world = (p − x) × J.
    pub fn apply_impulse(&mut self, body: &RigidBox, impulse: DVec3, at: DVec3) {
        self.velocity += impulse * body.inverse_mass();
        let moment = (at - self.position).cross(impulse);
        self.angular_momentum += self.rotation.inverse() * moment;
    }

    /// Applies `impulse` \[N s\] (world axes) at a point given in body axes from the center \[m\].
    pub fn apply_impulse_at_body_point(
        &mut self,
        body: &RigidBox,
        impulse: DVec3,
        body_point: DVec3,
    ) {
        self.velocity += impulse * body.inverse_mass();
        self.angular_momentum += body_point.cross(self.rotation.inverse() * impulse);
    }

    /// Applies an angular impulse \[N m s\], world axes.
    pub fn apply_angular_impulse(&mut self, moment: DVec3) {
        self.angular_momentum += self.rotation.inverse() * moment;
    }

    /// Returns `true` if every number is finite.
    pub fn is_finite(&self) -> bool {
        self.position.is_finite()
            && self.rotation.is_finite()
            && self.velocity.is_finite()
            && self.angular_momentum.is_finite()
    }

    /// Returns `true` if the state can be stepped and displayed.
    ///
    /// Position, velocity and angular momentum must be within 1e38 in their units: the largest f32 is 3.4e38, and
    /// products of the values must not overflow. The squared norm of the attitude must be within 1e-3 of 1.
    #[inline(always)]
    pub fn is_valid(&self) -> bool {
        (self.rotation.length_squared() - 1.0).abs() < 1e-3
            && [self.position, self.velocity, self.angular_momentum]
                .into_iter()
                .all(|v| v.abs().cmple(DVec3::splat(1e38)).all())
    }

    /// The 13 numbers of the state: position, attitude (x, y, z, w), velocity, angular momentum.
    pub fn to_array(&self) -> [f64; 13] {
        let (x, q) = (self.position, self.rotation);
        let (v, l) = (self.velocity, self.angular_momentum);
        [
            x.x, x.y, x.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, l.x, l.y, l.z,
        ]
    }

    /// The body axis that is closest to a world direction, as one of the six unit vectors in body axes. For the
    /// direction up it is the normal of a die's upper face.
    ///
    /// ```
    /// use box_physics::prelude::*;
    /// let quarter = DQuat::from_xyzw(0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()); // 90° about z
    /// let die = BodyState::at_pose(DVec3::ZERO, quarter);
    /// assert_eq!(die.axis_towards(DVec3::Y), DVec3::X);
    /// let faces = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_Z, DVec3::NEG_Y, DVec3::NEG_X];
    /// let pips = faces.iter().position(|&face| face == die.axis_towards(DVec3::Y)); // 0 to 5
    /// assert_eq!(pips, Some(0));
    /// ```
    pub fn axis_towards(&self, direction: impl Into<DVec3>) -> DVec3 {
        let local = self.rotation.inverse() * direction.into();
        let opposite = [DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
        let axes = DVec3::AXES.into_iter().chain(opposite);
        let closer = |a: DVec3, b: DVec3| if b.dot(local) > a.dot(local) { b } else { a };
        axes.fold(DVec3::X, closer)
    }

    /// Rotation angle between two attitudes \[rad\], 0 to π. Computed as 2 atan2(|vec|, |w|) of q₁* q₂, because `acos`
    /// cannot resolve angles below 1e-8. q and −q are the same attitude.
    pub fn attitude_difference(&self, other: &Self) -> f64 {
        let d = self.rotation.inverse() * other.rotation;
        2.0 * libm::atan2(d.xyz().length(), d.w.abs())
    }

    /// Turns the body by `turn` (body axes), and renormalizes the attitude: q ← q∘p.
    #[inline(always)]
    pub(crate) fn turn_by(&mut self, turn: DQuat) {
        self.rotation = renormalize(compose(self.rotation, turn));
    }

    /// Renormalizes the attitude to unit length.
    #[inline(always)]
    pub(crate) fn renormalize(&mut self) {
        self.rotation = renormalize(self.rotation);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sin_cos;

    fn body() -> RigidBox {
        RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid")
    }

    fn tilted() -> BodyState {
        let (s, c) = sin_cos(0.4);
        BodyState::at_pose(
            DVec3::new(1.0, 2.0, 3.0),
            DQuat::from_xyzw(s * 0.6, 0.0, s * 0.8, c),
        )
        .with_velocity(DVec3::new(0.5, -1.0, 0.25))
        .with_angular_velocity(&body(), DVec3::new(1.0, 2.0, -1.0))
    }

    #[test]
    fn values_beyond_1e38_or_not_finite_are_invalid() {
        let parts: [fn(&mut BodyState) -> &mut DVec3; 3] = [
            |state| &mut state.position,
            |state| &mut state.velocity,
            |state| &mut state.angular_momentum,
        ];
        for part in parts {
            for value in [1e37, -1e37, 1e39, -1e39, f64::INFINITY, f64::NAN] {
                let mut state = BodyState::default();
                part(&mut state).z = value;
                assert_eq!(state.is_valid(), value.abs() < 1e38, "{state:?}");
            }
        }
    }

    #[test]
    fn angular_velocity_round_trip() {
        let w = tilted().angular_velocity(&body());
        assert!((w - DVec3::new(1.0, 2.0, -1.0)).length() < 1e-15);
    }

    /// Turning keeps the spin in the chosen axes to rounding. Position and velocity do not change.
    #[test]
    fn turning_keeps_the_spin_in_the_chosen_axes() {
        let (body, before) = (body(), tilted());
        let (s, c) = sin_cos(0.3);
        let turn = DQuat::from_xyzw(0.0, 2.0 * s, 0.0, 2.0 * c);
        for spin in [Frame::World, Frame::Body] {
            let mut after = before;
            after.turn_to(&body, turn, spin);
            assert!((after.rotation - turn * 0.5).length() < 1e-15);
            assert_eq!(
                (after.position, after.velocity),
                (before.position, before.velocity)
            );
            let changed = match spin {
                Frame::World => after.angular_velocity(&body) - before.angular_velocity(&body),
                Frame::Body => after.angular_momentum - before.angular_momentum,
            };
            assert!(changed.length() < 1e-15, "{spin:?}: {changed}");
        }
    }

    #[test]
    fn impulse_bookkeeping() {
        let (body, before) = (body(), tilted());
        let (j, r) = (DVec3::new(0.3, -0.7, 1.1), DVec3::new(0.5, 0.25, -0.125));
        let mut a = before;
        a.apply_impulse_at_body_point(&body, j, r);
        let dv = a.velocity - before.velocity;
        assert!((dv - j / 3.0).length() < 1e-15);
        let dl = a.angular_momentum_world() - before.angular_momentum_world();
        assert!((dl - (before.rotation * r).cross(j)).length() < 1e-15);
        // The same impulse at the same point, given in world coordinates.
        let mut b = before;
        b.apply_impulse(&body, j, before.point(r));
        assert!((b.angular_momentum - a.angular_momentum).length() < 1e-15);
        // The opposite impulse restores the state to 2 ulp.
        a.apply_impulse_at_body_point(&body, -j, r);
        let ulp = 4.0 * f64::EPSILON;
        assert!((a.velocity - before.velocity).abs().max_element() <= ulp);
        let dl = a.angular_momentum - before.angular_momentum;
        assert!(dl.abs().max_element() <= ulp);
    }

    #[test]
    fn attitude_difference_is_sharp_near_zero() {
        let a = tilted();
        let mut b = a;
        b.rotation = a.rotation * DQuat::from_xyzw(5e-13, 0.0, 0.0, 1.0);
        assert!((a.attitude_difference(&b) - 1e-12).abs() < 1e-15);
        b.rotation = -b.rotation;
        assert!((a.attitude_difference(&b) - 1e-12).abs() < 1e-15);
    }
}
