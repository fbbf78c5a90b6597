//! The tables of a document, between markers, rewritten from what was measured.
//!
//! A table named `step` is between the lines `<!-- table: step -->` and `<!-- /table -->`; its name is
//! a suite's, or that of something computed from several: `targets`, `million`.

use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};

use crate::rows::Row;
use crate::targets::{self, Aim};

/// Replaces every table of the file whose suite is among the rows.
///
/// # Errors
/// If the file cannot be read or written.
pub fn rewrite(file: &Path, rows: &[Row]) -> io::Result<()> {
    let file = from_the_top(file);
    let text = std::fs::read_to_string(&file)?;
    std::fs::write(&file, with_tables(&text, rows))
}

/// Cargo runs a benchmark in its package's folder; a relative path means the repository's.
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

/// The measurement of a name, if there is one.
fn block(name: &str, rows: &[Row]) -> Option<String> {
    let found: Vec<_> = rows.iter().filter(|row| row.suite == name).collect();
    match name {
        "targets" => targets_table(rows),
        "million" => targets::million(rows),
        _ if found.is_empty() => None,
        "kernels" => Some(integrators_table(&found)),
        _ => Some(table(&found)),
    }
}

fn targets_table(rows: &[Row]) -> Option<String> {
    // Of the kernels alone too little can be said.
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

/// One line an integrator: its plain step of the bodies that stay in the cache best, and many at a time.
fn integrators_table(rows: &[&Row]) -> String {
    let mut sizes: Vec<_> = rows.iter().map(|row| row.bodies).collect();
    sizes.sort_unstable();
    sizes.dedup();
    // Of one body the call is measured as well.
    let plain = sizes.iter().copied().find(|&n| n >= 100);
    let plain = plain.unwrap_or(sizes[0]);
    let mut integrators = Vec::new();
    for row in rows {
        if !integrators.contains(&row.integrator) {
            integrators.push(row.integrator);
        }
    }
    let heads: Vec<_> = ["integrator".to_owned(), format!("plain, {plain}")]
        .into_iter()
        .chain(sizes.iter().map(|n| format!("many, {n}")))
        .collect();
    let heads: Vec<_> = heads.iter().map(String::as_str).collect();
    let mut lines = Lines::new(&heads);
    for integrator in integrators {
        let cost = |name: &str, n: usize| {
            let mut rows = rows.iter();
            let row =
                rows.find(|r| (r.integrator, r.name.as_str(), r.bodies) == (integrator, name, n));
            row.map_or_else(String::new, |row| number(row.cost.min))
        };
        let mut cells = vec![format!("`{integrator}`"), cost("plain", plain)];
        cells.extend(sizes.iter().map(|&n| cost("many at a time", n)));
        let cells: Vec<_> = cells.iter().map(String::as_str).collect();
        lines.push(&cells);
    }
    lines.0
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

/// Columns that say the same everywhere, or nothing, are left out.
fn table(rows: &[&Row]) -> String {
    let ratio = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.2}"));
    let count = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.0}"));
    let columns: [(&str, Vec<String>); 9] = [
        ("what", rows.iter().map(|r| r.name.clone()).collect()),
        (
            "integrator",
            rows.iter().map(|r| r.integrator.to_owned()).collect(),
        ),
        (
            "bodies",
            rows.iter().map(|r| r.bodies.to_string()).collect(),
        ),
        (
            "threads",
            rows.iter().map(|r| r.threads.to_string()).collect(),
        ),
        (
            "ns, least",
            rows.iter().map(|r| number(r.cost.min)).collect(),
        ),
        (
            "ns, median",
            rows.iter().map(|r| number(r.cost.median)).collect(),
        ),
        (
            "to bare loop",
            rows.iter().map(|r| ratio(r.to_bare)).collect(),
        ),
        (
            "to memory",
            rows.iter().map(|r| ratio(r.to_memory)).collect(),
        ),
        (
            "allocations",
            rows.iter().map(|r| count(r.allocations)).collect(),
        ),
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

/// Three significant digits will do.
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
        let mut one = row("plain", 20.0);
        (one.suite, one.bodies) = ("kernels", 100);
        let mut many = one.clone();
        (many.name, many.cost) = ("many at a time".to_owned(), Cost::of(&[8.0]));
        let pivot = with_tables("<!-- table: kernels -->\n<!-- /table -->\n", &[one, many]);
        assert!(
            pivot.contains("| integrator | plain, 100 | many, 100 |\n"),
            "{pivot}"
        );
        assert!(pivot.contains("| `split` | 20.0 | 8.0 |\n"), "{pivot}");
        let again = with_tables(&once, &[row("resting", 12.34), row("sliding", 890.6)]);
        assert_eq!(again, once);
    }
}
