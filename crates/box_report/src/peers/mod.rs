//! `peers`: the same boxes in other engines. A program outside the workspace measures them, and its last result is
//! committed.

mod section;

use std::path::{Path, PathBuf};
use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::context::{Context, Stop};
use crate::files;
use box_bench::machine::Machine;

pub(crate) use section::section;

/// The measurements of `box_peers`.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Measured {
    engines: Vec<Engine>,
    accuracy: Vec<Accuracy>,
    cost: Vec<CostRow>,
    /// Notes for the reader, such as omissions and their reasons.
    notes: Vec<String>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Engine {
    id: String,
    name: String,
    version: String,
    /// Number of threads that it may use.
    #[serde(default)]
    threads: Option<usize>,
    /// Description of how the engine was driven.
    driven: String,
}

impl Engine {
    /// Name of the engine, with the number of threads where it is known.
    fn full_name(&self) -> String {
        match self.threads {
            None => self.name.clone(),
            Some(1) => format!("{}, 1 thread", self.name),
            Some(n) => format!("{}, {n} threads", self.name),
        }
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Accuracy {
    engine: String,
    case: String,
    rate_hz: u32,
    /// Time \[s\], attitude error \[rad\] and signed relative energy error.
    points: Vec<(f64, f64, f64)>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct CostRow {
    engine: String,
    /// `free`, `landing` or `resting`.
    place: String,
    bodies: usize,
    ns_per_body_step_min: f64,
    ns_per_body_step_median: f64,
    ns_per_body_step_p95: f64,
    /// Cost of the physics alone, for engines that are part of an app.
    #[serde(default)]
    physics_ns_per_body_step_min: Option<f64>,
    #[serde(default)]
    physics_ns_per_body_step_median: Option<f64>,
}

/// A result and the conditions of its measurement, as committed.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Stored {
    machine: Machine,
    measured: Measured,
}

fn manifest() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../box_peers/Cargo.toml")
}

/// Path of the committed result.
fn committed() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/results/peers.json")
}

/// Runs `box_peers` through cargo and saves its result in the output folder. With `docs`, it also saves the result
/// where it is committed.
pub(crate) fn measure(ctx: &Context, docs: Option<&Path>) -> Result<(), Stop> {
    let manifest = manifest();
    if !manifest.is_file() {
        return Err(Stop::Failed(format!(
            "{} not found: measuring the other engines requires a source checkout",
            manifest.display()
        )));
    }
    let notice = "building and running box_peers (the first build takes about 15 minutes) …";
    ctx.progress.suspend(|| eprintln!("{notice}"));
    let mut command = Command::new("cargo");
    command
        .args(["run", "--release", "--locked", "--quiet", "--manifest-path"])
        .arg(&manifest)
        .arg("--")
        .arg("--output")
        .arg(&ctx.folder);
    if ctx.quick {
        command.arg("--quick");
    }
    // It depends on other packages. In the workspace's target folder, each of the two builds would invalidate the
    // other.
    if let Some(target) = std::env::var_os("CARGO_TARGET_DIR") {
        command.env("CARGO_TARGET_DIR", Path::new(&target).join("peers"));
    }
    let status = command
        .status()
        .map_err(|e| Stop::Failed(format!("cannot start cargo: {e}")))?;
    if !status.success() {
        return Err(Stop::Failed(format!("box_peers ended with {status}")));
    }
    let text = files::read(&ctx.file("peers-measured.json"))?;
    let measured: Measured = serde_json::from_str(&text)
        .map_err(|e| Stop::Failed(format!("peers-measured.json: {e}")))?;
    let stored = Stored {
        machine: Machine::this(),
        measured,
    };
    let json =
        serde_json::to_string(&stored).map_err(|e| Stop::Internal(format!("peers.json: {e}")))?;
    files::write(&ctx.file("peers.json"), &json)?;
    if let Some(docs) = docs {
        let folder = docs.join("results");
        files::create_folder(&folder)?;
        files::write(&folder.join("peers.json"), &json)?;
    }
    Ok(())
}
