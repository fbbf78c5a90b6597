//! Cost of the plugin's whole step. `cargo bench --bench step -- --help`

use box_bench::{options::Options, rows, suites};
use clap::Parser;

fn main() -> std::io::Result<()> {
    let options = Options::parse();
    let count = |f: &mut dyn FnMut()| allocation_counter::measure(f).count_total;
    rows::report(&suites::step(&options, count), &options)
}
