//! Commands that teleport a body.

use bevy::ecs::entity::Entity;
use bevy::ecs::system::Command;
use bevy::ecs::world::{DeferredWorld, World};
use bevy::transform::components::Transform;
use glam::{DQuat, DVec3};
use log::warn;

use super::contacts::end_contacts;
use super::placement::{ShownBody, Unsmoothed};
use crate::body::RigidBox;
use crate::state::{BodyState, Frame};

/// Command: moves a body to another pose immediately. Its velocity is kept and its contacts end. It is displayed there
/// in this frame without smoothing, even when paused.
///
/// Velocity and spin keep their world axes: a body that flies north and spins about the vertical still does, whatever
/// its new attitude. [`with_body_spin`](Self::with_body_spin) turns the spin with the body, and [`PassPortal`] turns
/// both spin and velocity.
///
/// (Changing `Transform` also teleports the body, at the next step, and keeps velocity and spin in world axes. With
/// `bevy_transform_interpolation` the change can be lost, because smoothing restores `Transform` before each step.)
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn back_to_the_table(dice: Query<Entity, With<RigidBox>>, mut commands: Commands) {
///     for die in &dice {
///         commands.queue(Teleport::to(die, Vec3::Y).turned(DQuat::IDENTITY));
///     }
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Teleport {
    /// The body.
    pub entity: Entity,
    /// New position of the center \[m\].
    pub position: DVec3,
    /// New attitude; `None` keeps the current one.
    pub rotation: Option<DQuat>,
    /// The axes in which the angular velocity is kept when the attitude changes.
    pub spin: Frame,
}

impl Teleport {
    /// Teleports to a position \[m\]; attitude, velocity and spin are kept.
    pub fn to(entity: Entity, position: impl Into<DVec3>) -> Self {
        Self {
            entity,
            position: position.into(),
            rotation: None,
            spin: Frame::World,
        }
    }

    /// Also sets the attitude. The angular velocity is kept in world axes.
    #[must_use]
    pub fn turned(mut self, rotation: DQuat) -> Self {
        self.rotation = Some(rotation);
        self
    }

    /// Keeps the angular velocity in body axes, so that the spin turns with the body.
    #[must_use]
    pub fn with_body_spin(mut self) -> Self {
        self.spin = Frame::Body;
        self
    }

    fn apply_to(self, body: &RigidBox, state: &mut BodyState) {
        state.position = self.position;
        if let Some(rotation) = self.rotation {
            state.turn_to(body, rotation, self.spin);
        }
    }
}

impl Command for Teleport {
    type Out = ();

    fn apply(self, world: &mut World) {
        teleport(world, self.entity, |body, state| self.apply_to(body, state));
    }
}

/// Command: moves a body through a portal immediately. Position, attitude, velocity and spin relative to `entrance`
/// become those relative to `exit`.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// /// A body that crosses the entrance toward its −z leaves the exit toward the exit's −z.
/// fn pass(bodies: Query<BodyRef>, portals: Query<&Transform, Without<RigidBox>>, mut commands: Commands) {
///     let Some((entrance, exit)) = portals.iter().zip(portals.iter().skip(1)).next() else {
///         return;
///     };
///     for body in &bodies {
///         let side = entrance.rotation * Vec3::Z;
///         if (body.position.as_vec3() - entrance.translation).dot(side) < 0.0 {
///             commands.queue(PassPortal { entity: body.entity, entrance: *entrance, exit: *exit });
///         }
///     }
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassPortal {
    /// The body.
    pub entity: Entity,
    /// Pose of the entrance. Its scale is ignored.
    pub entrance: Transform,
    /// Pose of the exit. Its scale is ignored.
    pub exit: Transform,
}

impl Command for PassPortal {
    type Out = ();

    fn apply(self, world: &mut World) {
        let pose =
            |t: Transform| BodyState::at_pose(t.translation.as_dvec3(), t.rotation.as_dquat());
        let (entrance, exit) = (pose(self.entrance), pose(self.exit));
        let turn = exit.rotation * entrance.rotation.inverse();
        teleport(world, self.entity, |_, state| {
            // The angular momentum is stored in body axes, so it turns with the body.
            *state = BodyState {
                velocity: turn * state.velocity,
                angular_momentum: state.angular_momentum,
                ..BodyState::at_pose(
                    exit.position + turn * (state.position - entrance.position),
                    turn * state.rotation,
                )
            };
        });
    }
}

fn teleport(world: &mut World, entity: Entity, change: impl FnOnce(&RigidBox, &mut BodyState)) {
    let found = world.get_entity_mut(entity).ok().and_then(|mut found| {
        let body = found.get_components_mut::<ShownBody>().ok()?;
        let mut state = *body.state;
        change(body.body, &mut state);
        Some(state)
    });
    let Some(state) = found else {
        warn!("box_physics: {entity} cannot be teleported: it is not a body, or no longer one");
        return;
    };
    if !state.is_valid() {
        warn!("box_physics: {entity} cannot be teleported: the pose is not finite");
        return;
    }
    end_contacts(&mut DeferredWorld::from(&mut *world), entity);
    show_jump(world, entity, state);
}

/// Sets the state of a body and displays it in this frame without smoothing.
pub(crate) fn show_jump(world: &mut World, entity: Entity, state: BodyState) {
    if let Ok(mut found) = world.get_entity_mut(entity)
        && let Ok(mut body) = found.get_components_mut::<ShownBody>()
    {
        *body.state = state;
        let before = body.show();
        world.resource_mut::<Unsmoothed>().add(entity, before);
    }
}
