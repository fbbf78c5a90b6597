//! Components: what a user may put on a body, and what the plugin keeps there.

use bevy::ecs::component::Component;
use bevy::ecs::reflect::ReflectComponent;
use bevy::math::bounding::Aabb3d;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::transform::components::Transform;
use glam::{DVec3, Quat, Vec3};

use super::contacts::ReportedContacts;
use crate::aabb;
use crate::body::RigidBox;
use crate::error::InvalidValue;
use crate::force::{PointForce, Spring};
use crate::integrators::Integrator;
use crate::state::BodyState;

/// The integrator of this body alone, instead of the [`GlobalIntegrator`](super::GlobalIntegrator).
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn setup(mut commands: Commands) {
///     commands.spawn((RigidBox::default(), BodyIntegrator(Integrator::Split4)));
/// }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyIntegrator(pub Integrator);

/// Factor on the [`WorldGravity`](super::WorldGravity) for this body (1 without the component; 0
/// floats, negative rises).
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn setup(mut commands: Commands) {
///     commands.spawn((RigidBox::default(), GravityScale(0.0))); // floats
///     commands.spawn((RigidBox::default(), GravityScale(-0.2))); // a balloon
/// }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GravityScale(pub f64);

impl Default for GravityScale {
    fn default() -> Self {
        Self(1.0)
    }
}

macro_rules! coefficient {
    ($(#[$attribute:meta])* $name:ident, $field:literal) => {
        $(#[$attribute])*
        #[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
        #[reflect(Component, Default, Clone, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name(pub f64);

        impl $name {
            /// Checked.
            ///
            /// # Errors
            /// [`InvalidValue`] if it is negative or not finite.
            pub fn new(coefficient: f64) -> Result<Self, InvalidValue> {
                InvalidValue::check_coefficient($field, coefficient).map(Self)
            }
        }
    };
}

coefficient! {
    /// Linear drag c₁ [N s/m], ≥ 0: force −c₁ v.
    LinearDrag, "linear drag"
}
coefficient! {
    /// Quadratic drag k₂ [N s²/m²], ≥ 0: force −k₂ |v| v.
    QuadraticDrag, "quadratic drag"
}
coefficient! {
    /// Angular damping rate γ [1/s], ≥ 0: torque −γ L.
    AngularDamping, "angular damping"
}
coefficient! {
    /// Angular drag c_ω \[N m s\], ≥ 0: torque −c_ω ω.
    AngularDrag, "angular drag"
}

/// A force through the center \[N\] and a torque \[N m\], both in **world** axes, held constant over each
/// step. It stays until changed. For forces that depend on the state use [`PointForces`],
/// [`Springs`], or the core with a [`ForceModel`](crate::force::ForceModel) of your own.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// /// Blows from the left for the first second.
/// fn wind(clock: Res<PhysicsClock>, mut bodies: Query<&mut ExternalForce>) {
///     for mut body in &mut bodies {
///         body.force = if clock.time() < 1.0 { DVec3::X * 2.0 } else { DVec3::ZERO };
///     }
/// }
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
///     .add_systems(PhysicsSchedule, wind.in_set(PhysicsSystems::Forces));
/// app.update();
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ExternalForce {
    /// Force \[N\].
    pub force: DVec3,
    /// Torque about the center of mass \[N m\].
    pub torque: DVec3,
}

/// A constant torque in **body** axes \[N m\].
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyTorque(pub DVec3);

/// Forces at body points, evaluated at every stage of the integrator.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// /// Two thrusters at the sides, full throttle: it rises, and turns with the box.
/// fn setup(mut commands: Commands) {
///     let thruster = |x| PointForce {
///         body_point: DVec3::new(x, 0.0, 0.0),
///         force: DVec3::Y * 8.0, // N
///         frame: Frame::Body,
///     };
///     commands.spawn((RigidBox::default(), PointForces(vec![thruster(-0.5), thruster(0.5)])));
/// }
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PointForces(pub Vec<PointForce>);

/// Springs from body points to world anchors, evaluated at every stage of the integrator.
///
/// ```
/// use box_physics::prelude::*;
/// /// Holds a box by one corner, as a mouse does.
/// fn grab(cursor: DVec3) -> Springs {
///     Springs(vec![Spring {
///         body_point: DVec3::splat(0.5),
///         anchor: cursor,
///         stiffness: 50.0, // N/m
///         damping: 5.0,    // N s/m
///     }])
/// }
/// assert_eq!(grab(DVec3::Y).0[0].anchor, DVec3::Y);
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Springs(pub Vec<Spring>);

/// The bounding box in the world, re-fitted after every step and rounded outward, so that it contains
/// the box in f64. Comes with [`AabbPlugin`](super::AabbPlugin).
///
/// ```
/// use box_physics::prelude::*;
/// let brick = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0)?;
/// let aabb = WorldAabb::of(&brick, &BodyState::at(DVec3::Y)).0;
/// assert_eq!((aabb.min.y, aabb.max.y), (0.75, 1.25));
/// # Ok::<(), InvalidValue>(())
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone)]
pub struct WorldAabb(pub Aabb3d);

impl WorldAabb {
    /// Fitted to a body: |R|·h about its center, rounded outward.
    #[inline(always)]
    pub fn of(body: &RigidBox, state: &BodyState) -> Self {
        let half = aabb::world_half_extents(state.rotation, body.half_extents());
        let (min, max) = aabb::outward(state.position, half);
        Self(Aabb3d {
            min: min.into(),
            max: max.into(),
        })
    }
}

impl Default for WorldAabb {
    fn default() -> Self {
        Self(Aabb3d {
            min: bevy::math::Vec3A::ZERO,
            max: bevy::math::Vec3A::ZERO,
        })
    }
}

/// Asks for [`FloorContact`](super::FloorContact) messages about this body. Without it none are made. Every contact
/// that began ends once, also where the body is despawned, disabled, quarantined or teleported, or the floor removed.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[require(ReportedContacts)]
pub struct ReportContacts;

/// On a body whose state, body or forces were not finite or led beyond 1e38: it is left out of every step, frozen
/// at its last good state. Give it a finite state and remove this component, and it goes on.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// /// Out of range means lost: a game that can spare it despawns it.
/// fn clear(lost: Query<Entity, Added<Quarantined>>, mut commands: Commands) {
///     for entity in &lost {
///         commands.entity(entity).despawn();
///     }
/// }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Quarantined {
    /// Simulated time at which it happened \[s\].
    pub time: f64,
}

/// The pose last written to `Transform`, in its f32 bits. A `Transform` that changed since and differs from
/// it was changed by somebody else: a teleport. (Change detection alone would not do: smoothing between
/// steps writes `Transform` every frame.)
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub(crate) struct PublishedPose {
    pub(crate) translation: Vec3,
    pub(crate) rotation: Quat,
    /// Whether the body was placed. Until then its `Transform` says where it starts, whatever wrote it.
    pub(crate) placed: bool,
}

impl Default for PublishedPose {
    /// The default `Transform`: so a body that is spawned with a `Transform` starts there, and one
    /// spawned with a `BodyState` alone starts as that says.
    fn default() -> Self {
        Self {
            translation: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            placed: false,
        }
    }
}

impl PublishedPose {
    /// `state`'s pose in f32.
    #[inline(always)]
    pub(crate) fn of(state: &BodyState) -> Self {
        Self {
            translation: state.position.as_vec3(),
            rotation: state.rotation.as_quat(),
            placed: true,
        }
    }

    /// The pose of `transform`, if it is one.
    pub(crate) fn shown_by(transform: &Transform) -> Option<Self> {
        let norm = transform.rotation.as_dquat().length();
        let usable = transform.translation.is_finite() && norm.is_finite() && norm > 1e-6;
        usable.then_some(Self {
            translation: transform.translation,
            rotation: transform.rotation,
            placed: true,
        })
    }

    pub(crate) fn is_shown_by(&self, transform: &Transform) -> bool {
        transform.translation == self.translation && transform.rotation == self.rotation
    }

    pub(crate) fn show(&self, transform: &mut Transform) {
        transform.translation = self.translation;
        transform.rotation = self.rotation;
    }

    /// At this pose, at rest: what is left of a body whose state is lost.
    pub(crate) fn state_at_rest(&self) -> BodyState {
        BodyState::at_pose(self.translation.as_dvec3(), self.rotation.as_dquat())
    }

    /// Takes over into `state` what somebody changed in `transform` since we wrote it. Returns whether
    /// there was anything, or an error if it is not usable (then nothing is taken).
    pub(crate) fn take_teleport(
        &self,
        transform: &Transform,
        state: &mut BodyState,
    ) -> Result<bool, NotFinite> {
        let now = Self::of(state);
        let moved =
            transform.translation != self.translation && transform.translation != now.translation;
        // Smoothing between two equal rotations may change their last bits: that is nobody's wish.
        let turned = !same_rotation(transform.rotation, self.rotation)
            && !same_rotation(transform.rotation, now.rotation);
        if !moved && !turned {
            return Ok(false);
        }
        if Self::shown_by(transform).is_none() {
            return Err(NotFinite);
        }
        if moved {
            state.position = transform.translation.as_dvec3();
        }
        if turned {
            // The momentum is stored in body axes: the body carries its spin along.
            state.rotation =
                BodyState::at_pose(state.position, transform.rotation.as_dquat()).rotation;
        }
        Ok(true)
    }
}

/// Whether two f32 rotations are the same but for rounding (four units in the last place of 1).
#[inline(always)]
fn same_rotation(a: Quat, b: Quat) -> bool {
    const ROUNDING: f32 = 4.0 * f32::EPSILON;
    a == b || (a - b).length_squared() < ROUNDING * ROUNDING
}

/// A `Transform` that names no place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NotFinite;

/// What *Integrate* and *Contact* tell each other of a body.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct NearFloor {
    /// It may touch the floor during this step: left to *Contact*.
    pub(crate) pending: bool,
    /// It touched at the end of the last step: *Contact* takes it once more, to report the end.
    pub(crate) touched: bool,
    /// It lay still before this step and does after it: bounding box and pose are what they were.
    pub(crate) still: bool,
    /// The number of the last run of *Contact* in which it lay still under nothing but gravity; 0 for none.
    pub(crate) asleep: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_teleport_is_a_transform_that_we_did_not_write() {
        let mut state = BodyState::at(DVec3::new(0.1, 0.2, 0.3));
        let published = PublishedPose::of(&state);
        let mut transform = Transform::from_translation(published.translation);
        assert_eq!(published.take_teleport(&transform, &mut state), Ok(false));
        assert_eq!(
            state.position,
            DVec3::new(0.1, 0.2, 0.3),
            "keeps its f64 digits"
        );
        transform.translation.y = 5.0;
        assert_eq!(published.take_teleport(&transform, &mut state), Ok(true));
        assert_eq!(state.position.y, 5.0);
        transform.translation.y = f32::NAN;
        assert_eq!(
            published.take_teleport(&transform, &mut state),
            Err(NotFinite)
        );
        assert_eq!(state.position.y, 5.0);
    }

    #[test]
    fn a_new_body_starts_where_its_transform_or_its_state_says() {
        let new = PublishedPose::default();
        let mut state = BodyState::default();
        let transform = Transform::from_xyz(0.0, 5.0, 0.0);
        assert_eq!(new.take_teleport(&transform, &mut state), Ok(true));
        assert_eq!(state.position, DVec3::Y * 5.0);
        let mut state = BodyState::at(DVec3::X);
        assert_eq!(
            new.take_teleport(&Transform::default(), &mut state),
            Ok(false)
        );
        assert_eq!(state.position, DVec3::X);
    }

    #[test]
    fn coefficients_are_checked() {
        assert_eq!(LinearDrag::new(0.5), Ok(LinearDrag(0.5)));
        let error = AngularDamping::new(-1.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "angular damping must be finite and not negative, but is -1"
        );
    }
}
