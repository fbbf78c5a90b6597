//! The table of keys in `docs/game.md` is generated from the game's list. `UPDATE_KEYS=1 cargo test --release --test
//! keys` rewrites it, as `box_report bless` does with every stored table.

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
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/game.md");
    let mut page = std::fs::read_to_string(path).expect("a page about the game");
    let (open, close) = ("<!-- keys -->\n", "<!-- /keys -->");
    let from = page.find(open).expect("a section of keys") + open.len();
    let place = from..page.find(close).expect("the section's end");
    let table = keys();
    if std::env::var_os("UPDATE_KEYS").is_some() {
        page.replace_range(place, &table);
        std::fs::write(path, &page).expect("writable");
    } else {
        assert_eq!(page[place], table, "UPDATE_KEYS=1 rewrites it");
    }
}
