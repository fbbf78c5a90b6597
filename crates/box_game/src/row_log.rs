//! After every step: its counts, and one row of the log while one is open.

use bevy::diagnostic::{DiagnosticsStore, FrameCount};
use bevy::prelude::*;
use box_physics::prelude::{
    BodyState, ContactPhase, FloorContact, GlobalIntegrator, Integrator, PhysicsClock,
    PhysicsTimings, Quarantined,
};

use crate::csv_log::{CsvLog, Row};
use crate::history::{History, frame_time};
use crate::sampling::SchemeSamples;
use crate::session::{Hero, Session};

/// Writes the row of the step that just ended. Runs in `PhysicsSystems::Last`.
pub fn write_row(
    log: Option<ResMut<CsvLog>>,
    mut session: ResMut<Session>,
    hero: Query<(&BodyState, Has<Quarantined>), With<Hero>>,
    (clock, integrator): (Res<PhysicsClock>, Res<GlobalIntegrator>),
    (timings, samples, history): (
        Option<Res<PhysicsTimings>>,
        Res<SchemeSamples>,
        Res<History>,
    ),
    (diagnostics, frame, real): (
        Option<Res<DiagnosticsStore>>,
        Option<Res<FrameCount>>,
        Option<Res<Time<Real>>>,
    ),
    mut contacts: MessageReader<FloorContact>,
    mut commands: Commands,
) {
    if let Some(timings) = &timings {
        for &i in Integrator::ALL {
            let outcome = timings.scheme(i).outcome;
            session.fallbacks += u64::from(outcome.fallbacks);
            session.unconverged += u64::from(outcome.unconverged);
        }
    }
    let event = core::mem::take(&mut session.events).join("; ");
    let touching = contacts
        .read()
        .filter(|c| c.phase != ContactPhase::Ended)
        .count() as u32;
    let (Some(mut log), Some((state, quarantined))) = (log, hero.iter().next()) else {
        return;
    };
    let step = clock.step();
    let t = clock.time();
    let setup = session.setup();
    let energy = setup.energy(state);
    let e0 = setup.energy(&setup.initial);
    let reference = session.truth.as_ref().and_then(|truth| truth.at(t));
    let constant = session.truth.is_some() && setup.conserves_energy();
    let statistics = samples.statistics(integrator.0);
    let outcome = timings.as_ref().map(|t| t.scheme(integrator.0).outcome);
    let cpu = history.cpu.back();
    let row = Row {
        run_id: session.run_id(),
        frame: frame.map_or(0, |f| u64::from(f.0)),
        sim_t_s: t,
        wall_t_s: real.map(|r| r.elapsed_secs_f64()),
        lane: 0,
        integrator: integrator.0.id().to_owned(),
        dt_s: step * f64::from(clock.substeps.max(1)),
        substeps: clock.substeps.max(1),
        rhs_evals: outcome.map_or(0, |o| u64::from(o.evaluations)),
        step_ns_min: statistics.map(|s| s.0),
        step_ns_med: statistics.map(|s| s.1),
        pos_err_m: reference.map(|r| (state.position - r.position).length()),
        rot_err_deg: reference.map(|r| state.attitude_difference(&r).to_degrees()),
        local_pos_err_m: None,
        energy_j: energy,
        energy_rel: (constant && e0 != 0.0).then(|| (energy - e0) / e0.abs()),
        angmom_rel: (session.truth.is_some() && setup.conserves_angular_momentum())
            .then(|| setup.angular_momentum_error(state)),
        contacts: touching,
        state: match (quarantined, touching) {
            (true, _) => "quarantined",
            (false, 0) => "ok",
            (false, _) if state.velocity.length() == 0.0 => "resting",
            (false, _) => "contact",
        }
        .to_owned(),
        cpu_process_pct: cpu.map(|c| c.1),
        cpu_system_pct: cpu.map(|c| c.2),
        frame_ms: frame_time(diagnostics.as_deref()),
        event,
    };
    if let Err(error) = log.write(&row) {
        session.notice(format!("log closed: {error}"));
        commands.remove_resource::<CsvLog>();
    }
}
