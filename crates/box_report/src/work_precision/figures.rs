//! Diagrams of a family: each error against time, and the first error against evaluations.

use box_scenarios::Metric;

use super::{FamilyPoints, Point};
use crate::context::{Context, Stop};
use crate::document::Figure;
use crate::plot::{self, Axis, Line, Plot};

/// Errors above this value are not drawn, because the result is entirely wrong.
const MAX_DRAWN_ERROR: f64 = 1e4;
/// Errors below this value are drawn at it, because they are rounding errors.
const MIN_DRAWN_ERROR: f64 = 1e-16;

/// Families whose first diagram appears in the digest.
const IN_DIGEST: [&str; 6] = [
    "free-tumble",
    "flip",
    "needle",
    "quadratic-drag",
    "heavy-top",
    "corner-drop",
];

/// The quantity on the vertical axis.
#[derive(Clone, Copy, PartialEq)]
enum Work {
    Time,
    Evaluations,
}

pub(super) fn of(ctx: &Context, f: &FamilyPoints) -> Result<Vec<Figure>, Stop> {
    let mut figures = Vec::new();
    for (k, &metric) in f.family.metrics.iter().enumerate() {
        let digest = k == 0 && IN_DIGEST.contains(&f.family.id);
        figures.push(figure(ctx, f, metric, Work::Time, digest)?);
        if k == 0 {
            figures.push(figure(ctx, f, metric, Work::Evaluations, false)?);
        }
    }
    Ok(figures)
}

fn figure(
    ctx: &Context,
    f: &FamilyPoints,
    metric: Metric,
    work: Work,
    digest: bool,
) -> Result<Figure, Stop> {
    let place = |p: &Point| -> Option<plot::Point> {
        let error = p.run.error(metric).filter(|e| *e < MAX_DRAWN_ERROR)?;
        let x = error.max(MIN_DRAWN_ERROR);
        Some(match work {
            Work::Evaluations => plot::Point::new(x, p.evaluations()),
            Work::Time => plot::Point {
                scatter: p
                    .cost
                    .map(|cost| (p.per_second(cost.min), p.per_second(cost.p95))),
                ..plot::Point::new(x, p.microseconds()?)
            },
        })
    };
    let lines = ctx.integrators.iter().map(|&integrator| {
        let label = format!("{integrator} ({})", f.order(integrator, metric));
        Line::of(integrator, label, f.of(integrator).map(place).collect())
    });
    let (axis, suffix, against) = match work {
        Work::Time => ("time per simulated second [µs/s]", "", "time"),
        Work::Evaluations => (
            "force evaluations per simulated second [1/s]",
            "-evaluations",
            "force evaluations",
        ),
    };
    let plot = Plot {
        title: format!("{}: {} against {against}", f.family.title, metric.id()),
        x: Axis::log(metric.title()).within(MIN_DRAWN_ERROR, MAX_DRAWN_ERROR),
        y: Axis::log(axis),
        lines: lines.collect(),
    };
    let steps: Vec<f64> = f.points.iter().map(|p| p.dt).collect();
    let finest = steps.iter().copied().fold(f64::INFINITY, f64::min);
    let coarsest = steps.iter().copied().fold(0.0, f64::max);
    Ok(Figure {
        id: format!("work-precision-{}-{}{suffix}", f.family.id, metric.id()),
        caption: format!(
            "{} {} error against {against}, dt = {} to {} s. Reference: {}.",
            f.family.what,
            capital(metric.id()),
            crate::text::step(coarsest),
            crate::text::step(finest),
            f.reference
        ),
        svg: plot.svg().map_err(Stop::Internal)?,
        digest,
    })
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters
        .next()
        .map(|c| c.to_uppercase().chain(letters).collect())
        .unwrap_or_default()
}
