//! Cost of a box at the floor. `cargo bench --bench contact -- --help`

use box_bench::{options::Options, rows, suites};
use clap::Parser;

fn main() -> std::io::Result<()> {
    let options = Options::parse();
    let found = suites::contact(&options);
    rows::print(&found);
    options
        .json
        .as_deref()
        .map_or(Ok(()), |file| rows::write_json(&found, file))
}
