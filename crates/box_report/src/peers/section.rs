//! The section of the report: tables, diagrams and a sentence for each engine.

use serde::Serialize;

use super::{Accuracy, Engine, Measured, Stored, committed};
use crate::context::{Context, Stop};
use crate::document::{Figure, Section, Table};
use crate::plot::{Axis, Line, Plot, Point, plain};
use crate::{files, text};
use box_physics::integrators::Integrator;
use box_scenarios::style::{Dash, Marker, Style};

const ID: &str = "peers";
const TITLE: &str = "Other engines";

/// The section: of a result in the folder, if `fresh`, else of the committed one.
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
            "No result is committed; measure one with `cargo box-report peers`.",
        ));
    }
    let stored: Stored = serde_json::from_str(&files::read(&path)?)
        .map_err(|e| Stop::Failed(format!("{}: {e}", path.display())))?;
    let (m, measured) = (&stored.machine, &stored.measured);
    let engines: Vec<String> = measured
        .engines
        .iter()
        .map(|e| format!("{} {} ({})", e.full_name(), e.version, e.driven))
        .collect();
    let mut section = Section::new(
        ID,
        TITLE,
        format!(
            "The same boxes in other engines with their default settings, and with as many threads as there are: {}. {} on {m}. \
             Repeat it with `cargo box-report peers`. Attitude and energy against the reference trajectories of free \
             motion; cost per body and step of everything that an update does, box–box collisions off. {}",
            engines.join("; "),
            if fresh {
                "Measured in this run"
            } else {
                "**The last measured result**"
            },
            measured.notes.join(" ")
        ),
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
    columns.extend(cases.iter().map(|c| format!("{c} [rad · energy]")));
    let row = |e: &Engine| {
        let mut cells = vec![e.name.clone()];
        cells.extend(cases.iter().map(|c| {
            let found = measured
                .accuracy
                .iter()
                .find(|a| a.engine == e.id && a.case == *c && a.rate_hz == 60);
            found.map_or_else(String::new, |a| {
                let (attitude, energy) = ends(a);
                format!("{} · {:+.2e}", text::error(attitude), energy)
            })
        }));
        cells
    };
    Table {
        title: "Largest attitude error, and energy error at the end, 60 Hz".to_owned(),
        note: "π ≈ 3.1 rad is as wrong as an attitude can be.".to_owned(),
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

fn cost_table(measured: &Measured) -> Table {
    let mut keys: Vec<(String, usize)> = Vec::new();
    for c in &measured.cost {
        let key = (c.place.clone(), c.bodies);
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let mut columns = vec!["engine".to_owned()];
    columns.extend(keys.iter().map(|(p, n)| format!("{p}, {n} boxes [ns]")));
    let mut engines: Vec<&str> = Vec::new();
    for c in &measured.cost {
        if !engines.contains(&c.engine.as_str()) {
            engines.push(&c.engine);
        }
    }
    let name = |id: &str| {
        let found = measured.engines.iter().find(|e| e.id == id);
        found.map_or_else(|| id.to_owned(), Engine::full_name)
    };
    let row = |id: &str, alone: bool| {
        let words = if alone { ", physics alone" } else { "" };
        let mut cells = vec![name(id) + words];
        cells.extend(keys.iter().map(|(p, n)| {
            let mut rows = measured.cost.iter();
            let found = rows.find(|c| c.engine == id && c.place == *p && c.bodies == *n);
            let cost = found.and_then(|c| {
                if alone {
                    c.physics_ns_per_body_step_min
                        .zip(c.physics_ns_per_body_step_median)
                } else {
                    Some((c.ns_per_body_step_min, c.ns_per_body_step_median))
                }
            });
            cost.map_or_else(String::new, |(least, median)| {
                let spread = 100.0 * (median / least - 1.0);
                format!("{} (+{spread:.0} %)", text::significant(least, 3))
            })
        }));
        cells
    };
    let in_an_app = |id: &str| {
        let mut rows = measured.cost.iter().filter(|c| c.engine == id);
        rows.any(|c| c.physics_ns_per_body_step_min.is_some())
    };
    let rows = engines.into_iter().flat_map(|id| {
        let alone = in_an_app(id).then(|| row(id, true));
        [Some(row(id, false)), alone].into_iter().flatten()
    });
    Table {
        title: "Cost per body and step".to_owned(),
        note: "Fastest sample, and how far the median lies above it. Rapier and Box3D run without an app: \
               what compares with them is our physics alone."
            .to_owned(),
        rows: rows.collect(),
        columns,
        csv: "peers-cost.csv".to_owned(),
    }
}

fn look(id: &str) -> Style {
    let (color, dash, marker) = match id {
        "box_physics" => return box_scenarios::style(Integrator::Split),
        "avian" => ([0x00, 0x72, 0xB2], Dash::Solid, Marker::Up),
        "rapier" => ([0x00, 0x9E, 0x73], Dash::Dashed, Marker::Square),
        "box3d" => ([0xCC, 0x79, 0xA7], Dash::Dotted, Marker::Diamond),
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
        title: format!("{case}: {what} error over time at 60 Hz"),
        x: Axis::linear("time [s]"),
        y: Axis::log(title).within(1e-12, 10.0),
        lines: lines.collect(),
    };
    Ok(Figure {
        id: format!("peers-{}-{what}", case.to_lowercase().replace(' ', "-")),
        caption: format!(
            "{case} in every engine, 60 Hz, {what} error against the reference trajectory."
        ),
        svg: plot.svg().map_err(Stop::Internal)?,
        digest: false,
    })
}

/// How much faster and how much nearer, in numbers.
fn verdicts(measured: &Measured) -> Vec<String> {
    let mut said = Vec::new();
    let most = measured.cost.iter().map(|c| c.bodies).max().unwrap_or(0);
    let cost = |engine: &str, place: &str| {
        let found = measured
            .cost
            .iter()
            .find(|c| c.engine == engine && c.place == place && c.bodies == most)?;
        let alone = found.physics_ns_per_body_step_min;
        Some((found.ns_per_body_step_min, alone))
    };
    for e in measured.engines.iter().filter(|e| e.id != "box_physics") {
        let mut parts = Vec::new();
        for (place, words) in [
            ("free", "in free flight"),
            ("landing", "landing"),
            ("resting", "at rest on the floor"),
        ] {
            let (Some((own, own_alone)), Some((other, other_alone))) =
                (cost("box_physics", place), cost(&e.id, place))
            else {
                continue;
            };
            let ratio = text::significant(other / own, 2);
            let alone = own_alone.map_or_else(String::new, |own| {
                let ratio = text::significant(other_alone.unwrap_or(other) / own, 2);
                format!(" (physics alone: {ratio})")
            });
            parts.push(format!("{ratio} times our cost {words}{alone}"));
        }
        let worst = |id: &str| {
            let of = measured
                .accuracy
                .iter()
                .filter(|a| a.engine == id && a.rate_hz == 60);
            of.map(|a| ends(a).0).reduce(f64::max)
        };
        parts.extend(
            worst(&e.id)
                .zip(worst("box_physics"))
                .map(|(theirs, ours)| {
                    let [theirs, ours] = [theirs, ours].map(text::error);
                    format!("worst attitude error {theirs} rad against our {ours}")
                }),
        );
        said.push(format!(
            "{} {}, {most} boxes: {}.",
            e.full_name(),
            e.version,
            parts.join(", ")
        ));
    }
    said
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
