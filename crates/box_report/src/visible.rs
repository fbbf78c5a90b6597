//! `visible`: the time until a player can see the error: 1° of attitude, or 1 % of the box's size.

use box_physics::integrators::Integrator;
use box_scenarios::{Family, Metric};
use serde::Serialize;

use crate::context::{Context, Stop};
use crate::document::{Section, Table};
use crate::{files, text};

/// Steps per second.
pub(crate) const RATES: [u32; 3] = [30, 60, 120];
/// Attitude error above which a difference is visible \[rad\].
const ATTITUDE: f64 = core::f64::consts::PI / 180.0;
/// Position error above which a difference is visible, relative to the longest edge.
const SIZE: f64 = 0.01;
/// Time for which a player watches one throw or spin before the next push \[s\]. Recommendations are based on it.
pub(crate) const THROW: f64 = 10.0;
/// Time by which every scene has ended \[s\].
pub(crate) const MINUTE: f64 = 60.0;
/// Maximum time per scene with `--quick` \[s\].
const QUICK_WATCH: f64 = THROW;

/// Result of one integrator in one scene at one rate.
#[derive(Clone, Copy, Debug)]
struct Seen {
    family: usize,
    integrator: Integrator,
    rate: u32,
    /// The time at which an error becomes visible, and which error; `None` if none does until the end.
    at: Option<(f64, Metric)>,
    /// End of the scene \[s\].
    end: f64,
}

/// The results of all scenes.
pub(crate) struct Visible {
    seen: Vec<Seen>,
}

impl Visible {
    /// The number of scenes in which `integrator` has no visible error at `rate`, for `seconds` or to the end.
    pub(crate) fn invisible(&self, integrator: Integrator, rate: u32, seconds: f64) -> usize {
        let unseen = |s: &&Seen| s.at.is_none_or(|(t, _)| t > seconds);
        self.of(integrator, rate).filter(unseen).count()
    }

    /// The time of the first visible error of `integrator` in any scene at `rate` \[s\], if there is one.
    pub(crate) fn first(&self, integrator: Integrator, rate: u32) -> Option<f64> {
        let times = self.of(integrator, rate).filter_map(|s| Some(s.at?.0));
        times.reduce(f64::min)
    }

    fn of(&self, integrator: Integrator, rate: u32) -> impl Iterator<Item = &Seen> {
        let wanted = move |s: &&Seen| s.integrator == integrator && s.rate == rate;
        self.seen.iter().filter(wanted)
    }
}

#[derive(Serialize)]
struct Row {
    family: &'static str,
    integrator: &'static str,
    rate_hz: u32,
    /// Empty if no error is visible until the end.
    visible_after_s: Option<f64>,
    error: Option<&'static str>,
    watched_s: f64,
}

/// Progress ticks of [`measure`].
pub(crate) fn ticks() -> u64 {
    Family::all().len() as u64
}

/// Runs every scene with every integrator at every rate.
pub(crate) fn measure(ctx: &Context) -> Result<Visible, Stop> {
    let longest = if ctx.quick { QUICK_WATCH } else { MINUTE };
    watch(&ctx.integrators, longest, |family| ctx.tick(family.title))
}

/// Runs every scene to its end or for `longest` \[s\], and calls `done` after each scene.
fn watch(
    integrators: &[Integrator],
    longest: f64,
    mut done: impl FnMut(&Family) -> Result<(), Stop>,
) -> Result<Visible, Stop> {
    let mut seen = Vec::new();
    for (k, family) in Family::all().iter().enumerate() {
        let end = family.watch.min(longest);
        let finest = RATES[RATES.len() - 1];
        let reference = family
            .reference(1.0 / f64::from(finest), end)
            .map_err(Stop::Internal)?;
        let size = 2.0 * family.setup.body.half_extents().max_element();
        for rate in RATES {
            let reference = reference.every((finest / rate) as usize);
            for &integrator in integrators {
                let at = family.first_passing(&reference, integrator, 1, ATTITUDE, SIZE * size);
                seen.push(Seen {
                    family: k,
                    integrator,
                    rate,
                    at,
                    end,
                });
            }
        }
        done(family)?;
    }
    Ok(Visible { seen })
}

/// Writes the CSV file and creates the tables.
pub(crate) fn section(ctx: &Context, data: &Visible) -> Result<Section, Stop> {
    let mut section = Section::new(
        "visible",
        "Time until an error is visible",
        "Time until the attitude error exceeds 1° or the position error exceeds 1 % of the box's longest \
         edge, whichever comes first, over a minute of each scene (corner drop: one second). Compared with the reference \
         at every step.",
    );
    let rows: Vec<Row> = data
        .seen
        .iter()
        .map(|s| Row {
            family: Family::all()[s.family].id,
            integrator: s.integrator.id(),
            rate_hz: s.rate,
            visible_after_s: s.at.map(|(t, _)| t),
            error: s.at.map(|(_, m)| m.id()),
            watched_s: s.end,
        })
        .collect();
    files::write_csv(&ctx.file("visible.csv"), &rows)?;
    for rate in RATES {
        section.tables.push(table(ctx, data, rate));
        let mut never: Vec<(usize, Integrator)> = ctx
            .integrators
            .iter()
            .map(|&s| (data.invisible(s, rate, MINUTE), s))
            .collect();
        never.sort_by_key(|n| std::cmp::Reverse(n.0));
        let best: Vec<String> = never
            .iter()
            .take(3)
            .map(|(n, s)| format!("`{s}` {n}"))
            .collect();
        section.verdicts.push(format!(
            "At {rate} Hz, scenes out of {} without a visible error to the end: {} (best three).",
            Family::all().len(),
            best.join(", ")
        ));
    }
    Ok(section)
}

fn table(ctx: &Context, data: &Visible, rate: u32) -> Table {
    let mut columns = vec!["integrator".to_owned()];
    columns.extend(Family::all().iter().map(|f| f.title.to_owned()));
    let row = |&integrator: &Integrator| {
        let mut cells = vec![text::code(integrator)];
        cells.extend(data.of(integrator, rate).map(|s| match s.at {
            None => format!("> {} s", text::significant(s.end, 2)),
            Some((t, m)) => {
                let which = if m == Metric::Position { "x" } else { "°" };
                format!("{} s {which}", text::significant(t, 2))
            }
        }));
        cells
    };
    Table {
        title: format!("Time until the error is visible at {rate} Hz"),
        note: "°: attitude error, x: position error. “> 60 s”: not visible within the minute."
            .to_owned(),
        columns,
        rows: ctx.integrators.iter().map(row).collect(),
        csv: "visible.csv".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_shows_under_the_default_for_a_minute() {
        let (default, engine) = (Integrator::Split, Integrator::EngineRescaled);
        let data = watch(&[default, engine], MINUTE, |_| Ok(())).expect("references");
        let scenes = Family::all().len();
        for rate in RATES {
            let first = data.first(default, rate);
            let unseen = data.invisible(default, rate, MINUTE);
            assert_eq!(unseen, scenes, "{rate} Hz: first visible after {first:?} s");
            assert!(data.invisible(engine, rate, MINUTE) < scenes / 2);
        }
    }
}
