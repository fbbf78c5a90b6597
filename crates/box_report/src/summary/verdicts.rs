//! Conclusions from the measurements, as sentences.

use super::Results;
use crate::context::Context;
use crate::efficiency::CLEARLY_CHEAPER;
use crate::text;
use crate::visible::{MINUTE, THROW};
use box_physics::integrators::{Integrator, Limit};
use box_scenarios::Family;

impl Results {
    /// The recommended integrator for a game at `rate`. Candidates are the integrators that survive every hard case, if
    /// these were measured. The best one has no visible error for the time of a throw in the largest number of scenes.
    /// Ties are decided by the number for a minute, then by the cost.
    pub(crate) fn recommended(&self, ctx: &Context, rate: u32) -> Option<Integrator> {
        let (work, visible) = (self.work_precision.as_ref()?, self.visible.as_ref()?);
        let survives = |s: &Integrator| {
            let score = self.stability.as_ref().map(|d| d.score(*s));
            score.is_none_or(|[_, _, diverged]| diverged == 0)
        };
        let rank = |s: Integrator| {
            let scenes = [THROW, MINUTE].map(|t| visible.invisible(s, rate, t));
            (scenes, work.cost(s, rate).unwrap_or(f64::INFINITY))
        };
        let best = |integrators: &mut dyn Iterator<Item = Integrator>| {
            integrators.max_by(|&a, &b| {
                let ((scenes_a, cost_a), (scenes_b, cost_b)) = (rank(a), rank(b));
                scenes_a.cmp(&scenes_b).then(cost_b.total_cmp(&cost_a))
            })
        };
        // If none of the integrators survives every case, take the best of all.
        best(&mut ctx.integrators.iter().copied().filter(survives))
            .or_else(|| best(&mut ctx.integrators.iter().copied()))
    }

    /// The integrators that have both a smaller error than `one` in the median scene and a clearly smaller cost at
    /// `rate`.
    pub(super) fn better_and_cheaper(
        &self,
        ctx: &Context,
        one: Integrator,
        rate: u32,
    ) -> Vec<Integrator> {
        let Some(work) = self.work_precision.as_ref() else {
            return Vec::new();
        };
        let price = |s| work.cost(s, rate).unwrap_or(f64::INFINITY);
        let beats = |s: &Integrator| {
            *s != one
                && price(*s) < CLEARLY_CHEAPER * price(one)
                && work.median_ratio(*s, one, rate) < 1.0
        };
        ctx.integrators.iter().copied().filter(beats).collect()
    }

    /// The cheapest integrator at `rate`.
    fn cheapest(&self, ctx: &Context, rate: u32) -> Option<Integrator> {
        let work = self.work_precision.as_ref()?;
        let cost = |s: Integrator| work.cost(s, rate).unwrap_or(f64::INFINITY);
        let integrators = ctx.integrators.iter().copied();
        integrators.min_by(|&a, &b| cost(a).total_cmp(&cost(b)))
    }
}

/// Describes where `rk4` is the better choice than `split` at 60 Hz: without a visible error, and cheaper.
fn rk4_wins(results: &Results) -> Option<String> {
    let (work, visible) = (results.work_precision.as_ref()?, results.visible.as_ref()?);
    let (ours, theirs) = (Integrator::Split, Integrator::Rk4);
    let unseen = visible.invisible(theirs, 60, MINUTE);
    let ratio = |scene: &str| {
        let cost = |i| results.timings.as_ref()?.of(scene, i);
        Some(text::significant(cost(theirs)? / cost(ours)?, 2))
    };
    let better: Vec<String> = work
        .families
        .iter()
        .filter_map(|f| {
            let error = |i| f.at(i, 60)?.run.error(f.family.metrics[0]);
            let (own, other) = (error(ours)?, error(theirs)?);
            // Ignore differences between rounding errors.
            (other < own && own > 1e-9).then(|| {
                format!(
                    "{} ({} against {} {})",
                    f.family.title.to_lowercase(),
                    text::error(other),
                    text::error(own),
                    f.family.metrics[0].unit()
                )
            })
        })
        .collect();
    Some(format!(
        "**Where `rk4` wins**: in {unseen} of {} scenes, its error is not visible for a minute. There it is the better choice if it \
         costs less than `split`: {} of its cost in flight, {} under a torque. Its error is smaller than `split`'s in: {}.",
        work.families.len(),
        ratio("free-many")?,
        ratio("torque")?,
        text::list(&better)
    ))
}

/// Describes how many hard cases `integrator` survives.
fn survived(results: &Results, integrator: Integrator) -> String {
    results.stability.as_ref().map_or_else(
        || "an unknown number of hard cases (not measured)".to_owned(),
        |d| {
            let [ok, degraded, diverged] = d.score(integrator);
            let all = ok + degraded + diverged;
            format!("{} of {all} hard cases ({ok} ok)", ok + degraded)
        },
    )
}

/// Recommends an integrator at `rate` and compares it with the cheapest.
fn recommendation(ctx: &Context, results: &Results, rate: u32) -> Option<String> {
    let (work, visible) = (results.work_precision.as_ref()?, results.visible.as_ref()?);
    let (best, cheapest) = (
        results.recommended(ctx, rate)?,
        results.cheapest(ctx, rate)?,
    );
    let price = |s| text::significant(work.cost(s, rate).unwrap_or(f64::NAN), 2);
    let scenes = Family::all().len();
    let first = visible.first(best, rate).map_or_else(
        || "not within a minute".to_owned(),
        |t| format!("after {} s at the earliest", text::significant(t, 2)),
    );
    Some(format!(
        "**At {rate} Hz, use `{best}`**: no error is visible for a minute in {} of {scenes} scenes (first visible error: {first}), at {} µs per \
         box and simulated second. It survives {}. The cheapest integrator, `{cheapest}`, costs {} µs; with it, no error is visible for ten \
         seconds in {} of {scenes} scenes. {}",
        visible.invisible(best, rate, MINUTE),
        price(best),
        survived(results, best),
        price(cheapest),
        visible.invisible(cheapest, rate, THROW),
        match results.better_and_cheaper(ctx, best, rate).as_slice() {
            [] => "No integrator has both a smaller error in the median scene and a smaller cost."
                .to_owned(),
            better => format!(
                "Both a smaller error in the median scene and a smaller cost: {}.",
                text::list(&better.iter().map(text::code).collect::<Vec<_>>())
            ),
        }
    ))
}

/// All conclusions. The first two also appear in the digest.
pub(super) fn verdicts(ctx: &Context, results: &Results) -> Vec<String> {
    let mut said = Vec::new();
    for rate in [60, 30, 120] {
        said.extend(recommendation(ctx, results, rate));
        if rate == 60 {
            said.extend(rk4_wins(results));
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
            "**Springs too stiff for the step**: stable at every step size tried: {}.",
            unlimited(3)
        ));
        said.push(format!(
            "**Drag too stiff for the step**: stable at every step size tried: {}.",
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
            "**Not for spinning boxes or undamped springs**, because they add energy at any step size: {}.",
            text::list(&growing)
        ));
    }
    said
}
