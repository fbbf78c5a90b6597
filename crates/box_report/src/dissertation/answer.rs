//! An answer to the dissertation's question: which integrator to choose for simple rigid bodies in a game, at 30, 60
//! and 120 Hz, and how much it gains.

use box_physics::integrators::Integrator;
use serde::Serialize;

use crate::context::{Context, Stop};
use crate::document::Table;
use crate::summary::Results;
use crate::visible::{MINUTE, RATES, THROW};
use crate::{files, text};

/// The two integrators of the dissertation: Heun with its position rule, and the textbook form of RK4.
const ITS: [Integrator; 2] = [Integrator::Heun2012, Integrator::Rk4];

#[derive(Serialize)]
struct Row {
    rate_hz: u32,
    integrator: &'static str,
    invisible_10s: usize,
    invisible_60s: usize,
    microseconds_per_simulated_s: f64,
    median_error_over_the_best: f64,
}

/// The table and its conclusions; `None` if the measurements that they need are missing.
pub(super) fn table(
    ctx: &Context,
    results: &Results,
) -> Result<Option<(Table, Vec<String>)>, Stop> {
    let (Some(work), Some(visible)) = (&results.work_precision, &results.visible) else {
        return Ok(None);
    };
    let mut rows = Vec::new();
    let mut verdicts = Vec::new();
    for rate in RATES {
        let Some(best) = results.recommended(ctx, rate) else {
            continue;
        };
        let mut compared = vec![best];
        compared.extend(
            ITS.iter()
                .copied()
                .filter(|s| *s != best && ctx.integrators.contains(s)),
        );
        for &s in &compared {
            rows.push(Row {
                rate_hz: rate,
                integrator: s.id(),
                invisible_10s: visible.invisible(s, rate, THROW),
                invisible_60s: visible.invisible(s, rate, MINUTE),
                microseconds_per_simulated_s: work.cost(s, rate).unwrap_or(f64::NAN),
                median_error_over_the_best: work.median_ratio(s, best, rate),
            });
        }
        let against = |s: Integrator| -> Option<String> {
            if s == best {
                return None;
            }
            let (own, other) = (work.cost(best, rate)?, work.cost(s, rate)?);
            Some(format!(
                "`{s}`: {} scenes, {} times the error in the median scene, {} times the cost",
                visible.invisible(s, rate, THROW),
                ratio(work.median_ratio(s, best, rate)),
                text::significant(other / own, 2)
            ))
        };
        let compared: Vec<String> = ITS.iter().copied().filter_map(against).collect();
        verdicts.push(format!(
            "At {rate} Hz, the answer is `{best}`: no visible error for ten seconds in {} of {} scenes, at {} µs per box and simulated second. By comparison, {}.",
            visible.invisible(best, rate, THROW),
            work.families.len(),
            text::significant(work.cost(best, rate).unwrap_or(f64::NAN), 2),
            compared.join("; ")
        ));
    }
    files::write_csv(&ctx.file("dissertation-answer.csv"), &rows)?;
    let cells = rows
        .iter()
        .map(|r| {
            vec![
                format!("{} Hz", r.rate_hz),
                text::code(r.integrator),
                format!(
                    "{} · {} of {}",
                    r.invisible_10s,
                    r.invisible_60s,
                    work.families.len()
                ),
                text::significant(r.microseconds_per_simulated_s, 2),
                ratio(r.median_error_over_the_best),
            ]
        })
        .collect();
    let table = Table {
        title: "The answer to its question: the integrator for simple rigid bodies in a game".to_owned(),
        note: "First row at each rate: of the integrators that survive every hard case, the one with the most scenes without a visible error (1° or 1 % of the size) in ten seconds, then in a minute; \
               of equals, the cheapest. Below it, the dissertation's two. Cost: geometric mean over the scenes of the time per box and simulated second."
            .to_owned(),
        columns: text::columns(
            "rate | integrator | scenes without a visible error in 10 s · 60 s | cost [µs/s] | \
             error relative to the first, median scene",
        ),
        rows: cells,
        csv: "dissertation-answer.csv".to_owned(),
    };
    Ok(Some((table, verdicts)))
}

fn ratio(x: f64) -> String {
    if x >= 1e4 {
        format!("{x:.0e}")
    } else {
        text::significant(x, 2)
    }
}
