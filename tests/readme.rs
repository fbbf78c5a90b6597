//! The tables of the README are made from the code: keys from the game's list, integrators from what
//! each integrator says of itself. `UPDATE_README=1 cargo test --release --test readme` rewrites them.

use std::fmt::Write as _;

use box_game::ui::panel::KEYS;
use box_physics::prelude::Integrator;

fn keys() -> String {
    let mut table = "| key | what it does |\n|---|---|\n".to_owned();
    for (key, what) in KEYS {
        let key = key.replace('|', "\\|");
        writeln!(table, "| {key} | {what} |").expect("a string");
    }
    table
}

fn integrators() -> String {
    let mut table = "| id | order: rotation · gravity · drag · torque | evaluations a step: free · forced | energy of a tumbling box | keeps L | \\|ω\\|dt | c·dt/m | √(k/m)·dt | in a sentence |\n|---|---|---|---|---|---|---|---|---|\n".to_owned();
    for i in Integrator::ALL {
        let info = i.info();
        let (o, e, s) = (info.orders, info.evaluations, info.stability);
        let keeps = match (info.keeps.momentum, info.keeps.momentum_magnitude) {
            (true, _) => "yes",
            (false, true) => "its length",
            _ => "no",
        };
        writeln!(
            table,
            "| `{}` | {} · {} · {} · {} | {} | {} | {} | {} | {} | {} | {} |",
            info.id,
            o.rotation,
            o.gravity,
            o.linear_drag,
            o.torque,
            e,
            info.keeps.energy,
            keeps,
            s.rotation,
            s.drag,
            s.oscillator,
            info.summary.replace('|', "\\|")
        )
        .expect("a string");
    }
    table
}

#[test]
fn the_tables_of_the_readme_are_those_of_the_code() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../README.md");
    let mut readme = std::fs::read_to_string(path).expect("a README");
    for (name, table) in [("keys", keys()), ("integrators", integrators())] {
        let (open, close) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
        let span = |readme: &str| {
            let from = readme.find(&open)? + open.len();
            Some(from..readme.find(&close)?)
        };
        let place = span(&readme).unwrap_or_else(|| panic!("the README has no section {open}"));
        if std::env::var_os("UPDATE_README").is_some() {
            readme.replace_range(place, &table);
            std::fs::write(path, &readme).expect("writable");
        }
        let place = span(&readme).expect("still there");
        assert_eq!(readme[place], table, "{name}: UPDATE_README=1 rewrites it");
    }
}
