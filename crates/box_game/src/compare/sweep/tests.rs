use super::*;
use box_scenarios::Scenario;

fn task(setup: &Setup, integrators: &[Integrator]) -> SweepTask {
    SweepTask::new(setup.clone(), 1, integrators.to_vec())
}

fn swept(setup: &Setup, integrators: &[Integrator]) -> Sweep {
    let mut sweep = Sweep::default();
    sweep.start(task(setup, integrators)).expect("a thread");
    sweep.wait();
    sweep
}

/// The fitted orders of the flip are the claimed orders of the integrators for rotation.
#[test]
fn orders_are_found() {
    let mut setup = Scenario::find("throw").expect("a scene").setup;
    setup.duration = 2.0;
    let integrators = [
        Integrator::SymmetricTop,
        Integrator::Rk4,
        Integrator::SemiImplicitEuler,
        Integrator::Exact,
    ];
    let sweep = swept(&setup, &integrators);
    assert_eq!(sweep.progress(), (32, 32));
    let lines = sweep.lines();
    for (line, order) in lines.iter().zip([Some(2.0), Some(4.0), Some(1.0), None]) {
        assert_eq!(line.points.len(), RATES.len());
        match (line.order(false), order) {
            (Fitted::Order(found), Some(order)) => {
                assert!((found - order).abs() < 0.2, "{}: {found}", line.integrator);
            }
            (found, None) => assert_eq!(found, Fitted::Rounding, "{}", line.integrator),
            (found, _) => panic!("{}: {found}", line.integrator),
        }
        assert!(line.points.iter().all(|p| p.cost > 0.0));
    }
}

/// Without a formula the reference is a fine simulation; a diverged point is a gap.
#[test]
fn scenes_without_a_formula_and_divergence() {
    let mut setup = Scenario::find("contact").expect("a scene").setup;
    setup.duration = 0.5;
    let sweep = swept(&setup, &[Integrator::Split]);
    assert!(sweep.lines()[0].points.iter().all(|p| p.position < 1.0));
    let setup = Scenario::find("needle").expect("a scene").setup;
    let sweep = swept(&setup, &[Integrator::SemiImplicitEuler]);
    let points = &sweep.lines()[0].points;
    assert!(points[0].attitude.is_nan() && points[0].cost.is_nan());
}

#[test]
fn it_can_be_canceled_and_dropped() {
    let setup = Scenario::find("heavy-top").expect("a scene").setup;
    let mut sweep = Sweep::default();
    let all = task(&setup, Integrator::ALL);
    sweep.start(all).expect("a thread");
    sweep.cancel();
    assert!(!sweep.is_running());
    let (done, total) = sweep.progress();
    assert!(done < total);
    let one = task(&setup, &[Integrator::Rk4]);
    sweep.start(one).expect("a thread");
    drop(sweep);
}

/// The work is cut into slices, as in a browser, and a coarse clock does not prevent it.
#[test]
fn a_sweep_in_slices_under_a_coarse_clock() {
    for scene in ["throw", "contact", "heavy-top"] {
        let mut setup = Scenario::find(scene).expect("a scene").setup;
        setup.duration = 0.5;
        // After a push the reference is unknown.
        let task = SweepTask {
            grain: Duration::from_micros(100),
            ..task(&setup, &[Integrator::Split, Integrator::Rk4])
        };
        let (shared, mut slices) = (Arc::new(Shared::of(&task.integrators)), 1);
        let mut work = Work::new(task, &shared);
        while work.slice() {
            slices += 1;
        }
        // 16 points of 3 samples of 50 grains are 240 ms: 30 slices of 8 ms.
        assert!(slices >= 20, "{scene}: {slices} slices");
        let lines = shared.lines.lock().expect("not poisoned");
        assert_eq!(lines.len(), 2);
        let points = lines.iter().flat_map(|l| &l.points);
        assert!(points.clone().all(|p| p.cost > 0.0), "{scene}");
        assert!(points.clone().all(|p| p.attitude < 180.0), "{scene}");
    }
}

/// Many boxes in fine steps are timed in parts, which would otherwise block a frame for long. The cost is the same.
#[test]
fn a_long_course_is_timed_in_parts() {
    use std::sync::atomic::AtomicU64;
    static LONGEST: AtomicU64 = AtomicU64::new(0);
    let mut setup = Scenario::find("throw").expect("a scene").setup;
    setup.duration = 10.0;
    let task = SweepTask {
        boxes: 100,
        stopwatch: |work| {
            let nanoseconds = 30 * work();
            LONGEST.fetch_max(nanoseconds, Ordering::Relaxed);
            Duration::from_nanos(nanoseconds)
        },
        ..task(&setup, &[Integrator::Rk4])
    };
    let shared = Arc::new(Shared::of(&task.integrators));
    let mut work = Work::new(task, &shared);
    while work.slice() {}
    let lines = shared.lines.lock().expect("not poisoned");
    let steps: Vec<f64> = lines[0].points.iter().map(|p| p.cost * p.dt).collect();
    assert!(
        steps.iter().all(|ns| (ns - steps[0]).abs() < 1e-6),
        "{steps:?}"
    );
    // At 1920 Hz, 32 boxes are simulated.
    let course = 19_200.0 * 32.0 * steps[0];
    let part = LONGEST.load(Ordering::Relaxed) as f64 / course;
    assert!(part > 0.0 && part < 0.5, "{part} of a course at once");
}
