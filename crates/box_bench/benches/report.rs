//! All benchmarks, and the tables of `docs/performance.md`:
//! `cargo bench --bench report -- --write docs/performance.md`

use box_bench::{document, options::Options, rows, suites};
use clap::Parser;

fn main() -> std::io::Result<()> {
    let options = Options::parse();
    let count = |f: &mut dyn FnMut()| allocation_counter::measure(f).count_total;
    let mut found = suites::contact(&options);
    found.extend(suites::kernels(&options));
    found.extend(suites::refit(&options));
    found.extend(suites::step(&options, count));
    rows::report(&found, &options)?;
    let file = options.write.as_deref();
    file.map_or(Ok(()), |file| document::rewrite(file, &found))
}
