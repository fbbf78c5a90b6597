//! Cost of a step of every integrator on plain arrays. `cargo bench --bench kernels -- --help`

use box_bench::{options::Options, rows, suites};
use clap::Parser;

fn main() -> std::io::Result<()> {
    let options = Options::parse();
    rows::report(&suites::kernels(&options), &options)
}
