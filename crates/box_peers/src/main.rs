//! The same boxes in Avian, Rapier, Box3D and `box_physics`, in one run: the error of a free tumble over time, and the
//! cost per body and step. Writes `peers-measured.json`, which `cargo box-report peers` reads.

mod accuracy;
mod avian;
mod box3d;
mod cost;
mod engine;
mod in_bevy;
mod ours;
mod rapier;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use serde::Serialize;

use engine::Engine;

/// Measures box_physics, Avian, Rapier and Box3D side by side.
#[derive(Parser)]
#[command(name = "box_peers", version)]
struct Options {
    /// Folder for peers-measured.json
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    output: PathBuf,
    /// Few bodies, one sample
    #[arg(long)]
    quick: bool,
}

#[derive(Serialize)]
struct EngineInfo {
    id: &'static str,
    name: &'static str,
    version: String,
    threads: usize,
    driven: String,
}

#[derive(Serialize)]
struct Measured {
    engines: Vec<EngineInfo>,
    accuracy: Vec<accuracy::Accuracy>,
    cost: Vec<cost::CostRow>,
    notes: Vec<String>,
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), String> {
    let mut engines: Vec<Box<dyn Engine>> = vec![
        Box::new(ours::Ours {
            no_slow_bounces: false,
        }),
        Box::new(ours::Ours {
            no_slow_bounces: true,
        }),
        Box::new(avian::Avian { fine: false }),
        Box::new(avian::Avian { fine: true }),
    ];
    engines.extend(rapier::Rapier::all().map(|e| Box::new(e) as Box<dyn Engine>));
    let mut notes = Vec::new();
    match box3d::Box3d::all() {
        Ok(all) => engines.extend(all.into_iter().map(|e| Box::new(e) as Box<dyn Engine>)),
        Err(e) => notes.push(format!("Box3D is left out: {e}.")),
    }
    let accuracy = accuracy::measure(&engines)?;
    let (cost, more) = cost::measure(&engines, options.quick)?;
    notes.extend(more);
    let info = |e: &dyn Engine| EngineInfo {
        id: e.id(),
        name: e.name(),
        version: e.version(),
        threads: e.threads(),
        driven: e.driven(),
    };
    let measured = Measured {
        engines: engines.iter().map(|e| info(e.as_ref())).collect(),
        accuracy,
        cost,
        notes,
    };
    let json = serde_json::to_string(&measured).map_err(|e| e.to_string())?;
    let path = options.output.join("peers-measured.json");
    std::fs::write(&path, json).map_err(|e| format!("{}: {e}", path.display()))
}
