//! `dissertation`: the comparison of 2012, repeated, with an answer to its question and the errors of its text.

mod answer;
mod claims;
mod cycle;
mod figures;

use box_physics::integrators::Integrator;
use box_scenarios::dissertation::Stepper;
use serde::Serialize;

use crate::context::{Context, Stop};
use crate::document::{Section, Table};
use crate::summary::Results;
use crate::{files, text};

/// Progress ticks of [`section`].
pub(crate) fn ticks() -> u64 {
    cycle::STEPS.len() as u64 + 1
}

/// Measures everything and writes the files; the answer is computed from `results`.
pub(crate) fn section(ctx: &Context, results: &Results) -> Result<Section, Stop> {
    let mut section = Section::new(
        "dissertation",
        "The 2012 dissertation, repeated",
        "V. Stojanovic, “Evaluation of Numerical Integration Methods for Simulation of Simple 3D Rigid Body Motion \
         Within a Game Environment” (2012), asked which integrator is the most efficient for simple rigid bodies in a game. This section repeats its measurement \
         and adds this library: its two integrators (RK4, and what it calls implicit Euler), steps of 0.005 to 0.01 s, one cube over a floor, \
         pushed along each axis in turn, the time of each integration cycle over the run, and the CPU share. \
         `2012-…` are the dissertation's own integrators with its own contact, reproduced line by line.",
    );
    let mut runs = Vec::new();
    for h in cycle::STEPS {
        runs.push(cycle::run(h, ctx.quick));
        ctx.tick("cycle by cycle")?;
    }
    let rows: Vec<_> = runs.iter().flat_map(cycle::Cycles::rows).collect();
    files::write_csv(&ctx.file("dissertation-cycles.csv"), &rows)?;
    section.tables.push(cycle_table(&runs));
    section.figures.push(figures::cycles(&runs[0])?);
    section.figures.push(figures::amplification()?);
    section.figures.push(figures::fall()?);
    let tumbles = figures::Tumbles::measure().map_err(Stop::Internal)?;
    section.figures.push(tumbles.attitude()?);
    section.figures.push(tumbles.energy()?);
    ctx.tick("its claims")?;
    section.tables.push(claim_table(ctx, &runs, &tumbles)?);
    if let Some((table, verdicts)) = answer::table(ctx, results)? {
        section.tables.insert(0, table);
        section.verdicts = verdicts;
    }
    section.write_figures(&ctx.folder)?;
    Ok(section)
}

fn cycle_table(runs: &[cycle::Cycles]) -> Table {
    let mut rows = Vec::new();
    for run in runs {
        for (k, name) in cycle::CONTENDERS.iter().enumerate() {
            let c = run.cost(k);
            rows.push(vec![
                text::significant(run.h, 2),
                (*name).to_owned(),
                format!("{:.0}", c.median),
                format!("{:.0}", c.p95),
                if k == 0 {
                    "–".to_owned()
                } else {
                    format!("{:.0}", run.net(k))
                },
                if k == 0 {
                    "–".to_owned()
                } else {
                    format!("{:.5} %", run.net(k) * 1e-9 / run.h * 100.0)
                },
            ]);
        }
    }
    Table {
        title: "The 2012 comparison: one integration cycle of one box".to_owned(),
        note: "Every cycle is timed individually, so each time includes reading the clock; the last two columns exclude it (means of the middle half of the cycles)."
            .to_owned(),
        columns: text::columns(
            "dt [s] | integrator | median [ns] | 95th percentile [ns] | without the clock [ns] | \
             share of one core",
        ),
        rows,
        csv: "dissertation-cycles.csv".to_owned(),
    }
}

/// A claim of the text, the correct statement, and the measured values.
#[derive(Serialize)]
struct ClaimRow {
    says: &'static str,
    holds: &'static str,
    measured: String,
    figure: String,
}

/// The table of claims: correct statements, measured values and the figure.
fn claim_table(
    ctx: &Context,
    runs: &[cycle::Cycles],
    tumbles: &figures::Tumbles,
) -> Result<Table, Stop> {
    use Integrator::{
        BackwardEuler, ExplicitEuler, Heun2012, ImplicitMidpoint, Midpoint, Rk4, Split,
    };
    let grows = |s: Integrator, z: f64| text::significant(claims::amplification(s, z), 3);
    let cm = |m: f64| match m {
        _ if m < 1e-10 => "rounding".to_owned(),
        _ => format!("{} cm", text::significant(100.0 * m, 3)),
    };
    let run = &runs[0];
    let worst = |s| text::error(tumbles.of(s).map_or(f64::NAN, claims::Tumble::worst));
    let energy = |s| {
        let change = tumbles
            .of(s)
            .map_or(f64::NAN, claims::Tumble::energy_change);
        // A value that rounds to zero is shown without a sign.
        format!("{:+.1} %", 100.0 * change)
            .replace("-0.0 %", "0.0 %")
            .replace("+0.0 %", "0.0 %")
    };
    let rows = [
        (
            "Its integrator is the implicit Euler method",
            "It is Heun's explicit method, stable up to c·dt/m = 2 like explicit Euler; the implicit method is always stable",
            format!(
                "At c·dt/m = 3 a step multiplies the speed by {} (2012-heun: {}), explicit Euler's by {}, backward Euler's by {}",
                grows(Heun2012, 3.0),
                text::significant(claims::amplification_2012(Stepper::Heun, 3.0), 3),
                grows(ExplicitEuler, 3.0),
                grows(BackwardEuler, 3.0)
            ),
            figures::AMPLIFICATION,
        ),
        (
            "RK4 is stable for any step",
            "No explicit Runge–Kutta method is; RK4's drag limit is c·dt/m = 2.785",
            format!(
                "At c·dt/m = 2.7 a step multiplies the speed by {}, at 2.9 by {}",
                grows(Rk4, 2.7),
                grows(Rk4, 2.9)
            ),
            figures::AMPLIFICATION,
        ),
        (
            "One integrator has order 2, the other order 4",
            "Both update the position with the new velocity, which reduces any integrator to order 1, with an error of ½·g·dt·t",
            format!(
                "Error after a second of fall at dt = 0.005 and 0.01: 2012-heun {} and {}, 2012-rk4 {} and {}; split {}",
                cm(claims::fall_error_2012(Stepper::Heun, 0.005)),
                cm(claims::fall_error_2012(Stepper::Heun, 0.01)),
                cm(claims::fall_error_2012(Stepper::Rk4, 0.005)),
                cm(claims::fall_error_2012(Stepper::Rk4, 0.01)),
                cm(claims::fall_error(Split, 0.01))
            ),
            figures::FALL,
        ),
        (
            "The demo integrates gravity",
            "It adds g to the position: the box sinks at 9.81 m/s and never accelerates",
            format!(
                "After a second, its box is off by {} at any step size",
                cm(claims::demo_fall_error(0.005))
            ),
            figures::FALL,
        ),
        (
            "The demo integrates the rotation of a rigid body",
            "ω grows by α/60 per step at any step size, without the gyroscopic term; the attitude is rotated about three axes in succession",
            format!(
                "Free tumble, 60 Hz, 10 s: attitude error up to {} rad, without its damping {} rad; rk4 {}, split {} rad",
                text::error(tumbles.demo.worst()),
                text::error(tumbles.undamped.worst()),
                worst(Rk4),
                worst(Split)
            ),
            figures::ATTITUDE,
        ),
        (
            "Rigid-body motion is stiff, so implicit methods are better",
            "Free rotation is not stiff: its fastest time scale is the spin itself; implicit Euler damps it",
            format!(
                "Energy after 10 s at 60 Hz: backward Euler {}, explicit Euler {}, implicit midpoint {}, split {}",
                energy(BackwardEuler),
                energy(ExplicitEuler),
                energy(ImplicitMidpoint),
                energy(Split)
            ),
            figures::ENERGY,
        ),
        (
            "A small step makes an explicit second-order method stable on rotation",
            "Explicit Euler and second-order Runge–Kutta methods gain energy at every step, however small; RK4 loses a little",
            format!(
                "Energy after 10 s at 60 Hz: heun-2012 {}, midpoint {}, rk4 {}",
                tumbles.of(Heun2012).map_or_else(String::new, |t| format!(
                    "{:+.4} %",
                    100.0 * t.energy_change()
                )),
                tumbles.of(Midpoint).map_or_else(String::new, |t| format!(
                    "{:+.4} %",
                    100.0 * t.energy_change()
                )),
                tumbles.of(Rk4).map_or_else(String::new, |t| format!(
                    "{:+.7} %",
                    100.0 * t.energy_change()
                ))
            ),
            figures::ENERGY,
        ),
        (
            "RK4 costs fractions of a millisecond more",
            "It timed four vector additions and a context switch; both integrators cost less than reading the clock",
            format!(
                "dt = 0.005, without the clock: 2012-heun {}, 2012-rk4 {}; correct rk4 with contact {}, split {}",
                text::time(run.net(1)),
                text::time(run.net(2)),
                text::time(run.net(4)),
                text::time(run.net(3))
            ),
            figures::CYCLES,
        ),
    ];
    let claims: Vec<ClaimRow> = rows
        .into_iter()
        .map(|(says, holds, measured, figure)| ClaimRow {
            says,
            holds,
            measured,
            figure: format!("{figure}.svg"),
        })
        .collect();
    files::write_csv(&ctx.file("dissertation-claims.csv"), &claims)?;
    Ok(Table {
        title: "Incorrect claims".to_owned(),
        note: "Each claim with a measurement of this run and the figure that shows it.".to_owned(),
        columns: text::columns("claim or assumption | correct | measured | figure"),
        rows: claims
            .into_iter()
            .map(|c| {
                let figure = format!("`{}`", c.figure);
                vec![c.says.to_owned(), c.holds.to_owned(), c.measured, figure]
            })
            .collect(),
        csv: "dissertation-claims.csv".to_owned(),
    })
}
