//! Cost of the plugin's whole step. `cargo bench --bench step -- --help`

use box_bench::{options::Options, rows, suites};
use clap::Parser;

fn main() -> std::io::Result<()> {
    let options = Options::parse();
    let count = |f: &mut dyn FnMut()| allocation_counter::measure(f).count_total;
    let found = suites::step(&options, count);
    rows::print(&found);
    options
        .json
        .as_deref()
        .map_or(Ok(()), |file| rows::write_json(&found, file))
}
