//! One plane that is not level: the step in axes in which it is, where it is the problem of the floor under tilted
//! gravity. The integrator stays in the world.

use glam::{DQuat, DVec3};

use super::{Plane, PlanesContext};
use crate::body::RigidBox;
use crate::floor::frame::Method;
use crate::floor::ground::BodyStep;
use crate::floor::motion::Supported;
use crate::floor::step::in_floor_frame;
use crate::floor::{ContactReport, Floor, FloorContext, FloorOutcome};
use crate::force::{Damping, Dissipation, ForceModel, Wrench};
use crate::integrators::StepOutcome;
use crate::state::BodyState;

/// The axes of a plane: y along its normal, the origin below the plane by `height`, so that the floor's tolerance is
/// relative to the scene's size here as well.
#[derive(Clone, Copy)]
struct Axes {
    /// From these axes to the world.
    turn: DQuat,
    origin: DVec3,
    height: f64,
}

impl Axes {
    fn point_to_world(self, point: DVec3) -> DVec3 {
        self.origin + self.turn * (point - DVec3::Y * self.height)
    }

    fn to_world(self, state: &BodyState) -> BodyState {
        BodyState {
            position: self.point_to_world(state.position),
            rotation: self.turn * state.rotation,
            velocity: self.turn * state.velocity,
            ..*state
        }
    }

    fn to_plane(self, state: &BodyState) -> BodyState {
        let back = self.turn.inverse();
        BodyState {
            position: back * (state.position - self.origin) + DVec3::Y * self.height,
            rotation: back * state.rotation,
            velocity: back * state.velocity,
            ..*state
        }
    }
}

/// A force model in the axes of a plane.
struct Turned<'a, F> {
    inner: &'a F,
    /// The integrator in the world.
    method: &'a Method<F>,
    axes: Axes,
}

impl<F: ForceModel> Turned<'_, F> {
    /// Does a step of the integrator in the world.
    fn in_world(
        &self,
        state: &mut BodyState,
        step: impl FnOnce(&mut BodyState) -> StepOutcome,
    ) -> StepOutcome {
        let mut world = self.axes.to_world(state);
        let outcome = step(&mut world);
        *state = self.axes.to_plane(&world);
        outcome
    }

    /// The torque is in body axes, which are the same.
    fn turned(&self, mut wrench: Wrench) -> Wrench {
        wrench.force = self.axes.turn.inverse() * wrench.force;
        wrench
    }
}

impl<F: ForceModel> ForceModel for Turned<'_, F> {
    fn acceleration(&self) -> DVec3 {
        self.axes.turn.inverse() * self.inner.acceleration()
    }

    fn dissipation(&self) -> Dissipation {
        let world = self.inner.dissipation();
        let wind = self.axes.turn.inverse() * world.wind;
        Dissipation { wind, ..world }
    }

    fn has_dissipation(&self) -> bool {
        self.inner.has_dissipation()
    }

    fn has_wrench(&self) -> bool {
        self.inner.has_wrench()
    }

    fn wrench(&self, body: &RigidBox, state: &BodyState) -> Wrench {
        self.turned(self.inner.wrench(body, &self.axes.to_world(state)))
    }

    fn elastic_wrench(&self, body: &RigidBox, state: &BodyState) -> Wrench {
        let world = self.axes.to_world(state);
        self.turned(self.inner.elastic_wrench(body, &world))
    }

    fn damping(&self) -> Damping {
        self.inner.damping()
    }
}

/// The step at one plane. A state that comes back as it was is the state that it was, to the last bit.
pub(super) fn step_at<F: ForceModel>(
    context: &PlanesContext<'_, F>,
    plane: &Plane,
    method: &Method<F>,
    step: BodyStep<'_>,
) -> FloorOutcome {
    let state = step.state;
    let axes = Axes {
        turn: plane.axes.unwrap_or(DQuat::IDENTITY),
        origin: plane.shape.point,
        height: plane.scale(state),
    };
    let force = Turned {
        inner: context.force,
        method,
        axes,
    };
    let carried = plane.surface.velocity;
    let floor = Floor {
        height: axes.height,
        velocity: axes.turn.inverse() * carried,
        ..plane.surface
    };
    let in_axes = FloorContext {
        floor: &floor,
        settings: context.settings,
        body: context.body,
        force: &force,
    };
    let in_world = Method {
        step: |body, state, force: &Turned<F>, h, memory| {
            force.in_world(state, |s| {
                (force.method.step)(body, s, force.inner, h, memory)
            })
        },
        supported: |body, state, force: &Supported<Turned<F>>, h, memory| {
            let (turned, turn) = (force.inner, force.inner.axes.turn);
            let law = Supported {
                inner: turned.inner,
                acceleration: turn * force.acceleration,
                torque: turn * force.torque,
            };
            turned.in_world(state, |s| {
                (turned.method.supported)(body, s, &law, h, memory)
            })
        },
        errs_in_gravity: method.errs_in_gravity,
    };
    // The plane's velocity leaves and comes back in the world: whoever moves with it is at rest to the last bit.
    let start = axes.to_plane(&BodyState {
        velocity: state.velocity - carried,
        ..*state
    });
    let mut end = start;
    let mut found = step.report.is_some().then(ContactReport::default);
    let mut in_its_axes = BodyStep {
        state: &mut end,
        report: found.as_mut(),
        ..step
    };
    let h = in_its_axes.h;
    let outcome = in_floor_frame(&in_axes, &in_world, &mut in_its_axes, None);
    if end != start || carried != DVec3::ZERO {
        let velocity = axes.turn * end.velocity + carried;
        in_axes.to_world(&mut end, h);
        *state = axes.to_world(&end);
        state.velocity = velocity;
        state.renormalize();
    }
    if let (Some(report), Some(mut found)) = (step.report, found) {
        found.points = found.points.map(|point| axes.point_to_world(point));
        found.tangential_impulse = axes.turn * found.tangential_impulse;
        found.normal = plane.shape.normal;
        *report = found;
    }
    outcome
}
