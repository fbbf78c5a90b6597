//! `work-precision`: error against time and against force evaluations, for every family of motion, integrator and step.

mod figures;

use std::time::Duration;

use box_bench::measure::{Contender, Cost};
use box_bench::snapshot::Snapshot;
use box_physics::floor::ContactState;
use box_physics::integrators::Integrator;
use box_physics::state::BodyState;
use box_scenarios::statistics::{self, Fitted, Quantiles};
use box_scenarios::{Family, FamilyRun, Metric, ReferenceTable};
use serde::Serialize;

use crate::context::{Context, SAMPLES_IN_WORDS, Stop};
use crate::document::{Section, Table};
use crate::{files, text};

/// The coarsest step, which is also the interval at which errors are sampled \[s\].
pub(crate) const INTERVAL: f64 = 1.0 / 15.0;
/// Divisors of the interval: steps from 1/15 to 1/1920 s.
const DIVISORS: [u64; 8] = [1, 2, 4, 8, 16, 32, 64, 128];
/// Divisors with `--quick`.
const QUICK_DIVISORS: [u64; 4] = [2, 4, 8, 16];
/// Time for measuring a family.
const SHARE: Duration = Duration::from_secs(7);
/// Number of boxes that are stepped together.
const BOXES: usize = 100;
/// The number over a floor, where each box does the whole scene.
const FLOOR_BOXES: usize = 8;

/// Smallest error in a ratio \[m, rad or relative\]; smaller errors are rounding errors.
const MIN_RATIO_ERROR: f64 = 1e-12;
/// Error with which a failed run counts: the largest possible attitude error \[rad\].
const FAILED_RUN_ERROR: f64 = core::f64::consts::PI;

/// Result of one integrator in one family at one step.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub(crate) integrator: Integrator,
    pub(crate) dt: f64,
    pub(crate) run: FamilyRun,
    /// Cost per step \[ns\]; `None` if the run failed.
    pub(crate) cost: Option<Cost>,
}

impl Point {
    /// Time per simulated second of the fastest sample \[µs\].
    pub(crate) fn microseconds(&self) -> Option<f64> {
        Some(self.per_second(self.cost?.min))
    }

    /// Converts ns per step to µs per simulated second.
    pub(crate) fn per_second(&self, ns: f64) -> f64 {
        ns * 1e-3 / self.dt
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
    /// The points of one integrator.
    pub(crate) fn of(&self, integrator: Integrator) -> impl Iterator<Item = &Point> {
        self.points
            .iter()
            .filter(move |p| p.integrator == integrator)
    }

    /// The point of one integrator at `rate` [1/s].
    pub(crate) fn at(&self, integrator: Integrator, rate: u32) -> Option<&Point> {
        let at = |p: &&Point| (p.dt * f64::from(rate) - 1.0).abs() < 1e-9;
        self.of(integrator).find(at)
    }

    /// The first error of one integrator at `rate` [1/s], as text.
    pub(crate) fn error_in_words(&self, integrator: Integrator, rate: u32) -> String {
        let point = self.at(integrator, rate);
        match point.map(|p| p.run.error(self.family.metrics[0])) {
            Some(Some(e)) => text::error(e),
            Some(None) => "diverged".to_owned(),
            None => "–".to_owned(),
        }
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

/// The results of all families.
pub(crate) struct WorkPrecision {
    pub(crate) families: Vec<FamilyPoints>,
}

impl WorkPrecision {
    /// The family with this id.
    pub(crate) fn family(&self, id: &str) -> Option<&FamilyPoints> {
        self.families.iter().find(|f| f.family.id == id)
    }

    /// Geometric mean over the families of the time per simulated second \[µs\] at `rate`, without failed runs.
    pub(crate) fn cost(&self, integrator: Integrator, rate: u32) -> Option<f64> {
        let costs: Vec<f64> = self
            .families
            .iter()
            .filter_map(|f| f.at(integrator, rate)?.microseconds())
            .collect();
        if costs.is_empty() {
            return None;
        }
        let logs: f64 = costs.iter().map(|c| c.ln()).sum();
        Some((logs / costs.len() as f64).exp())
    }

    /// The median over all families and metrics of the ratio between the errors of `integrator` and `best`. Energy
    /// errors are not included.
    pub(crate) fn median_ratio(&self, integrator: Integrator, best: Integrator, rate: u32) -> f64 {
        let mut ratios = Vec::new();
        for f in &self.families {
            for &metric in f.family.metrics.iter().filter(|m| **m != Metric::Energy) {
                let error = |s: Integrator| {
                    let e = f.at(s, rate).and_then(|p| p.run.error(metric));
                    e.unwrap_or(FAILED_RUN_ERROR).max(MIN_RATIO_ERROR)
                };
                ratios.push(error(integrator) / error(best));
            }
        }
        Quantiles::of(ratios).median()
    }
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

/// Progress ticks of [`measure`].
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

/// The runs of one family, without times, and the reference.
fn runs(
    family: &'static Family,
    integrators: &[Integrator],
    divisors: &[u64],
) -> Result<(ReferenceTable, Vec<Point>), Stop> {
    let reference = family
        .reference(INTERVAL, family.setup.duration)
        .map_err(Stop::Internal)?;
    let mut points: Vec<Point> = Vec::new();
    for &integrator in integrators {
        for &divisor in divisors {
            points.push(Point {
                integrator,
                dt: INTERVAL / divisor as f64,
                run: family.run(&reference, integrator, divisor),
                cost: None,
            });
        }
    }
    Ok((reference, points))
}

fn measure_family(ctx: &Context, family: &'static Family) -> Result<FamilyPoints, Stop> {
    let (reference, mut points) = runs(family, &ctx.integrators, divisors(ctx.quick))?;
    // Spread the bodies over the motion, so that the cost covers all phases of the flight.
    let every = (reference.states().len() / 8).max(1);
    let starts: Vec<BodyState> = reference.states().iter().copied().step_by(every).collect();
    let ran: Vec<usize> = (0..points.len())
        .filter(|&k| points[k].run.errors.is_some())
        .collect();
    let mut contenders: Vec<Contender> = ran
        .iter()
        .map(|&k| contender(family, &starts, &points[k]))
        .collect::<Result<_, _>>()?;
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

/// A contender with many boxes in the plugin's code path: the whole scene over a floor, otherwise a few steps from
/// `starts`.
fn contender(
    family: &'static Family,
    starts: &[BodyState],
    p: &Point,
) -> Result<Contender<'static>, Stop> {
    let setup = &family.setup;
    let snapshot = if setup.floor.is_some() {
        Snapshot::of_scene(setup, FLOOR_BOXES, p.dt)
    } else {
        let states = starts.iter().cycle().take(BOXES);
        let bodies = states.map(|s| (&setup.body, s, ContactState::default()));
        Snapshot::new(bodies, &setup.forces, None, p.dt)
    };
    let snapshot = snapshot.ok_or_else(|| Stop::Internal(format!("{}: no bodies", family.id)))?;
    Ok(snapshot.contender(p.integrator))
}

/// Writes the CSV and the figures.
pub(crate) fn section(ctx: &Context, data: &WorkPrecision) -> Result<Section, Stop> {
    let mut section = Section::new(
        "work-precision",
        "Work–precision diagrams",
        format!(
            "Each line is an integrator, each marker a step size; lower left is better. The error is the largest \
             over the run, sampled every 1/15 s, relative to the reference named below each figure, at the time \
             actually simulated. Time is that of a step of one of {BOXES} boxes by the plugin's path on one core, in SIMD lanes \
             under gravity alone (over a floor: over the whole scene with its impacts): {SAMPLES_IN_WORDS}; thin bars extend to the \
             95th percentile. The order in the legend is fitted to the errors between lost and rounding. A run that diverged or \
             left the range of valid states appears as a gap."
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
    section.write_figures(&ctx.folder)?;
    Ok(section)
}

/// Describes how much the measured times varied.
fn spread(data: &WorkPrecision) -> String {
    let costs = data
        .families
        .iter()
        .flat_map(|f| f.points.iter().filter_map(|p| p.cost));
    let spreads: Vec<f64> = costs.map(|c| 100.0 * c.spread()).collect();
    let count = spreads.len();
    let spreads = Quantiles::of(spreads);
    format!(
        "Timing noise: the median sample is at most {:.0} % above the fastest for half of the {} measurements, and at most {:.0} % for 95 % of them.",
        spreads.median(),
        count,
        spreads.at(0.95)
    )
}

/// Table of errors and costs at 60 Hz, the rate of most games.
fn at_60_hz(ctx: &Context, data: &WorkPrecision) -> Table {
    let mut columns = vec!["integrator".to_owned()];
    columns.extend(data.families.iter().map(|f| {
        let metric = f.family.metrics[0];
        format!("{} [{}]", f.family.title, metric.unit())
    }));
    let row = |&integrator: &Integrator| {
        let mut cells = vec![text::code(integrator)];
        cells.extend(data.families.iter().map(|f| {
            match f
                .at(integrator, 60)
                .map(|p| (p.run.error(f.family.metrics[0]), p.cost))
            {
                Some((Some(e), Some(c))) => format!("{} · {:.0} ns", text::error(e), c.min),
                Some((Some(e), None)) => text::error(e),
                _ => "failed".to_owned(),
            }
        }));
        cells
    };
    Table {
        title: "Largest error and time per step at 60 Hz".to_owned(),
        note: format!(
            "Error over the whole run; time of a step of one of {BOXES} boxes by the plugin's path. An attitude error is at most \
             π ≈ 3.1 rad."
        ),
        columns,
        rows: ctx.integrators.iter().map(row).collect(),
        csv: "work-precision.csv".to_owned(),
    }
}

/// Table of the fitted orders.
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
        note: "p in error ∝ dt^p; “rounding”: only rounding errors at every step size; –: lost at too many step sizes for a fit.".to_owned(),
        columns,
        rows: ctx.integrators.iter().map(row).collect(),
        csv: "work-precision.csv".to_owned(),
    }
}

#[cfg(test)]
mod tests;
