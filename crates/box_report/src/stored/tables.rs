//! Tables of `docs/integrators.md` and `docs/contact.md`.

use box_physics::integrators::Integrator;
use box_scenarios::contact_cases;

use crate::context::Stop;
use crate::text;

/// The properties that each integrator claims.
pub(super) fn integrators() -> Result<String, Stop> {
    let heading = text::columns(
        "id | order: rotation · gravity · drag · torque | evaluations per step: free · forced | \
         energy of a tumbling box | conserves L | |ω|dt | c·dt/m | √(k/m)·dt | summary",
    );
    let rows = Integrator::ALL.iter().map(|i| {
        let info = i.info();
        let (o, e, s) = (info.orders, info.evaluations, info.stability);
        let conserves = match (info.conserved.momentum, info.conserved.momentum_magnitude) {
            (true, _) => "yes",
            (false, true) => "magnitude",
            _ => "no",
        };
        vec![
            text::code(info.id),
            format!(
                "{} · {} · {} · {}",
                o.rotation, o.gravity, o.linear_drag, o.torque
            ),
            e.to_string(),
            info.conserved.energy.to_string(),
            conserves.to_owned(),
            s.rotation.to_string(),
            s.drag.to_string(),
            s.oscillator.to_string(),
            info.summary.to_owned(),
        ]
    });
    Ok(markdown(&heading, rows))
}

/// The source of each integrator.
pub(super) fn sources() -> Result<String, Stop> {
    let line = |i: &Integrator| {
        let info = i.info();
        format!(
            "- {} ({}): {}\n",
            text::code(info.id),
            info.name,
            info.source
        )
    };
    Ok(Integrator::ALL.iter().map(line).collect())
}

/// Integrators in the contact table: those that games would choose.
const CHOSEN: [Integrator; 4] = [
    Integrator::Split,
    Integrator::Exact,
    Integrator::Split4,
    Integrator::Rk4,
];

/// The measured results of the hard cases of contact.
pub(super) fn contact() -> Result<String, Stop> {
    let mut heading = text::columns("case | what happens | measured | bound");
    heading.extend(CHOSEN.map(text::code));
    let rows = contact_cases().into_iter().map(|case| {
        let mut row = vec![
            case.number.to_string(),
            case.title.to_owned(),
            case.quantity.to_owned(),
            figure(case.bound),
        ];
        row.extend(CHOSEN.map(|i| figure(case.measure(i))));
        row
    });
    Ok(markdown(&heading, rows))
}

/// A Markdown table; `|` is escaped in its cells.
pub(crate) fn markdown(heading: &[String], rows: impl Iterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|c| c.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let rule = format!("|{}\n", "---|".repeat(heading.len()));
    let rows: String = rows.map(|row| line(&row)).collect();
    line(heading) + &rule + &rows
}

/// Smallest relative error that is printed as a number; the digits of a smaller one are rounding.
const MIN_PRINTED: f64 = 1e-12;

fn figure(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        x if x.abs() < MIN_PRINTED => "rounding".to_owned(),
        x if (0.1..1000.0).contains(&x) => format!("{x:.2}"),
        x => format!("{x:.0e}"),
    }
}

/// The lines that were added and removed.
pub(super) fn differences(stored: &str, new: &str) -> Result<Vec<String>, String> {
    let missing = |from: &str, of: &str| -> Vec<String> {
        let known: std::collections::HashSet<&str> = of.lines().collect();
        let lines = from.lines().filter(|l| !known.contains(l));
        lines.map(str::to_owned).collect()
    };
    let gone = missing(stored, new).into_iter().map(|l| format!("- {l}"));
    let added = missing(new, stored).into_iter().map(|l| format!("+ {l}"));
    let mut found: Vec<String> = gone.chain(added).collect();
    if found.is_empty() && stored != new {
        found.push("the same lines in another order".to_owned());
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_below_rounding_have_no_digits() {
        assert_eq!(figure(0.0), "0");
        assert_eq!(figure(7e-16), "rounding");
        assert_eq!(figure(5.2e-9), "5e-9");
        assert_eq!(figure(16.3), "16.30");
    }

    #[test]
    fn lines_gone_and_added_are_shown() {
        let found = differences("a\nb\n", "b\nc\n").expect("text");
        assert_eq!(found, ["- a", "+ c"]);
        assert_eq!(differences("a\nb\n", "b\na\n").expect("text").len(), 1);
        assert!(differences("a\n", "a\n").expect("text").is_empty());
    }
}
