//! Command-line options of the benchmarks.

use std::path::PathBuf;
use std::time::Duration;

use box_physics::prelude::Integrator;
use clap::Parser;

use crate::measure::Settings;

/// Options shared by all benchmarks.
#[derive(Clone, Debug, Parser)]
pub struct Options {
    /// Measure for seconds instead of minutes: fewer samples, at most 10 000 bodies.
    #[arg(long)]
    pub quick: bool,
    /// Also write the rows to this file as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Numbers of bodies.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "1,100,1000,10000,100000,1000000"
    )]
    pub bodies: Vec<usize>,
    /// Integrators by id (default: all for kernels, `split` for the plugin).
    #[arg(long, value_delimiter = ',', value_name = "IDS")]
    pub integrators: Vec<Integrator>,
    /// Only situations whose name contains this text.
    #[arg(long, value_name = "TEXT")]
    pub only: Option<String>,
    /// Rewrite the tables between the markers of this file, relative to the top of the repository
    /// (`--bench report` only).
    #[arg(long, value_name = "FILE")]
    pub write: Option<PathBuf>,
    /// Passed by cargo to every benchmark; ignored.
    #[arg(long, hide = true)]
    pub bench: bool,
}

impl Options {
    /// Number and length of the samples.
    pub fn settings(&self) -> Settings {
        if self.quick {
            Settings {
                shortest_sample: Duration::from_micros(100),
                samples: (5, 5),
                ..Settings::default()
            }
        } else {
            Settings::default()
        }
    }

    /// The numbers of bodies to measure.
    pub fn sizes(&self) -> Vec<usize> {
        let most = if self.quick { 10_000 } else { usize::MAX };
        self.bodies.iter().copied().filter(|&n| n <= most).collect()
    }

    /// Returns `true` if the benchmark `name` is selected.
    pub fn selects(&self, name: &str) -> bool {
        self.only.as_deref().is_none_or(|only| name.contains(only))
    }

    /// The selected integrators, or `default`.
    pub fn integrators_or(&self, default: &[Integrator]) -> Vec<Integrator> {
        if self.integrators.is_empty() {
            default.to_vec()
        } else {
            self.integrators.clone()
        }
    }
}
