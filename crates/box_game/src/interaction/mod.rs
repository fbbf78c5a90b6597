//! What hands can do: poke a face, drag the box on a spring, go back in time, take back a change.
//!
//! [`pick`]: where a ray meets the box; [`grab`]: the spring; [`rewind`]: the ring of past states;
//! [`undo`]: parameters and resets; [`mouse`]: gestures to actions (needs a camera).

pub mod grab;
pub mod mouse;
pub mod pick;
pub mod rewind;
pub mod undo;

use bevy::prelude::*;
use box_physics::prelude::{ApplyImpulse, BodyState};

use crate::action::Poke;
use crate::demo_2012;
use crate::scene::session::{Hero, Session};

/// Everything but the mouse: runs without a window.
pub struct InteractionPlugin;

impl Plugin for InteractionPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<grab::Grip>()
            .init_resource::<rewind::Rewind>()
            .init_resource::<undo::UndoStack>()
            .add_systems(FixedUpdate, (rewind::record, grab::pull).chain());
    }
}

/// An impulse at a point of the hero's surface, against its normal.
pub fn poke(world: &mut World, poke: Poke) {
    let strength = world.resource::<Session>().parameters.impulse * poke.strength;
    let hero = world
        .query_filtered::<(Entity, &BodyState), With<Hero>>()
        .iter(world)
        .next()
        .map(|(entity, state)| (entity, *state));
    let Some((entity, state)) = hero else {
        return;
    };
    let impulse = state.rotation * -poke.normal.normalize_or_zero() * strength;
    if !(impulse.is_finite() && poke.normal.is_finite() && poke.body_point.is_finite()) {
        world
            .resource_mut::<Session>()
            .notice(format!("not possible: {poke:?}"));
        return;
    }
    world.write_message(ApplyImpulse::at_body_point(
        entity,
        impulse,
        poke.body_point,
    ));
    demo_2012::push(world, impulse, poke.body_point);
    world.resource_mut::<Session>().perturb(format!(
        "poke {:.3} {:.3} {:.3} N s",
        impulse.x, impulse.y, impulse.z
    ));
}
