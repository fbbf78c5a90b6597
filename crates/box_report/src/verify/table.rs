//! The result as a table or as comma-separated values.

use std::io::{self, Write};

use box_scenarios::oracle::{MAX_ERRORS, Outcome};

use super::Row;

/// The columns of the CSV. Other programs read them, so names and order must not change.
#[rustfmt::skip]
const COLUMNS: [&str; 14] = [
    "case", "kind", "integrator", "dt_s", "position_error_m", "velocity_error_m_s",
    "attitude_error_rad", "angular_momentum_error_rel", "energy_error_rel", "steps", "evaluations",
    "fallbacks", "ns_per_step", "status",
];

/// Writes one record per row. Missing values are empty, and errors of a diverged run are `inf`.
pub(super) fn write_csv<'a>(
    rows: impl Iterator<Item = Row<'a>>,
    out: &mut impl Write,
) -> Result<(), csv::Error> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(COLUMNS)?;
    for row in rows {
        let m = &row.measured;
        let ran = !matches!(m.outcome, Outcome::Unsupported(_));
        let error = |x: f64| if ran { format!("{x:e}") } else { String::new() };
        let count = |n: u64| if ran { n.to_string() } else { String::new() };
        csv.write_record([
            row.case.name.clone(),
            row.case.kind.clone(),
            row.integrator.to_string(),
            row.dt.to_string(),
            error(m.position),
            error(m.velocity),
            error(m.attitude),
            error(m.angular_momentum),
            m.energy.map_or_else(String::new, error),
            count(m.totals.steps),
            count(m.totals.evaluations),
            count(m.totals.fallbacks),
            row.ns_per_step
                .map_or_else(String::new, |ns| format!("{ns:.1}")),
            status(m.outcome),
        ])?;
        csv.flush()?;
    }
    csv.flush()?;
    Ok(())
}

/// Writes one block per case and one line per row; the headings contain the units.
pub(super) fn write_table<'a>(
    rows: impl Iterator<Item = Row<'a>>,
    out: &mut impl Write,
) -> io::Result<()> {
    let mut current = None;
    let mut unconverged = 0;
    for row in rows {
        unconverged += row.measured.totals.unconverged;
        if current != Some(&row.case.name) {
            let gap = if current.is_some() { "\n" } else { "" };
            writeln!(
                out,
                "{gap}{} ({}), {} s",
                row.case.name, row.case.kind, row.case.setup.duration
            )?;
            writeln!(
                out,
                "  {:<20} {:>10}  {:>8} {:>8} {:>8} {:>8} {:>8}  {:>7} {:>6} {:>9} {:>8}  status",
                "integrator",
                "dt [s]",
                "x [m]",
                "v [m/s]",
                "att[rad]",
                "L rel",
                "E rel",
                "steps",
                "evals",
                "fallbacks",
                "ns/step"
            )?;
            current = Some(&row.case.name);
        }
        let m = &row.measured;
        let ran = !matches!(m.outcome, Outcome::Unsupported(_));
        let error = |x: Option<f64>| {
            x.filter(|_| ran)
                .map_or_else(|| "-".to_owned(), |x| format!("{x:.1e}"))
        };
        let count = |n: u64| if ran { n.to_string() } else { "-".to_owned() };
        writeln!(
            out,
            "  {:<20} {:>10.8}  {:>8} {:>8} {:>8} {:>8} {:>8}  {:>7} {:>6} {:>9} {:>8}  {}",
            row.integrator,
            row.dt,
            error(Some(m.position)),
            error(Some(m.velocity)),
            error(Some(m.attitude)),
            error(Some(m.angular_momentum)),
            error(m.energy),
            count(m.totals.steps),
            if ran {
                format!("{:.1}", m.totals.evaluations_per_step())
            } else {
                "-".to_owned()
            },
            count(m.totals.fallbacks),
            row.ns_per_step
                .map_or_else(|| "-".to_owned(), |ns| format!("{ns:.0}")),
            match m.totals.unconverged {
                0 => status(m.outcome),
                n => format!("{}, {n} not converged", status(m.outcome)),
            },
        )?;
    }
    if current.is_some() {
        writeln!(
            out,
            "\nerrors: maximum over the samples; evals: force evaluations per step; L and E relative to the start; ns/step: one box by its plain step"
        )?;
        writeln!(
            out,
            "lost: error of x above {} of the reference's extent, attitude above {} rad, L above {} or E above {}, relative",
            MAX_ERRORS.position,
            MAX_ERRORS.attitude,
            MAX_ERRORS.angular_momentum,
            MAX_ERRORS.energy
        )?;
        writeln!(
            out,
            "steps whose iteration reached its limit before its tolerance: {unconverged}"
        )?;
    }
    Ok(())
}

fn status(outcome: Outcome) -> String {
    match outcome {
        Outcome::Ok => "ok".to_owned(),
        Outcome::Lost(quantity) => format!("lost ({quantity})"),
        Outcome::Diverged => "diverged".to_owned(),
        Outcome::Unsupported(reason) => format!("unsupported ({reason})"),
    }
}
