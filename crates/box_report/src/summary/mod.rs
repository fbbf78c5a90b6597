//! The summary: which integrator to choose, its cost and its error, and the step at which it becomes unstable.

mod verdicts;

use box_physics::integrators::{Integrator, Limit};
use box_scenarios::Family;
use serde::Serialize;

use crate::context::{Context, Stop};
use crate::document::{Section, Table};
use crate::stability::{StabilityData, shown};
use crate::timing::Timings;
use crate::visible::{MINUTE, RATES, THROW, Visible};
use crate::work_precision::WorkPrecision;
use crate::{files, text};

/// The completed measurements.
#[derive(Default)]
pub(crate) struct Results {
    pub(crate) work_precision: Option<WorkPrecision>,
    pub(crate) stability: Option<StabilityData>,
    pub(crate) timings: Option<Timings>,
    pub(crate) visible: Option<Visible>,
}

#[derive(Serialize)]
struct Row {
    integrator: &'static str,
    invisible_10s_30hz: Option<usize>,
    invisible_10s_60hz: Option<usize>,
    invisible_10s_120hz: Option<usize>,
    invisible_60s_30hz: Option<usize>,
    invisible_60s_60hz: Option<usize>,
    invisible_60s_120hz: Option<usize>,
    error_of_split_30hz: Option<f64>,
    error_of_split_60hz: Option<f64>,
    error_of_split_120hz: Option<f64>,
    us_per_simulated_s_30hz: Option<f64>,
    us_per_simulated_s_60hz: Option<f64>,
    us_per_simulated_s_120hz: Option<f64>,
    ns_per_step_many: Option<f64>,
    ns_per_step_one: Option<f64>,
    limit_spin: String,
    limit_drag: String,
    limit_damper: String,
    limit_spring: String,
    hard_cases_ok: Option<usize>,
    hard_cases_degraded: Option<usize>,
    hard_cases_diverged: Option<usize>,
}

/// Creates the first section of the report.
pub(crate) fn section(ctx: &Context, results: &Results) -> Result<Section, Stop> {
    let mut section = Section::new(
        "summary",
        "Summary",
        "Which integrator to choose for a game: error, cost and stability limits.",
    );
    let scenes = Family::all().len();
    let row = |&s: &Integrator| {
        let seen = |rate, seconds| {
            let visible = results.visible.as_ref();
            visible.map(|v| v.invisible(s, rate, seconds))
        };
        let work = results.work_precision.as_ref();
        let error = |rate| work.map(|w| w.median_ratio(s, Integrator::Split, rate));
        let cost = |rate| work.and_then(|w| w.cost(s, rate));
        let limits = results
            .stability
            .as_ref()
            .and_then(|d| d.limits(s).copied());
        let limit = |k: usize| limits.map_or_else(String::new, |l: [Limit; 4]| shown(l[k]));
        let score = results.stability.as_ref().map(|d| d.score(s));
        let ns = |situation| results.timings.as_ref()?.of(situation, s);
        Row {
            integrator: s.id(),
            invisible_10s_30hz: seen(30, THROW),
            invisible_10s_60hz: seen(60, THROW),
            invisible_10s_120hz: seen(120, THROW),
            invisible_60s_30hz: seen(30, MINUTE),
            invisible_60s_60hz: seen(60, MINUTE),
            invisible_60s_120hz: seen(120, MINUTE),
            error_of_split_30hz: error(30),
            error_of_split_60hz: error(60),
            error_of_split_120hz: error(120),
            us_per_simulated_s_30hz: cost(30),
            us_per_simulated_s_60hz: cost(60),
            us_per_simulated_s_120hz: cost(120),
            ns_per_step_many: ns("free-many"),
            ns_per_step_one: ns("free-one"),
            limit_spin: limit(0),
            limit_drag: limit(1),
            limit_damper: limit(2),
            limit_spring: limit(3),
            hard_cases_ok: score.map(|s| s[0]),
            hard_cases_degraded: score.map(|s| s[1]),
            hard_cases_diverged: score.map(|s| s[2]),
        }
    };
    let rows: Vec<Row> = ctx.integrators.iter().map(row).collect();
    files::write_csv(&ctx.file("summary.csv"), &rows)?;
    section.tables.push(at_60_hz(results));
    section.tables.push(at_each_rate(ctx, results, &rows));
    section.tables.push(Table {
        title: "Every integrator".to_owned(),
        note: format!(
            "No visible error: scenes, out of {scenes}, whose errors stay below 1° and 1 % of the box's size for 10 s and for 60 s, at 30, 60 and 120 Hz. \
             Cost: geometric mean over the scenes at 60 Hz per box and simulated second, 100 boxes; a step in free flight of 100 boxes \
             (SIMD lanes) and of one (plain step). Stable up to: largest stable step. \
             Hard cases: ok, degraded, diverged."
        ),
        columns: text::columns(
            "integrator | no visible error in 10 s, 30 · 60 · 120 Hz | in 60 s | cost [µs/s] | \
             free step, 100 boxes [ns] | one box [ns] | stable up to spin |ω|·dt | drag c·dt/m | \
             damper d·dt/m | spring √(k/m)·dt | hard cases",
        ),
        rows: rows.iter().map(cells).collect(),
        csv: "summary.csv".to_owned(),
    });
    section.verdicts = verdicts::verdicts(ctx, results);
    Ok(section)
}

/// The rows of the first table: a description and the integrators to which it applies.
const ROWS: [(&str, &[Integrator]); 5] = [
    ("the default", &[Integrator::Split]),
    ("closed form", &[Integrator::Exact]),
    ("the baseline", &[Integrator::Rk4]),
    (
        "as in Jolt, Avian, Rapier / Bullet, Box3D",
        &[Integrator::EngineRescaled, Integrator::EngineNewton],
    ),
    ("2012 dissertation", &[Integrator::Heun2012]),
];

/// The short table for most readers: five rows, at 60 Hz.
fn at_60_hz(results: &Results) -> Table {
    const RATE: u32 = 60;
    let unknown = || "–".to_owned();
    let work = results.work_precision.as_ref();
    let error = |i, family: &str| {
        let family = work.and_then(|w| w.family(family));
        family.map_or_else(unknown, |f| f.error_in_words(i, RATE))
    };
    let seen = |i| {
        let visible = results.visible.as_ref();
        visible.map_or_else(unknown, |v| v.invisible(i, RATE, MINUTE).to_string())
    };
    let cost = |i, situation| {
        let timings = results.timings.as_ref();
        let cost = timings.and_then(|t| t.of(situation, i));
        cost.map_or_else(unknown, |ns| text::significant(ns, 2))
    };
    let breaks = |i| {
        let limits = results
            .stability
            .as_ref()
            .and_then(|d| d.limits(i).copied());
        limits.map_or_else(unknown, |l| breaks_at(l, f64::from(RATE)))
    };
    let row = |&(what, integrators): &(&str, &[Integrator])| {
        let each = |cell: &dyn Fn(Integrator) -> String| {
            let cells: Vec<String> = integrators.iter().map(|&i| cell(i)).collect();
            if cells.iter().all(|c| *c == cells[0]) {
                cells[0].clone()
            } else {
                cells.join(" / ")
            }
        };
        vec![
            format!("{} ({what})", each(&|i| text::code(i))),
            each(&|i| error(i, "free-tumble")),
            each(&|i| error(i, "flip")),
            each(&|i| error(i, "heavy-top")),
            each(&seen),
            each(&|i| cost(i, "free-many")),
            each(&|i| cost(i, "free-one")),
            each(&|i| cost(i, "torque")),
            each(&breaks),
        ]
    };
    Table {
        title: "At 60 Hz".to_owned(),
        note: format!(
            "Largest attitude error over the run (at most π ≈ 3.1 rad), scenes out of {} without a visible error for a minute, \
             nanoseconds per box and step, and the spin, drag, damping and stiffness above which the integrator is unstable.",
            Family::all().len()
        ),
        columns: text::columns(
            "integrator | tumbling box, 10 s [rad] | flip, 10 s [rad] | heavy top, 5 s [rad] | \
             no visible error | 100 boxes in flight [ns] | one box [ns] | under a torque [ns] | \
             unstable for",
        ),
        rows: ROWS.iter().map(row).collect(),
        csv: "summary.csv".to_owned(),
    }
}

/// Compares the same integrators with the default at each rate, and notes integrators that are better.
fn at_each_rate(ctx: &Context, results: &Results, rows: &[Row]) -> Table {
    let default = Integrator::Split;
    let beats = |rate| {
        let better = results.better_and_cheaper(ctx, default, rate);
        better
            .into_iter()
            .map(move |i| format!("`{i}` at {rate} Hz"))
    };
    let better: Vec<String> = RATES.into_iter().flat_map(beats).collect();
    let verdict = if better.is_empty() {
        format!(
            "None of the {} integrators has both a smaller error and a clearly smaller cost than `{default}` at any of these rates.",
            ctx.integrators.len()
        )
    } else {
        format!(
            "Smaller error and clearly smaller cost than `{default}`: {}.",
            text::list(&better)
        )
    };
    let shown = |r: &&Row| {
        let mut all = ROWS.iter().flat_map(|(_, integrators)| integrators.iter());
        all.any(|i| i.id() == r.integrator)
    };
    let row = |r: &Row| {
        let error = |e: Option<f64>| e.map_or_else(|| "–".to_owned(), text::error);
        let [a, b, c] = [
            r.error_of_split_30hz,
            r.error_of_split_60hz,
            r.error_of_split_120hz,
        ]
        .map(error);
        let [x, y, z] = [
            r.us_per_simulated_s_30hz,
            r.us_per_simulated_s_60hz,
            r.us_per_simulated_s_120hz,
        ]
        .map(|c| number(c, 2));
        vec![
            text::code(r.integrator),
            for_a_minute(r),
            format!("{a} · {b} · {c}"),
            format!("{x} · {y} · {z}"),
        ]
    };
    Table {
        title: "At 30, 60 and 120 Hz".to_owned(),
        note: format!(
            "At 30 · 60 · 120 Hz: scenes out of {} without a visible error for a minute; the error relative to that of `{default}`, in the median \
             scene; µs per box and simulated second, geometric mean over the scenes (100 boxes by the plugin's path). {verdict}",
            Family::all().len()
        ),
        columns: text::columns("integrator | no visible error | error | cost [µs/s]"),
        rows: rows.iter().filter(shown).map(row).collect(),
        csv: "summary.csv".to_owned(),
    }
}

/// A sentence on the limits of spin, drag, damper and spring at a rate [1/s].
fn breaks_at(limits: [Limit; 4], rate: f64) -> String {
    let [spin, drag, damper, spring] = limits;
    let of = |limit, what: &str, value: fn(f64, f64) -> f64, unit: &str| match limit {
        Limit::None => None,
        Limit::AlwaysGrows => Some(format!("any {what}")),
        Limit::Below(x) => Some(format!(
            "{what} above {} {unit}",
            text::significant(value(x, rate), 2)
        )),
    };
    let found = [
        of(spin, "spin", |x, r| x * r, "rad/s"),
        of(drag, "drag c/m", |x, r| x * r, "/s"),
        of(damper, "damper d/m", |x, r| x * r, "/s"),
        of(spring, "spring k/m", |x, r| (x * r).powi(2), "/s²"),
    ];
    let found: Vec<String> = found.into_iter().flatten().collect();
    if found.is_empty() {
        "–".to_owned()
    } else {
        found.join(", ")
    }
}

fn or_dash(n: Option<usize>) -> String {
    n.map_or_else(|| "–".to_owned(), |n| n.to_string())
}

fn number(x: Option<f64>, digits: usize) -> String {
    x.map_or_else(|| "–".to_owned(), |x| text::significant(x, digits))
}

/// The number of scenes without a visible error for a minute, at each rate.
fn for_a_minute(r: &Row) -> String {
    format!(
        "{} · {} · {}",
        or_dash(r.invisible_60s_30hz),
        or_dash(r.invisible_60s_60hz),
        or_dash(r.invisible_60s_120hz)
    )
}

fn cells(r: &Row) -> Vec<String> {
    vec![
        text::code(r.integrator),
        format!(
            "{} · {} · {}",
            or_dash(r.invisible_10s_30hz),
            or_dash(r.invisible_10s_60hz),
            or_dash(r.invisible_10s_120hz)
        ),
        for_a_minute(r),
        number(r.us_per_simulated_s_60hz, 2),
        number(r.ns_per_step_many, 3),
        number(r.ns_per_step_one, 3),
        r.limit_spin.clone(),
        r.limit_drag.clone(),
        r.limit_damper.clone(),
        r.limit_spring.clone(),
        format!(
            "{} · {} · {}",
            or_dash(r.hard_cases_ok),
            or_dash(r.hard_cases_degraded),
            or_dash(r.hard_cases_diverged)
        ),
    ]
}
