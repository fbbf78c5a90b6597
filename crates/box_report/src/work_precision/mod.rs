//! `work-precision`: error against time and against force evaluations, over every family of motion, every
//! integrator and every step.

mod figures;

use std::time::Duration;

use box_bench::measure::Cost;
use box_physics::integrators::Integrator;
use box_physics::state::BodyState;
use box_scenarios::statistics::{self, Fitted, Quantiles};
use box_scenarios::{Family, FamilyRun, Metric};
use serde::Serialize;

use crate::context::{Context, SAMPLES_IN_WORDS, Stop};
use crate::document::{Section, Table};
use crate::{files, herd, text};

/// The coarsest step, between two looks at the error \[s\].
pub(crate) const INTERVAL: f64 = 1.0 / 15.0;
/// Into how many steps it is divided: 1/15 to 1/1920 s.
const DIVISORS: [u64; 8] = [1, 2, 4, 8, 16, 32, 64, 128];
/// With `--quick`.
const QUICK_DIVISORS: [u64; 4] = [2, 4, 8, 16];
/// Time for the measurements of a family.
const SHARE: Duration = Duration::from_secs(7);

/// One integrator in one family at one step.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub(crate) integrator: Integrator,
    pub(crate) dt: f64,
    pub(crate) run: FamilyRun,
    /// ns per step; `None` if the run failed.
    pub(crate) cost: Option<Cost>,
}

impl Point {
    /// Time per simulated second \[µs\], at the fastest sample.
    pub(crate) fn microseconds(&self) -> Option<f64> {
        self.per_second(self.cost?.min)
    }

    /// ns per step as µs per simulated second.
    pub(crate) fn per_second(&self, ns: f64) -> Option<f64> {
        Some(ns * 1e-3 / self.dt)
    }

    /// Force evaluations per simulated second.
    pub(crate) fn evaluations(&self) -> f64 {
        self.run.totals.evaluations as f64 / self.run.totals.steps.max(1) as f64 / self.dt
    }
}

/// All points of one family.
pub(crate) struct FamilyPoints {
    pub(crate) family: &'static Family,
    pub(crate) reference: String,
    /// Integrators in order, each with its steps from coarse to fine.
    pub(crate) points: Vec<Point>,
}

impl FamilyPoints {
    /// Those of one integrator.
    pub(crate) fn of(&self, integrator: Integrator) -> impl Iterator<Item = &Point> {
        self.points
            .iter()
            .filter(move |p| p.integrator == integrator)
    }

    /// The fitted order of `integrator` in `metric`.
    pub(crate) fn order(&self, integrator: Integrator, metric: Metric) -> Fitted {
        let points: Vec<_> = self
            .of(integrator)
            .filter_map(|p| Some((p.dt, p.run.error(metric)?)))
            .collect();
        statistics::order(&points)
    }
}

/// The whole measurement.
pub(crate) struct WorkPrecision {
    pub(crate) families: Vec<FamilyPoints>,
}

/// A line of the CSV file.
#[derive(Serialize)]
struct Row {
    family: &'static str,
    integrator: &'static str,
    dt_s: f64,
    steps: u64,
    evaluations_per_step: f64,
    position_error_m: Option<f64>,
    attitude_error_rad: Option<f64>,
    energy_error_rel: Option<f64>,
    ns_per_step_min: Option<f64>,
    ns_per_step_median: Option<f64>,
    ns_per_step_p95: Option<f64>,
    us_per_simulated_s: Option<f64>,
    status: &'static str,
}

/// Ticks of the progress that [`measure`] takes.
pub(crate) fn ticks() -> u64 {
    Family::all().len() as u64
}

/// The steps, as divisors of [`INTERVAL`].
pub(crate) fn divisors(quick: bool) -> &'static [u64] {
    if quick { &QUICK_DIVISORS } else { &DIVISORS }
}

/// Measures every family.
pub(crate) fn measure(ctx: &Context) -> Result<WorkPrecision, Stop> {
    let mut families = Vec::new();
    for family in Family::all() {
        families.push(measure_family(ctx, family)?);
        ctx.tick(family.title)?;
    }
    Ok(WorkPrecision { families })
}

fn measure_family(ctx: &Context, family: &'static Family) -> Result<FamilyPoints, Stop> {
    let reference = family
        .reference(INTERVAL, family.setup.duration)
        .map_err(Stop::Internal)?;
    let mut points: Vec<Point> = Vec::new();
    for &integrator in &ctx.integrators {
        for &divisor in divisors(ctx.quick) {
            points.push(Point {
                integrator,
                dt: INTERVAL / divisor as f64,
                run: family.run(&reference, integrator, divisor),
                cost: None,
            });
        }
    }
    // Bodies spread over the motion, so that the cost is that of all its phases.
    let every = (reference.states().len() / 8).max(1);
    let starts: Vec<BodyState> = reference.states().iter().copied().step_by(every).collect();
    let ran: Vec<usize> = (0..points.len())
        .filter(|&k| points[k].run.errors.is_some())
        .collect();
    let mut contenders: Vec<_> = ran
        .iter()
        .map(|&k| {
            let p = &points[k];
            herd::many(
                &family.setup,
                &starts,
                p.integrator,
                p.dt,
                p.run.totals.steps,
            )
        })
        .collect();
    let costs = ctx.measure(&mut contenders, SHARE);
    drop(contenders);
    for (k, cost) in ran.into_iter().zip(costs) {
        points[k].cost = Some(cost);
    }
    Ok(FamilyPoints {
        family,
        reference: reference.source,
        points,
    })
}

/// Writes the CSV and the figures.
pub(crate) fn section(ctx: &Context, data: &WorkPrecision) -> Result<Section, Stop> {
    let mut section = Section::new(
        "work-precision",
        "Work–precision diagrams",
        format!(
            "Each line is an integrator, each marker a step size. Down and left is better. The error is the largest \
             over the run, looked at every 1/15 s, against the reference named below each figure, at the time \
             actually simulated. Time is that of a step of one body among 16 along the plugin's path, in SIMD lanes under gravity alone (over a floor: of a whole \
             run with its impacts) on one core: {SAMPLES_IN_WORDS}; thin bars reach to the 95th percentile. The order in the legend \
             is fitted to the errors between lost and rounding. A run that diverged, is not finite or not sound \
             is a gap."
        ),
    );
    let mut rows = Vec::new();
    for f in &data.families {
        for p in &f.points {
            let errors = p.run.errors;
            rows.push(Row {
                family: f.family.id,
                integrator: p.integrator.id(),
                dt_s: p.dt,
                steps: p.run.totals.steps,
                evaluations_per_step: p.evaluations() * p.dt,
                position_error_m: errors.map(|e| e.position),
                attitude_error_rad: errors.map(|e| e.attitude),
                energy_error_rel: errors
                    .filter(|_| f.family.metrics.contains(&Metric::Energy))
                    .map(|e| e.energy),
                ns_per_step_min: p.cost.map(|c| c.min),
                ns_per_step_median: p.cost.map(|c| c.median),
                ns_per_step_p95: p.cost.map(|c| c.p95),
                us_per_simulated_s: p.microseconds(),
                status: if errors.is_some() { "ok" } else { "failed" },
            });
        }
        section.figures.extend(figures::of(ctx, f)?);
    }
    files::write_csv(&ctx.file("work-precision.csv"), &rows)?;
    section.tables.push(at_60_hz(ctx, data));
    section.tables.push(orders(ctx, data));
    section.verdicts = vec![spread(data)];
    section.write_figures(ctx.folder())?;
    Ok(section)
}

/// How quiet the machine was.
fn spread(data: &WorkPrecision) -> String {
    let costs = data
        .families
        .iter()
        .flat_map(|f| f.points.iter().filter_map(|p| p.cost));
    let spreads: Vec<f64> = costs.map(|c| 100.0 * c.spread()).collect();
    let count = spreads.len();
    let spreads = Quantiles::of(spreads);
    format!(
        "How quiet the machine was: the median sample lies {:.0} % above the fastest for half of the {} measurements, {:.0} % for one in twenty.",
        spreads.median(),
        count,
        spreads.at(0.95)
    )
}

/// Errors and cost at 60 Hz: what most games will see.
fn at_60_hz(ctx: &Context, data: &WorkPrecision) -> Table {
    let mut columns = vec!["integrator".to_owned()];
    columns.extend(data.families.iter().map(|f| {
        let metric = f.family.metrics[0];
        format!("{} [{}]", f.family.title, metric.unit())
    }));
    let row = |&integrator: &Integrator| {
        let mut cells = vec![text::code(integrator)];
        cells.extend(data.families.iter().map(|f| {
            let point = f.of(integrator).find(|p| (p.dt * 60.0 - 1.0).abs() < 1e-9);
            match point.map(|p| (p.run.error(f.family.metrics[0]), p.cost)) {
                Some((Some(e), Some(c))) => format!("{} · {:.0} ns", text::error(e), c.min),
                Some((Some(e), None)) => text::error(e),
                _ => "failed".to_owned(),
            }
        }));
        cells
    };
    Table {
        title: "Largest error and time per step at 60 Hz".to_owned(),
        note: "Error over the whole run; time of a step of one body. π ≈ 3.1 rad is as wrong as an attitude can be."
            .to_owned(),
        columns,
        rows: ctx.integrators.iter().map(row).collect(),
        csv: "work-precision.csv".to_owned(),
        digest: true,
    }
}

/// Fitted orders.
fn orders(ctx: &Context, data: &WorkPrecision) -> Table {
    let short = |f: Fitted| match f {
        Fitted::Order(p) => format!("{p:.1}"),
        Fitted::Rounding => "rounding".to_owned(),
        Fitted::Unknown => "–".to_owned(),
    };
    let mut columns = vec!["integrator".to_owned()];
    columns.extend(
        data.families
            .iter()
            .map(|f| format!("{} ({})", f.family.title, f.family.metrics[0].id())),
    );
    let row = |&integrator: &Integrator| {
        let mut cells = vec![text::code(integrator)];
        let orders = data
            .families
            .iter()
            .map(|f| short(f.order(integrator, f.family.metrics[0])));
        cells.extend(orders);
        cells
    };
    Table {
        title: "Fitted order".to_owned(),
        note: "p in error ∝ dt^p; “rounding”: nothing but rounding errors at any step; –: lost at too many steps to tell.".to_owned(),
        columns,
        rows: ctx.integrators.iter().map(row).collect(),
        csv: "work-precision.csv".to_owned(),
        digest: false,
    }
}
