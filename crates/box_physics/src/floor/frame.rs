//! The frame of a surface, in which the surface is level and at rest. Contact and energy are computed in it. At the
//! start of the step it coincides with the world, or with the axes of a tilted plane. Integrator and forces use world
//! coordinates.

use glam::{DQuat, DVec3};

use super::FloorContext;
use super::motion::Supported;
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::integrators::{Integrate, IntegratorMemory, Order, StepOutcome};
use crate::state::BodyState;

/// [`Integrate::step`] under the forces `F`.
type Step<F> = fn(&RigidBox, &mut BodyState, &F, f64, &mut IntegratorMemory) -> StepOutcome;

/// An integrator as a value instead of a type parameter, so that contact is compiled once for all integrators.
pub(super) struct Method<F> {
    /// A step without the floor.
    pub(super) step: Step<F>,
    /// A step with corners held.
    pub(super) supported: for<'s> fn(
        &RigidBox,
        &mut BodyState,
        &Supported<'s, F>,
        f64,
        &mut IntegratorMemory,
    ) -> StepOutcome,
    /// `true` if the integrator has order 1 in uniform gravity. A closed form would hide that error.
    pub(super) errs_in_gravity: bool,
}

impl<F: ForceModel> Method<F> {
    pub(super) fn of<S: Integrate>() -> Self {
        Self {
            step: S::step::<F>,
            supported: |body, state, force, h, memory| S::step(body, state, force, h, memory),
            errs_in_gravity: matches!(S::INFO.orders.gravity, Order::Of(1)),
        }
    }
}

/// The axes of a tilted plane: y along its normal, with the origin below the plane by `height`. The tolerance is thus
/// relative to the size of the scene.
#[derive(Clone, Copy)]
pub(super) struct Axes {
    /// Rotation from these axes to the world.
    pub(super) turn: DQuat,
    pub(super) origin: DVec3,
    pub(super) height: f64,
}

/// Transformation between a frame and the world. If they coincide, no bit changes.
pub(super) struct Frame {
    /// The velocity of the surface [m/s], world axes.
    velocity: DVec3,
    axes: Option<Axes>,
    /// `true` if the frame moves or is turned.
    differs: bool,
}

impl Frame {
    pub(super) fn new(velocity: DVec3, axes: Option<Axes>) -> Self {
        Self {
            velocity,
            axes,
            differs: velocity != DVec3::ZERO || axes.is_some(),
        }
    }

    #[inline(always)]
    pub(super) fn is_world(&self) -> bool {
        !self.differs
    }

    /// Returns `true` if the surface has a velocity.
    pub(super) fn moves(&self) -> bool {
        self.velocity != DVec3::ZERO
    }

    /// Returns `true` if the frame is turned.
    pub(super) fn is_turned(&self) -> bool {
        self.axes.is_some()
    }

    /// Converts a state to the world, `elapsed` \[s\] after the start of the step.
    #[inline(always)]
    pub(super) fn to_world(&self, state: &mut BodyState, elapsed: f64) {
        if self.differs {
            state.position = self.point(state.position, elapsed);
            state.rotation = self
                .axes
                .map_or(state.rotation, |a| a.turn * state.rotation);
            state.velocity = self.vector(state.velocity) + self.velocity;
        }
    }

    /// The opposite of [`Frame::to_world`].
    #[inline(always)]
    pub(super) fn to_surface(&self, state: &mut BodyState, elapsed: f64) {
        if self.differs {
            state.position -= self.velocity * elapsed;
            state.velocity -= self.velocity;
            if let Some(axes) = &self.axes {
                let back = axes.turn.inverse();
                state.position = back * (state.position - axes.origin) + DVec3::Y * axes.height;
                state.rotation = back * state.rotation;
                state.velocity = back * state.velocity;
            }
        }
    }

    /// World position of a point of the frame.
    #[inline(always)]
    pub(super) fn point(&self, point: DVec3, elapsed: f64) -> DVec3 {
        if self.is_world() {
            return point;
        }
        let turned = |axes: Axes| axes.origin + axes.turn * (point - DVec3::Y * axes.height);
        self.axes.map_or(point, turned) + self.velocity * elapsed
    }

    /// A vector of the frame in world axes.
    pub(super) fn vector(&self, v: DVec3) -> DVec3 {
        self.axes.map_or(v, |axes| axes.turn * v)
    }

    /// The opposite of [`Frame::vector`].
    pub(super) fn vector_to_surface(&self, v: DVec3) -> DVec3 {
        self.axes.map_or(v, |axes| axes.turn.inverse() * v)
    }
}

/// A level floor, in whose frame contact is solved. Among several planes only its body and forces matter.
pub(super) struct Level<'a, F> {
    /// The floor of the frame; the forces are in the world.
    pub(super) context: &'a FloorContext<'a, F>,
    pub(super) method: &'a Method<F>,
    pub(super) frame: Frame,
    /// The uniform acceleration in the frame [m/s²].
    pub(super) pull: DVec3,
    /// |c| at which a corner touches \[m\].
    pub(super) tolerance: f64,
    /// The circumradius of the box \[m\].
    pub(super) radius: f64,
}

impl<'a, F: ForceModel> Level<'a, F> {
    pub(super) fn new(
        context: &'a FloorContext<'a, F>,
        method: &'a Method<F>,
        frame: Frame,
    ) -> Self {
        Self {
            context,
            method,
            pull: frame.vector_to_surface(context.force.acceleration()),
            frame,
            tolerance: context.tolerated_height(),
            radius: context.body.radius(),
        }
    }

    /// Advances a state of the frame by `tau` \[s\] with `step`, in the world.
    pub(super) fn in_world(
        &self,
        state: &mut BodyState,
        elapsed: f64,
        tau: f64,
        step: impl FnOnce(&mut BodyState) -> StepOutcome,
    ) -> StepOutcome {
        self.frame.to_world(state, elapsed);
        let outcome = step(state);
        self.frame.to_surface(state, elapsed + tau);
        outcome
    }

    /// Advances a state of the frame without contact.
    pub(super) fn fly(
        &self,
        state: &mut BodyState,
        elapsed: f64,
        tau: f64,
        memory: &mut IntegratorMemory,
    ) -> StepOutcome {
        let (body, force) = (self.context.body, self.context.force);
        self.in_world(state, elapsed, tau, |state| {
            (self.method.step)(body, state, force, tau, memory)
        })
    }

    /// Returns `true` if only the uniform acceleration can add energy in the frame. A wrench may, and so may moving air.
    pub(super) fn bounds_energy(&self) -> bool {
        let force = self.context.force;
        let blown = self.frame.moves() || force.dissipation().wind != DVec3::ZERO;
        !(force.has_wrench() || blown && force.has_dissipation())
    }
}
