//! `verify`: compares every integrator with every reference trajectory of a folder, at every requested step.

mod options;
mod table;

use std::io::Write;

use box_bench::measure::{Contender, Settings, interleaved};
use box_physics::integrators::Integrator;
use box_scenarios::oracle::{Case, Measurement, OracleError};
use box_scenarios::run_plan;

use options::Format;
pub(crate) use options::Options;

/// One line of the result.
struct Row<'a> {
    case: &'a Case,
    integrator: Integrator,
    /// The requested step \[s\].
    dt: f64,
    measured: Measurement,
    ns_per_step: Option<f64>,
}

/// Reasons why nothing was verified.
#[derive(Debug, thiserror::Error)]
pub(crate) enum VerifyError {
    /// The folder cannot be listed.
    #[error(transparent)]
    Folder(#[from] OracleError),
    /// The folder contains no reference trajectory.
    #[error("{folder}: no *.json file in this folder")]
    Empty {
        /// The folder.
        folder: String,
    },
    /// `--case` excludes everything.
    #[error("no case matches '{glob}'; allowed: {names}")]
    NoMatch {
        /// The pattern.
        glob: String,
        /// The names of all cases.
        names: String,
    },
    /// The output cannot be written.
    #[error("cannot write the result: {0}")]
    Output(#[from] std::io::Error),
}

impl From<csv::Error> for VerifyError {
    fn from(e: csv::Error) -> Self {
        Self::Output(e.into())
    }
}

/// Runs the comparison and prints the result. Returns the files that could not be used; the result contains the others.
pub(crate) fn run(
    options: &Options,
    out: &mut impl Write,
) -> Result<Vec<OracleError>, VerifyError> {
    let files = Case::load_folder(&options.folder)?;
    if files.is_empty() {
        return Err(VerifyError::Empty {
            folder: options.folder.display().to_string(),
        });
    }
    let (mut cases, mut bad) = (Vec::new(), Vec::new());
    for file in files {
        match file {
            Ok(case) => cases.push(case),
            Err(e) => bad.push(e),
        }
    }
    if let Some(glob) = &options.case {
        let names: Vec<_> = cases.iter().map(|c| c.name.clone()).collect();
        cases.retain(|c| glob.matches(&c.name));
        if cases.is_empty() && bad.is_empty() {
            return Err(VerifyError::NoMatch {
                glob: glob.to_string(),
                names: names.join(", "),
            });
        }
    }
    match options.format {
        Format::Csv => table::write_csv(rows(&cases, options), out)?,
        Format::Table => table::write_table(rows(&cases, options), out)?,
    }
    Ok(bad)
}

/// The rows, ordered by case, then integrator, then step. A case is measured when its first row is requested, because
/// its integrators and steps are timed in turns.
fn rows<'a>(cases: &'a [Case], options: &'a Options) -> impl Iterator<Item = Row<'a>> {
    cases.iter().flat_map(move |case| {
        let mut rows: Vec<Row> = options
            .integrators()
            .iter()
            .flat_map(|&integrator| {
                options.dt.iter().map(move |&dt| Row {
                    case,
                    integrator,
                    dt,
                    measured: case.measure(integrator, dt),
                    ns_per_step: None,
                })
            })
            .collect();
        let mut timed: Vec<(&mut Row, Contender)> = rows
            .iter_mut()
            .filter(|r| r.measured.totals.steps > 0)
            .map(|row| {
                let contender = whole_run(row);
                (row, contender)
            })
            .collect();
        let (rows_timed, mut contenders): (Vec<_>, Vec<_>) = timed.drain(..).unzip();
        let costs = interleaved(&mut contenders, &Settings::default());
        for (row, cost) in rows_timed.into_iter().zip(costs) {
            row.ns_per_step = Some(cost.min);
        }
        rows
    })
}

/// A contender for the run of a row from start to last sample; its unit is a step.
fn whole_run<'a>(row: &Row<'a>) -> Contender<'a> {
    let (case, integrator, plan) = (row.case, row.integrator, row.case.plan(row.dt));
    Contender::new(row.measured.totals.steps as f64, move || {
        run_plan(&case.setup, integrator, &plan, |_, state| {
            std::hint::black_box(state.position);
            state.is_finite()
        });
    })
}
