//! Results of a benchmark as rows, in text and JSON.

use std::io;

use serde::Serialize;

use crate::machine::Machine;
use crate::measure::Cost;
use crate::options::Options;

/// One measurement.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Name of the benchmark.
    pub suite: &'static str,
    /// The measured work.
    pub name: String,
    /// The integrator's id.
    pub integrator: &'static str,
    /// Number of bodies.
    pub bodies: usize,
    /// Maximum number of threads.
    pub threads: usize,
    /// Cost \[ns per body-step\].
    pub cost: Cost,
    /// Minimum cost relative to that of the bare loop in the same run.
    pub to_bare: Option<f64>,
    /// Minimum cost relative to that of the pass over the same bytes in the same run.
    pub to_memory: Option<f64>,
    /// Allocations per step on the calling thread.
    pub allocations: Option<f64>,
}

/// Prints rows as a table, with the machine on which they were measured. With `--json`, also writes both to that file.
///
/// # Errors
/// If the file cannot be written.
pub fn report(rows: &[Row], options: &Options) -> io::Result<()> {
    println!("{}", Machine::this());
    println!(
        "{:<10} {:<24} {:<20} {:>8} {:>3} {:>9} {:>9} {:>9} {:>7} {:>8} {:>7}",
        "suite",
        "what",
        "integrator",
        "bodies",
        "thr",
        "min ns",
        "median",
        "p95",
        "x bare",
        "x memory",
        "allocs"
    );
    let optional = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.2}"));
    for row in rows {
        println!(
            "{:<10} {:<24} {:<20} {:>8} {:>3} {:>9.1} {:>9.1} {:>9.1} {:>7} {:>8} {:>7}",
            row.suite,
            row.name,
            row.integrator,
            row.bodies,
            row.threads,
            row.cost.min,
            row.cost.median,
            row.cost.p95,
            optional(row.to_bare),
            optional(row.to_memory),
            optional(row.allocations),
        );
    }
    let Some(file) = &options.json else {
        return Ok(());
    };
    let measured = serde_json::json!({ "machine": Machine::this(), "rows": rows });
    std::fs::write(file, serde_json::to_string_pretty(&measured)? + "\n")
}
