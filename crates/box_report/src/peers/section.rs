//! The section of the report on other engines: tables, diagrams and a conclusion for each engine.

use serde::Serialize;

use super::{Accuracy, CostRow, Engine, Measured, Stored, committed};
use crate::context::{Context, Stop};
use crate::document::{Figure, Section, Table};
use crate::plot::{Axis, Line, Plot, Point, plain};
use crate::{files, text};
use box_physics::integrators::Integrator;
use box_scenarios::style::{Dash, Marker, Style};

const ID: &str = "peers";
const OURS: &str = "box_physics";
const TITLE: &str = "Other engines";

/// Creates the section from the result in the output folder if `fresh`, otherwise from the committed one.
pub(crate) fn section(ctx: &Context, fresh: bool) -> Result<Section, Stop> {
    let path = if fresh {
        ctx.file("peers.json")
    } else {
        committed()
    };
    if !path.is_file() {
        return Ok(Section::new(
            ID,
            TITLE,
            "There is no stored result; measure one with `cargo box-report peers`.",
        ));
    }
    let stored: Stored = serde_json::from_str(&files::read(&path)?)
        .map_err(|e| Stop::Failed(format!("{}: {e}", path.display())))?;
    let (m, measured) = (&stored.machine, &stored.measured);
    let mut section = Section::new(
        ID,
        TITLE,
        format!(
            "The same boxes in other engines; floor and boxes have the same friction and restitution in all, box–box collisions \
             are off, other settings are the defaults. *Fine*: ten times the default number of substeps. {} on {m}. \
             To repeat: `cargo box-report peers`.",
            if fresh {
                "Measured in this run"
            } else {
                "The last measured result,"
            },
        ),
    );
    let engines = measured.engines.iter();
    let engines = engines.map(|e| format!("{} {} ({})", e.full_name(), e.version, e.driven));
    section.method = format!(
        "{}. {}",
        engines.collect::<Vec<_>>().join("; "),
        measured.notes.join(" ")
    );
    section.tables.push(accuracy_table(measured));
    section.tables.push(cost_table(measured));
    for case in cases(measured) {
        section.figures.push(figure(measured, &case, false)?);
        section.figures.push(figure(measured, &case, true)?);
    }
    section.verdicts = verdicts(measured);
    write_csvs(ctx, measured)?;
    section.write_figures(&ctx.folder)?;
    Ok(section)
}

fn cases(measured: &Measured) -> Vec<String> {
    let mut cases: Vec<String> = Vec::new();
    for a in &measured.accuracy {
        if !cases.contains(&a.case) {
            cases.push(a.case.clone());
        }
    }
    cases
}

/// The largest attitude error and the last energy error.
fn ends(a: &Accuracy) -> (f64, f64) {
    let worst = a.points.iter().map(|p| p.1).fold(0.0, f64::max);
    (worst, a.points.last().map_or(0.0, |p| p.2))
}

fn accuracy_table(measured: &Measured) -> Table {
    let cases = cases(measured);
    let mut columns = vec!["engine".to_owned()];
    columns.extend(cases.iter().map(|c| case_name(c)));
    let in_flight = situations(measured);
    let in_flight = in_flight.iter().find(|s| s.of("avian-fine").is_some());
    let row = |e: &Engine| {
        let dearer = || {
            let (fine, default) = (&e.id, e.id.strip_suffix("-fine")?);
            let situation = in_flight?;
            Some(situation.of(fine)?.alone() / situation.of(default)?.alone())
        };
        let mut name = e.name.clone();
        if let Some(ratio) = dearer() {
            name += &format!(" ({}× the cost)", text::significant(ratio, 2));
        }
        let mut cells = vec![name];
        cells.extend(cases.iter().map(|c| {
            let found = measured
                .accuracy
                .iter()
                .find(|a| a.engine == e.id && a.case == *c && a.rate_hz == 60);
            found.map_or_else(String::new, |a| {
                let (attitude, energy) = ends(a);
                format!("{} rad · {}", text::error(attitude), text::percent(energy))
            })
        }));
        cells
    };
    Table {
        title: "Largest attitude error, and energy error at the end, 60 Hz".to_owned(),
        note: "Against the reference trajectories of free motion (`tests/oracle`). An attitude error is at most π ≈ 3.1 rad."
            .to_owned(),
        columns,
        rows: measured
            .engines
            .iter()
            .filter(|e| measured.accuracy.iter().any(|a| a.engine == e.id))
            .map(row)
            .collect(),
        csv: "peers-accuracy.csv".to_owned(),
    }
}

/// Converts `pub04_thin_plate` to `thin plate`.
fn case_name(case: &str) -> String {
    let name = case.split_once('_').map_or(case, |(_, name)| name);
    name.replace('_', " ")
}

/// The costs of all engines in one situation.
struct Situation<'a> {
    place: &'a str,
    bodies: usize,
    rows: Vec<&'a CostRow>,
}

impl Situation<'_> {
    fn of(&self, engine: &str) -> Option<&CostRow> {
        self.rows.iter().copied().find(|c| c.engine == engine)
    }

    /// Cost of the physics of `engine` without the app \[ns\], and its ratio to ours.
    fn alone(&self, engine: &str) -> Option<(f64, f64)> {
        let (theirs, ours) = (self.of(engine)?.alone(), self.of(OURS)?.alone());
        Some((theirs, theirs / ours))
    }
}

impl CostRow {
    /// Cost of the physics without the app \[ns\]. For an engine that runs without an app, it is the whole cost.
    fn alone(&self) -> f64 {
        self.physics_ns_per_body_step_min
            .unwrap_or(self.ns_per_body_step_min)
    }
}

fn situations(measured: &Measured) -> Vec<Situation<'_>> {
    let mut found: Vec<Situation> = Vec::new();
    for c in &measured.cost {
        let same = |s: &&mut Situation| s.place == c.place && s.bodies == c.bodies;
        match found.iter_mut().find(same) {
            Some(s) => s.rows.push(c),
            None => found.push(Situation {
                place: &c.place,
                bodies: c.bodies,
                rows: vec![c],
            }),
        }
    }
    found
}

fn cost_table(measured: &Measured) -> Table {
    let situations = situations(measured);
    let mut columns = vec!["engine".to_owned()];
    columns.extend(
        situations
            .iter()
            .map(|s| format!("{}, {}", s.place, s.bodies)),
    );
    let row = |name: String, cell: &dyn Fn(&Situation) -> Option<String>| {
        let cells = situations.iter().map(|s| cell(s).unwrap_or_default());
        [name].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let shown = |e: &&Engine| !e.id.ends_with("-fine");
    let alone = measured.engines.iter().filter(shown).map(|e| {
        row(e.full_name(), &|s| {
            let (ns, ratio) = s.alone(&e.id)?;
            let ns = text::significant(ns, 3);
            let ratio = text::significant(ratio, 2);
            Some(if e.id == OURS {
                ns
            } else {
                format!("{ns} ({ratio}×)")
            })
        })
    });
    let in_an_app = measured.engines.iter().filter(shown).filter(|e| {
        let mut rows = measured.cost.iter().filter(|c| c.engine == e.id);
        rows.any(|c| c.physics_ns_per_body_step_min.is_some())
    });
    let whole = in_an_app.map(|e| {
        row(format!("{}, whole app", e.full_name()), &|s| {
            Some(text::significant(s.of(&e.id)?.ns_per_body_step_min, 3))
        })
    });
    Table {
        title: "Cost of the physics per box and step [ns]".to_owned(),
        note: "By situation and number of boxes; in parentheses, the ratio to box_physics. Fastest sample. Last rows: the whole \
               `App::update` of the engines in Bevy."
            .to_owned(),
        rows: alone.chain(whole).collect(),
        columns,
        csv: "peers-cost.csv".to_owned(),
    }
}

fn look(id: &str) -> Style {
    let (color, dash, marker) = match id {
        OURS => return box_scenarios::style(Integrator::Split),
        "avian" => ([0x00, 0x72, 0xB2], Dash::Solid, Marker::Up),
        "avian-fine" => ([0x00, 0x72, 0xB2], Dash::Dotted, Marker::Up),
        "rapier" => ([0x00, 0x9E, 0x73], Dash::Solid, Marker::Square),
        "rapier-fine" => ([0x00, 0x9E, 0x73], Dash::Dotted, Marker::Square),
        "box3d" => ([0xCC, 0x79, 0xA7], Dash::Solid, Marker::Diamond),
        "box3d-fine" => ([0xCC, 0x79, 0xA7], Dash::Dotted, Marker::Diamond),
        _ => return plain(Dash::Solid, Marker::Cross),
    };
    Style {
        color,
        dash,
        marker,
    }
}

fn figure(measured: &Measured, case: &str, energy: bool) -> Result<Figure, Stop> {
    let lines = measured.engines.iter().filter_map(|e| {
        let a = measured
            .accuracy
            .iter()
            .find(|a| a.engine == e.id && a.case == case && a.rate_hz == 60)?;
        let point =
            |p: &(f64, f64, f64)| Some(Point::new(p.0, if energy { p.2.abs() } else { p.1 }));
        Some(Line {
            label: e.name.clone(),
            style: look(&e.id),
            points: a.points.iter().map(point).collect(),
            markers: true,
        })
    });
    let what = if energy { "energy" } else { "attitude" };
    let title = if energy {
        "energy error, relative"
    } else {
        "attitude error [rad]"
    };
    let plot = Plot {
        title: format!("{}: {what} error over time at 60 Hz", case_name(case)),
        x: Axis::linear("time [s]"),
        y: Axis::log(title).within(1e-12, 10.0),
        lines: lines.collect(),
    };
    Ok(Figure {
        id: format!("peers-{}-{what}", case_name(case).replace(' ', "-")),
        caption: format!(
            "{} in every engine, 60 Hz, {what} error against the reference trajectory.",
            case_name(case)
        ),
        svg: plot.svg().map_err(Stop::Internal)?,
        digest: false,
    })
}

/// Conclusions: how small the error of each engine is, and where the engine is cheaper than ours.
fn verdicts(measured: &Measured) -> Vec<String> {
    let worst = |e: &Engine| {
        let of = measured.accuracy.iter();
        let of = of.filter(|a| a.engine == e.id && a.rate_hz == 60);
        let worst = of.map(|a| ends(a).0).reduce(f64::max)?;
        Some(format!("{} {} rad", e.name, text::error(worst)))
    };
    let worst: Vec<String> = measured.engines.iter().filter_map(worst).collect();
    let situations = situations(measured);
    let cheaper: Vec<String> = situations
        .iter()
        .filter_map(|s| {
            let others = measured.engines.iter().filter(|e| !e.id.starts_with(OURS));
            let others = others.filter_map(|e| {
                let (_, ratio) = s.alone(&e.id)?;
                let name = e.full_name();
                (ratio < 1.0).then(|| format!("{name} {}×", text::significant(ratio, 2)))
            });
            let others: Vec<String> = others.collect();
            (!others.is_empty())
                .then(|| format!("{}, {} boxes ({})", s.place, s.bodies, others.join("; ")))
        })
        .collect();
    vec![
        format!("Largest attitude error: {}.", text::list(&worst)),
        format!("Cheaper than box_physics: {}.", text::list(&cheaper)),
    ]
}

#[derive(Serialize)]
struct AccuracyRow<'a> {
    engine: &'a str,
    case: &'a str,
    rate_hz: u32,
    t_s: f64,
    attitude_error_rad: f64,
    energy_error_rel: f64,
}

fn write_csvs(ctx: &Context, measured: &Measured) -> Result<(), Stop> {
    let rows: Vec<AccuracyRow> = measured
        .accuracy
        .iter()
        .flat_map(|a| {
            a.points.iter().map(|p| AccuracyRow {
                engine: &a.engine,
                case: &a.case,
                rate_hz: a.rate_hz,
                t_s: p.0,
                attitude_error_rad: p.1,
                energy_error_rel: p.2,
            })
        })
        .collect();
    files::write_csv(&ctx.file("peers-accuracy.csv"), &rows)?;
    files::write_csv(&ctx.file("peers-cost.csv"), &measured.cost)
}
