//! Records after every step: its counts and, while a log is open, its rows. There is one row for the main box and one
//! for each comparison that has taken a step.

use bevy::diagnostic::{DiagnosticsStore, FrameCount};
use bevy::prelude::*;
use box_physics::prelude::{Integrator, PhysicsClock, PhysicsTimings, Quarantined};

use super::csv_log::{CsvLog, Row};
use super::history::{History, frame_time};
use crate::action::Action;
use crate::compare::sampling::IntegratorSamples;
use crate::compare::{Comparison, Quantity};
use crate::platform;
use crate::scene::session::{MainBox, Session};
use box_scenarios::Status;

/// Observes the switch of the log.
pub(super) fn on_action(
    action: On<Action>,
    log: Option<ResMut<CsvLog>>,
    mut session: ResMut<Session>,
    mut commands: Commands,
) {
    if *action != Action::ToggleLog {
        return;
    }
    if let Some(mut log) = log {
        let (path, rows) = (log.path.display().to_string(), log.rows);
        session.notice(match log.sync() {
            Ok(()) => format!("log closed: {path} ({rows} rows)"),
            Err(error) => format!("log closed: {path}: {error}"),
        });
        commands.remove_resource::<CsvLog>();
        return;
    }
    let opened = platform::next_free("run", "csv")
        .and_then(|path| CsvLog::create(&path, session.scenario.id, session.seed));
    match opened {
        Ok(log) => {
            session.notice(format!("logging to {}", log.path.display()));
            commands.insert_resource(log);
        }
        Err(error) => session.notice(format!("log: {error}")),
    }
}

/// Writes the rows of the step that just ended. Runs in `PhysicsSystems::Last`, after the comparison.
pub(super) fn write_rows(
    log: Option<ResMut<CsvLog>>,
    (mut session, mut comparison): (ResMut<Session>, ResMut<Comparison>),
    main_box: Query<Has<Quarantined>, With<MainBox>>,
    clock: Res<PhysicsClock>,
    (timings, samples, history): (Res<PhysicsTimings>, Res<IntegratorSamples>, Res<History>),
    (diagnostics, frame, real): (
        Option<Res<DiagnosticsStore>>,
        Res<FrameCount>,
        Res<Time<Real>>,
    ),
    mut commands: Commands,
) {
    for &i in Integrator::ALL {
        let outcome = timings.integrator(i).outcome;
        session.fallbacks += outcome.fallbacks;
        session.unconverged += outcome.unconverged;
    }
    let mut event = core::mem::take(&mut session.events).join("; ");
    let (Some(mut log), Some(quarantined)) = (log, main_box.iter().next()) else {
        return;
    };
    let Some(run) = &mut comparison.run else {
        return;
    };
    let substeps = clock.substeps.max(1);
    let cpu = history.cpu.back();
    let common = Row {
        run_id: session.run_id(),
        frame: u64::from(frame.0),
        wall_t_s: Some(real.elapsed_secs_f64()),
        cpu_process_pct: cpu.map(|c| c.1),
        cpu_system_pct: cpu.map(|c| c.2),
        frame_ms: frame_time(diagnostics.as_deref()),
        ..Row::default()
    };
    let (step, law) = (run.step, run.law.clone());
    for (trajectory, runner) in
        (0..).zip([&mut run.main_box].into_iter().chain(&mut run.comparisons))
    {
        let (main, track) = (trajectory == 0, &runner.track);
        let (driver, totals) = (&runner.simulation.driver, runner.simulation.driver.totals);
        if !main && totals.steps == runner.logged {
            continue;
        }
        let cost = samples.cost(driver.integrator);
        let known = |quantity| Some(track.now.sample.get(quantity)).filter(|v| v.is_finite());
        let model = if main { &law } else { &runner.simulation.model };
        let row = Row {
            sim_t_s: driver.time,
            trajectory,
            integrator: driver.integrator.id().to_owned(),
            dt_s: runner.factor * step * if main { f64::from(substeps) } else { 1.0 },
            substeps: if main { substeps } else { 1 },
            rhs_evals: if main {
                timings.integrator(driver.integrator).outcome.evaluations
            } else {
                totals.evaluations / totals.steps.max(1)
            },
            step_ns_min: cost.map(|c| c.min),
            step_ns_med: cost.map(|c| c.median),
            pos_err_m: known(Quantity::Position),
            rot_err_deg: known(Quantity::Attitude),
            local_pos_err_m: known(Quantity::LocalPosition),
            energy_j: model.energy(&driver.state),
            energy_rel: known(Quantity::Energy),
            angmom_rel: Some(track.now.momentum).filter(|v| v.is_finite()),
            contacts: driver.contacts(),
            state: if main && quarantined {
                Status::Quarantined
            } else {
                runner.simulation.status()
            },
            event: match runner.skew {
                _ if main => core::mem::take(&mut event),
                skew if skew > 0.0 => format!("input {skew:e} s late"),
                _ => String::new(),
            },
            ..common.clone()
        };
        (runner.logged, runner.skew) = (totals.steps, 0.0);
        if let Err(error) = log.write(&row) {
            session.notice(format!("log closed: {error}"));
            commands.remove_resource::<CsvLog>();
            return;
        }
    }
}
