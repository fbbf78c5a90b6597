//! Several planes: walls, ramps, the tray of the dice.
//!
//! ```text
//! reach: the planes that the box can come near in this step, whatever it strikes on the way
//!   it may fly past all → the integrator's plain step
//!   one                 → step_on_floor, in the axes of that plane (frame)
//!   several             → the same events with the contacts of all of them (step, held, law)
//! ```
//!
//! A *contact* is a corner at a plane. Over several planes everything is in world axes, and each contact has its own
//! normal, friction and restitution.

mod contacts;
mod frame;
mod held;
mod law;
mod step;

#[cfg(test)]
mod tests;

use glam::{DMat3, DQuat, DVec3};

use super::bounds::{acceleration_bound, curvature_bound};
use super::frame::Method;
use super::geometry::Corners;
use super::{
    ContactReport, ContactSettings, ContactState, Floor, FloorContext, FloorOutcome, Friction,
    Restitution, may_touch_plane, step_on_floor,
};
use crate::body::RigidBox;
#[cfg(feature = "bevy")]
use crate::ecs::*;
use crate::error::InvalidValue;
use crate::force::{ForceModel, fingerprint};
use crate::integrators::{Integrate, Integrator, IntegratorMemory, IntegratorVisitor};
use crate::state::BodyState;
use contacts::PLANES;

/// A plane that bodies stay on one side of: a wall, a ramp, a ceiling. It is infinite and does not move.
///
/// With the plugin it is a component of an entity of its own, which may have a [`Friction`] and a [`Restitution`]
/// (otherwise those of the default [`Floor`] count; the rule of a body decides how they combine). `point` is best near the place where bodies touch it:
/// heights over the plane are as sharp as coordinates relative to it.
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
/// On a ramp a box slides with g (sin θ − µ cos θ), and it holds where µ exceeds tan θ:
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
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Clone, PartialEq)
)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(alias("half-shape", "wall", "ramp"))]
pub struct StaticPlane {
    /// A point of the plane \[m\].
    pub point: DVec3,
    /// The unit normal: on this side bodies are.
    pub normal: DVec3,
}

impl Default for StaticPlane {
    /// y = 0, with the bodies above.
    fn default() -> Self {
        Self {
            point: DVec3::ZERO,
            normal: DVec3::Y,
        }
    }
}

impl StaticPlane {
    /// The plane through `point` \[m\] with this `normal`, of any length but zero.
    ///
    /// # Errors
    /// [`InvalidValue`] if the point is not finite, or the normal has no direction.
    pub fn new(point: impl Into<DVec3>, normal: impl Into<DVec3>) -> Result<Self, InvalidValue> {
        let (point, normal) = (point.into(), normal.into());
        let normal = normal.try_normalize().unwrap_or(DVec3::ZERO);
        let plane = Self { point, normal };
        plane.validate().map(|()| plane)
    }

    /// Whether the fields are in their ranges, however they were set.
    ///
    /// # Errors
    /// [`InvalidValue`] if the point is not finite, or the normal's length is not 1 within 1e-6.
    pub fn validate(&self) -> Result<(), InvalidValue> {
        let (point, length) = (self.point.element_sum(), self.normal.length());
        InvalidValue::check(self.point.is_finite(), "point", point, "finite")?;
        let unit = (length - 1.0).abs() <= 1e-6;
        InvalidValue::check(unit, "normal", length, "of length 1").map(|_| ())
    }

    /// How far `point` is from the plane, along the normal \[m\].
    pub fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point)
    }
}

/// A plane and how it answers: the [`Floor`], or a [`StaticPlane`] with a surface. What the core takes.
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
    shape: StaticPlane,
    /// Its surface and velocity; of a level floor its height as well.
    surface: Floor,
    /// From axes in which the plane is level to the world; `None` for the floor.
    axes: Option<DQuat>,
}

impl From<Floor> for Plane {
    fn from(floor: Floor) -> Self {
        Self {
            shape: StaticPlane {
                point: DVec3::Y * floor.height,
                normal: DVec3::Y,
            },
            surface: floor,
            axes: None,
        }
    }
}

impl Plane {
    /// A plane with restitution 0 to 1 and friction ≥ 0.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first field out of range.
    pub fn new(shape: StaticPlane, restitution: f64, friction: f64) -> Result<Self, InvalidValue> {
        shape.validate()?;
        let surface = Floor::new(0.0, restitution, friction)?;
        let normal = shape.normal.normalize();
        let shape = StaticPlane { normal, ..shape };
        // The shortest turn from the vertical; half a turn about x first where the plane faces down.
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

    /// A plane with these surfaces; one that is missing or out of range is the default [`Floor`]'s.
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

    /// The same plane with the coefficient of static friction, at least that of kinetic friction.
    ///
    /// # Errors
    /// [`InvalidValue`] if it is smaller or not finite.
    pub fn with_static_friction(mut self, coefficient: f64) -> Result<Self, InvalidValue> {
        self.surface.static_friction = Some(coefficient);
        self.surface.validate().map(|()| self)
    }

    /// The plane as a body with these surfaces meets it ([`Floor::against`]).
    pub fn against(self, friction: Option<&Friction>, restitution: Option<&Restitution>) -> Self {
        Self {
            surface: self.surface.against(friction, restitution),
            ..self
        }
    }

    /// Where it is.
    pub fn shape(&self) -> StaticPlane {
        self.shape
    }

    /// Height of a point over the plane \[m\], in the order of operations of the floor's.
    fn height(&self, point: DVec3) -> f64 {
        match self.axes {
            None => point.y - self.surface.height,
            Some(_) => self.shape.distance(point),
        }
    }

    /// The coefficient of friction that holds.
    fn grip(&self) -> f64 {
        self.surface
            .static_friction
            .unwrap_or(self.surface.friction)
    }

    /// Its velocity along the normal [m/s].
    fn rise(&self) -> f64 {
        self.surface.velocity.dot(self.shape.normal)
    }

    /// Of everything that a body at rest on it depends on.
    fn numbers(&self) -> [f64; 14] {
        let (StaticPlane { point, normal }, s) = (&self.shape, &self.surface);
        let ([px, py, pz], [nx, ny, nz], [vx, vy, vz]) =
            (point.to_array(), normal.to_array(), s.velocity.to_array());
        let holds = s.static_friction.unwrap_or(-1.0);
        let level = f64::from(u8::from(self.axes.is_none()));
        [
            px,
            py,
            pz,
            nx,
            ny,
            nz,
            vx,
            vy,
            vz,
            s.restitution,
            s.friction,
            holds,
            s.height,
            level,
        ]
    }
}

/// A body, its force model and the planes around it: what a step among planes reads. More than six that are within reach
/// at once are not told from one another: the six nearest count.
#[derive(Clone, Copy, Debug)]
pub struct PlanesContext<'a, F> {
    /// The planes.
    pub planes: &'a [Plane],
    /// How contact is solved.
    pub settings: &'a ContactSettings,
    /// The box.
    pub body: &'a RigidBox,
    /// The forces on it, contact aside.
    pub force: &'a F,
}

/// The planes within reach.
struct Near {
    count: usize,
    planes: [Plane; PLANES],
    /// Heights of the lowest corners over them, the center's motion aside \[m\].
    gap: [f64; PLANES],
}

impl Near {
    fn planes(&self) -> &[Plane] {
        &self.planes[..self.count]
    }

    /// Adds a plane; of too many the farthest is left out.
    fn add(&mut self, plane: &Plane, gap: f64) {
        let farther = |far: usize, k: usize| if self.gap[k] > self.gap[far] { k } else { far };
        let mut place = self.count;
        if self.count < PLANES {
            self.count += 1;
        } else {
            place = (0..PLANES).fold(0, farther);
            if gap >= self.gap[place] {
                return;
            }
        }
        (self.planes[place], self.gap[place]) = (*plane, gap);
    }
}

impl<F: ForceModel> PlanesContext<'_, F> {
    /// The planes that the box can come near within `h` \[s\], whatever it strikes on the way: an impact turns its
    /// velocity and its spin, and gives no energy.
    fn near(&self, state: &BodyState, h: f64) -> Near {
        let (body, radius) = (self.body, self.body.radius());
        let twice = 2.0 * state.kinetic_energy(body);
        let pull = 2.0 * h * acceleration_bound(body, state, self.force);
        let turn = h * (twice * body.inverse_inertia().max_element()).sqrt() + h * pull / radius;
        let way = h * ((twice * body.inverse_mass()).sqrt() + pull);
        let attitude = DMat3::from_quat(state.rotation);
        let mut near = Near {
            count: 0,
            planes: [Plane::from(Floor::default()); PLANES],
            gap: [f64::INFINITY; PLANES],
        };
        for plane in self.planes {
            let height = plane.height(state.position);
            let now = reach(body, &attitude, plane.shape.normal);
            let carried = h * 2.0 * plane.surface.velocity.length();
            let turned = (now + turn * radius).min(radius);
            if height - turned <= way + carried + 4.0 * self.tolerance(state, plane) {
                near.add(plane, height - now);
            }
        }
        near
    }

    /// |c| at which a corner touches a plane \[m\]: as at the floor, relative to the box and the scene.
    fn tolerance(&self, state: &BodyState, plane: &Plane) -> f64 {
        self.settings.tolerance * (self.body.radius() + plane.scale(state))
    }
}

impl Plane {
    /// How large the numbers are that heights over it come from \[m\].
    fn scale(&self, state: &BodyState) -> f64 {
        match self.axes {
            None => self.surface.height.abs(),
            Some(_) => self.shape.point.length() + (state.position - self.shape.point).length(),
        }
    }
}

/// How far the box reaches from its center against `normal` \[m\].
fn reach(body: &RigidBox, attitude: &DMat3, normal: DVec3) -> f64 {
    let half = body.half_extents();
    attitude.x_axis.dot(normal).abs() * half.x
        + attitude.y_axis.dot(normal).abs() * half.y
        + attitude.z_axis.dot(normal).abs() * half.z
}

/// Whether the box can reach a plane within `h` \[s\]: [`may_touch`](super::may_touch) for any of them.
pub fn may_touch_planes<F: ForceModel>(
    planes: &[Plane],
    body: &RigidBox,
    state: &BodyState,
    force: &F,
    h: f64,
) -> bool {
    planes.iter().any(|plane| {
        let normal = plane.shape.normal;
        let reach = || reach(body, &DMat3::from_quat(state.rotation), normal);
        let height = plane.height(state.position);
        may_touch_plane((normal, height, plane.rise()), reach, body, state, force, h)
    })
}

/// Advances `state` by `h` \[s\] among the planes, free flight included, as [`step_on_floor`] does over one floor. A box
/// that can reach no more than one plane in the step is stepped by it, in the axes of that plane. In contact with
/// several, all contacts are solved together, in impacts and while they last.
///
/// The planes are those at the beginning of the step; if the floor among them moves, [`Floor::advance`] it afterwards.
pub fn step_on_planes<S: Integrate, F: ForceModel>(
    context: &PlanesContext<'_, F>,
    state: &mut BodyState,
    h: f64,
    memory: &mut IntegratorMemory,
    contact: &mut ContactState,
    report: Option<&mut ContactReport>,
) -> FloorOutcome {
    let mut outcome = FloorOutcome::default();
    let &PlanesContext {
        settings,
        body,
        force,
        ..
    } = context;
    let level = Floor::default();
    let mut at_one = FloorContext {
        floor: &level,
        settings,
        body,
        force,
    };
    let all = fingerprint(context.planes.iter().flat_map(Plane::numbers));
    if contact.still_rests(&at_one, Some(all), state) {
        outcome.resting = true;
        if let (Some(report), Some(rest)) = (report, &contact.rest) {
            let corners = Corners::at(&level, body, state);
            report.normal = rest.planes.map_or(DVec3::Y, |(_, normal)| normal);
            report.hold(state.position, &corners, h, &rest.reaction);
            report.end(state.position, &corners.lever, contact.touching);
        }
        return outcome;
    }
    if h <= 0.0 || !h.is_finite() || !state.is_finite() {
        return outcome;
    }
    let near = context.near(state, h);
    if let [plane] = near.planes()
        && plane.axes.is_none()
    {
        at_one.floor = &plane.surface;
        return step_on_floor::<S, F>(&at_one, state, h, memory, contact, report);
    }
    contact.rest = None;
    if contact.touching == 0 || near.count == 0 {
        let (mut end, spare) = (*state, &mut contact.spare.0[0]);
        spare.clone_from(memory);
        outcome.step = S::step(body, &mut end, force, h, spare);
        if near.count == 0 || context.clears(near.planes(), state, &end, h) {
            *state = end;
            core::mem::swap(memory, spare);
            contact.touching = 0;
            return outcome;
        }
        outcome.step = Default::default();
    }
    let method = Method::of::<S>();
    let reaction = match near.planes() {
        [plane] => {
            outcome = frame::step_at(context, plane, &method, state, h, memory, contact, report);
            let rest = contact.rest.take();
            rest.map(|rest| (rest.reaction, plane.shape.normal))
        }
        planes => {
            let reaction;
            (outcome, reaction) =
                step::step(context, planes, &method, state, h, memory, contact, report);
            reaction
        }
    };
    outcome.step.fallbacks = outcome.step.fallbacks.min(1);
    outcome.step.unconverged = outcome.step.unconverged.min(1);
    if let Some((reaction, normal)) = reaction {
        outcome.resting = true;
        contact.establish_rest(&at_one, Some((all, normal)), state, 0.0, reaction);
    }
    outcome
}

impl<F: ForceModel> PlanesContext<'_, F> {
    /// Whether no corner touches one of these planes between `start` and `end`, `h` \[s\] later, as a flight over the
    /// floor.
    fn clears(&self, planes: &[Plane], start: &BodyState, end: &BodyState, h: f64) -> bool {
        let body = self.body;
        let pull = acceleration_bound(body, start, self.force);
        let axes = [start, end].map(|s| DMat3::from_quat(s.rotation));
        planes.iter().all(|plane| {
            let normal = plane.shape.normal;
            let margin = 2.0 * self.tolerance(start, plane);
            let before = plane.height(start.position) - reach(body, &axes[0], normal);
            let after =
                plane.height(end.position) - plane.rise() * h - reach(body, &axes[1], normal);
            let curvature = curvature_bound(body, start, pull, self.force, normal);
            before > margin
                && after > margin
                && before.sqrt() + after.sqrt() >= h * (0.5 * curvature).sqrt()
        })
    }
}

impl Integrator {
    /// [`step_on_planes`] by the chosen integrator.
    pub fn step_on_planes<F: ForceModel>(
        self,
        context: &PlanesContext<'_, F>,
        state: &mut BodyState,
        h: f64,
        memory: &mut IntegratorMemory,
        contact: &mut ContactState,
        report: Option<&mut ContactReport>,
    ) -> FloorOutcome {
        self.dispatch(StepOnPlanes {
            context,
            state,
            h,
            memory,
            contact,
            report,
        })
    }
}

/// The arguments of [`Integrator::step_on_planes`].
struct StepOnPlanes<'a, 'c, F> {
    context: &'a PlanesContext<'c, F>,
    state: &'a mut BodyState,
    h: f64,
    memory: &'a mut IntegratorMemory,
    contact: &'a mut ContactState,
    report: Option<&'a mut ContactReport>,
}

impl<F: ForceModel> IntegratorVisitor for StepOnPlanes<'_, '_, F> {
    type Output = FloorOutcome;

    fn visit<S: Integrate>(self) -> FloorOutcome {
        let (state, memory, contact) = (self.state, self.memory, self.contact);
        step_on_planes::<S, F>(self.context, state, self.h, memory, contact, self.report)
    }
}
