//! `efficiency`: the cheapest integrator and step below a given error, and the Pareto frontier of error and cost.

use box_physics::integrators::Integrator;
use serde::Serialize;

use crate::context::{Context, Stop};
use crate::document::{Section, Table};
use crate::work_precision::{FamilyPoints, Point, WorkPrecision};
use crate::{files, text};

/// Error limits, in the unit of each family's first metric.
const BELOW: [f64; 4] = [1e-1, 1e-2, 1e-4, 1e-6];
/// Cost ratio below which an integrator is clearly cheaper than another. Smaller differences cannot be distinguished by
/// measurements on one machine.
pub(crate) const CLEARLY_CHEAPER: f64 = 0.95;
/// Errors below this value are replaced by it: smaller ones are not needed, and rounding would decide the order.
const MIN_COMPARED_ERROR: f64 = 1e-9;

#[derive(Serialize)]
struct Row {
    family: &'static str,
    metric: &'static str,
    below: f64,
    integrator: Option<&'static str>,
    dt_s: Option<f64>,
    error: Option<f64>,
    us_per_simulated_s: Option<f64>,
    /// The next cheapest integrator and its cost.
    runner_up: Option<&'static str>,
    runner_up_us_per_simulated_s: Option<f64>,
}

#[derive(Serialize)]
struct FrontierRow {
    integrator: &'static str,
    families_on_frontier: usize,
    families: String,
}

/// The points that did not fail, each with its error and cost.
fn measured(f: &FamilyPoints) -> impl Iterator<Item = (&Point, f64, f64)> {
    f.points.iter().filter_map(|p| {
        let error = p.run.error(f.family.metrics[0])?.max(MIN_COMPARED_ERROR);
        Some((p, error, p.microseconds()?))
    })
}

/// The cheapest point of each integrator below `limit`, cheapest first.
fn ranking(f: &FamilyPoints, limit: f64) -> Vec<(&Point, f64)> {
    let mut best: Vec<(&Point, f64)> = Vec::new();
    for (p, error, cost) in measured(f) {
        if error > limit {
            continue;
        }
        match best.iter_mut().find(|(b, _)| b.integrator == p.integrator) {
            Some(b) if b.1 <= cost => {}
            Some(b) => *b = (p, cost),
            None => best.push((p, cost)),
        }
    }
    best.sort_by(|a, b| a.1.total_cmp(&b.1));
    best
}

/// Returns `true` if `integrator` has a point on the frontier: no point of another integrator beats it.
fn on_frontier(f: &FamilyPoints, integrator: Integrator) -> bool {
    measured(f)
        .filter(|(p, ..)| p.integrator == integrator)
        .any(|(_, e, c)| {
            !measured(f).any(|(q, error, cost)| {
                q.integrator != integrator && error <= e && cost < CLEARLY_CHEAPER * c
            })
        })
}

/// Makes the section from the work–precision measurement.
pub(crate) fn section(ctx: &Context, data: &WorkPrecision) -> Result<Section, Stop> {
    let mut section = Section::new(
        "efficiency",
        "Efficiency",
        "For each scene, the cheapest integrator and step size whose error stays below a bound, from the points of the \
         work–precision diagrams. Cost: time per box and simulated second on one core, for many boxes by the plugin's path. Error: the \
         first one named for the scene (attitude in rad, position in m).",
    );
    let mut rows = Vec::new();
    let mut cells = Vec::new();
    let mut wins: Vec<(Integrator, usize)> = Vec::new();
    for f in &data.families {
        let metric = f.family.metrics[0];
        let mut line = vec![format!("{} ({})", f.family.title, metric.id())];
        for below in BELOW {
            let ranking = ranking(f, below);
            let (first, second) = (ranking.first(), ranking.get(1));
            rows.push(Row {
                family: f.family.id,
                metric: metric.id(),
                below,
                integrator: first.map(|b| b.0.integrator.id()),
                dt_s: first.map(|b| b.0.dt),
                error: first.and_then(|b| b.0.run.error(metric)),
                us_per_simulated_s: first.map(|b| b.1),
                runner_up: second.map(|b| b.0.integrator.id()),
                runner_up_us_per_simulated_s: second.map(|b| b.1),
            });
            if let Some((p, _)) = first {
                match wins.iter_mut().find(|w| w.0 == p.integrator) {
                    Some(w) => w.1 += 1,
                    None => wins.push((p.integrator, 1)),
                }
            }
            line.push(first.map_or_else(
                || "not reached".to_owned(),
                |(p, cost)| {
                    format!(
                        "`{}` {} s: {} µs/s",
                        p.integrator,
                        text::step(p.dt),
                        text::significant(*cost, 2)
                    )
                },
            ));
        }
        cells.push(line);
    }
    files::write_csv(&ctx.file("efficiency.csv"), &rows)?;
    let mut columns = vec!["scene (error)".to_owned()];
    columns.extend(BELOW.map(|b| format!("below {b:.0e}")));
    section.tables.push(Table {
        title: "Cheapest integrator for each error bound".to_owned(),
        note: "Integrator, step size and time per box and simulated second.".to_owned(),
        columns,
        rows: cells,
        csv: "efficiency.csv".to_owned(),
    });
    section.tables.push(frontier(ctx, data)?);
    section.verdicts = verdicts(ctx, data, wins);
    Ok(section)
}

fn frontier_families(data: &WorkPrecision, integrator: Integrator) -> Vec<&'static str> {
    data.families
        .iter()
        .filter(|f| on_frontier(f, integrator))
        .map(|f| f.family.id)
        .collect()
}

fn frontier(ctx: &Context, data: &WorkPrecision) -> Result<Table, Stop> {
    let rows: Vec<FrontierRow> = ctx
        .integrators
        .iter()
        .map(|&s| {
            let families = frontier_families(data, s);
            FrontierRow {
                integrator: s.id(),
                families_on_frontier: families.len(),
                families: families.join(" "),
            }
        })
        .collect();
    files::write_csv(&ctx.file("frontier.csv"), &rows)?;
    Ok(Table {
        title: "Pareto frontier of error and cost".to_owned(),
        note: format!(
            "An integrator is on the frontier of a scene if, at one of its step sizes, no other integrator is at least as accurate \
             in clearly less time ({:.0} %). Errors below {MIN_COMPARED_ERROR:.0e} count as equal.",
            100.0 * (1.0 - CLEARLY_CHEAPER)
        ),
        columns: text::columns("integrator | scenes | which"),
        rows: rows
            .iter()
            .map(|r| {
                vec![
                    text::code(r.integrator),
                    r.families_on_frontier.to_string(),
                    if r.families.is_empty() {
                        "none".to_owned()
                    } else {
                        r.families.replace(' ', ", ")
                    },
                ]
            })
            .collect(),
        csv: "frontier.csv".to_owned(),
    })
}

fn verdicts(
    ctx: &Context,
    data: &WorkPrecision,
    mut wins: Vec<(Integrator, usize)>,
) -> Vec<String> {
    wins.sort_by_key(|w| std::cmp::Reverse(w.1));
    let questions = data.families.len() * BELOW.len();
    let cheapest: Vec<String> = wins.iter().map(|(s, n)| format!("`{s}` {n}")).collect();
    let (on, off): (Vec<_>, Vec<_>) = ctx
        .integrators
        .iter()
        .partition(|&&s| !frontier_families(data, s).is_empty());
    let names = |s: &[&Integrator]| text::list(&s.iter().map(text::code).collect::<Vec<_>>());
    vec![
        format!(
            "How often each integrator is the cheapest, out of {questions} pairs of scene and error bound: {}.",
            text::list(&cheapest)
        ),
        format!("On the frontier of at least one scene: {}.", names(&on)),
        format!("Not on the frontier of any scene: {}.", names(&off)),
    ]
}
