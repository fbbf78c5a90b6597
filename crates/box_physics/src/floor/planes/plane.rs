//! A plane and its surface.

use glam::{DQuat, DVec3};

#[cfg(feature = "bevy")]
use crate::ecs::*;
use crate::error::InvalidValue;
use crate::floor::frame::{Axes, Frame};
use crate::floor::{Floor, Friction, Restitution};
use crate::state::BodyState;

/// An infinite plane that bodies cannot cross: a wall, a ramp, a ceiling.
///
/// With the plugin it is a component of a separate entity, which may have a [`Friction`] and a [`Restitution`]; without
/// them it has the coefficients of the default [`Floor`]. The rule of the body applies. Choose `point` near the place
/// where bodies touch the plane: heights are as precise as coordinates relative to it.
///
/// ```
/// use box_physics::prelude::*;
/// // A wall at x = 2 m that faces −x, and a ramp of slope 3/4, down along +x.
/// let wall = StaticPlane::new(DVec3::X * 2.0, DVec3::NEG_X)?;
/// let ramp = StaticPlane::new(DVec3::ZERO, DVec3::new(0.6, 0.8, 0.0))?;
/// assert_eq!(wall.distance(DVec3::ZERO), 2.0);
/// # Ok::<(), InvalidValue>(())
/// ```
///
/// On a ramp a box accelerates by g (sin θ − µ cos θ). It rests if µ exceeds tan θ:
///
/// ```
/// use bevy::prelude::*;
/// use bevy::time::TimeUpdateStrategy;
/// use box_physics::prelude::*;
/// fn slide(friction: f64) -> Result<DVec3, BevyError> {
///     let mut app = App::new();
///     app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
///         .insert_resource(Time::<Fixed>::from_hz(50.0))
///         .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
///     app.update();
///     let ramp = StaticPlane::new(DVec3::ZERO, DVec3::new(0.6, 0.8, 0.0))?;
///     app.world_mut().spawn((ramp, Friction::new(friction)?));
///     // A box of 1 m that lies on it.
///     let attitude = DQuat::from_rotation_z(-f64::atan2(0.6, 0.8));
///     let start = BodyState::at_pose(0.5 * ramp.normal, attitude);
///     let body = app.world_mut().spawn((RigidBox::default(), start)).id();
///     for _ in 0..50 {
///         app.update();
///     }
///     let state = app.world().get::<BodyState>(body).ok_or("no body")?;
///     Ok(state.position - start.position)
/// }
/// let way = 0.5 * 9.81 * (0.6 - 0.5 * 0.8);
/// assert!((slide(0.5)? - way * DVec3::new(0.8, -0.6, 0.0)).length() < 1e-12);
/// assert!(slide(0.76)?.length() < 1e-15);
/// # Ok::<(), BevyError>(())
/// ```
///
/// A plane with a `velocity` is a conveyor belt on a slope, or a wall that pushes. The plugin moves `point` along the
/// normal in every step. Bodies do not sleep while a plane moves.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Clone, PartialEq)
)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(alias("half-space", "wall", "ramp"))]
pub struct StaticPlane {
    /// A point of the plane \[m\].
    pub point: DVec3,
    /// The unit normal, toward the side of the bodies.
    pub normal: DVec3,
    /// Velocity [m/s], world axes. Default 0.
    #[cfg_attr(feature = "serde", serde(default))]
    pub velocity: DVec3,
}

impl Default for StaticPlane {
    /// y = 0, with the bodies above.
    fn default() -> Self {
        Self {
            point: DVec3::ZERO,
            normal: DVec3::Y,
            velocity: DVec3::ZERO,
        }
    }
}

impl StaticPlane {
    /// Creates the plane through `point` \[m\] with this `normal` of any nonzero length.
    ///
    /// # Errors
    /// [`InvalidValue`] if the point is not finite, or the normal has no direction.
    pub fn new(point: impl Into<DVec3>, normal: impl Into<DVec3>) -> Result<Self, InvalidValue> {
        let (point, normal) = (point.into(), normal.into());
        let normal = normal.try_normalize().unwrap_or(DVec3::ZERO);
        let plane = Self {
            point,
            normal,
            ..Self::default()
        };
        plane.validate().map(|()| plane)
    }

    /// Sets the velocity [m/s], world axes.
    pub fn with_velocity(self, velocity: impl Into<DVec3>) -> Self {
        Self {
            velocity: velocity.into(),
            ..self
        }
    }

    /// Moves the plane to its place after a step of `h` \[s\]. The plugin does this.
    pub fn advance(&mut self, h: f64) {
        self.point += self.normal * (self.velocity.dot(self.normal) * h);
    }

    /// Checks the fields.
    ///
    /// # Errors
    /// [`InvalidValue`] if point or velocity is not finite, or the normal's length is not 1 within 1e-6.
    pub fn validate(&self) -> Result<(), InvalidValue> {
        let length = self.normal.length();
        for (field, v) in [("point", self.point), ("velocity", self.velocity)] {
            InvalidValue::check(v.is_finite(), field, v.element_sum(), "finite")?;
        }
        let unit = (length - 1.0).abs() <= 1e-6;
        InvalidValue::check(unit, "normal", length, "of length 1")
    }

    /// Signed distance of `point` from the plane \[m\].
    pub fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point)
    }
}

/// A plane with its surface, for the core: the [`Floor`], or a [`StaticPlane`].
///
/// ```
/// use box_physics::floor::{ContactState, Plane, PlanesContext};
/// use box_physics::force::Gravity;
/// use box_physics::prelude::*;
/// // A die slides along the floor into a wall and comes to rest there.
/// let wall = Plane::new(StaticPlane::new(DVec3::X * 0.1, DVec3::NEG_X)?, 0.0, 0.2)?;
/// let planes = [Plane::from(Floor::new(0.0, 0.0, 0.2)?), wall];
/// let (die, settings) = (RigidBox::cube(0.016, 0.004)?, ContactSettings::default());
/// let weight = Gravity(DVec3::new(0.0, -9.81, 0.0));
/// let context = PlanesContext { planes: &planes, settings: &settings, body: &die, force: &weight };
/// let mut state = BodyState::at(DVec3::Y * 0.008).with_velocity(DVec3::X);
/// let (mut memory, mut contact) = (IntegratorMemory::default(), ContactState::default());
/// for _ in 0..60 {
///     let h = 1.0 / 60.0;
///     Integrator::Split.step_on_planes(&context, &mut state, h, &mut memory, &mut contact, None);
/// }
/// assert!(contact.is_resting(&state) && (state.position.x - 0.092).abs() < 1e-12);
/// # Ok::<(), InvalidValue>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    pub(super) shape: StaticPlane,
    /// Surface and velocity; for the floor also the height.
    pub(super) surface: Floor,
    /// From axes in which the plane is level to the world; `None` for the floor.
    pub(super) axes: Option<DQuat>,
}

impl From<Floor> for Plane {
    fn from(floor: Floor) -> Self {
        Self {
            shape: StaticPlane {
                point: DVec3::Y * floor.height,
                normal: DVec3::Y,
                velocity: floor.velocity,
            },
            surface: floor,
            axes: None,
        }
    }
}

impl Plane {
    /// Creates a plane with restitution 0 to 1 and friction ≥ 0.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first field out of range.
    pub fn new(shape: StaticPlane, restitution: f64, friction: f64) -> Result<Self, InvalidValue> {
        shape.validate()?;
        let surface = Floor::new(0.0, restitution, friction)?.with_velocity(shape.velocity);
        let normal = shape.normal.normalize();
        let shape = StaticPlane { normal, ..shape };
        // The shortest turn from the vertical. If the plane faces down, half a turn about x comes first.
        let (from, first) = if normal.y < 0.0 {
            (DVec3::NEG_Y, DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0))
        } else {
            (DVec3::Y, DQuat::IDENTITY)
        };
        let axis = from.cross(normal);
        let turn = DQuat::from_xyzw(axis.x, axis.y, axis.z, 1.0 + from.dot(normal));
        Ok(Self {
            shape,
            surface,
            axes: Some(turn.normalize() * first),
        })
    }

    /// Creates a plane with this surface. Missing or invalid coefficients are those of the default [`Floor`].
    ///
    /// # Errors
    /// [`InvalidValue`] if `shape` is not valid.
    pub fn of(
        shape: StaticPlane,
        friction: Option<&Friction>,
        restitution: Option<&Restitution>,
    ) -> Result<Self, InvalidValue> {
        let friction = friction.copied().filter(|own| own.validate().is_ok());
        let friction = friction.unwrap_or_default();
        let restitution = restitution.copied().filter(|own| own.validate().is_ok());
        let e = restitution.unwrap_or_default().coefficient;
        let mut plane = Self::new(shape, e, friction.dynamic_coefficient)?;
        let holds = friction.static_coefficient;
        plane.surface.static_friction = (holds > friction.dynamic_coefficient).then_some(holds);
        Ok(plane)
    }

    /// Combines the plane with the surface of a body ([`Floor::against`]).
    pub fn against(self, friction: Option<&Friction>, restitution: Option<&Restitution>) -> Self {
        Self {
            surface: self.surface.against(friction, restitution),
            ..self
        }
    }

    /// Moves the plane to its place after a step of `h` \[s\] of all bodies.
    pub fn advance(&mut self, h: f64) {
        match self.axes {
            None => {
                self.surface.advance(h);
                *self = Self::from(self.surface);
            }
            Some(_) => self.shape.advance(h),
        }
    }

    /// Position, normal and velocity of the plane.
    pub fn shape(&self) -> StaticPlane {
        self.shape
    }

    /// Height of a point over the plane \[m\], with the floor's order of operations.
    pub(in crate::floor) fn height(&self, point: DVec3) -> f64 {
        match self.axes {
            None => point.y - self.surface.height,
            Some(_) => self.shape.distance(point),
        }
    }

    /// Returns `true` if the plane does not move.
    pub(super) fn is_fixed(&self) -> bool {
        self.shape.velocity == DVec3::ZERO
    }

    /// The same plane in a frame with this velocity [m/s].
    pub(super) fn seen_from(mut self, velocity: DVec3) -> Self {
        self.shape.velocity -= velocity;
        self.surface.velocity -= velocity;
        self
    }

    /// Returns the plane's surface as a floor, and the frame in which that floor is level and at rest.
    pub(super) fn level(&self, state: &BodyState) -> (Floor, Frame) {
        let axes = Axes {
            turn: self.axes.unwrap_or(DQuat::IDENTITY),
            origin: self.shape.point,
            height: self.scale(state),
        };
        let floor = Floor {
            height: axes.height,
            ..self.surface
        };
        (floor, Frame::new(self.surface.velocity, Some(axes)))
    }

    /// The same plane without its position.
    pub(super) fn anywhere(mut self) -> Self {
        self.shape.point = DVec3::ZERO;
        self.surface.height = 0.0;
        self
    }

    /// Velocity of the plane along its normal [m/s].
    pub(super) fn rise(&self) -> f64 {
        self.surface.velocity.dot(self.shape.normal)
    }

    /// All numbers that affect rest on the plane.
    pub(super) fn numbers(self) -> impl Iterator<Item = f64> {
        let (shape, s) = (&self.shape, &self.surface);
        let vectors = [shape.point, shape.normal, s.velocity];
        let holds = s.static_friction.unwrap_or(-1.0);
        let level = f64::from(u8::from(self.axes.is_none()));
        let rest = [s.restitution, s.friction, holds, s.height, level];
        vectors.into_iter().flat_map(|v| v.to_array()).chain(rest)
    }

    /// Scale of the numbers from which heights are computed \[m\].
    pub(super) fn scale(&self, state: &BodyState) -> f64 {
        match self.axes {
            None => self.surface.height.abs(),
            Some(_) => self.shape.point.length() + (state.position - self.shape.point).length(),
        }
    }
}
