//! A made-up view, for tests of the panel and of its callers.

use box_bench::measure::Cost;
use box_physics::prelude::{DVec3, Integrator};

use super::view::{HistoryView, IntegratorTiming, MainBoxView, PanelView};

use crate::action::Plot;
use crate::compare::{CompareView, Quantity, TrajectoryView};
use crate::parameters::Parameters;
use crate::preferences::Preferences;
use crate::scene::library::SceneCard;
use box_scenarios::Scenario;

/// A plausible moment of a game: everything filled, nothing extreme.
#[doc(hidden)]
pub fn sample_view() -> PanelView {
    let parameters = Parameters {
        step: 1.0 / 60.0,
        substeps: 1.0,
        gravity: 9.81,
        restitution: Some(0.5),
        restitution_law: Some(0.0),
        friction: Some(0.6),
        linear_drag: 0.0,
        angular_damping: 0.0,
        half_extents: DVec3::new(0.5, 0.25, 0.125),
        mass: 2.0,
        impulse: 1.0,
        boxes: 1.0,
    };
    PanelView {
        scenes: ["playground", "throw", "dzhanibekov"]
            .map(|id| SceneCard::of(&Scenario::find(id).expect("built in")))
            .into(),
        scene: "playground".into(),
        title: "Playground".into(),
        lesson: "The box rests on the floor. Press D to push it, and watch the energy.".into(),
        integrator: Integrator::default(),
        paused: false,
        time: 12.35,
        steps: 741,
        speed: 1.0,
        actual_speed: Some(1.0),
        dropped: 0.0,
        parameters,
        defaults: parameters,
        main_box: MainBoxView {
            translational_energy: 1.5,
            rotational_energy: 0.25,
            potential_energy: 4.9,
            angular_momentum: 0.125,
            speed: 1.22,
            spin: 3.0,
            position: DVec3::new(0.1, 0.25, -0.3),
            state: Default::default(),
        },
        timings: Integrator::ALL
            .iter()
            .enumerate()
            .map(|(k, &integrator)| {
                let median = 60.0 + 45.0 * k as f64;
                IntegratorTiming {
                    integrator,
                    cost: Some(Cost::of(&[0.9 * median, median, 1.3 * median])),
                    evaluations: f64::from(integrator.info().evaluations.free),
                }
            })
            .collect(),
        fallbacks: 0,
        unconverged: 0,
        stages_us: Some([0.5, 0.1, 0.1, 0.1]),
        stage_history: vec![[0.5, 0.1, 0.1, 0.1]; 120],
        frame_time_ms: 16.7,
        history: HistoryView {
            timing: (0..Integrator::ALL.len())
                .map(|s| {
                    (0..60)
                        .map(|k| (f64::from(k) / 4.0, 60.0 + 45.0 * s as f64))
                        .collect()
                })
                .collect(),
            cpu: (0..30).map(|k| (f64::from(k), 12.0, 30.0)).collect(),
            ..HistoryView::default()
        },
        compare: sample_comparison(),
        show_help: false,
        hidden: false,
        plot: Plot::Energy,
        log: None,
        software_rendering: false,
        notices: Vec::new(),
        preferences: Preferences::default(),
        hints: Default::default(),
        scene_errors: Vec::new(),
        undoes: None,
        redoes: None,
        show_picker: false,
        demo: None,
    }
}

/// The main box and two comparisons, two seconds in.
fn sample_comparison() -> CompareView {
    let trajectories = [
        Integrator::default(),
        Integrator::Rk4,
        Integrator::SemiImplicitEuler,
    ];
    CompareView {
        trajectories: trajectories
            .iter()
            .enumerate()
            .map(|(k, &integrator)| {
                let error = 1e-6 * 100_f64.powi(k as i32);
                TrajectoryView {
                    integrator,
                    main_box: k == 0,
                    dt: 1.0 / 60.0,
                    skew: 0.0,
                    status: Default::default(),
                    cost: Some(Cost::of(&[50.0, 60.0, 80.0])),
                    run_cost: Some(3600.0),
                    evaluations: 1.0,
                    now: [error; Quantity::ALL.len()],
                    worst: (error, error),
                    late: None,
                    energies: [1.5, 0.25, 4.9],
                    lines: Quantity::ALL
                        .iter()
                        .map(|&quantity| {
                            let points = (0..120)
                                .map(|n| [f64::from(n) / 60.0, error * f64::from(n) / 119.0])
                                .collect();
                            (quantity, points)
                        })
                        .collect(),
                }
            })
            .collect(),
        attitude: true,
        reference: "closed form".into(),
        conservative: true,
        ..CompareView::default()
    }
}
