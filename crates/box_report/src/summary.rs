//! The summary: which integrator to take, its cost, its error, and when it breaks.

use box_physics::integrators::{Integrator, Limit};
use box_scenarios::Family;
use serde::Serialize;

use crate::context::{Context, Stop};
use crate::dissertation::answer::{cost, median_ratio};
use crate::document::{Section, Table};
use crate::efficiency::CLEARLY;
use crate::stability::{StabilityData, shown};
use crate::timing::Timings;
use crate::visible::{MINUTE, RATES, THROW, Visible};
use crate::work_precision::WorkPrecision;
use crate::{files, text};

/// The measurements so far.
#[derive(Default)]
pub(crate) struct Results {
    pub(crate) work_precision: Option<WorkPrecision>,
    pub(crate) stability: Option<StabilityData>,
    pub(crate) timings: Option<Timings>,
    pub(crate) visible: Option<Visible>,
}

impl Results {
    /// The integrator for a game at `rate`: among those that survive every hard case (where these were
    /// measured) the one that shows nothing for a throw's time in most scenes, of equals for a minute, and of
    /// equals the cheapest.
    pub(crate) fn recommended(&self, ctx: &Context, rate: u32) -> Option<Integrator> {
        let (work, visible) = (self.work_precision.as_ref()?, self.visible.as_ref()?);
        let survives = |s: &Integrator| {
            let score = self.stability.as_ref().map(|d| d.score(*s));
            score.is_none_or(|[_, _, diverged]| diverged == 0)
        };
        let rank = |s: Integrator| {
            let scenes = [THROW, MINUTE].map(|t| visible.invisible(s, rate, t));
            (scenes, cost(work, s, rate).unwrap_or(f64::INFINITY))
        };
        let best = |integrators: &mut dyn Iterator<Item = Integrator>| {
            integrators.max_by(|&a, &b| {
                let ((scenes_a, cost_a), (scenes_b, cost_b)) = (rank(a), rank(b));
                scenes_a.cmp(&scenes_b).then(cost_b.total_cmp(&cost_a))
            })
        };
        // Where none of the integrators compared survives everything, the best of them.
        best(&mut ctx.integrators.iter().copied().filter(survives))
            .or_else(|| best(&mut ctx.integrators.iter().copied()))
    }

    /// The integrators that have both a smaller error than `one` in the median scene and a clearly smaller cost at
    /// `rate`.
    fn better_and_cheaper(&self, ctx: &Context, one: Integrator, rate: u32) -> Vec<Integrator> {
        let Some(work) = self.work_precision.as_ref() else {
            return Vec::new();
        };
        let price = |s| cost(work, s, rate).unwrap_or(f64::INFINITY);
        let beats = |s: &Integrator| {
            *s != one && price(*s) < CLEARLY * price(one) && median_ratio(work, *s, one, rate) < 1.0
        };
        ctx.integrators.iter().copied().filter(beats).collect()
    }

    /// The cheapest integrator of all at `rate`.
    fn cheapest(&self, ctx: &Context, rate: u32) -> Option<Integrator> {
        let work = self.work_precision.as_ref()?;
        let cost = |s: Integrator| cost(work, s, rate).unwrap_or(f64::INFINITY);
        let integrators = ctx.integrators.iter().copied();
        integrators.min_by(|&a, &b| cost(a).total_cmp(&cost(b)))
    }
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
    us_per_simulated_s_60hz: Option<f64>,
    ns_per_step_many: Option<f64>,
    ns_per_step_one: Option<f64>,
    limit_spin: String,
    limit_drag: String,
    limit_spring: String,
    hard_cases_ok: Option<usize>,
    hard_cases_degraded: Option<usize>,
    hard_cases_diverged: Option<usize>,
}

/// The first section.
pub(crate) fn section(ctx: &Context, results: &Results) -> Result<Section, Stop> {
    let mut section = Section::new(
        "summary",
        "In a minute",
        "Which integrator to take for a game: its cost, its error, and when it breaks.",
    );
    let scenes = Family::all().len();
    let row = |&s: &Integrator| {
        let seen = |rate, seconds| {
            let visible = results.visible.as_ref();
            visible.map(|v| v.invisible(s, rate, seconds))
        };
        let limits = results
            .stability
            .as_ref()
            .and_then(|d| d.limits(s).copied());
        let limit = |k: usize| limits.map_or_else(String::new, |l: [Limit; 3]| shown(l[k]));
        let score = results.stability.as_ref().map(|d| d.score(s));
        Row {
            integrator: s.id(),
            invisible_10s_30hz: seen(30, THROW),
            invisible_10s_60hz: seen(60, THROW),
            invisible_10s_120hz: seen(120, THROW),
            invisible_60s_30hz: seen(30, MINUTE),
            invisible_60s_60hz: seen(60, MINUTE),
            invisible_60s_120hz: seen(120, MINUTE),
            us_per_simulated_s_60hz: results.work_precision.as_ref().and_then(|w| cost(w, s, 60)),
            ns_per_step_many: results.timings.as_ref().and_then(|t| t.many(s)),
            ns_per_step_one: results.timings.as_ref().and_then(|t| t.one(s)),
            limit_spin: limit(0),
            limit_drag: limit(1),
            limit_spring: limit(2),
            hard_cases_ok: score.map(|s| s[0]),
            hard_cases_degraded: score.map(|s| s[1]),
            hard_cases_diverged: score.map(|s| s[2]),
        }
    };
    let rows: Vec<Row> = ctx.integrators.iter().map(row).collect();
    files::write_csv(&ctx.file("summary.csv"), &rows)?;
    section.tables.push(Table {
        title: "Every integrator".to_owned(),
        note: format!(
            "Nothing shows: scenes of {scenes} in which neither 1° nor 1 % of the box's size is passed in 10 s and in 60 s, at 30, 60 and 120 Hz. \
             Cost: geometric mean over the scenes at 60 Hz per box and simulated second, many boxes; a step in free flight of many boxes \
             (SIMD lanes) and of one (plain step). Breaks beyond: largest stable step. \
             Hard cases: ok, degraded, diverged."
        ),
        columns: [
            "integrator",
            "nothing shows for 10 s, 30 · 60 · 120 Hz",
            "for 60 s",
            "cost [µs/s]",
            "free step, many boxes [ns]",
            "one box [ns]",
            "breaks beyond |ω|·dt",
            "c·dt/m",
            "√(k/m)·dt",
            "hard cases",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.iter().map(cells).collect(),
        csv: "summary.csv".to_owned(),
        digest: true,
    });
    section.verdicts = verdicts(ctx, results);
    Ok(section)
}

fn cells(r: &Row) -> Vec<String> {
    let or_dash = |n: Option<usize>| n.map_or_else(|| "–".to_owned(), |n| n.to_string());
    let number =
        |x: Option<f64>, digits| x.map_or_else(|| "–".to_owned(), |x| text::significant(x, digits));
    vec![
        text::code(r.integrator),
        format!(
            "{} · {} · {}",
            or_dash(r.invisible_10s_30hz),
            or_dash(r.invisible_10s_60hz),
            or_dash(r.invisible_10s_120hz)
        ),
        format!(
            "{} · {} · {}",
            or_dash(r.invisible_60s_30hz),
            or_dash(r.invisible_60s_60hz),
            or_dash(r.invisible_60s_120hz)
        ),
        number(r.us_per_simulated_s_60hz, 2),
        number(r.ns_per_step_many, 3),
        number(r.ns_per_step_one, 3),
        r.limit_spin.clone(),
        r.limit_drag.clone(),
        r.limit_spring.clone(),
        format!(
            "{} · {} · {}",
            or_dash(r.hard_cases_ok),
            or_dash(r.hard_cases_degraded),
            or_dash(r.hard_cases_diverged)
        ),
    ]
}

/// How many hard cases `integrator` survives, in words.
fn survived(results: &Results, integrator: Integrator) -> String {
    results.stability.as_ref().map_or_else(
        || "hard cases that were not measured".to_owned(),
        |d| {
            let [ok, degraded, diverged] = d.score(integrator);
            let all = ok + degraded + diverged;
            format!("{} of {all} hard cases ({ok} ok)", ok + degraded)
        },
    )
}

fn verdicts(ctx: &Context, results: &Results) -> Vec<String> {
    let mut said = Vec::new();
    if let (Some(work), Some(visible)) = (&results.work_precision, &results.visible) {
        for rate in RATES {
            let Some(best) = results.recommended(ctx, rate) else {
                continue;
            };
            let Some(cheapest) = results.cheapest(ctx, rate) else {
                continue;
            };
            let price = |s| text::significant(cost(work, s, rate).unwrap_or(f64::NAN), 2);
            let scenes = Family::all().len();
            let first = visible.first(best, rate).map_or_else(
                || "never in a minute".to_owned(),
                |t| format!("{} s at the earliest", text::significant(t, 2)),
            );
            said.push(format!(
                "**At {rate} Hz take `{best}`**: for ten seconds nothing shows in {} of {scenes} scenes, for a minute in {} (first visible: {first}), \
                 at {} µs per box and simulated second, and it survives {}. The cheapest of all, `{cheapest}`, costs {} µs; \
                 with it nothing shows for ten seconds in {}. {}",
                visible.invisible(best, rate, THROW),
                visible.invisible(best, rate, MINUTE),
                price(best),
                survived(results, best),
                price(cheapest),
                visible.invisible(cheapest, rate, THROW),
                match results.better_and_cheaper(ctx, best, rate).as_slice() {
                    [] => "No integrator has both a smaller error in the median scene and a smaller cost.".to_owned(),
                    better => format!(
                        "Both a smaller error in the median scene and a smaller cost: {}.",
                        text::list(&better.iter().map(text::code).collect::<Vec<_>>())
                    ),
                }
            ));
        }
    }
    if let Some(stability) = &results.stability {
        let unlimited = |k: usize| {
            let free = ctx.integrators.iter().filter(|s| {
                let limits = stability.limits(**s);
                limits.is_some_and(|l| l[k] == Limit::None)
            });
            text::list(&free.map(text::code).collect::<Vec<_>>())
        };
        said.push(format!(
            "**Springs too stiff for the step**: stable at every step tried are {}.",
            unlimited(2)
        ));
        said.push(format!(
            "**Drag too stiff for the step**: stable at every step tried are {}.",
            unlimited(1)
        ));
        let growing: Vec<String> = ctx
            .integrators
            .iter()
            .filter(|s| {
                let limits = stability.limits(**s);
                limits.is_some_and(|l| l.contains(&Limit::AlwaysGrows))
            })
            .map(text::code)
            .collect();
        said.push(format!(
            "**Not for spinning boxes or undamped springs**, whose energy they raise at every step: {}.",
            text::list(&growing)
        ));
    }
    said
}
