//! After every step: its counts, and the rows of the log while one is open: one for the main box, one for
//! each comparison that has taken a step.

use bevy::diagnostic::{DiagnosticsStore, FrameCount};
use bevy::prelude::*;
use box_physics::prelude::{
    BodyState, GlobalIntegrator, Integrator, PhysicsClock, PhysicsTimings, Quarantined,
};

use super::csv_log::{CsvLog, Row};
use super::history::{History, frame_time};
use super::screenshot::next_free;
use crate::action::Action;
use crate::compare::runner::Runner;
use crate::compare::sampling::IntegratorSamples;
use crate::compare::track::Track;
use crate::compare::{Comparison, Quantity};
use crate::scene::session::{MainBox, Session};
use box_scenarios::{Model, Status};

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
        let (path, rows) = (log.path().display().to_string(), log.rows());
        session.notice(match log.sync() {
            Ok(()) => format!("log closed: {path} ({rows} rows)"),
            Err(error) => format!("log closed: {path}: {error}"),
        });
        commands.remove_resource::<CsvLog>();
        return;
    }
    let opened = next_free("run", "csv")
        .ok_or_else(|| std::io::Error::other("run-01.csv to run-9999.csv exist"))
        .and_then(|path| CsvLog::create(&path, session.scenario.id, session.seed));
    match opened {
        Ok(log) => {
            session.notice(format!("logging to {}", log.path().display()));
            commands.insert_resource(log);
        }
        Err(error) => session.notice(format!("log: {error}")),
    }
}

/// Writes the rows of the step that just ended. Runs in `PhysicsSystems::Last`, after the comparison.
pub(super) fn write_rows(
    log: Option<ResMut<CsvLog>>,
    (mut session, mut comparison): (ResMut<Session>, ResMut<Comparison>),
    main_box: Query<(&BodyState, Has<Quarantined>), With<MainBox>>,
    (clock, integrator): (Res<PhysicsClock>, Res<GlobalIntegrator>),
    (timings, samples, history): (
        Option<Res<PhysicsTimings>>,
        Res<IntegratorSamples>,
        Res<History>,
    ),
    (diagnostics, frame, real): (
        Option<Res<DiagnosticsStore>>,
        Option<Res<FrameCount>>,
        Option<Res<Time<Real>>>,
    ),
    mut commands: Commands,
) {
    if let Some(timings) = &timings {
        for &i in Integrator::ALL {
            let outcome = timings.integrator(i).outcome;
            session.fallbacks += outcome.fallbacks;
            session.unconverged += outcome.unconverged;
        }
    }
    let event = core::mem::take(&mut session.events).join("; ");
    let (Some(mut log), Some((state, quarantined))) = (log, main_box.iter().next()) else {
        return;
    };
    let Some(run) = &mut comparison.run else {
        return;
    };
    let substeps = clock.substeps.max(1);
    let outcome = timings.as_ref().map(|t| t.integrator(integrator.0).outcome);
    let cpu = history.cpu.back();
    let common = Row {
        run_id: session.run_id(),
        frame: frame.map_or(0, |f| u64::from(f.0)),
        wall_t_s: real.map(|r| r.elapsed_secs_f64()),
        cpu_process_pct: cpu.map(|c| c.1),
        cpu_system_pct: cpu.map(|c| c.2),
        frame_ms: frame_time(diagnostics.as_deref()),
        ..Row::default()
    };
    let mut rows = vec![Row {
        sim_t_s: clock.time(),
        dt_s: clock.step() * f64::from(substeps),
        substeps,
        rhs_evals: outcome.map_or(0, |o| o.evaluations),
        contacts: run.main_box.contacts,
        state: if quarantined {
            Status::Quarantined
        } else {
            run.main_box.status()
        },
        event,
        ..measured(
            &common,
            0,
            integrator.0,
            &run.law,
            state,
            &run.main_box.track,
            &samples,
        )
    }];
    for (k, runner) in run.comparisons.iter_mut().enumerate() {
        if runner.simulation.driver.totals.steps != runner.logged {
            rows.push(comparison_row(
                &common,
                k as u32 + 1,
                runner,
                run.step,
                &samples,
            ));
            runner.logged = runner.simulation.driver.totals.steps;
        }
    }
    for row in rows {
        if let Err(error) = log.write(&row) {
            session.notice(format!("log closed: {error}"));
            commands.remove_resource::<CsvLog>();
            return;
        }
    }
}

fn comparison_row(
    common: &Row,
    number: u32,
    runner: &mut Runner,
    step: f64,
    samples: &IntegratorSamples,
) -> Row {
    let driver = &runner.simulation.driver;
    let skew = core::mem::take(&mut runner.skew);
    Row {
        sim_t_s: driver.time,
        dt_s: runner.factor * step,
        substeps: 1,
        rhs_evals: driver.totals.evaluations / driver.totals.steps.max(1),
        contacts: driver.contacts(),
        state: runner.simulation.status(),
        event: if skew > 0.0 {
            format!("input {skew:e} s late")
        } else {
            String::new()
        },
        ..measured(
            common,
            number,
            driver.integrator,
            &runner.simulation.model,
            &driver.state,
            &runner.track,
            samples,
        )
    }
}

/// The columns that every trajectory has.
fn measured(
    common: &Row,
    trajectory: u32,
    integrator: Integrator,
    law: &Model,
    state: &BodyState,
    track: &Track,
    samples: &IntegratorSamples,
) -> Row {
    let cost = samples.cost(integrator);
    let known = |quantity| Some(track.now.sample.get(quantity)).filter(|v| v.is_finite());
    Row {
        trajectory,
        integrator: integrator.id().to_owned(),
        step_ns_min: cost.map(|c| c.min),
        step_ns_med: cost.map(|c| c.median),
        pos_err_m: known(Quantity::Position),
        rot_err_deg: known(Quantity::Attitude),
        local_pos_err_m: known(Quantity::LocalPosition),
        energy_j: law.energy(state),
        energy_rel: known(Quantity::Energy),
        angmom_rel: Some(track.now.momentum).filter(|v| v.is_finite()),
        ..common.clone()
    }
}
