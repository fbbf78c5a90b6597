//! The measured tables in the README and on the integrators and performance pages. `--docs` rewrites them from the same
//! measurement as the results page.

use std::path::Path;

use box_bench::machine::Machine;
use box_physics::integrators::Integrator;

use crate::context::{SAMPLES_IN_WORDS, Stop};
use crate::document::Table;
use crate::stored::{section, tables};
use crate::summary::Results;
use crate::timing::Timings;
use crate::work_precision::WorkPrecision;
use crate::{files, text};

/// The command that rewrites all of them.
const COMMAND: &str = "cargo box-report --docs docs";
/// Families whose errors are shown on the integrators page.
const FAMILIES: [&str; 7] = [
    "free-tumble",
    "flip",
    "needle",
    "linear-drag",
    "quadratic-drag",
    "heavy-top",
    "bounce",
];
/// Situations whose costs are shown on the integrators page.
const SITUATIONS: [&str; 3] = ["free-many", "free-one", "torque"];

/// Rewrites the measured sections of the files in `docs` and of the README in its parent folder, where these files
/// exist.
/// `summary` is the table of five rows.
pub(crate) fn rewrite(
    docs: &Path,
    summary: &Table,
    results: &Results,
    (machine, quick): (&Machine, bool),
) -> Result<(), Stop> {
    let (Some(work), Some(timings)) = (&results.work_precision, &results.timings) else {
        return Ok(());
    };
    for (file, name, table) in [
        (
            "../README.md",
            "results",
            tables::markdown(&summary.columns, summary.rows.iter().cloned()),
        ),
        ("integrators.md", "errors", errors(work, timings)),
        ("performance.md", "integrators", costs(timings)),
    ] {
        let file = docs.join(file);
        if !file.is_file() {
            continue;
        }
        let mut page = files::read(&file)?;
        let place = section(&file.display().to_string(), &page, name)?;
        let hurry = if quick {
            "; **quick run (`--quick`): times are noisy**"
        } else {
            ""
        };
        let source = format!("\n(`{COMMAND}`; {machine}; {SAMPLES_IN_WORDS}{hurry}.)\n");
        page.replace_range(place, &(table + &source));
        files::write(&file, &page)?;
    }
    Ok(())
}

/// Table of the largest errors at 60 Hz and of the costs.
fn errors(work: &WorkPrecision, timings: &Timings) -> String {
    let families: Vec<_> = FAMILIES.iter().filter_map(|id| work.family(id)).collect();
    let titles = families.iter().map(|f| {
        let (title, unit) = (f.family.title, f.family.metrics[0].unit());
        format!("{title} [{unit}]")
    });
    let mut heading = vec!["at 60 Hz".to_owned()];
    heading.extend(titles);
    heading.extend(timings.titles(&SITUATIONS));
    let rows = Integrator::ALL.iter().map(|&i| {
        let mut row = vec![text::code(i)];
        row.extend(families.iter().map(|f| f.error_in_words(i, 60)));
        row.extend(SITUATIONS.iter().map(|s| nanoseconds(timings.of(s, i))));
        row
    });
    tables::markdown(&heading, rows)
}

/// Table of the cost of every integrator in every situation.
fn costs(timings: &Timings) -> String {
    let situations = timings.situations();
    let mut heading = vec!["integrator".to_owned()];
    heading.extend(timings.titles(&situations));
    let rows = Integrator::ALL.iter().map(|&i| {
        let mut row = vec![text::code(i)];
        row.extend(situations.iter().map(|s| nanoseconds(timings.of(s, i))));
        row
    });
    tables::markdown(&heading, rows)
}

fn nanoseconds(cost: Option<f64>) -> String {
    cost.map_or_else(|| "–".to_owned(), |ns| text::significant(ns, 3))
}
