//! `check`: a short, deterministic run whose errors must be what they were. Times are never compared.

use std::path::{Path, PathBuf};

use box_physics::integrators::Integrator;
use box_scenarios::{Family, Metric};
use clap::Args;
use serde::{Deserialize, Serialize};

use crate::context::Stop;
use crate::files;
use crate::work_precision::INTERVAL;

/// Divisors of 1/15 s: 30, 60 and 240 Hz.
const DIVISORS: [u64; 3] = [2, 4, 16];
/// Relative and absolute difference within which two errors are the same: formulas of another machine's
/// mathematical library round differently, and a motion stretches that.
const SAME: (f64, f64) = (1e-5, 1e-8);
/// Errors beyond this are lost runs: that they are lost is compared, not where they ended up.
const LOST: f64 = 0.5;
/// Differences shown at most.
const SHOWN: usize = 40;

/// What to compare with.
#[derive(Args)]
pub(crate) struct Options {
    /// The stored errors
    #[arg(long, value_name = "FILE", default_value_os_t = stored())]
    expected: PathBuf,
    /// Store what this run finds, instead of comparing
    #[arg(long)]
    update: bool,
}

fn stored() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/expected/report.csv")
}

/// The errors of one run; empty where it failed, or where the energy is not constant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Row {
    family: String,
    integrator: String,
    steps_per_s: u64,
    position_error_m: Option<f64>,
    attitude_error_rad: Option<f64>,
    energy_error_rel: Option<f64>,
    evaluations: u64,
}

impl Row {
    fn key(&self) -> (&str, &str, u64) {
        (&self.family, &self.integrator, self.steps_per_s)
    }

    fn errors(&self) -> [(&'static str, Option<f64>); 3] {
        [
            ("position_error_m", self.position_error_m),
            ("attitude_error_rad", self.attitude_error_rad),
            ("energy_error_rel", self.energy_error_rel),
        ]
    }
}

/// Compares, or stores.
pub(crate) fn run(options: &Options) -> Result<(), Stop> {
    let now = measure()?;
    if options.update {
        if let Some(folder) = options.expected.parent() {
            files::create_folder(folder)?;
        }
        files::write_csv(&options.expected, &now)?;
        println!("{}: {} runs stored", options.expected.display(), now.len());
        return Ok(());
    }
    let text = files::read(&options.expected)?;
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let stored: Vec<Row> = reader
        .deserialize()
        .collect::<Result<_, _>>()
        .map_err(|e| Stop::Usage(format!("{}: {e}", options.expected.display())))?;
    let differences = compare(&stored, &now);
    if differences.is_empty() {
        println!("{} runs have the errors that they had", now.len());
        return Ok(());
    }
    let mut message = format!(
        "{} differences from {}:",
        differences.len(),
        options.expected.display()
    );
    for d in differences.iter().take(SHOWN) {
        message += &format!("\n  {d}");
    }
    if differences.len() > SHOWN {
        message += &format!("\n  … and {} more", differences.len() - SHOWN);
    }
    message += "\nIf they are meant: box_report check --update";
    Err(Stop::Changed(message))
}

fn measure() -> Result<Vec<Row>, Stop> {
    let mut rows = Vec::new();
    for family in Family::all() {
        let reference = family
            .reference(INTERVAL, family.setup.duration)
            .map_err(Stop::Internal)?;
        for &integrator in Integrator::ALL {
            for divisor in DIVISORS {
                let run = family.run(&reference, integrator, divisor);
                let error = |m: Metric| {
                    let known = m != Metric::Energy || family.metrics.contains(&m);
                    run.error(m).filter(|_| known)
                };
                rows.push(Row {
                    family: family.id.to_owned(),
                    integrator: integrator.id().to_owned(),
                    steps_per_s: 15 * divisor,
                    position_error_m: error(Metric::Position),
                    attitude_error_rad: error(Metric::Attitude),
                    energy_error_rel: error(Metric::Energy),
                    evaluations: run.totals.evaluations,
                });
            }
        }
    }
    Ok(rows)
}

/// Every difference, in words.
fn compare(stored: &[Row], now: &[Row]) -> Vec<String> {
    let mut differences = Vec::new();
    for new in now {
        let (family, integrator, rate) = new.key();
        let name = format!("{family} {integrator} {rate} Hz");
        let Some(old) = stored.iter().find(|o| o.key() == new.key()) else {
            differences.push(format!("{name}: not stored"));
            continue;
        };
        for ((column, before), (_, after)) in old.errors().into_iter().zip(new.errors()) {
            if !same(before, after) {
                let shown =
                    |x: Option<f64>| x.map_or_else(|| "failed".to_owned(), |x| format!("{x:e}"));
                differences.push(format!(
                    "{name}: {column} was {}, is {}",
                    shown(before),
                    shown(after)
                ));
            }
        }
    }
    for old in stored {
        if !now.iter().any(|n| n.key() == old.key()) {
            let (family, integrator, rate) = old.key();
            differences.push(format!(
                "{family} {integrator} {rate} Hz: stored, but not run"
            ));
        }
    }
    differences
}

fn same(before: Option<f64>, after: Option<f64>) -> bool {
    match (before, after) {
        (Some(a), Some(b)) => {
            (a > LOST && b > LOST) || (a - b).abs() <= SAME.0 * a.abs().max(b.abs()) + SAME.1
        }
        (a, b) => a == b,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(attitude: Option<f64>) -> Row {
        Row {
            family: "flip".to_owned(),
            integrator: "split".to_owned(),
            steps_per_s: 60,
            position_error_m: Some(0.0),
            attitude_error_rad: attitude,
            energy_error_rel: None,
            evaluations: 600,
        }
    }

    #[test]
    fn a_changed_number_is_named() {
        let old = [row(Some(1e-3))];
        assert!(compare(&old, &[row(Some(1e-3 * (1.0 + 1e-7)))]).is_empty());
        let changed = compare(&old, &[row(Some(1.01e-3))]);
        assert_eq!(
            changed,
            ["flip split 60 Hz: attitude_error_rad was 1e-3, is 1.01e-3"]
        );
        assert_eq!(compare(&old, &[row(None)]).len(), 1);
        assert_eq!(
            compare(&old, &[]),
            ["flip split 60 Hz: stored, but not run"]
        );
        assert_eq!(compare(&[], &old), ["flip split 60 Hz: not stored"]);
    }
}
