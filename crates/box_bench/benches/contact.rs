//! Cost of a box at the floor. `cargo bench --bench contact -- --help`

use box_bench::{options::Options, rows, suites};
use clap::Parser;

fn main() -> std::io::Result<()> {
    let options = Options::parse();
    rows::report(&suites::contact(&options), &options)
}
