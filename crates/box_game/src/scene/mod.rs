//! The current scene: its parameters, start and clock, and the scene files.

mod boxes;
pub(crate) mod clock;
pub mod library;
pub mod session;
pub mod start;

use bevy::prelude::*;
use box_physics::prelude::{PhysicsSchedule, PhysicsSystems};

/// Opens and starts scenes, sets their parameters, and runs their clock.
pub fn plugin(app: &mut App) {
    app.add_observer(start::on_action)
        .add_observer(clock::on_action)
        .add_observer(library::on_action)
        .add_systems(
            PhysicsSchedule,
            start::apply_timed_impulses.in_set(PhysicsSystems::First),
        )
        .add_systems(Update, library::watch_scenes);
}
