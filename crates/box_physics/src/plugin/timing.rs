//! Timing of stages and integrators. Measured around loops, never per body, stored in one resource and published
//! through Bevy's `DiagnosticsStore` under `box_physics/…`.

use std::sync::LazyLock;

use bevy::app::{App, Plugin};
use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::ecs::reflect::ReflectResource;
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::{Res, ResMut};
use bevy::platform::time::Instant;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};

use super::{PhysicsSchedule, PhysicsSystems};
use crate::floor::FloorOutcome;
use crate::integrators::{Integrator, StepOutcome};

/// The stages of a step that are timed.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Clone, PartialEq)]
pub enum Stage {
    /// Bodies in free flight.
    Integrate,
    /// Bodies at the floor.
    Contact,
    /// Bounding boxes.
    Refit,
    /// `Transform`s.
    Writeback,
}

impl Stage {
    /// Every stage, in the order of a step.
    pub const ALL: [Self; 4] = [Self::Integrate, Self::Contact, Self::Refit, Self::Writeback];

    const PATHS: [&'static str; 4] = [
        "box_physics/integrate",
        "box_physics/contact",
        "box_physics/refit",
        "box_physics/writeback",
    ];

    /// Name of the stage in lower case.
    pub fn name(self) -> &'static str {
        Self::PATHS[self as usize].trim_start_matches("box_physics/")
    }

    /// Path of its diagnostic: `box_physics/integrate`, …, in microseconds.
    pub fn path(self) -> DiagnosticPath {
        DiagnosticPath::new(Self::PATHS[self as usize])
    }
}

/// Timing of one integrator in the last step.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, Clone, PartialEq)]
pub struct IntegratorTiming {
    /// Number of bodies stepped in free flight.
    pub bodies: u64,
    /// Time of these steps \[ns\].
    pub nanoseconds: u64,
    /// Force evaluations, fallbacks and unconverged iterations, in flight and at the floor.
    pub outcome: StepOutcome,
}

impl IntegratorTiming {
    /// Time per body-step \[ns\]; `None` if no body was stepped.
    pub fn per_body(&self) -> Option<f64> {
        (self.bodies > 0).then(|| self.nanoseconds as f64 / self.bodies as f64)
    }
}

/// Timings of the last step. Present with [`PhysicsDiagnosticsPlugin`]; without it nothing is timed.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::plugin::Stage;
/// use box_physics::prelude::*;
/// fn show(timings: Res<PhysicsTimings>) {
///     let floor = timings.stage(Stage::Contact) as f64 / 1000.0;
///     println!("{floor:.1} µs for {} bodies at the floor", timings.bodies_at_floor);
///     if let Some(ns) = timings.integrator(Integrator::Split).per_body() {
///         println!("split: {ns:.0} ns a body");
///     }
/// }
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugins::default())).add_systems(Update, show);
/// app.update();
/// ```
#[derive(Resource, Reflect, Clone, Debug)]
#[reflect(Resource, Default, Clone)]
pub struct PhysicsTimings {
    stages: [u64; 4],
    integrators: Vec<IntegratorTiming>,
    /// Impacts, reached limits and recoveries at the floor in the last step.
    pub floor: FloorOutcome,
    /// Number of bodies that *Contact* stepped.
    pub bodies_at_floor: u64,
}

impl Default for PhysicsTimings {
    fn default() -> Self {
        Self {
            stages: [0; 4],
            integrators: vec![IntegratorTiming::default(); Integrator::ALL.len()],
            floor: FloorOutcome::default(),
            bodies_at_floor: 0,
        }
    }
}

impl PhysicsTimings {
    /// Time of a stage in the last step \[ns\].
    pub fn stage(&self, stage: Stage) -> u64 {
        self.stages[stage as usize]
    }

    /// Time of all stages in the last step \[ns\].
    pub fn total(&self) -> u64 {
        self.stages.iter().sum()
    }

    /// Timing of an integrator in the last step.
    pub fn integrator(&self, integrator: Integrator) -> IntegratorTiming {
        self.integrators[integrator.index()]
    }

    pub(crate) fn begin_step(&mut self) {
        self.integrators.fill(IntegratorTiming::default());
        self.floor = FloorOutcome::default();
        self.bodies_at_floor = 0;
        self.stages = [0; 4];
    }

    /// Adds to the time of a stage \[ns\].
    pub(crate) fn record_stage(&mut self, stage: Stage, nanoseconds: u64) {
        self.stages[stage as usize] += nanoseconds;
    }

    pub(crate) fn record_integrator(
        &mut self,
        integrator: Integrator,
        bodies: u64,
        nanoseconds: u64,
        outcome: StepOutcome,
    ) {
        let entry = &mut self.integrators[integrator.index()];
        entry.bodies += bodies;
        entry.nanoseconds += nanoseconds;
        entry.outcome += outcome;
    }
}

/// Times consecutive pieces of work, if enabled.
pub(crate) struct LapTimer(Option<Instant>);

impl LapTimer {
    pub(crate) fn start(wanted: bool) -> Self {
        Self(wanted.then(Instant::now))
    }

    /// Time since the start or the last lap \[ns\]; 0 if nothing is timed.
    pub(crate) fn lap(&mut self) -> u64 {
        let Some(last) = &mut self.0 else {
            return 0;
        };
        let now = Instant::now();
        let spent = now - core::mem::replace(last, now);
        u64::try_from(spent.as_nanos()).unwrap_or(u64::MAX)
    }
}

/// Path of an integrator's diagnostic: `box_physics/integrator/split`, …, in ns per body-step.
pub fn integrator_path(integrator: Integrator) -> DiagnosticPath {
    // Created once and leaked: a path of static text is cloned without an allocation, and one is cloned in every step.
    static PATHS: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
        let path = |i: &Integrator| format!("box_physics/integrator/{i}").leak() as &str;
        Integrator::ALL.iter().map(path).collect()
    });
    DiagnosticPath::new(PATHS[integrator.index()])
}

/// Times every stage and integrator, and publishes the results. Without this plugin nothing is timed.
///
/// ```
/// use bevy::diagnostic::DiagnosticsStore;
/// use bevy::prelude::*;
/// use box_physics::prelude::*;
/// fn show(store: Res<DiagnosticsStore>) {
///     let step = store.get(&PhysicsDiagnosticsPlugin::STEP);
///     if let Some(microseconds) = step.and_then(|d| d.smoothed()) {
///         println!("physics: {microseconds:.0} µs a step");
///     }
/// }
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct PhysicsDiagnosticsPlugin;

impl PhysicsDiagnosticsPlugin {
    /// Path of the diagnostic of the whole step \[µs\].
    pub const STEP: DiagnosticPath = DiagnosticPath::const_new("box_physics/step");
}

impl Plugin for PhysicsDiagnosticsPlugin {
    fn is_unique(&self) -> bool {
        false
    }

    fn build(&self, app: &mut App) {
        if app.is_plugin_added::<Self>() {
            return;
        }
        app.init_resource::<PhysicsTimings>()
            .register_type::<PhysicsTimings>()
            .register_type::<Stage>();
        app.register_diagnostic(Diagnostic::new(Self::STEP).with_suffix(" µs"));
        for stage in Stage::ALL {
            app.register_diagnostic(Diagnostic::new(stage.path()).with_suffix(" µs"));
        }
        for &integrator in Integrator::ALL {
            app.register_diagnostic(
                Diagnostic::new(integrator_path(integrator)).with_suffix(" ns"),
            );
        }
        app.add_systems(
            PhysicsSchedule,
            publish
                .after(PhysicsSystems::Writeback)
                .before(PhysicsSystems::Last),
        );
    }
}

fn publish(timings: Res<PhysicsTimings>, mut diagnostics: Diagnostics) {
    let microseconds = |ns: u64| ns as f64 * 1e-3;
    diagnostics.add_measurement(&PhysicsDiagnosticsPlugin::STEP, || {
        microseconds(timings.total())
    });
    for stage in Stage::ALL {
        diagnostics.add_measurement(&stage.path(), || microseconds(timings.stage(stage)));
    }
    for &integrator in Integrator::ALL {
        if let Some(ns) = timings.integrator(integrator).per_body() {
            diagnostics.add_measurement(&integrator_path(integrator), || ns);
        }
    }
}

/// Resets the timings at the start of a step.
pub(crate) fn begin_step(timings: Option<ResMut<PhysicsTimings>>) {
    if let Some(mut timings) = timings {
        timings.begin_step();
    }
}
