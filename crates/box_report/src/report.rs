//! Runs the report: selects the parts, measures them in order and writes the pages.

use std::path::PathBuf;
use std::time::Instant;

use box_physics::integrators::Integrator;
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};

use crate::context::{Context, Interrupt, Stop};
use crate::document::{Document, Section};
use crate::summary::Results;
use crate::{
    determinism, dissertation, docs, efficiency, files, peers, stability, summary, timing, visible,
    work_precision,
};
use box_bench::machine::Machine;

/// Options of every part that measures.
#[derive(Args)]
pub(crate) struct Options {
    /// Folder for report.md, report.html, the figures and one CSV file per table
    #[arg(short, long, value_name = "DIR", default_value = "report")]
    output: PathBuf,
    /// Fewer steps and samples: seconds instead of minutes, noisier times
    #[arg(long)]
    quick: bool,
    /// Only these integrators, separated by commas [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    integrators: Vec<Integrator>,
    /// Also rewrite the documents of the repository: DIR/results.md, its figures DIR/results/*.svg, and the measured
    /// tables of DIR/integrators.md, DIR/performance.md and DIR/../README.md
    #[arg(long, value_name = "DIR")]
    docs: Option<PathBuf>,
}

/// The parts that can be measured alone, in the order of measurement: a part comes after those it needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Part {
    WorkPrecision,
    Efficiency,
    Stability,
    Timing,
    Visible,
    Dissertation,
    Determinism,
    Peers,
}

impl Part {
    /// The name on the command line: `work-precision`.
    fn id(self) -> String {
        let name = self.to_possible_value();
        name.map_or_else(String::new, |name| name.get_name().to_owned())
    }

    /// Number of progress ticks.
    fn ticks(self, quick: bool) -> u64 {
        match self {
            Self::WorkPrecision => work_precision::ticks(),
            Self::Efficiency | Self::Determinism | Self::Peers => 0,
            Self::Stability => stability::ticks(quick),
            Self::Timing => timing::ticks(),
            Self::Visible => visible::ticks(),
            Self::Dissertation => dissertation::ticks(),
        }
    }
}

/// Measures `only` (all parts if `None`) and writes the pages, also after Ctrl-C.
///
/// # Errors
/// A file cannot be written; or Ctrl-C was pressed. In that case the finished parts have been written.
pub(crate) fn run(options: &Options, only: Option<Part>) -> Result<(), Stop> {
    let clock = Instant::now();
    files::create_folder(&options.output)?;
    if let Some(docs) = &options.docs {
        if only.is_some_and(|p| p != Part::Peers) {
            return Err(Stop::Usage(
                "--docs rewrites the summary of all parts; it is allowed without a command or with 'peers'"
                    .to_owned(),
            ));
        }
        files::create_folder(docs)?;
    }
    let wanted = wanted(only);
    let needed = measurements(&wanted);
    let ctx = Context {
        folder: options.output.clone(),
        integrators: if options.integrators.is_empty() {
            Integrator::ALL.to_vec()
        } else {
            options.integrators.clone()
        },
        quick: options.quick,
        progress: progress(needed.iter().map(|p| p.ticks(options.quick)).sum()),
        interrupt: Interrupt::listen()?,
    };
    let (mut done, mut results) = (Vec::new(), Results::default());
    let result = measure_all(&ctx, options, only, &mut results, &mut done);
    ctx.progress.finish_and_clear();
    let missing: Vec<String> = wanted
        .iter()
        .map(|p| p.id())
        .filter(|id| !done.iter().any(|s: &Section| s.id == id))
        .collect();
    let machine = Machine::this();
    let document = Document {
        sections: &done,
        missing: &missing,
        machine: &machine,
        seconds: clock.elapsed().as_secs_f64(),
        quick: options.quick,
    };
    document.write(&options.output)?;
    result?;
    if let (Some(docs), None) = (&options.docs, only) {
        document.write_digest(docs)?;
        if let Some(table) = done.first().and_then(|summary| summary.tables.first()) {
            docs::rewrite(docs, table, &results, (&machine, options.quick))?;
        }
    }
    for v in done.iter().flat_map(|s| &s.verdicts) {
        println!("{}", v.replace("**", ""));
    }
    println!(
        "written in {:.0} s: {}",
        clock.elapsed().as_secs_f64(),
        options.output.join("report.html").display()
    );
    Ok(())
}

/// A progress line at the bottom of the terminal, for `steps` ticks of work.
fn progress(steps: u64) -> ProgressBar {
    let line = "{bar:28} {pos}/{len} steps, {elapsed} elapsed, about {eta} left  {msg}";
    let bar = ProgressBar::new(steps);
    match ProgressStyle::with_template(line) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// The requested parts.
fn wanted(only: Option<Part>) -> Vec<Part> {
    only.map_or_else(|| Part::value_variants().to_vec(), |p| vec![p])
}

/// The parts that must be measured for the requested ones, because some parts use the results of others.
fn measurements(wanted: &[Part]) -> Vec<Part> {
    let needs = |p: Part| {
        wanted.contains(&p)
            || match p {
                Part::WorkPrecision => {
                    wanted.contains(&Part::Efficiency) || wanted.contains(&Part::Dissertation)
                }
                Part::Stability | Part::Visible => wanted.contains(&Part::Dissertation),
                _ => false,
            }
    };
    let all = Part::value_variants().iter().copied();
    all.filter(|p| needs(*p)).collect()
}

/// Measures the parts into `done`. If it ends early, `done` contains the finished parts.
fn measure_all(
    ctx: &Context,
    options: &Options,
    only: Option<Part>,
    results: &mut Results,
    done: &mut Vec<Section>,
) -> Result<(), Stop> {
    let wanted = wanted(only);
    for part in measurements(&wanted) {
        let section = match part {
            Part::WorkPrecision => {
                let data = work_precision::measure(ctx)?;
                let section = work_precision::section(ctx, &data)?;
                results.work_precision = Some(data);
                Some(section)
            }
            Part::Efficiency => results
                .work_precision
                .as_ref()
                .map(|data| efficiency::section(ctx, data))
                .transpose()?,
            Part::Stability => {
                let data = stability::measure(ctx)?;
                let section = stability::section(ctx, &data)?;
                results.stability = Some(data);
                Some(section)
            }
            Part::Timing => {
                let data = timing::measure(ctx)?;
                let section = timing::section(ctx, &data)?;
                results.timings = Some(data);
                Some(section)
            }
            Part::Visible => {
                let data = visible::measure(ctx)?;
                let section = visible::section(ctx, &data)?;
                results.visible = Some(data);
                Some(section)
            }
            Part::Dissertation => Some(dissertation::section(ctx, results)?),
            Part::Determinism => Some(determinism::section(ctx)?),
            Part::Peers => {
                let fresh = only == Some(Part::Peers);
                if fresh {
                    peers::measure(ctx, options.docs.as_deref())?;
                }
                Some(peers::section(ctx, fresh)?)
            }
        };
        done.extend(section.filter(|_| wanted.contains(&part)));
    }
    if only.is_none() {
        done.insert(0, summary::section(ctx, results)?);
    }
    Ok(())
}
