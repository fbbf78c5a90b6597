//! Query types that combine a body's box and its state.

use core::ops::{Deref, DerefMut};

use bevy::ecs::entity::Entity;
use bevy::ecs::query::QueryData;
use glam::DVec3;

use crate::body::RigidBox;
use crate::state::BodyState;

/// Read access to a body, as `Query<BodyRef>`. It dereferences to the [`BodyState`] and adds methods that also need the
/// [`RigidBox`].
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn fastest_spin(bodies: Query<BodyRef>) -> f64 {
///     let spins = bodies.iter().map(|body| body.angular_velocity().length());
///     spins.fold(0.0, f64::max)
/// }
/// ```
#[derive(QueryData)]
pub struct BodyRef {
    /// The entity.
    pub entity: Entity,
    /// Size, mass and inertia.
    pub body: &'static RigidBox,
    /// Motion state.
    pub state: &'static BodyState,
}

/// Write access to a body, as `Query<BodyMut>`. Changes take effect in the next step and wake a sleeping body.
/// [`ApplyImpulse`](super::ApplyImpulse) does the same as a message.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn kick(mut balls: Query<BodyMut>) {
///     for mut ball in &mut balls {
///         ball.apply_impulse(DVec3::Y * 2.0); // N s
///         ball.apply_angular_impulse(DVec3::Z * 0.1); // N m s
///         ball.set_angular_velocity(DVec3::ZERO); // rad/s, world axes
///         ball.velocity *= 0.5;
///     }
/// }
/// ```
#[doc(alias("Forces", "apply_linear_impulse", "apply_torque_impulse"))]
#[derive(QueryData)]
#[query_data(mutable)]
pub struct BodyMut {
    /// The entity.
    pub entity: Entity,
    /// Size, mass and inertia.
    pub body: &'static RigidBox,
    /// Motion state.
    pub state: &'static mut BodyState,
}

macro_rules! read {
    ($($Item:ident),+) => {$(
        impl Deref for $Item<'_, '_> {
            type Target = BodyState;

            fn deref(&self) -> &BodyState {
                &self.state
            }
        }

        impl $Item<'_, '_> {
            /// Angular velocity in world axes [rad/s].
            pub fn angular_velocity(&self) -> DVec3 {
                self.state.angular_velocity(self.body)
            }

            /// Velocity of the material point at `point` \[m\], both in world axes [m/s].
            pub fn velocity_at(&self, point: impl Into<DVec3>) -> DVec3 {
                let lever = point.into() - self.state.position;
                self.state.velocity + self.angular_velocity().cross(lever)
            }

            /// Kinetic energy \[J\].
            pub fn kinetic_energy(&self) -> f64 {
                self.state.kinetic_energy(self.body)
            }
        }
    )+};
}

read!(BodyRefItem, BodyMutItem, BodyMutReadOnlyItem);

impl DerefMut for BodyMutItem<'_, '_> {
    fn deref_mut(&mut self) -> &mut BodyState {
        &mut self.state
    }
}

impl BodyMutItem<'_, '_> {
    /// Sets the angular velocity, world axes [rad/s].
    pub fn set_angular_velocity(&mut self, world: impl Into<DVec3>) {
        self.state.set_angular_velocity(self.body, world.into());
    }

    /// Applies an impulse \[N s\] at the center of mass, world axes: Δv = J/m.
    pub fn apply_impulse(&mut self, impulse: impl Into<DVec3>) {
        self.state.velocity += impulse.into() * self.body.inverse_mass();
    }

    /// Applies an impulse \[N s\] at a point \[m\], both in world axes.
    pub fn apply_impulse_at(&mut self, impulse: impl Into<DVec3>, point: impl Into<DVec3>) {
        self.state
            .apply_impulse(self.body, impulse.into(), point.into());
    }

    /// Applies an impulse \[N s\] in world axes at a point in body axes from the center \[m\].
    pub fn apply_impulse_at_body_point(
        &mut self,
        impulse: impl Into<DVec3>,
        point: impl Into<DVec3>,
    ) {
        self.state
            .apply_impulse_at_body_point(self.body, impulse.into(), point.into());
    }

    /// Applies an angular impulse \[N m s\], world axes.
    pub fn apply_angular_impulse(&mut self, angular_impulse: impl Into<DVec3>) {
        self.state.apply_angular_impulse(angular_impulse.into());
    }
}
