//! Cost of bounding boxes and transforms. `cargo bench --bench refit -- --help`

use box_bench::{options::Options, rows, suites};
use clap::Parser;

fn main() -> std::io::Result<()> {
    let options = Options::parse();
    let found = suites::refit(&options);
    rows::print(&found);
    options
        .json
        .as_deref()
        .map_or(Ok(()), |file| rows::write_json(&found, file))
}
