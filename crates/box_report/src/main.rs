//! Offline comparison of speed and error: measures every integrator against references.

mod context;
mod determinism;
mod dissertation;
mod docs;
mod document;
mod efficiency;
mod files;
mod peers;
mod plot;
mod report;
mod simulate;
mod stability;
mod stored;
mod summary;
mod text;
mod timing;
mod verify;
mod visible;
mod work_precision;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use context::Stop;
use report::Part;

/// Measures error and cost of every integrator and writes a report. Without a command,
/// it measures everything, in less than five minutes on an idle machine.
#[derive(Parser)]
#[command(name = "box_report", version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(flatten)]
    options: report::Options,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Error against time and against force evaluations: diagrams for every family of motion
    WorkPrecision(report::Options),
    /// The cheapest integrator for each error bound, and the Pareto frontier
    Efficiency(report::Options),
    /// Hard cases, and the largest stable steps compared with theory
    Stability(report::Options),
    /// Cost per step in flight, under forces and on the floor
    Timing(report::Options),
    /// Time until an error is visible
    Visible(report::Options),
    /// The 2012 comparison repeated, and the answer to its question
    Dissertation(report::Options),
    /// State digest of every integrator, which must be equal on every machine
    Determinism(report::Options),
    /// The same boxes in Avian, Rapier and Box3D: builds and runs crates/box_peers
    Peers(report::Options),
    /// Compare the stored digests, errors and tables with those of this build
    Check(stored::Repository),
    /// Store the digests, errors and tables of this build, and print what changed
    Bless(stored::BlessOptions),
    /// Write a trajectory as CSV
    Simulate(simulate::Options),
    /// Run every reference trajectory of a folder under the integrators and print their errors
    Verify(verify::Options),
}

/// Success.
const OK: u8 = 0;
/// A file could not be used, or a value differs from the stored one.
const BAD: u8 = 1;
/// Invalid command line (clap uses the same code).
const USAGE: u8 = 2;
/// Interrupted by Ctrl-C; shells use the same code.
const INTERRUPTED: u8 = 130;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(e) => return refuse(&e),
    };
    let Some(command) = &cli.command else {
        return end(report::run(&cli.options, None));
    };
    let (options, part) = match command {
        Command::WorkPrecision(options) => (options, Part::WorkPrecision),
        Command::Efficiency(options) => (options, Part::Efficiency),
        Command::Stability(options) => (options, Part::Stability),
        Command::Timing(options) => (options, Part::Timing),
        Command::Visible(options) => (options, Part::Visible),
        Command::Dissertation(options) => (options, Part::Dissertation),
        Command::Determinism(options) => (options, Part::Determinism),
        Command::Peers(options) => (options, Part::Peers),
        Command::Check(repository) => return end(stored::check(repository)),
        Command::Bless(options) => return end(stored::bless(options)),
        Command::Simulate(options) => return end(simulate::run(options)),
        Command::Verify(options) => return verify(options),
    };
    end(report::run(options, Some(part)))
}

/// Prints clap's message. For an unknown command, adds the list of commands, which clap omits.
fn refuse(e: &clap::Error) -> ExitCode {
    // Standard error may be closed.
    let _ = e.print();
    if e.kind() == clap::error::ErrorKind::InvalidSubcommand {
        let commands = Cli::command();
        let names: Vec<_> = commands.get_subcommands().map(|c| c.get_name()).collect();
        eprintln!("allowed: {}", names.join(", "));
    }
    ExitCode::from(if e.use_stderr() { USAGE } else { OK })
}

fn verify(options: &verify::Options) -> ExitCode {
    match verify::run(options, &mut std::io::stdout().lock()) {
        Ok(bad_files) if bad_files.is_empty() => ExitCode::from(OK),
        Ok(bad_files) => {
            for e in bad_files {
                eprintln!("error: {e}");
            }
            ExitCode::from(BAD)
        }
        // The reader of the output has closed it (`… | head`).
        Err(verify::VerifyError::Output(e)) if e.kind() == std::io::ErrorKind::BrokenPipe => {
            ExitCode::from(OK)
        }
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::from(USAGE)
        }
    }
}

fn end(result: Result<(), Stop>) -> ExitCode {
    let Err(stop) = result else {
        return ExitCode::from(OK);
    };
    let code = match &stop {
        Stop::File { source, .. } if source.kind() == std::io::ErrorKind::BrokenPipe => {
            return ExitCode::from(OK);
        }
        Stop::Interrupted => INTERRUPTED,
        Stop::Usage(_) | Stop::File { .. } => USAGE,
        Stop::Changed(_) | Stop::Failed(_) | Stop::Internal(_) => BAD,
    };
    eprintln!("error: {stop}");
    ExitCode::from(code)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Help pages contain plain text: no escapes and no markup of doc comments.
    #[test]
    fn help_pages_are_plain_text() {
        fn pages(command: &mut clap::Command, found: &mut Vec<String>) {
            found.push(command.render_long_help().to_string());
            found.push(command.render_help().to_string());
            for sub in command.get_subcommands_mut() {
                pages(sub, found);
            }
        }
        let mut found = Vec::new();
        pages(&mut Cli::command(), &mut found);
        for page in found {
            for markup in ["\\", "`", "[[", "]("] {
                assert!(!page.contains(markup), "{markup} in:\n{page}");
            }
        }
    }
}
