//! CPU time of a frame of the game, without window and renderer. It covers all of the game's systems (physics,
//! comparisons and their measurement, timing of every integrator, log off), the panel with a plot open, and its
//! tessellation. `cargo bench --bench frame` prints the minimum and the median for every tab.

use std::time::Instant;

use bevy::ecs::system::SystemState;
use bevy_egui::egui;
use box_game::action::compare::CompareAction;
use box_game::action::{Action, Plot};
use box_game::app;
use box_game::cli::Cli;
use box_game::scene::session::Session;
use box_game::ui::panel::{self, PanelMemory};
use box_game::ui::panel_view::{self, Sources};
use clap::Parser;

/// Number of untimed frames of 1/60 s at the start: a full minute of plots.
const WARM_UP: u32 = 3700;
/// Number of frames timed for each tab.
const FRAMES: usize = 300;

fn main() {
    for scene in ["dzhanibekov", "bounce", "spring-orbit"] {
        let integrators = "split,exact,rk4,semi-implicit-euler,engine-rescaled,engine-newton";
        println!("{scene}, main box and 5 comparisons: a frame [ms], least and median of {FRAMES}");
        measure(&[scene, "--integrator", integrators], WARM_UP, &Plot::ALL);
    }
    for boxes in ["1000", "10000"] {
        println!(
            "load, {boxes} boxes, from the throw on, main box and 2 comparisons: a frame [ms], least and median of {FRAMES}"
        );
        measure(&["load", "--boxes", boxes], 5, &[(Plot::Timing, "timing")]);
    }
}

/// Times frames of a scene under each of `tabs`, after the first `warm_up`.
fn measure(arguments: &[&str], warm_up: u32, tabs: &[(Plot, &str)]) {
    let cli = Cli::try_parse_from([&["box_game"], arguments].concat()).expect("valid arguments");
    let mut app = app::headless(cli);
    for _ in 0..warm_up {
        app.update();
    }
    let context = egui::Context::default();
    let mut memory = PanelMemory::default();
    let mut state = SystemState::<Sources>::new(app.world_mut());
    app.world_mut()
        .trigger(Action::Compare(CompareAction::StartSweep));
    app.world_mut().flush();
    for &(plot, name) in tabs {
        app.world_mut().resource_mut::<Session>().plot = plot;
        let mut times = Vec::with_capacity(FRAMES);
        let (mut systems, mut drawing) = (f64::INFINITY, f64::INFINITY);
        for n in 0..FRAMES {
            let start = Instant::now();
            app.update();
            let updated = start.elapsed().as_secs_f64() * 1e3;
            let sources = state
                .get_mut(app.world_mut())
                .expect("every resource is there");
            let view = panel_view::view(&sources);
            let input = egui::RawInput {
                screen_rect: Some(egui::Rect::from_min_size(
                    egui::Pos2::ZERO,
                    egui::vec2(1280.0, 720.0),
                )),
                time: Some(n as f64 / 60.0),
                ..Default::default()
            };
            let mut asked = Vec::new();
            let output = context.run_ui(input, |ui| {
                panel::show(ui, &view, &mut memory, &mut asked);
            });
            std::hint::black_box(context.tessellate(output.shapes, output.pixels_per_point));
            let whole = start.elapsed().as_secs_f64() * 1e3;
            systems = systems.min(updated);
            drawing = drawing.min(whole - updated);
            times.push(whole);
        }
        times.sort_by(f64::total_cmp);
        println!(
            "  {name:<16}{:>7.2}{:>7.2}   least: systems {systems:.2}, panel {drawing:.2}",
            times[0],
            times[FRAMES / 2]
        );
    }
}
