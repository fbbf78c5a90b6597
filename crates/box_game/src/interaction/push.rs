//! Pushes along an axis and pokes at a point of the surface.

use bevy::prelude::*;
use box_physics::prelude::{ApplyImpulse, BodyState, DVec3, RigidBox};

use crate::action::{Action, Push};
use crate::demo_2012;
use crate::scene::session::{MainBox, Session};

pub(crate) fn on_action(
    action: On<Action>,
    main_box: Query<(Entity, &RigidBox, &BodyState), With<MainBox>>,
    mut session: ResMut<Session>,
    mut commands: Commands,
) {
    let Some((entity, body, state)) = main_box.iter().next() else {
        return;
    };
    let strength = session.parameters.impulse;
    let (what, impulse, point) = match *action {
        Action::Push(push) => {
            let (impulse, point) = push_impulse(push, body, state, strength);
            ("push", impulse, push.off_center.then_some(point))
        }
        Action::Poke(poke) => {
            let normal = poke.normal.try_normalize().unwrap_or(DVec3::NAN);
            let impulse = state.rotation * -normal * (strength * poke.strength);
            ("poke", impulse, Some(poke.body_point))
        }
        _ => return,
    };
    if !(impulse.is_finite() && point.is_none_or(DVec3::is_finite)) {
        session.notice(format!(
            "{what}: point, direction and strength must be finite"
        ));
        return;
    }
    let DVec3 { x, y, z } = impulse;
    session.perturb(format!("{what} {x:.3} {y:.3} {z:.3} N s"));
    commands.write_message(match point {
        Some(point) => ApplyImpulse::at_body_point(entity, impulse, point),
        None => ApplyImpulse::center(entity, impulse),
    });
    commands.queue(move |world: &mut World| {
        demo_2012::push(world, impulse, point.unwrap_or_default());
    });
}

/// Impulse of a push \[N s\], world axes, and its point in body axes: the middle of the pushed face, or of an edge of
/// that face.
fn push_impulse(push: Push, body: &RigidBox, state: &BodyState, strength: f64) -> (DVec3, DVec3) {
    let local = if push.world {
        state.rotation.inverse() * push.direction
    } else {
        push.direction
    };
    // The face whose outward normal is most nearly opposite to the push, in body axes.
    let axis = DVec3::AXES[local.abs().max_position()];
    let h = body.half_extents();
    let face = axis * (h * axis) * -local.dot(axis).signum();
    // The edge is offset along the next axis.
    let side = DVec3::new(axis.z, axis.x, axis.y);
    let off = if push.off_center {
        side * h
    } else {
        DVec3::ZERO
    };
    (state.rotation * local * strength, face + off)
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::prelude::DQuat;

    #[test]
    fn a_push_acts_along_the_box_s_own_axes_or_the_world_s() {
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid");
        let quarter = DQuat::from_xyzw(0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt());
        let state = BodyState::at_pose(DVec3::ZERO, quarter);
        let pushed = |world, off_center| {
            let push = Push {
                direction: DVec3::X,
                world,
                off_center,
            };
            push_impulse(push, &body, &state, 2.0)
        };
        let (j, point) = pushed(false, false);
        assert!((j - DVec3::Y * 2.0).length() < 1e-15);
        assert_eq!(point, DVec3::NEG_X * 0.5);
        assert!((pushed(true, false).0 - DVec3::X * 2.0).length() < 1e-15);
        // Off-center: at the edge of the face, so the push has a moment.
        assert_eq!(pushed(false, true).1, DVec3::new(-0.5, 0.25, 0.0));
    }
}
