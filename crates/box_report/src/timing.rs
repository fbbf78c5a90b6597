//! `timing`: the cost of a step in flight, with forces and on the floor.

use std::time::Duration;

use box_bench::measure::Cost;
use box_bench::snapshot::{Snapshot, lone_body};
use box_physics::integrators::Integrator;
use box_scenarios::{Family, ForceSet, Scenario, Setup};
use serde::Serialize;

use crate::context::{Context, SAMPLES_IN_WORDS, Stop};
use crate::document::{Section, Table};
use crate::{files, text};

/// The step \[s\].
const H: f64 = 1.0 / 60.0;
/// Time for measuring a situation.
const SHARE: Duration = Duration::from_secs(3);
/// Number of boxes where a situation has many.
const BOXES: usize = 100;

/// A situation in which a step is timed.
struct Situation {
    id: &'static str,
    title: &'static str,
    setup: Setup,
    /// `true` to time the plain step of one body instead of many bodies in the plugin's code path.
    alone: bool,
}

/// Costs per situation and integrator, in order.
pub(crate) struct Timings {
    situations: Vec<(Situation, Vec<(Integrator, Cost)>)>,
}

impl Timings {
    /// The ids of the situations.
    pub(crate) fn situations(&self) -> Vec<&'static str> {
        self.situations.iter().map(|(s, _)| s.id).collect()
    }

    /// Column headings of the given situations.
    pub(crate) fn titles(&self, ids: &[&str]) -> Vec<String> {
        let wanted = |id: &&str| self.situations.iter().find(|(s, _)| s.id == *id);
        let found = ids.iter().filter_map(wanted);
        found.map(|(s, _)| format!("{} [ns]", s.title)).collect()
    }

    /// Cost of `integrator` in the situation with this id \[ns per body and step\].
    pub(crate) fn of(&self, situation: &str, integrator: Integrator) -> Option<f64> {
        let (_, costs) = self.situations.iter().find(|(s, _)| s.id == situation)?;
        let found = costs.iter().find(|(s, _)| *s == integrator);
        found.map(|(_, c)| c.min)
    }
}

#[derive(Serialize)]
struct Row {
    situation: &'static str,
    integrator: &'static str,
    ns_per_step_min: f64,
    ns_per_step_median: f64,
    ns_per_step_p95: f64,
}

fn situations() -> Result<Vec<Situation>, Stop> {
    let tumbling = &Family::all()[0].setup;
    let under = |forces: ForceSet| Setup {
        forces,
        ..tumbling.clone()
    };
    let scene = |id: &str| {
        Scenario::find(id)
            .map(|s| s.setup)
            .map_err(|e| Stop::Internal(e.to_string()))
    };
    let dissipation = ForceSet {
        linear_drag: 0.3,
        quadratic_drag: 0.1,
        angular_damping: 0.2,
        angular_drag: 0.01,
        ..ForceSet::gravity(9.81)
    };
    let situation = |id, title, setup| Situation {
        id,
        title,
        setup,
        alone: false,
    };
    let free = under(ForceSet::gravity(9.81));
    Ok(vec![
        situation("free-many", "free flight, 100 boxes", free.clone()),
        Situation {
            alone: true,
            ..situation("free-one", "free flight, one box", free)
        },
        situation("drag", "with every drag", under(dissipation)),
        situation("torque", "under a torque", scene("heavy-top")?),
        situation("spring", "on a spring", scene("spring-orbit")?),
        situation("bouncing", "bouncing on a floor", scene("contact")?),
        situation("sliding", "sliding on a floor", scene("slide")?),
    ])
}

/// Progress ticks of [`measure`].
pub(crate) fn ticks() -> u64 {
    situations().map_or(0, |all| all.len() as u64)
}

/// Times every integrator in every situation.
pub(crate) fn measure(ctx: &Context) -> Result<Timings, Stop> {
    let mut timed = Vec::new();
    for situation in situations()? {
        let setup = &situation.setup;
        let snapshot = Snapshot::of_scene(setup, BOXES, H)
            .ok_or_else(|| Stop::Internal(format!("{}: no bodies", situation.title)))?;
        let contender = |&i: &Integrator| {
            if situation.alone {
                lone_body(setup, i, H)
            } else {
                snapshot.clone().contender(i)
            }
        };
        let mut contenders: Vec<_> = ctx.integrators.iter().map(contender).collect();
        let costs = ctx.measure(&mut contenders, SHARE);
        drop(contenders);
        ctx.tick(situation.title)?;
        let costs = ctx.integrators.iter().copied().zip(costs).collect();
        timed.push((situation, costs));
    }
    Ok(Timings { situations: timed })
}

/// Writes the CSV and makes the table.
pub(crate) fn section(ctx: &Context, data: &Timings) -> Result<Section, Stop> {
    let mut section = Section::new(
        "timing",
        "Cost per step",
        format!(
            "Nanoseconds per body and step of 1/60 s on one core over the whole scene, without bounding box and `Transform`. \
             *{BOXES} boxes* (and all columns except *one box*): by the plugin's path for them, in SIMD lanes under gravity \
             alone if the integrator supports it. *One box*: the plain step of a single body. Fastest sample, and how far the \
             median lies above it: {SAMPLES_IN_WORDS}."
        ),
    );
    let mut rows = Vec::new();
    for (situation, costs) in &data.situations {
        rows.extend(costs.iter().map(|(s, c)| Row {
            situation: situation.id,
            integrator: s.id(),
            ns_per_step_min: c.min,
            ns_per_step_median: c.median,
            ns_per_step_p95: c.p95,
        }));
    }
    files::write_csv(&ctx.file("timing.csv"), &rows)?;
    let mut columns = vec!["integrator".to_owned()];
    columns.extend(data.titles(&data.situations()));
    columns.push("boxes in free flight per ms".to_owned());
    let lines = ctx.integrators.iter().enumerate().map(|(k, s)| {
        let mut line = vec![text::code(s)];
        for (_, costs) in &data.situations {
            let c = costs[k].1;
            line.push(format!("{:.0} (+{:.0} %)", c.min, 100.0 * c.spread()));
        }
        let free = data.situations.first().map(|(_, c)| c[k].1.min);
        line.push(free.map_or_else(String::new, |ns| text::significant((1e6 / ns).round(), 3)));
        line
    });
    section.tables.push(Table {
        title: "Time per body and step".to_owned(),
        note: String::new(),
        columns,
        rows: lines.collect(),
        csv: "timing.csv".to_owned(),
    });
    section.verdicts = verdicts(ctx, data);
    Ok(section)
}

fn verdicts(ctx: &Context, data: &Timings) -> Vec<String> {
    let mut by_cost: Vec<(Integrator, f64)> = ctx
        .integrators
        .iter()
        .filter_map(|&s| Some((s, data.of("free-many", s)?)))
        .collect();
    by_cost.sort_by(|a, b| a.1.total_cmp(&b.1));
    match (by_cost.first(), by_cost.last()) {
        (Some(first), Some(last)) => vec![format!(
            "In free flight, `{}` is cheapest at {} and `{}` most expensive at {}; even that is {} boxes per millisecond.",
            first.0,
            text::time(first.1),
            last.0,
            text::time(last.1),
            text::significant((1e6 / last.1).round(), 3)
        )],
        _ => Vec::new(),
    }
}
