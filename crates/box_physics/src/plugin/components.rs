//! Components of a body: those that users insert and those that the plugin maintains.

use bevy::ecs::component::Component;
use bevy::ecs::reflect::ReflectComponent;
use bevy::math::bounding::Aabb3d;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use glam::DVec3;

use super::contacts::ReportedContacts;
use crate::aabb;
use crate::body::RigidBox;
use crate::error::InvalidValue;
use crate::floor::{Friction, Restitution};
use crate::force::{PointForce, Spring};
use crate::integrators::Integrator;
use crate::state::BodyState;

/// The integrator of this body, overriding the [`GlobalIntegrator`](super::GlobalIntegrator).
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

/// Factor on the [`WorldGravity`](super::WorldGravity) for this body. Bodies without this component have 1; with 0 a
/// body floats, and with a negative value it rises.
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

/// A component that takes effect only while its values are valid. An invalid one is logged once, and its body is
/// stepped without it.
pub(crate) trait Checked: Component {
    fn check(&self) -> Result<(), InvalidValue>;
}

impl Checked for Springs {
    fn check(&self) -> Result<(), InvalidValue> {
        self.0.iter().try_for_each(|spring| {
            InvalidValue::check_coefficient("spring stiffness", spring.stiffness)?;
            InvalidValue::check_coefficient("spring damping", spring.damping)
        })
    }
}

impl Checked for Friction {
    fn check(&self) -> Result<(), InvalidValue> {
        self.validate()
    }
}

impl Checked for Restitution {
    fn check(&self) -> Result<(), InvalidValue> {
        self.validate()
    }
}

macro_rules! coefficient {
    ($(#[$attribute:meta])* $name:ident, $field:literal) => {
        $(#[$attribute])* ///
        /// A value that is negative or not finite is logged, and the body is stepped without it.
        #[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
        #[reflect(Component, Default, Clone, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name(pub f64);

        impl $name {
            /// Checks the coefficient.
            ///
            /// # Errors
            /// [`InvalidValue`] if it is negative or not finite.
            pub fn new(coefficient: f64) -> Result<Self, InvalidValue> {
                InvalidValue::check_coefficient($field, coefficient).map(|()| Self(coefficient))
            }
        }

        impl Checked for $name {
            #[inline(always)]
            fn check(&self) -> Result<(), InvalidValue> {
                InvalidValue::check_coefficient($field, self.0)
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

/// A force through the center \[N\] and a torque \[N m\], both in **world** axes and constant over each step.
///
/// It acts until it is changed; [`OneShotForce`] lasts for one tick. For forces that depend on the state use
/// [`PointForces`], [`Springs`], or the core with your own [`ForceModel`](crate::force::ForceModel).
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// /// Pushes from the left for the first second.
/// fn push(clock: Res<PhysicsClock>, mut bodies: Query<&mut ExternalForce>) {
///     for mut body in &mut bodies {
///         body.force = if clock.time() < 1.0 { DVec3::X * 2.0 } else { DVec3::ZERO };
///     }
/// }
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
///     .add_systems(PhysicsSchedule, push.in_set(PhysicsSystems::Forces));
/// app.update();
/// ```
#[doc(alias("ConstantForce", "ConstantTorque"))]
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ExternalForce {
    /// Force \[N\].
    pub force: DVec3,
    /// Torque about the center of mass \[N m\].
    pub torque: DVec3,
}

/// A force through the center \[N\] and a torque \[N m\], both in **world** axes, that act during the next physics tick
/// only.
///
/// They are constant over all substeps of that tick and then cleared. Any system in any schedule may add to them. A
/// body with this component does not sleep. For instantaneous pushes use [`ApplyImpulse`](super::ApplyImpulse).
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn thrust(keys: Res<ButtonInput<KeyCode>>, mut rockets: Query<&mut OneShotForce>) {
///     for mut rocket in &mut rockets {
///         if keys.pressed(KeyCode::Space) {
///             rocket.force += DVec3::Y * 20.0; // N
///         }
///     }
/// }
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
///     .init_resource::<ButtonInput<KeyCode>>() // DefaultPlugins bring it along
///     .add_systems(FixedUpdate, thrust);
/// app.world_mut().spawn((RigidBox::default(), OneShotForce::default()));
/// app.update();
/// ```
#[doc(alias("Forces", "apply_force", "apply_torque", "add_force"))]
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OneShotForce {
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

/// Velocity of the air around this body [m/s], world axes, overriding the global [`Wind`](super::Wind). It acts only
/// through [`LinearDrag`] and [`QuadraticDrag`].
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyWind(pub DVec3);

/// Forces at body points, evaluated at every stage of the integrator.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// /// Two thrusters at the sides, full throttle: the box rises, and the thrust turns with it.
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
/// If a stiffness or damping is negative or not finite, this is logged and the body is stepped without any of these
/// springs.
///
/// ```
/// use box_physics::prelude::*;
/// /// Holds a box by one corner, like a mouse grab.
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

/// World-aligned bounding box, refitted after every step. It is rounded outward to f32, so it contains the f64 box.
/// Added by [`AabbPlugin`](super::AabbPlugin).
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
    /// The bounding box of a body: |R|·h around its center, rounded outward.
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

/// Enables [`Landed`](super::Landed) and [`FloorContact`](super::FloorContact) messages for this body; bodies without
/// it emit none.
///
/// Every contact that began ends exactly once, also if the body is despawned, disabled, quarantined or teleported, or
/// if the floor is removed.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[require(ReportedContacts)]
pub struct ReportContacts;

/// Emits a [`FloorContact`](super::FloorContact) for this body in every step in which it touches the floor, including
/// at rest. Such a body does not sleep.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[require(ReportContacts)]
pub struct ReportPersisting;

/// Simulated time at which the body came to rest on the floor \[s\]; `None` while it moves.
///
/// Written by the physics. It changes only when the body comes to rest ([`Settled`](super::Settled)) or stops resting
/// ([`Woken`](super::Woken)), so `Changed<RestingSince>` detects both.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RestingSince(pub Option<f64>);

/// Marks a body whose state, box or forces were not finite, or led to values beyond 1e38. It is excluded from every
/// step and frozen at its last valid state. To resume it, write a valid state and remove this component.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// /// Despawns bodies that left the valid range.
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
    /// Simulated time of the quarantine \[s\].
    pub time: f64,
}

/// Passed for each body from *Integrate* to *Contact*, and from *Contact* to the next *Integrate*.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct NearFloor {
    /// The body may touch the floor during this step, so *Contact* steps it.
    pub(crate) pending: bool,
    /// The body touched the floor at the end of the last step. *Contact* steps it once more, to report the end of the
    /// contact.
    pub(crate) touched: bool,
    /// The body came to rest in this step, or no longer rests.
    pub(crate) rest_changed: bool,
}
