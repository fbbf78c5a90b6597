//! Cost of a step of one load, as measured by panel, headless table, sweep, report and kernel benchmark
//! [ns per body-step, minimum]. `cargo bench --bench cost`

use std::collections::HashMap;
use std::path::Path;
use std::process::Command;

use box_bench::options::Options;
use box_bench::suites;
use box_game::app;
use box_game::cli::Cli;
use box_game::compare::headless::Headless;
use box_game::compare::sampling::IntegratorSamples;
use box_game::compare::sweep::{Sweep, SweepLine, SweepPoint, SweepTask};
use box_physics::prelude::Integrator;
use box_scenarios::Scenario;
use clap::Parser;

/// Number of boxes, as in the report's situations.
const BOXES: u32 = 100;
const RATE: f64 = 60.0;
/// Number of frames: several rounds over all integrators.
const FRAMES: u32 = 300;

fn main() {
    let report = report();
    let kernels = kernels();
    for (scene, situation) in [("throw", "free-many"), ("heavy-top", "torque")] {
        let mut scenario = Scenario::find(scene).expect("a scene");
        scenario.boxes = BOXES;
        let panel = panel(scene);
        let headless = headless(&scenario);
        let sweep = sweep(&scenario);
        println!("\n{scene}, {BOXES} boxes, {RATE} Hz: ns per body-step");
        println!(
            "{:<21}{:>9}{:>10}{:>9}{:>9}{:>9}{:>20}",
            "integrator", "panel", "headless", "sweep", "report", "bench", "largest / smallest"
        );
        for &i in Integrator::ALL {
            let bench = (situation == "free-many").then(|| kernels.get(i.id()).copied());
            let found = [
                panel.get(&i).copied(),
                headless.get(&i).copied(),
                sweep.get(&i).copied(),
                report
                    .get(&(situation.to_owned(), i.id().to_owned()))
                    .copied(),
                bench.flatten(),
            ];
            let known = || found.iter().flatten().copied().filter(|ns| ns.is_finite());
            let ratio = known().fold(0.0, f64::max) / known().fold(f64::INFINITY, f64::min);
            let cell = |ns: Option<f64>| ns.map_or_else(|| "-".to_owned(), |ns| format!("{ns:.1}"));
            let [panel, headless, sweep, report, bench] = found.map(cell);
            println!(
                "{:<21}{panel:>9}{headless:>10}{sweep:>9}{report:>9}{bench:>9}{ratio:>20.2}",
                i.id()
            );
        }
    }
}

type Costs = HashMap<Integrator, f64>;

fn panel(scene: &str) -> Costs {
    let boxes = BOXES.to_string();
    let cli = Cli::try_parse_from(["box_game", scene, "--boxes", &boxes]).expect("valid");
    let mut app = app::headless(cli);
    for _ in 0..FRAMES {
        app.update();
    }
    let samples = app.world().resource::<IntegratorSamples>();
    let min = |&i: &Integrator| Some((i, samples.cost(i)?.min));
    Integrator::ALL.iter().filter_map(min).collect()
}

fn headless(scenario: &Scenario) -> Costs {
    let headless = Headless {
        scenario: scenario.clone(),
        integrators: Integrator::ALL.to_vec(),
        dt: 1.0 / RATE,
        substeps: 1,
        log: Path::new("unused.csv").to_owned(),
        seed: 0,
    };
    let costs = headless.costs().into_iter().map(|c| c.min);
    Integrator::ALL.iter().copied().zip(costs).collect()
}

fn sweep(scenario: &Scenario) -> Costs {
    let mut sweep = Sweep::default();
    let task = SweepTask::new(
        scenario.setup.clone(),
        BOXES as usize,
        Integrator::ALL.to_vec(),
    );
    sweep.start(task).expect("a thread");
    sweep.wait();
    let cost = |line: SweepLine| {
        let at = |p: &&SweepPoint| (p.dt * RATE - 1.0).abs() < 1e-9;
        let point = line.points.iter().find(at)?;
        Some((line.integrator, point.cost * point.dt))
    };
    sweep.lines().into_iter().filter_map(cost).collect()
}

/// Costs from the report's part `timing`, by situation and integrator.
fn report() -> HashMap<(String, String), f64> {
    let folder = tempfile::tempdir().expect("a folder");
    let status = Command::new(env!("CARGO"))
        // The alias means the workspace's default members.
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .args(["box-report", "timing", "--output"])
        .arg(folder.path())
        .status()
        .expect("cargo starts");
    assert!(status.success(), "the report ended with {status}");
    let mut reader = csv::Reader::from_path(folder.path().join("timing.csv")).expect("a table");
    reader
        .deserialize::<HashMap<String, String>>()
        .map(|row| {
            let row = row.expect("a row");
            let ns = row["ns_per_step_min"].parse().expect("a number");
            ((row["situation"].clone(), row["integrator"].clone()), ns)
        })
        .collect()
}

fn kernels() -> HashMap<&'static str, f64> {
    let boxes = BOXES.to_string();
    let rows = suites::kernels(&Options::parse_from(["cost", "--bodies", &boxes]));
    let many = rows.into_iter().filter(|r| r.name == "many at a time");
    many.map(|r| (r.integrator, r.cost.min)).collect()
}
