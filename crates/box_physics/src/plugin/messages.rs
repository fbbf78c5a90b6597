//! Messages: requests to the physics, and reports of what happened.

use bevy::ecs::entity::Entity;
use bevy::ecs::event::EntityEvent;
use bevy::ecs::message::Message;
use bevy::ecs::reflect::ReflectMessage;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use glam::DVec3;

use super::queries::BodyRefItem;
use crate::body::RigidBox;
use crate::floor::ContactReport;
use crate::integrators::Integrator;
use crate::state::BodyState;

/// Requests an impulse on a body at the start of the next step. Several impulses are applied in order of arrival.
///
/// An impulse sent while the physics is paused waits for the next step. With
/// [`dropped_while_paused`](Self::dropped_while_paused) it is discarded instead, so that a key held down during a pause
/// does not launch the body afterward. [`BodyMut`](super::BodyMut) applies impulses immediately.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn jump(
///     keys: Res<ButtonInput<KeyCode>>,
///     boxes: Query<Entity, With<RigidBox>>,
///     mut impulses: MessageWriter<ApplyImpulse>,
/// ) {
///     if keys.just_pressed(KeyCode::Space) {
///         impulses.write_batch(boxes.iter().map(|b| ApplyImpulse::center(b, Vec3::Y * 4.0)));
///     }
/// }
/// ```
#[doc(alias("ExternalImpulse", "apply_impulse", "torque_impulse", "explosion"))]
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Message, Clone, PartialEq)]
pub struct ApplyImpulse {
    /// The body.
    pub entity: Entity,
    /// Impulse J \[N s\], world axes.
    pub impulse: DVec3,
    /// Point of application.
    pub at: ImpulsePoint,
    /// Additional angular impulse about the center of mass \[N m s\], world axes.
    pub angular_impulse: DVec3,
    /// Treatment of the impulse if it is sent while the physics is paused.
    pub while_paused: WhilePaused,
}

/// An explosion, for [`ApplyImpulse::radial`]. It pushes a body at the closest point of its box, away from the center
/// of the explosion. Boxes that are hit off-center start to spin.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn explode(boxes: Query<BodyRef>, mut impulses: MessageWriter<ApplyImpulse>) {
///     let bomb = Explosion {
///         center: DVec3::ZERO,
///         radius: 8.0,   // m
///         impulse: 20.0, // N s
///         falloff: 1.0,
///     };
///     impulses.write_batch(boxes.iter().filter_map(|b| ApplyImpulse::radial(&b, &bomb)));
/// }
/// ```
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Clone, PartialEq)]
pub struct Explosion {
    /// Center, world coordinates \[m\].
    pub center: DVec3,
    /// Distance beyond which it has no effect \[m\].
    pub radius: f64,
    /// Impulse at the center \[N s\].
    pub impulse: f64,
    /// Exponent p of the impulse J (1 − d/R)ᵖ at distance d: 0 is constant within the radius R, 1 is linear.
    pub falloff: f64,
}

/// Treatment of an impulse sent while the physics is paused. The pause may come from
/// [`PhysicsClock::paused`](super::PhysicsClock::paused), from Bevy's `Time<Virtual>`, or from a relative speed of 0.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Clone, PartialEq)]
pub enum WhilePaused {
    /// The impulse acts at the next step.
    #[default]
    Keep,
    /// The impulse is dropped.
    Drop,
}

/// Point of application of an impulse.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, Clone, PartialEq)]
pub enum ImpulsePoint {
    /// The center of mass; causes no spin.
    #[default]
    Center,
    /// A point in world coordinates \[m\].
    World(DVec3),
    /// A point in body axes from the center \[m\].
    Body(DVec3),
}

impl ApplyImpulse {
    fn new(entity: Entity, impulse: impl Into<DVec3>, at: ImpulsePoint) -> Self {
        Self {
            entity,
            impulse: impulse.into(),
            at,
            angular_impulse: DVec3::ZERO,
            while_paused: WhilePaused::Keep,
        }
    }

    /// Creates an impulse \[N s\] at the center of mass.
    pub fn center(entity: Entity, impulse: impl Into<DVec3>) -> Self {
        Self::new(entity, impulse, ImpulsePoint::Center)
    }

    /// Creates an impulse \[N s\] at a point in world coordinates \[m\].
    pub fn at_world_point(
        entity: Entity,
        impulse: impl Into<DVec3>,
        point: impl Into<DVec3>,
    ) -> Self {
        Self::new(entity, impulse, ImpulsePoint::World(point.into()))
    }

    /// Creates an impulse \[N s\] at a point in body axes from the center \[m\].
    pub fn at_body_point(
        entity: Entity,
        impulse: impl Into<DVec3>,
        point: impl Into<DVec3>,
    ) -> Self {
        Self::new(entity, impulse, ImpulsePoint::Body(point.into()))
    }

    /// Creates an angular impulse \[N m s\], world axes. It changes only the spin.
    pub fn angular(entity: Entity, angular_impulse: impl Into<DVec3>) -> Self {
        Self {
            angular_impulse: angular_impulse.into(),
            ..Self::center(entity, DVec3::ZERO)
        }
    }

    /// Creates the impulse of an explosion on a body; `None` beyond its radius. If the explosion's center is inside the
    /// box, the body is pushed at its center of mass.
    pub fn radial(body: &BodyRefItem<'_, '_>, explosion: &Explosion) -> Option<Self> {
        let (half, to_body) = (body.body.half_extents(), body.rotation.inverse());
        let center = to_body * (explosion.center - body.position);
        let closest = center.clamp(-half, half);
        let away = closest - center;
        let distance = away.length();
        if distance >= explosion.radius {
            return None;
        }
        let (direction, point) = if distance > 0.0 {
            (away / distance, closest)
        } else {
            ((-center).normalize_or(to_body * DVec3::Y), DVec3::ZERO)
        };
        let part = libm::pow(1.0 - distance / explosion.radius, explosion.falloff);
        let impulse = body.rotation * direction * (explosion.impulse * part);
        Some(Self::at_body_point(body.entity, impulse, point))
    }

    /// Returns the same impulse, to be dropped if it is sent while the physics is paused.
    #[must_use]
    pub fn dropped_while_paused(mut self) -> Self {
        self.while_paused = WhilePaused::Drop;
        self
    }

    /// Applies the impulse to `state`.
    pub fn apply(&self, body: &RigidBox, state: &mut BodyState) {
        match self.at {
            ImpulsePoint::Center => state.velocity += self.impulse * body.inverse_mass(),
            ImpulsePoint::World(point) => state.apply_impulse(body, self.impulse, point),
            ImpulsePoint::Body(point) => {
                state.apply_impulse_at_body_point(body, self.impulse, point);
            }
        }
        if self.angular_impulse != DVec3::ZERO {
            state.apply_angular_impulse(self.angular_impulse);
        }
    }
}

/// A body with [`ReportContacts`](super::ReportContacts) began, continued or stopped touching the floor.
///
/// There is one contact for the whole body, regardless of the number of corners. A body that bounces within a step
/// emits both `Began` and `Ended`. For sounds use [`Landed`].
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Message, Clone, PartialEq)]
pub struct FloorContact {
    /// The body.
    pub entity: Entity,
    /// Phase of the contact.
    pub phase: ContactPhase,
    /// Simulated time at the end of the step \[s\].
    pub time: f64,
    /// Points and impulses of the step, corner by corner.
    pub report: ContactReport,
}

/// Phase of a contact between a body and the floor.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Clone, PartialEq)]
pub enum ContactPhase {
    /// The body touches now and did not before this step.
    Began,
    /// The body touched before and still does. Emitted only with [`ReportPersisting`](super::ReportPersisting).
    Persists,
    /// The body no longer touches.
    Ended,
}

/// A body with [`ReportContacts`](super::ReportContacts) landed. Emitted as a message and as an event on the entity.
///
/// One landing covers all impacts that follow each other within 0.1 s: a box that drops on an edge hits with one corner
/// after the other and rattles. A bounce that lasts longer leads to another landing.
///
/// It is emitted when the impulses of the first 0.03 s are known. (A sound that is late by up to 0.125 s still seems
/// simultaneous, ITU-R BT.1359.) Impacts slower than
/// [`ContactSettings::restitution_threshold`](crate::floor::ContactSettings) do not count, so a body spawned on the
/// floor does not land.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn setup(mut commands: Commands) {
///     commands
///         .spawn((RigidBox::default(), Transform::from_xyz(0.0, 3.0, 0.0), ReportContacts))
///         .observe(|landed: On<Landed>| {
///             let loudness = landed.normal_impulse; // N s
///             println!("thud at {}: {loudness:.1} N s", landed.point);
///         });
/// }
/// // Or, of all bodies:
/// fn thuds(mut landings: MessageReader<Landed>) {
///     for landed in landings.read() {
///         println!("{} at {:.2} m/s", landed.entity, landed.approach_speed);
///     }
/// }
/// ```
#[derive(EntityEvent, Message, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Message, Clone, PartialEq)]
pub struct Landed {
    /// The body.
    pub entity: Entity,
    /// Simulated time of the first impact \[s\].
    pub time: f64,
    /// Point of impact in the world \[m\]: the mean of the contact points, weighted by their impulses.
    pub point: DVec3,
    /// Unit normal of the surface: +y for the floor.
    pub normal: DVec3,
    /// Total impulse along the normal \[N s\], > 0.
    pub normal_impulse: f64,
    /// Total friction impulse on the body \[N s\], world axes.
    pub tangential_impulse: DVec3,
    /// Highest normal speed at which a corner hit the surface [m/s], > 0.
    pub approach_speed: f64,
}

/// A body came to rest on the floor. Triggered on the entity, for every body.
///
/// From the next step on the body sleeps, if only gravity acts on it. [`RestingSince`](super::RestingSince) stores the
/// time.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn setup(mut commands: Commands) {
///     commands
///         .spawn((RigidBox::default(), Transform::from_xyz(0.0, 3.0, 0.0)))
///         .observe(|settled: On<Settled>, dice: Query<&BodyState>| {
///             if let Ok(die) = dice.get(settled.entity) {
///                 println!("{} is up", die.axis_towards(DVec3::Y));
///             }
///         });
/// }
/// ```
#[derive(EntityEvent, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Clone, PartialEq)]
pub struct Settled {
    /// The body.
    pub entity: Entity,
    /// Simulated time \[s\].
    pub time: f64,
}

/// A body that rested on the floor no longer does. Triggered on the entity, for every body that [`Settled`].
///
/// It is also sent if the body is teleported, disabled or quarantined and if the floor is removed, but not if the body
/// is despawned.
#[derive(EntityEvent, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Clone, PartialEq)]
pub struct Woken {
    /// The body.
    pub entity: Entity,
    /// Simulated time \[s\].
    pub time: f64,
}

/// A body was quarantined: see [`Quarantined`](super::Quarantined).
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn report(mut lost: MessageReader<BodyQuarantined>) {
///     for m in lost.read() {
///         println!("{} at {} s under {}: {}", m.entity, m.time, m.integrator, m.cause);
///     }
/// }
/// ```
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Message, Clone, PartialEq)]
pub struct BodyQuarantined {
    /// The body.
    pub entity: Entity,
    /// The integrator of the body.
    pub integrator: Integrator,
    /// Simulated time \[s\].
    pub time: f64,
    /// The cause.
    pub cause: QuarantineCause,
}

/// Cause of a quarantine.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Clone, PartialEq)]
pub enum QuarantineCause {
    /// The written [`BodyState`] is not finite or exceeds 1e38, or its attitude is not a unit quaternion. The body is
    /// at rest at its last displayed pose.
    State,
    /// A step from a valid state led to values that are not finite or exceed 1e38, because of the forces or because the
    /// integrator left its stable range. The body keeps its state from before that step.
    Step,
}

impl core::fmt::Display for QuarantineCause {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::State => {
                "its BodyState was written with values that are not finite or beyond 1e38, or with an \
                 attitude that is no unit quaternion"
            }
            Self::Step => {
                "its step led to values that are not finite or beyond 1e38 (forces, or an integrator beyond its \
                 range)"
            }
        })
    }
}
