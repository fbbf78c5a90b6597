//! Cost of bounding boxes and transforms. `cargo bench --bench refit -- --help`

use box_bench::{options::Options, rows, suites};
use clap::Parser;

fn main() -> std::io::Result<()> {
    let options = Options::parse();
    rows::report(&suites::refit(&options), &options)
}
