//! The comparison's panel for other Bevy apps: a window with the integrators to tick, error, energy,
//! work–precision and the table.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use box_game::compare::ComparePlugin;
//! use box_game::ui::panel_plugin::PanelPlugin;
//! use box_game::scene::session::Hero;
//! use box_physics::prelude::*;
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, PhysicsPlugins::default()))
//!     .add_plugins((ComparePlugin, PanelPlugin))
//!     .add_systems(Startup, |mut commands: Commands| {
//!         commands.spawn(Camera3d::default());
//!         commands.spawn((RigidBox::default(), Transform::from_xyz(0.0, 5.0, 0.0), Hero));
//!     })
//!     .run();
//! ```

use bevy::prelude::*;
use bevy_egui::{EguiContexts, EguiPlugin, EguiPrimaryContextPass, egui};
use box_physics::prelude::PhysicsClock;

use crate::action::{Action, Plot};
use crate::compare::fill::compare_view;
use crate::compare::sampling::{IntegratorSamples, sample_integrators};
use crate::compare::{CompareAction, Comparison, copy};
use crate::ui::panel::{PanelMemory, comparison_window};

/// Shows a [`Comparison`] in a window of its own, and carries out what is asked in it. Adds `EguiPlugin`
/// if the app has none, and [`ComparePlugin`](crate::compare::ComparePlugin) likewise.
pub struct PanelPlugin;

/// What the window keeps between frames.
#[derive(Resource, Default)]
pub struct ComparisonWindow {
    /// The tab that is open.
    pub plot: Plot,
    memory: PanelMemory,
    asked: Vec<CompareAction>,
}

impl Plugin for PanelPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<EguiPlugin>() {
            app.add_plugins(EguiPlugin::default());
        }
        if !app.is_plugin_added::<crate::compare::ComparePlugin>() {
            app.add_plugins(crate::compare::ComparePlugin);
        }
        app.init_resource::<ComparisonWindow>()
            .init_resource::<IntegratorSamples>()
            .add_systems(EguiPrimaryContextPass, show)
            .add_systems(Update, (sample_integrators, carry_out));
    }
}

fn show(
    mut contexts: EguiContexts,
    comparison: Res<Comparison>,
    samples: Res<IntegratorSamples>,
    clock: Res<PhysicsClock>,
    mut window: ResMut<ComparisonWindow>,
) -> Result {
    let context = contexts.ctx_mut()?;
    let window = &mut *window;
    let view = compare_view(&comparison, &samples, Some(window.plot), 1);
    let mut asked = Vec::new();
    egui::Window::new("Integrators")
        .default_size([560.0, 320.0])
        .show(context, |ui| {
            ui.label(format!("t = {:.3} s", clock.time()));
            comparison_window(ui, &view, window.plot, &mut window.memory, &mut asked);
        });
    for action in asked {
        match action {
            Action::SelectPlot(plot) => window.plot = plot,
            Action::Compare(action) => window.asked.push(action),
            _ => {}
        }
    }
    Ok(())
}

fn carry_out(world: &mut World) {
    let mut window = world.resource_mut::<ComparisonWindow>();
    let plot = window.plot;
    for action in core::mem::take(&mut window.asked) {
        match action {
            CompareAction::Copy => {
                let said = copy::copy(world, plot);
                info!("{said}");
            }
            action => crate::compare::apply(world, action),
        }
    }
}
