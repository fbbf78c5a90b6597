//! The benchmarks. Each measures its contenders in turns (see [`crate::measure`]), one size at a time.

use std::cell::RefCell;

use box_physics::prelude::*;

use crate::bare::Bare;
use crate::bodies::Situation;
use crate::contact_scenes::{ContactBench, ContactScene};
use crate::measure::{Contender, Cost, interleaved};
use crate::memory::Traffic;
use crate::options::Options;
use crate::plugin_world::PluginWorld;
use crate::rows::Row;

/// Step size of every benchmark \[s\].
pub const STEP: f64 = 1.0 / 60.0;

/// Numbers of threads to measure for `n` bodies. For few bodies it is one, because the plugin then uses no others.
fn threads(n: usize) -> &'static [usize] {
    if n < 256 { &[1] } else { &[1, 2] }
}

/// Largest number of bodies in an episode; more would take minutes.
const LARGEST_EPISODE: usize = 10_000;

/// Counts the allocations of a call on this thread.
pub type CountAllocations = fn(&mut dyn FnMut()) -> u64;

/// Measures every integrator on plain arrays in free flight: body by body, and many bodies at a time.
pub fn kernels(options: &Options) -> Vec<Row> {
    let mut rows = Vec::new();
    for n in options.sizes() {
        let set = Situation::Flight.bodies(n);
        let ways: Vec<_> = options
            .integrators_or(Integrator::ALL)
            .into_iter()
            .flat_map(|i| [(i, "plain"), (i, "many at a time")])
            .collect();
        let mut arrays: Vec<_> = ways.iter().map(|_| Bare::new(&set, DVec3::ZERO)).collect();
        let mut contenders: Vec<_> = arrays
            .iter_mut()
            .zip(&ways)
            .map(|(bare, &(i, way))| {
                Contender::new(n as f64, move || match way {
                    "plain" => bare.kernel_scalar(i, STEP),
                    _ => bare.kernel(i, STEP),
                })
            })
            .collect();
        let costs = interleaved(&mut contenders, &options.settings());
        let found = ways.iter().zip(costs);
        rows.extend(found.map(|(&(i, way), cost)| plain_row("kernels", way, i, n, cost)));
    }
    rows
}

/// Measures bounding boxes and transforms on plain arrays, compared with a pass over the bytes of a whole step.
pub fn refit(options: &Options) -> Vec<Row> {
    let mut rows = Vec::new();
    for n in options.sizes() {
        let set = Situation::Flight.bodies(n);
        let (mut boxes, mut poses) = (Bare::new(&set, DVec3::ZERO), Bare::new(&set, DVec3::ZERO));
        let mut traffic = Traffic::new(n, Bare::bytes_per_body());
        let costs = interleaved(
            &mut [
                Contender::new(n as f64, || boxes.refit()),
                Contender::new(n as f64, || poses.write_transforms()),
                Contender::new(n as f64, || traffic.pass()),
            ],
            &options.settings(),
        );
        for (name, cost) in ["bounding boxes", "transforms", "memory"].iter().zip(costs) {
            rows.push(plain_row("refit", name, Integrator::Split, n, cost));
        }
    }
    rows
}

/// Measures one box at the floor in every situation with a different cost, with the core alone and `split`.
pub fn contact(options: &Options) -> Vec<Row> {
    let mut boxes = ContactScene::ALL.map(ContactBench::new);
    let mut contenders: Vec<_> = boxes
        .iter_mut()
        .map(|bench| {
            Contender::new(1.0, || {
                core::hint::black_box(bench.step());
            })
        })
        .collect();
    let costs = interleaved(&mut contenders, &options.settings());
    ContactScene::ALL
        .iter()
        .zip(costs)
        .map(|(scene, cost)| plain_row("contact", scene.name(), Integrator::Split, 1, cost))
        .collect()
}

fn plain_row(suite: &'static str, name: &str, i: Integrator, bodies: usize, cost: Cost) -> Row {
    Row {
        suite,
        name: name.to_owned(),
        integrator: i.id(),
        bodies,
        threads: 1,
        cost,
        to_bare: None,
        to_memory: None,
        allocations: None,
    }
}

/// Measures the plugin's whole step in every situation, compared with the bare loop and the memory bound.
pub fn step(options: &Options, count: CountAllocations) -> Vec<Row> {
    let mut rows = Vec::new();
    for integrator in options.integrators_or(&[Integrator::Split]) {
        for n in options.sizes() {
            for &situation in Situation::ALL.iter().filter(|s| options.selects(s.name())) {
                if situation.episode() > 1 && n > LARGEST_EPISODE {
                    continue;
                }
                rows.extend(step_rows(options, count, integrator, n, situation));
            }
        }
    }
    rows
}

fn step_rows(
    options: &Options,
    count: CountAllocations,
    integrator: Integrator,
    n: usize,
    situation: Situation,
) -> Vec<Row> {
    let flight = situation == Situation::Flight;
    let set = situation.bodies(n);
    let mut bare = Bare::new(&set, situation.gravity());
    let mut traffic = Traffic::new(n, Bare::bytes_per_body());
    let world = RefCell::new(PluginWorld::new(situation, integrator, n));
    let steps = f64::from(world.borrow().steps_per_call());
    let mut contenders = vec![
        Contender::new(n as f64, || bare.step(integrator, STEP)),
        Contender::new(n as f64, || traffic.pass()),
    ];
    let mut rows = Vec::new();
    let world = &world;
    for &threads in threads(n) {
        let mut now = world.borrow_mut();
        now.use_threads(threads);
        // The second episode begins with all boxes waking, for which lists grow once.
        for _ in 0..if steps > 1.0 { 2 } else { 10 } {
            now.call();
        }
        let allocations = count(&mut || now.call()) as f64 / steps;
        rows.push((situation.name(), threads, Some(allocations)));
        contenders.push(Contender::new(n as f64 * steps, move || {
            let mut world = world.borrow_mut();
            world.use_threads(threads);
            world.call();
        }));
    }
    let mut settings = options.settings();
    if steps > 1.0 {
        // An episode is long and averages over many steps.
        settings.samples = (3, 3);
    }
    let costs = interleaved(&mut contenders, &settings);
    drop(contenders);
    let (bounds, own) = costs.split_at(2);
    let mut found = Vec::new();
    if flight {
        found.push(("bare loop", 1, None, bounds[0]));
        found.push(("memory", 1, None, bounds[1]));
    }
    let each = rows.into_iter().zip(own);
    found.extend(
        each.map(|((name, threads, allocations), &cost)| (name, threads, allocations, cost)),
    );
    let row = |(name, threads, allocations, cost): (&str, usize, Option<f64>, Cost)| Row {
        suite: "step",
        name: name.to_owned(),
        integrator: integrator.id(),
        bodies: n,
        threads,
        cost,
        to_bare: Some(cost.min / bounds[0].min),
        to_memory: Some(cost.min / bounds[1].min),
        allocations,
    };
    found.into_iter().map(row).collect()
}
