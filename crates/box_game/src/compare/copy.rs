//! Contents of the open tab, as CSV text for the clipboard.

use bevy::prelude::*;

use super::Comparison;
use super::series::Quantity;
use crate::action::Plot;
use crate::platform;
use crate::scene::session::Session;

/// Formats a number; empty if it is not finite.
fn figure(value: f64) -> String {
    if value.is_finite() {
        format!("{value:e}")
    } else {
        String::new()
    }
}

/// The visible window of every trajectory: one row per sample and integrator.
fn window_csv(comparison: &Comparison) -> String {
    let columns = Quantity::ALL.map(Quantity::column).join(",");
    let mut text = format!("sim_t_s,integrator,{columns}\n");
    let Some(run) = &comparison.run else {
        return text;
    };
    let window = comparison.settings.window.seconds();
    for r in run.trajectories() {
        let integrator = r.integrator();
        for sample in r.track.series.recent(window) {
            let values = sample.values.map(figure).join(",");
            text += &format!("{:.9},{integrator},{values}\n", sample.t);
        }
    }
    text
}

fn sweep_csv(comparison: &Comparison) -> String {
    let mut text = String::from("integrator,dt_s,pos_err_m,rot_err_deg,cost_ns_per_s\n");
    for line in comparison.sweep.lines() {
        for p in &line.points {
            let errors = [p.position, p.attitude, p.cost].map(figure).join(",");
            text += &format!("{},{:e},{errors}\n", line.integrator, p.dt);
        }
    }
    text
}

/// The table: one row per trajectory, with its current values.
fn table_csv(comparison: &Comparison) -> String {
    let mut text = String::from(
        "integrator,main_box,dt_s,sim_t_s,max_pos_err_m,max_rot_err_deg,energy_rel,angmom_rel,diverged_at_s\n",
    );
    let Some(run) = &comparison.run else {
        return text;
    };
    for r in run.trajectories() {
        let (integrator, step) = (r.integrator(), r.factor * run.step);
        let (sample, (distance, angle)) = (&r.track.now.sample, r.track.now.worst);
        let end = r.simulation.diverged;
        text += &format!(
            "{integrator},{},{step},{},{distance:e},{angle:e},{:e},{:e},{}\n",
            integrator == run.main_box.integrator(),
            sample.t,
            sample.get(Quantity::Energy),
            sample.get(Quantity::Momentum),
            end.map_or_else(String::new, |d| d.t.to_string())
        );
    }
    text
}

/// Copies the contents of the open tab and shows a notice.
pub(crate) fn copy_plot(world: &mut World) {
    let comparison = world.resource::<Comparison>();
    let text = match world.resource::<Session>().plot {
        Plot::WorkPrecision => sweep_csv(comparison),
        Plot::Table => table_csv(comparison),
        Plot::Error | Plot::Energy | Plot::Timing | Plot::Cpu => window_csv(comparison),
    };
    let rows = text.lines().count() - 1;
    let said = match platform::copy(world, &text) {
        true => format!("copied {rows} rows as CSV"),
        false => "nothing copied: the clipboard is not available".to_owned(),
    };
    world.resource_mut::<Session>().notice(said);
}
