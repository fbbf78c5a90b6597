//! Opening a scene: its parameters, its camera and plot, and nothing left of the one before.

use bevy::prelude::*;
use box_physics::prelude::{GlobalIntegrator, PhysicsClock};
use box_scenarios::{PlotPreset, Scenario};

use crate::action::Plot;
use crate::apply::{set_speed, set_step};
use crate::camera::CameraRequest;
use crate::demo_2012::Demo2012;
use crate::interaction::rewind::Rewind;
use crate::interaction::undo::UndoStack;
use crate::scene::session::{Session, parameters_of, start_scene};
use crate::ui::preferences::Preferences;

/// Starts `scenario`: a new one (with its own camera and plot), or the present one read again.
pub fn open_scene(world: &mut World, scenario: Scenario, new: bool) {
    let mut session = world.resource_mut::<Session>();
    session.defaults = parameters_of(&scenario);
    session.parameters = session.defaults;
    if new {
        session.plot = plot_of(scenario.view.plot);
        session.show_picker = false;
    }
    session.scenario = scenario;
    world.resource_mut::<UndoStack>().clear();
    world.resource_mut::<Rewind>().clear();
    if new {
        world.resource_mut::<Demo2012>().stepper = Demo2012::default().stepper;
        world.insert_resource(CameraRequest::Home);
    }
    start_scene(world);
}

/// The game's plot for a scene's wish.
pub fn plot_of(preset: PlotPreset) -> Plot {
    match preset {
        PlotPreset::Error => Plot::Error,
        PlotPreset::Energy => Plot::Energy,
        PlotPreset::Timing => Plot::Timing,
        PlotPreset::WorkPrecision => Plot::WorkPrecision,
        PlotPreset::Cpu => Plot::Cpu,
        PlotPreset::Table => Plot::Table,
    }
}

/// The last rung of the ladder of resets: the game as it opens.
pub fn reset_everything(world: &mut World) {
    world.insert_resource(GlobalIntegrator::default());
    set_speed(world, 1.0);
    set_step(world, 1.0 / 60.0);
    {
        let mut clock = world.resource_mut::<PhysicsClock>();
        (clock.paused, clock.substeps) = (false, 1);
    }
    world.insert_resource(Preferences::default());
    let seed = world.resource::<Session>().seed;
    let fresh = Session::new(Scenario::default(), seed);
    let mut session = world.resource_mut::<Session>();
    let (run, notices) = (session.run, core::mem::take(&mut session.notices));
    *session = Session {
        run,
        notices,
        ..fresh
    };
    open_scene(world, Scenario::default(), true);
}
