//! Rewrites the tables of a document between markers from measurements.
//!
//! A table named `step` is between the lines `<!-- table: step -->` and `<!-- /table -->`. Its name is that of a suite,
//! or one of `targets` and `million`, which are computed from several suites, and `machine`.

use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};

use crate::machine::Machine;
use crate::rows::Row;
use crate::targets::{self, Aim};

/// Replaces every table of the file for which the rows contain the suite.
///
/// # Errors
/// If the file cannot be read or written.
pub fn rewrite(file: &Path, rows: &[Row]) -> io::Result<()> {
    let file = from_the_top(file);
    let text = std::fs::read_to_string(&file)?;
    std::fs::write(&file, with_tables(&text, rows))
}

/// Resolves a relative path against the top of the repository, because cargo runs a benchmark in the folder of its
/// package.
fn from_the_top(file: &Path) -> PathBuf {
    if file.is_absolute() || file.exists() {
        return file.to_owned();
    }
    Path::new("../..").join(file)
}

fn with_tables(text: &str, rows: &[Row]) -> String {
    let mut out = String::new();
    let mut skipping = false;
    for line in text.lines() {
        if line == "<!-- /table -->" {
            skipping = false;
        }
        if !skipping {
            out.push_str(line);
            out.push('\n');
        }
        let name = line
            .strip_prefix("<!-- table: ")
            .and_then(|rest| rest.strip_suffix(" -->"));
        if let Some(block) = name.and_then(|name| block(name, rows)) {
            out.push_str(&block);
            skipping = true;
        }
    }
    out
}

/// The content of the table `name`, if it was measured.
fn block(name: &str, rows: &[Row]) -> Option<String> {
    let found: Vec<_> = rows.iter().filter(|row| row.suite == name).collect();
    match name {
        "targets" => targets_table(rows),
        "million" => targets::million(rows),
        "machine" => Some(format!("{}\n", Machine::this())),
        _ if found.is_empty() => None,
        _ => Some(table(&found)),
    }
}

fn targets_table(rows: &[Row]) -> Option<String> {
    // The kernels alone are not sufficient for the targets.
    if !rows.iter().any(|row| row.suite == "step") {
        return None;
    }
    let mut lines = Lines::new(&["target", "aim", "measured", "met"]);
    for target in targets::targets(rows) {
        let aim = match target.aim {
            Aim::AtMost(most) => format!("≤ {most}"),
            Aim::AtLeast(least) => format!("≥ {least}"),
        };
        let met = if target.is_met() { "yes" } else { "**no**" };
        let measured = format!("{:.2}", target.measured);
        lines.push(&[&target.what, &aim, &measured, met]);
    }
    Some(lines.0)
}

/// The lines of a table.
struct Lines(String);

impl Lines {
    fn new(heads: &[&str]) -> Self {
        let mut this = Self(String::new());
        this.push(heads);
        this.push(&vec!["---"; heads.len()]);
        this
    }

    fn push(&mut self, cells: &[&str]) {
        for cell in cells {
            let _ = write!(self.0, "| {cell} ");
        }
        self.0.push_str("|\n");
    }
}

/// Omits columns whose cells are all equal.
fn table(rows: &[&Row]) -> String {
    let ratio = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.2}"));
    let count = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.0}"));
    let column = |head: &'static str, cell: &dyn Fn(&Row) -> String| {
        (head, rows.iter().map(|&row| cell(row)).collect::<Vec<_>>())
    };
    let columns = [
        column("what", &|r| r.name.clone()),
        column("integrator", &|r| r.integrator.to_owned()),
        column("bodies", &|r| r.bodies.to_string()),
        column("threads", &|r| r.threads.to_string()),
        column("ns, least", &|r| number(r.cost.min)),
        column("ns, median", &|r| number(r.cost.median)),
        column("to bare loop", &|r| ratio(r.to_bare)),
        column("to memory", &|r| ratio(r.to_memory)),
        column("allocations", &|r| count(r.allocations)),
    ];
    let tells = |cells: &[String]| cells.len() == 1 || cells.iter().any(|c| *c != cells[0]);
    let columns: Vec<_> = columns
        .into_iter()
        .filter(|(name, cells)| *name == "what" || name.starts_with("ns") || tells(cells))
        .collect();
    let heads: Vec<_> = columns.iter().map(|(name, _)| *name).collect();
    let mut lines = Lines::new(&heads);
    for k in 0..rows.len() {
        let cells: Vec<_> = columns.iter().map(|(_, cells)| cells[k].as_str()).collect();
        lines.push(&cells);
    }
    lines.0
}

/// Formats with about three significant digits.
fn number(ns: f64) -> String {
    if ns < 100.0 {
        format!("{ns:.1}")
    } else {
        format!("{ns:.0}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Cost;

    fn row(name: &str, ns: f64) -> Row {
        Row {
            suite: "contact",
            name: name.to_owned(),
            integrator: "split",
            bodies: 1,
            threads: 1,
            cost: Cost::of(&[ns]),
            to_bare: None,
            to_memory: None,
            allocations: None,
        }
    }

    #[test]
    fn tables_are_replaced_and_the_rest_stays() {
        let text = "# A\n<!-- table: contact -->\nold\n<!-- /table -->\nend\n\
                    <!-- table: step -->\nkept\n<!-- /table -->\n";
        let once = with_tables(text, &[row("resting", 12.34), row("sliding", 890.6)]);
        assert!(
            once.contains("| what | ns, least | ns, median |\n"),
            "{once}"
        );
        assert!(once.contains("| resting | 12.3 | 12.3 |\n| sliding | 891 | 891 |\n"));
        assert!(!once.contains("old") && once.contains("end\n") && once.contains("kept"));
    }
}
