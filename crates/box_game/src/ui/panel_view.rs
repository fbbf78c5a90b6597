//! Fills the panel's view from the world.

use bevy::diagnostic::DiagnosticsStore;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use box_physics::energy::potential_energy;
use box_physics::prelude::{
    BodyState, Floor, GlobalIntegrator, Integrator, PhysicsClock, Quarantined, RigidBox,
};
use box_scenarios::Status;

use crate::compare::Comparison;
use crate::compare::sampling::IntegratorSamples;
use crate::compare::view::compare_view;
use crate::demo_2012::Demo2012;
use crate::interaction::undo::UndoStack;
use crate::platform;
use crate::preferences::Preferences;
use crate::record::csv_log::CsvLog;
use crate::record::history::{History, frame_time};
use crate::scene::library::SceneLibrary;
use crate::scene::session::{MainBox, Session};
use crate::ui::panel::{DemoView, FIGURES, PanelView};
use crate::view::renderer::PictureTarget;

/// Sources of the view.
#[derive(SystemParam)]
pub struct Sources<'w, 's> {
    session: Res<'w, Session>,
    integrator: Res<'w, GlobalIntegrator>,
    comparison: Res<'w, Comparison>,
    clock: Res<'w, PhysicsClock>,
    history: Res<'w, History>,
    samples: Res<'w, IntegratorSamples>,
    diagnostics: Option<Res<'w, DiagnosticsStore>>,
    log: Option<Res<'w, CsvLog>>,
    floor: Option<Res<'w, Floor>>,
    adapter: Option<Res<'w, RenderAdapterInfo>>,
    target: Option<Res<'w, PictureTarget>>,
    library: Res<'w, SceneLibrary>,
    undo: Res<'w, UndoStack>,
    demo: Res<'w, Demo2012>,
    /// The panel follows their scale and may change it.
    pub(crate) preferences: ResMut<'w, Preferences>,
    main_box:
        Query<'w, 's, (&'static RigidBox, &'static BodyState, Has<Quarantined>), With<MainBox>>,
}

/// The view of this frame.
pub fn view(s: &Sources) -> PanelView {
    let session = &*s.session;
    let open = s.preferences.show_plots && !session.hidden;
    let (figures, state) = main_box(s).unwrap_or_default();
    let timed = Integrator::ALL.iter().filter(|_| open);
    PanelView {
        scenario: session.scenario.clone(),
        scenes: s.library.scenes().to_vec(),
        integrator: s.integrator.0,
        paused: s.clock.paused,
        time: s.clock.elapsed().as_secs_f64(),
        steps: s.clock.steps(),
        speed: session.speed,
        actual_speed: s.history.actual_speed(),
        dropped: s.clock.dropped().as_secs_f64(),
        parameters: session.parameters,
        defaults: session.defaults,
        figures,
        state,
        timings: Integrator::ALL
            .iter()
            .map(|&i| (s.samples.cost(i), s.samples.evaluations(i)))
            .collect(),
        fallbacks: session.fallbacks,
        unconverged: session.unconverged,
        stages_us: s.samples.plugin(),
        stage_history: s.samples.plugin_steps().collect(),
        grain: s.samples.is_coarse().then(|| {
            let grain = s.samples.grain.as_secs_f64() * 1e6;
            (grain, s.samples.uncertainty)
        }),
        frame_time_ms: frame_time(s.diagnostics.as_deref()).unwrap_or(0.0),
        timing_history: timed.map(|&i| s.samples.history(i).collect()).collect(),
        cpu_history: s.history.cpu.iter().copied().filter(|_| open).collect(),
        no_cpu: platform::CPU_USAGE.err(),
        compare: compare_view(
            &s.comparison,
            &s.samples,
            open.then_some(session.plot),
            session.parameters.boxes(),
        ),
        show_help: session.show_help,
        hidden: session.hidden,
        plot: session.plot,
        log: s
            .log
            .as_ref()
            .map(|log| (log.path.display().to_string(), log.rows)),
        software_rendering: (s.target.as_deref())
            .is_some_and(|target| target.is_slow(s.adapter.as_deref())),
        notices: session.notices.iter().cloned().collect(),
        preferences: *s.preferences,
        scene_errors: s.library.errors(),
        undoes: s.undo.undoes(),
        redoes: s.undo.redoes(),
        show_picker: session.show_picker,
        demo: (session.scenario.id == crate::demo_2012::SCENE).then(|| demo(&s.demo)),
    }
}

/// Values of the main box, and its state.
fn main_box(s: &Sources) -> Option<([f64; FIGURES.len()], Status)> {
    let (body, state, quarantined) = s.main_box.iter().next()?;
    let forces = s.session.forces();
    let law = forces.forces(body);
    let floor = s.floor.as_deref().map_or(0.0, |f| f.height);
    let translational = state.translational_energy(body);
    let rotational = state.rotational_energy(body);
    let base = -body.mass() * law.acceleration.y * floor;
    let potential = potential_energy(body, state, &law) - base;
    let figures = [
        translational,
        rotational,
        potential,
        translational + rotational + potential,
        state.angular_momentum.length(),
        state.velocity.length(),
        state.body_angular_velocity(body).length(),
        state.position.x,
        state.position.y,
        state.position.z,
    ];
    let run = s.comparison.run.as_ref();
    let status = run.map_or(Status::Ok, |run| run.main_box.simulation.status());
    let frozen = quarantined.then_some(Status::Quarantined);
    Some((figures, frozen.unwrap_or(status)))
}

fn demo(demo: &Demo2012) -> DemoView {
    DemoView {
        stepper: demo.stepper,
        fault: demo.fault(),
        cycle_us: demo.cycle_ns as f64 * 1e-3,
        log: demo
            .log()
            .map(|(path, cycles)| (path.display().to_string(), cycles)),
    }
}
