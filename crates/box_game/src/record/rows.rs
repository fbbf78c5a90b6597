//! After every step: its counts, and the rows of the log while one is open: one for the main box, one for
//! each comparison that has taken a step.

use bevy::diagnostic::{DiagnosticsStore, FrameCount};
use bevy::prelude::*;
use box_physics::prelude::{
    BodyState, GlobalIntegrator, Integrator, PhysicsClock, PhysicsTimings, Quarantined,
};

use super::csv_log::{CsvLog, Row};
use super::history::{History, frame_time};
use crate::action::Action;
use crate::compare::sampling::IntegratorSamples;
use crate::compare::track::Track;
use crate::compare::{Comparison, Quantity};
use crate::platform;
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
    let opened = platform::next_free("run", "csv")
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
    let event = core::mem::take(&mut session.events).join("; ");
    let (Some(mut log), Some((state, quarantined))) = (log, main_box.iter().next()) else {
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
    let main_box = &run.main_box;
    let (main_integrator, main_track) = (integrator.0, &main_box.track);
    let mut rows = vec![Row {
        sim_t_s: clock.time(),
        dt_s: clock.step() * f64::from(substeps),
        substeps,
        rhs_evals: timings.integrator(integrator.0).outcome.evaluations,
        contacts: main_box.simulation.driver.contacts(),
        state: if quarantined {
            Status::Quarantined
        } else {
            main_box.simulation.status()
        },
        event,
        ..measured(
            &common,
            main_integrator,
            (&*run.law, state),
            main_track,
            &samples,
        )
    }];
    for (trajectory, runner) in (1..).zip(&mut run.comparisons) {
        let (simulation, track) = (&runner.simulation, &runner.track);
        let driver = &simulation.driver;
        if driver.totals.steps == runner.logged {
            continue;
        }
        runner.logged = driver.totals.steps;
        let skew = core::mem::take(&mut runner.skew);
        let now = (&*simulation.model, &driver.state);
        rows.push(Row {
            trajectory,
            sim_t_s: driver.time,
            dt_s: runner.factor * run.step,
            substeps: 1,
            rhs_evals: driver.totals.evaluations / driver.totals.steps.max(1),
            contacts: driver.contacts(),
            state: simulation.status(),
            event: if skew > 0.0 {
                format!("input {skew:e} s late")
            } else {
                String::new()
            },
            ..measured(&common, driver.integrator, now, track, &samples)
        });
    }
    for row in rows {
        if let Err(error) = log.write(&row) {
            session.notice(format!("log closed: {error}"));
            commands.remove_resource::<CsvLog>();
            return;
        }
    }
}

/// The columns that every trajectory has.
fn measured(
    common: &Row,
    integrator: Integrator,
    (law, state): (&Model, &BodyState),
    track: &Track,
    samples: &IntegratorSamples,
) -> Row {
    let cost = samples.cost(integrator);
    let known = |quantity| Some(track.now.sample.get(quantity)).filter(|v| v.is_finite());
    Row {
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
