//! The command line of `verify`.

use std::path::PathBuf;

use box_physics::integrators::Integrator;
use box_scenarios::parse_step;
use clap::{Args, ValueEnum};

/// Options of the command verify.
#[derive(Args)]
pub(crate) struct Options {
    /// Folder of reference trajectories, one JSON file per case
    #[arg(value_name = "DIR")]
    pub(super) folder: PathBuf,
    /// Integrators, separated by commas [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    integrator: Vec<Integrator>,
    /// Step sizes, separated by commas: 60hz, 1/60 or 0.0166 (seconds)
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_step, default_value = "60hz,120hz,240hz")]
    pub(super) dt: Vec<f64>,
    /// Only cases whose name matches, such as 'pub0*'
    #[arg(long, value_name = "GLOB")]
    pub(super) case: Option<glob::Pattern>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(super) format: Format,
}

/// Output format of the result.
#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Format {
    /// Aligned columns
    Table,
    /// Comma-separated values
    Csv,
}

impl Options {
    /// The requested integrators, or all if none was requested.
    pub(super) fn integrators(&self) -> &[Integrator] {
        if self.integrator.is_empty() {
            Integrator::ALL
        } else {
            &self.integrator
        }
    }
}
