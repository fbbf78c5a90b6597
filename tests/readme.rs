//! The README's table of keys is made from the game's list; `UPDATE_README=1 cargo test --release --test
//! readme` rewrites it, as `box_report bless` does with every stored table.

use std::fmt::Write as _;

use box_game::ui::panel::KEYS;

fn keys() -> String {
    let mut table = "| key | what it does |\n|---|---|\n".to_owned();
    for (key, what) in KEYS {
        let key = key.replace('|', "\\|");
        writeln!(table, "| {key} | {what} |").expect("a string");
    }
    table
}

#[test]
fn the_table_of_keys_is_that_of_the_game() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../README.md");
    let mut readme = std::fs::read_to_string(path).expect("a README");
    let (open, close) = ("<!-- keys -->\n", "<!-- /keys -->");
    let from = readme.find(open).expect("a section of keys") + open.len();
    let place = from..readme.find(close).expect("the section's end");
    let table = keys();
    if std::env::var_os("UPDATE_README").is_some() {
        readme.replace_range(place, &table);
        std::fs::write(path, &readme).expect("writable");
    } else {
        assert_eq!(readme[place], table, "UPDATE_README=1 rewrites it");
    }
}
