//! The benchmarks. Each takes its contenders in turns (see [`crate::measure`]), a size at a time.

use box_physics::prelude::*;

use crate::bare::Bare;
use crate::bodies::Situation;
use crate::measure::{Contender, Cost, interleaved};
use crate::memory::Traffic;
use crate::options::Options;
use crate::plugin_world::PluginWorld;
use crate::rows::Row;

/// Step size of every benchmark \[s\].
pub const STEP: f64 = 1.0 / 60.0;

/// Counts the allocations of a call on this thread.
pub type CountAllocations = fn(&mut dyn FnMut()) -> u64;

/// Every scheme on plain arrays, free flight: the readable definition, body by body.
pub fn kernels(options: &Options) -> Vec<Row> {
    let mut rows = Vec::new();
    for n in options.sizes() {
        let set = Situation::Flight.bodies(n);
        let integrators = options.integrators_or(Integrator::ALL);
        let mut arrays: Vec<_> = integrators
            .iter()
            .map(|_| Bare::new(&set, DVec3::ZERO))
            .collect();
        let mut contenders: Vec<_> = arrays
            .iter_mut()
            .zip(&integrators)
            .map(|(bare, &i)| Contender::new(n as f64, move || bare.kernel_scalar(i, STEP)))
            .collect();
        let costs = interleaved(&mut contenders, &options.settings());
        rows.extend(integrators.iter().zip(costs).map(|(i, cost)| Row {
            suite: "kernels",
            name: "body by body".to_owned(),
            integrator: i.id(),
            bodies: n,
            threads: 1,
            cost,
            to_bare: None,
            to_memory: None,
            allocations: None,
        }));
    }
    rows
}

/// The plugin's whole step in every situation, beside the bare loop and the memory bound.
pub fn step(options: &Options, count: CountAllocations) -> Vec<Row> {
    let mut rows = Vec::new();
    for integrator in options.integrators_or(&[Integrator::Split]) {
        for n in options.sizes() {
            for situation in Situation::ALL {
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
    let set = situation.bodies(n);
    let mut bare = Bare::new(&set, situation.gravity());
    let mut traffic = Traffic::new(n, Bare::bytes_per_body());
    let mut world = PluginWorld::new(situation, integrator, n);
    world.call();
    let steps = f64::from(world.steps_per_call());
    let allocations = count(&mut || world.call()) as f64 / steps;
    let costs = interleaved(
        &mut [
            Contender::new(n as f64, || bare.step_scalar(integrator, STEP)),
            Contender::new(n as f64, || traffic.pass()),
            Contender::new(n as f64 * steps, || world.call()),
        ],
        &options.settings(),
    );
    let row = |name: String, cost: Cost| Row {
        suite: "step",
        name,
        integrator: integrator.id(),
        bodies: n,
        threads: 1,
        cost,
        to_bare: Some(cost.min / costs[0].min),
        to_memory: Some(cost.min / costs[1].min),
        allocations: None,
    };
    let mut rows = Vec::new();
    if situation == Situation::Flight {
        rows.push(row("bare loop".to_owned(), costs[0]));
        rows.push(row("memory".to_owned(), costs[1]));
    }
    rows.push(Row {
        allocations: Some(allocations),
        ..row(situation.name().to_owned(), costs[2])
    });
    rows
}
