//! `determinism`: digests of the exact results, which are the same on every machine.

use std::num::NonZero;
use std::thread;

use box_physics::digest::fingerprint;
use box_physics::integrators::Integrator;
use serde::Serialize;

use crate::context::{Context, Stop};
use crate::document::{Section, Table};
use crate::{files, text};

#[derive(Serialize)]
struct Row {
    integrator: &'static str,
    /// 16 hexadecimal digits.
    digest: String,
}

/// Computes the digest of every integrator, on all threads of this machine at once.
///
/// # Errors
/// A file cannot be written, or threads disagree.
pub(crate) fn section(ctx: &Context) -> Result<Section, Stop> {
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let digests = on_threads(threads, &ctx.integrators)?;
    let rows: Vec<Row> = ctx
        .integrators
        .iter()
        .zip(digests)
        .map(|(integrator, digest)| Row {
            integrator: integrator.id(),
            digest: format!("{digest:016x}"),
        })
        .collect();
    files::write_csv(&ctx.file("determinism.csv"), &rows)?;
    let mut section = Section::new(
        "determinism",
        "Determinism",
        "Digest (FNV-1a, 64 bit) of the final states of three boxes that tumble, bounce and slide, with drag and a spring, \
         after 96 steps of 1/64 s. The code uses no platform sine and no fused multiply-add, so every machine, every \
         number of threads, debug and release builds must compute these digests. A game computes them with \
         `box_physics::digest::fingerprint`; `tests/determinism.rs` checks them.",
    );
    section.verdicts.push(format!(
        "On this machine, {threads} parallel threads computed the same {} digests.",
        rows.len()
    ));
    section.tables.push(Table {
        title: "State digest of every integrator".to_owned(),
        note: "Compare them with those of another machine.".to_owned(),
        columns: vec!["integrator".to_owned(), "digest".to_owned()],
        rows: rows
            .iter()
            .map(|r| vec![text::code(r.integrator), text::code(&r.digest)])
            .collect(),
        csv: "determinism.csv".to_owned(),
    });
    Ok(section)
}

/// Digests of `integrators`, computed by `threads` threads in parallel.
fn on_threads(threads: usize, integrators: &[Integrator]) -> Result<Vec<u64>, Stop> {
    let all = || {
        integrators
            .iter()
            .map(|&s| fingerprint(s))
            .collect::<Vec<_>>()
    };
    let found = thread::scope(|scope| {
        let running: Vec<_> = (0..threads).map(|_| scope.spawn(all)).collect();
        running
            .into_iter()
            .map(thread::ScopedJoinHandle::join)
            .collect::<Result<Vec<_>, _>>()
    });
    let found = found.map_err(|_| Stop::Internal("a fingerprint panicked".to_owned()))?;
    match found.split_first() {
        Some((first, others)) if others.iter().all(|o| o == first) => Ok(first.clone()),
        _ => Err(Stop::Internal(
            "threads computed different digests".to_owned(),
        )),
    }
}
