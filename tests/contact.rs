//! The hard cases of contact, 25 to 32, under the integrators that a game would choose, and the table of
//! `docs/contact.md`, which is made here: `UPDATE_DOCS=1 cargo test --release --test contact` rewrites it.

use std::fmt::Write as _;

use box_physics::integrators::Integrator;
use box_scenarios::contact_cases;

const SCHEMES: [Integrator; 4] = [
    Integrator::Split,
    Integrator::Exact,
    Integrator::Split4,
    Integrator::Rk4,
];

#[test]
fn contact_keeps_its_bounds_and_the_table_says_so() {
    let mut table = "| case | what happens | measured | bound |".to_owned();
    for s in SCHEMES {
        write!(table, " `{s}` |").expect("a string");
    }
    table += "\n|---|---|---|---|";
    table += &"---|".repeat(SCHEMES.len());
    table += "\n";
    let mut broken = Vec::new();
    for case in contact_cases() {
        write!(
            table,
            "| {} | {} | {} | {} |",
            case.number,
            case.title,
            case.quantity,
            figure(case.bound)
        )
        .expect("a string");
        for integrator in SCHEMES {
            let value = case.measure(integrator);
            if value.is_nan() || value > case.bound {
                broken.push(format!(
                    "{} {} {}: {value:e}, bound {:e}",
                    case.number, case.quantity, integrator, case.bound
                ));
            }
            write!(table, " {} |", figure(value)).expect("a string");
        }
        table += "\n";
    }
    println!("{table}");
    assert!(broken.is_empty(), "{broken:#?}");

    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/contact.md");
    let mut text = std::fs::read_to_string(path).expect("docs/contact.md");
    let (open, close) = ("<!-- cases -->\n", "<!-- /cases -->");
    let from = text.find(open).expect("the table's place") + open.len();
    let to = text.find(close).expect("the table's end");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        text.replace_range(from..to, &table);
        std::fs::write(path, text).expect("writable");
    } else {
        assert_eq!(
            &text[from..to],
            table,
            "UPDATE_DOCS=1 cargo test --release --test contact rewrites docs/contact.md"
        );
    }
}

fn figure(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else if (0.1..1000.0).contains(&value) {
        format!("{value:.2}")
    } else {
        format!("{value:.0e}")
    }
}
