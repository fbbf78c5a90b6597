//! An invented view, for tests of the panel and of code that uses the view.

use box_bench::measure::Cost;
use box_physics::prelude::{DVec3, Integrator};
use box_scenarios::{Scenario, Status};

use super::super::PanelView;
use crate::action::Plot;
use crate::compare::{CompareView, Quantity, TrajectoryView};
use crate::parameters::Parameters;
use crate::preferences::Preferences;

/// A plausible moment of a game: everything filled, nothing extreme.
pub(crate) fn sample_view() -> PanelView {
    let scenes = ["playground", "throw", "dzhanibekov"];
    let scenes = scenes.map(|id| Scenario::find(id).expect("built in"));
    let parameters = Parameters {
        restitution: Some(0.5),
        friction: Some(0.6),
        half_extents: DVec3::new(0.5, 0.25, 0.125),
        mass: 2.0,
        impulse: 1.0,
        ..Parameters::of(&scenes[0])
    };
    let scenario = Scenario {
        lesson: "The box rests on the floor. Press D to push it, and watch the energy.",
        hints: [""; 2],
        ..scenes[0].clone()
    };
    let median = |k: usize| 60.0 + 45.0 * k as f64;
    let timing = |integrator: &Integrator| {
        let samples = [0.9, 1.0, 1.3].map(|part| part * median(integrator.index()));
        let evaluations = integrator.info().evaluations.free;
        (Some(Cost::of(&samples)), f64::from(evaluations))
    };
    let past = |k| (0..60).map(|n| (f64::from(n) / 4.0, median(k))).collect();
    PanelView {
        scenario,
        scenes: scenes.into(),
        integrator: Integrator::default(),
        paused: false,
        time: 12.35,
        steps: 741,
        speed: 1.0,
        actual_speed: Some(1.0),
        dropped: 0.0,
        parameters,
        defaults: parameters,
        figures: [1.5, 0.25, 4.9, 6.65, 0.125, 1.22, 3.0, 0.1, 0.25, -0.3],
        state: Status::Ok,
        timings: Integrator::ALL.iter().map(timing).collect(),
        fallbacks: 0,
        unconverged: 0,
        stages_us: Some([0.5, 0.1, 0.1, 0.1]),
        stage_history: vec![[0.5, 0.1, 0.1, 0.1]; 120],
        grain: None,
        frame_time_ms: 16.7,
        timing_history: (0..Integrator::ALL.len()).map(past).collect(),
        cpu_history: (0..30).map(|k| (f64::from(k), 12.0, 30.0)).collect(),
        no_cpu: None,
        compare: sample_comparison(),
        show_help: false,
        hidden: false,
        plot: Plot::Energy,
        log: None,
        software_rendering: false,
        notices: Vec::new(),
        preferences: Preferences::default(),
        scene_errors: Vec::new(),
        undoes: None,
        redoes: None,
        show_picker: false,
        demo: None,
    }
}

/// The main box and two comparisons, two seconds in.
fn sample_comparison() -> CompareView {
    let trajectory = |(integrator, error): (Integrator, f64)| TrajectoryView {
        integrator,
        main_box: integrator == Integrator::default(),
        dt: 1.0 / 60.0,
        skew: 0.0,
        status: Status::Ok,
        cost: Some(Cost::of(&[50.0, 60.0, 80.0])),
        run_cost: Some(3600.0),
        evaluations: 1.0,
        now: [error; Quantity::ALL.len()],
        worst: (error, error),
        late: None,
        energies: [1.5, 0.25, 4.9],
        lines: Quantity::ALL
            .map(|quantity| {
                let point = |n| [f64::from(n) / 60.0, error * f64::from(n) / 119.0];
                (quantity, (0..120).map(point).collect())
            })
            .into(),
    };
    CompareView {
        trajectories: [
            (Integrator::default(), 1e-6),
            (Integrator::Rk4, 1e-4),
            (Integrator::SemiImplicitEuler, 1e-2),
        ]
        .map(trajectory)
        .into(),
        attitude: true,
        reference: "closed form".into(),
        conservative: true,
        ..CompareView::default()
    }
}
