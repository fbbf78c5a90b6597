//! Records of a run: CSV log, time series for the plots, screenshots.

pub mod csv_log;
pub mod history;
mod rows;
pub(crate) mod screenshot;

use bevy::prelude::*;
use box_physics::prelude::{PhysicsSchedule, PhysicsSystems};

use crate::compare::plugin::after_step;

/// Adds the CSV log and the time series of the plots.
pub fn plugin(app: &mut App) {
    app.init_resource::<history::History>()
        .init_resource::<screenshot::Pictures>()
        .add_observer(rows::on_action)
        .add_systems(
            PhysicsSchedule,
            rows::write_rows
                .in_set(PhysicsSystems::Last)
                .after(after_step),
        )
        .add_systems(Update, history::record);
}

/// Adds screenshots. Needs a renderer.
pub fn pictures_plugin(app: &mut App) {
    app.init_resource::<screenshot::PlotArea>()
        .add_observer(screenshot::on_action)
        .add_systems(Update, (screenshot::take_screenshot, screenshot::film));
}
