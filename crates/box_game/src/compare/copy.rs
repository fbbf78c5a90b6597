//! What the open tab shows, as text for the clipboard.

use std::fmt::Write as _;
use std::iter;

use bevy::clipboard::Clipboard;
use bevy::prelude::*;
use box_physics::prelude::Integrator;
use box_scenarios::Divergence;

use super::Comparison;
use super::series::Quantity;
use super::track::Track;
use crate::action::Plot;
use crate::scene::session::Session;

/// A number, or nothing where it is not known.
fn figure(value: f64) -> String {
    if value.is_finite() {
        format!("{value:e}")
    } else {
        String::new()
    }
}

/// The visible window of every trajectory: one row per moment and integrator.
pub fn window_csv(comparison: &Comparison) -> String {
    let mut text = String::from("sim_t_s,integrator");
    for quantity in Quantity::ALL {
        text.push(',');
        text.push_str(quantity.column());
    }
    text.push('\n');
    let Some(run) = &comparison.run else {
        return text;
    };
    let window = comparison.settings.window.seconds();
    let comparisons = run.comparisons.iter().map(|r| (r.integrator(), &r.track));
    let main_box = (run.main_box.integrator, &run.main_box.track);
    for (integrator, track) in iter::once(main_box).chain(comparisons) {
        for sample in track.series.recent(window) {
            // Writing to a string cannot fail.
            let _ = write!(text, "{:.9},{integrator}", sample.t);
            for value in sample.values {
                let _ = write!(text, ",{}", figure(value));
            }
            text.push('\n');
        }
    }
    text
}

/// The lines of the sweep.
pub fn sweep_csv(comparison: &Comparison) -> String {
    let mut text = String::from("integrator,dt_s,pos_err_m,rot_err_deg,cost_ns_per_s\n");
    for line in comparison.sweep.lines() {
        for p in &line.points {
            let _ = writeln!(
                text,
                "{},{:e},{},{},{}",
                line.integrator,
                p.dt,
                figure(p.position),
                figure(p.attitude),
                figure(p.cost)
            );
        }
    }
    text
}

/// The table: one row per trajectory, as it stands now.
pub fn table_csv(comparison: &Comparison) -> String {
    let mut text = String::from(
        "integrator,main_box,dt_s,sim_t_s,max_pos_err_m,max_rot_err_deg,energy_rel,angmom_rel,diverged_at_s\n",
    );
    let Some(run) = &comparison.run else {
        return text;
    };
    let mut row = |integrator: Integrator,
                   main_box: bool,
                   dt: f64,
                   track: &Track,
                   diverged: Option<Divergence>| {
        let sample = &track.now.sample;
        let _ = writeln!(
            text,
            "{integrator},{main_box},{dt},{},{:e},{:e},{:e},{:e},{}",
            sample.t,
            track.now.worst.0,
            track.now.worst.1,
            sample.get(Quantity::Energy),
            sample.get(Quantity::Momentum),
            diverged.map_or_else(String::new, |d| d.t.to_string())
        );
    };
    let main_box = &run.main_box;
    let (own, track) = (main_box.integrator, &main_box.track);
    row(own, true, run.step, track, main_box.diverged);
    for r in &run.comparisons {
        let (dt, diverged) = (r.factor * run.step, r.simulation.diverged);
        row(r.integrator(), false, dt, &r.track, diverged);
    }
    text
}

/// Copies what the game's open tab shows and says so.
pub fn copy_plot(world: &mut World) {
    let plot = world.resource::<Session>().plot;
    let said = copy(world, plot);
    world.resource_mut::<Session>().notice(said);
}

/// Copies what a tab shows; returns what there is to say about that.
pub fn copy(world: &mut World, plot: Plot) -> String {
    let comparison = world.resource::<Comparison>();
    let text = match plot {
        Plot::WorkPrecision => sweep_csv(comparison),
        Plot::Table => table_csv(comparison),
        Plot::Error | Plot::Energy | Plot::Timing | Plot::Cpu => window_csv(comparison),
    };
    let rows = text.lines().count() - 1;
    match world.get_resource_mut::<Clipboard>() {
        Some(mut clipboard) => match clipboard.set_text(text) {
            Ok(()) => format!("copied {rows} rows as CSV"),
            Err(error) => format!("nothing copied: {error:?}"),
        },
        None => "nothing copied: there is no clipboard".to_owned(),
    }
}
