//! Cost of a step of every integrator on plain arrays. `cargo bench --bench kernels -- --help`

use box_bench::{options::Options, rows, suites};
use clap::Parser;

fn main() -> std::io::Result<()> {
    let options = Options::parse();
    let found = suites::kernels(&options);
    rows::print(&found);
    options
        .json
        .as_deref()
        .map_or(Ok(()), |file| rows::write_json(&found, file))
}
