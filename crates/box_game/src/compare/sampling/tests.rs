use super::*;

fn load(h: f64) -> Load {
    Load {
        scene: String::new(),
        h,
        boxes: 1,
        floor: false,
        forced: false,
    }
}

fn sample(nanoseconds: f64) -> Sample {
    Sample {
        nanoseconds,
        evaluations: 1.0,
    }
}

/// One second after a change, the figures contain no earlier samples, and never a sample older than two seconds.
#[test]
fn nothing_is_older_than_two_seconds_or_of_another_load() {
    let mut samples = IntegratorSamples::default();
    let split = Integrator::Split;
    for n in 0_u32..600 {
        let time = f64::from(n) / 60.0;
        samples.begin(time, load(0.1));
        samples.record(split, time, sample(if n < 300 { 900.0 } else { 20.0 }));
        samples.record_plugin(time, n.into(), &PhysicsTimings::default());
        let recent = samples.each[split.index()].recent.front();
        let plugin = samples.plugin.front().map(|s| s.0);
        let oldest = recent.map(|s| s.0).into_iter().chain(plugin);
        assert!(oldest.map(|t| time - t).all(|age| age <= WINDOW));
    }
    assert_eq!(samples.cost(split), Some(Cost::of(&[20.0])));
    assert!(samples.plugin().is_some());
    samples.begin(10.0, load(0.2));
    assert_eq!(samples.cost(split), None);
    assert_eq!(samples.plugin(), None);
    samples.record(split, 10.0, sample(5.0));
    assert_eq!(samples.cost(split), Some(Cost::of(&[5.0])));
}

/// With a coarse clock, the last sample remains until the next one.
#[test]
fn a_coarse_clock_keeps_its_last_sample() {
    let mut samples = IntegratorSamples {
        grain: Duration::from_micros(100),
        ..IntegratorSamples::default()
    };
    samples.begin(0.0, load(0.1));
    // The very first sample, taken while a browser compiles, is discarded.
    samples.record(Integrator::Split, 0.0, sample(7000.0));
    assert_eq!(samples.cost(Integrator::Split), None);
    assert_eq!(samples.history(Integrator::Split).count(), 0);
    samples.record(Integrator::Split, 0.0, sample(9.0));
    samples.begin(10.0, load(0.1));
    assert_eq!(samples.cost(Integrator::Split), Some(Cost::of(&[9.0])));
    samples.record(Integrator::Split, 10.0, sample(5.0));
    samples.begin(10.1, load(0.1));
    assert_eq!(samples.cost(Integrator::Split), Some(Cost::of(&[5.0])));
}

/// With a clock made of force evaluations, sweep and panel measure the same costs. The dots of the work–precision plot
/// are thus on the lines of the sweep.
#[test]
fn dots_lie_on_the_lines_of_the_sweep() {
    use crate::cli::Cli;
    use crate::compare::sweep::{Sweep, SweepTask};
    use clap::Parser;

    const SECONDS: f64 = 3.0;
    // Equal in free flight, except for the first step of a memory. If an integrator iterates or touches the floor, its
    // motion in the sweep differs from the main box's.
    let mut wrong = Vec::new();
    for (scene, boxes, within) in [
        ("dzhanibekov", 1, 0.05),
        ("heavy-top", 1, 0.1),
        ("throw", 20, 0.05),
        ("contact", 1, 0.3),
    ] {
        let arguments = ["box_game", scene, "--boxes", &boxes.to_string()];
        let cli = Cli::try_parse_from(arguments).expect("valid");
        let mut app = crate::app::headless(cli);
        app.update();
        // Every integrator in every frame, on a clock of 30 ns per body-step or evaluation.
        let stopwatch: Stopwatch = |work| Duration::from_nanos(30 * work());
        let mut samples = app.world_mut().resource_mut::<IntegratorSamples>();
        (samples.stopwatch, samples.budget) = (stopwatch, Duration::from_secs(10));
        let mut session = app.world_mut().resource_mut::<Session>();
        session.scenario.setup.duration = SECONDS;
        let setup = session.setup();
        for _ in 0..(60.0 * SECONDS) as u32 {
            app.update();
        }
        let samples = app.world().resource::<IntegratorSamples>();
        let mut sweep = Sweep::default();
        let task = SweepTask {
            stopwatch,
            ..SweepTask::new(setup, boxes, Integrator::ALL.to_vec())
        };
        sweep.start(task).expect("a thread");
        sweep.wait();
        for line in sweep.lines() {
            let mut points = line.points.iter();
            let at_60_hz = points.find(|p| (p.dt * 60.0 - 1.0).abs() < 1e-9);
            let swept = at_60_hz.expect("a rate of the sweep").cost;
            let live = samples.mean_of_run(line.integrator).expect("sampled") * 60.0;
            if (live / swept - 1.0).abs() > within {
                let figures = format!("{live:.0} live, {swept:.0} swept");
                wrong.push(format!("{scene}, {}: {figures}", line.integrator));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn memory_stays_flat() {
    let mut samples = IntegratorSamples::default();
    for n in 0_u32..10_000 {
        let time = f64::from(n) * 1e-3;
        samples.begin(time, load(0.1));
        samples.record(Integrator::Split, time, sample(50.0));
        samples.record_plugin(time, n.into(), &PhysicsTimings::default());
    }
    assert_eq!(samples.history(Integrator::Split).count(), HISTORY);
    assert!(samples.each[Integrator::Split.index()].recent.len() <= 2001);
    assert!(samples.plugin.len() <= STEPS);
}
