//! The errors of a short deterministic run of every integrator in every family of motion.

use box_physics::integrators::Integrator;
use box_scenarios::{Family, Metric};
use serde::{Deserialize, Serialize};

use crate::context::Stop;
use crate::files;
use crate::work_precision::INTERVAL;

/// Divisors of 1/15 s, for 30, 60 and 240 Hz.
const DIVISORS: [u64; 3] = [2, 4, 16];
/// Relative difference up to which two errors count as equal: math libraries round the formulas of the references
/// differently.
const TOLERANCE: f64 = 1e-4;
/// Errors up to this value \[m, rad or relative\] are amplified rounding errors. Only their magnitude is meaningful, not
/// their digits.
const MAX_ROUNDING_ERROR: f64 = 1e-10;
/// Rounding errors count as equal up to this factor, or up to this difference \[m, rad or relative\].
const ROUNDING_TOLERANCE: (f64, f64) = (4.0, 1e-14);
/// Errors beyond this value \[m, rad or relative\] mean that the run is lost. Only that is compared, not the final value.
const MAX_COMPARED_ERROR: f64 = 0.5;

/// The errors of one run. They are empty where the run failed or the energy is not constant.
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

pub(super) fn make() -> Result<String, Stop> {
    files::csv_text(&measure()?).map_err(|e| Stop::Internal(e.to_string()))
}

pub(super) fn differences(stored: &str, new: &str) -> Result<Vec<String>, String> {
    Ok(compare(&files::parse_csv(stored)?, &files::parse_csv(new)?))
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

/// Descriptions of all differences.
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
        // A failed run ends early, so its number of evaluations means nothing.
        let failed = new.position_error_m.is_none();
        if old.evaluations != new.evaluations && !failed {
            differences.push(format!(
                "{name}: evaluations were {}, are {}",
                old.evaluations, new.evaluations
            ));
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

/// Returns `true` if two errors are equal relative to their own magnitude: an integrator that is exact to 1e-14 must
/// not degrade to 1e-12.
fn same(before: Option<f64>, after: Option<f64>) -> bool {
    let (Some(a), Some(b)) = (before, after) else {
        return before == after;
    };
    let (small, large) = (a.min(b), a.max(b));
    if small > MAX_COMPARED_ERROR || large <= small * (1.0 + TOLERANCE) {
        return true;
    }
    large <= MAX_ROUNDING_ERROR && large <= ROUNDING_TOLERANCE.0 * small + ROUNDING_TOLERANCE.1
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
        let mut dearer = row(Some(1e-3));
        dearer.evaluations += 1;
        assert_eq!(
            compare(&old, &[dearer]),
            ["flip split 60 Hz: evaluations were 600, are 601"]
        );
    }

    #[test]
    fn errors_are_compared_at_their_own_size() {
        let both = |a, b| same(Some(a), Some(b)) && same(Some(b), Some(a));
        // Rounding errors may differ by a factor, but not by orders of magnitude.
        assert!(both(2e-14, 7e-14) && both(0.0, 9e-15) && both(2e-12, 7e-12));
        assert!(!both(2e-14, 2e-13) && !both(1e-14, 1e-8) && !both(2e-12, 1e-11));
        assert!(!both(1e-9, 1.01e-9) && both(1e-9, 1.00001e-9));
        assert!(both(0.6, 3.0) && !both(0.4, 0.6));
    }
}
