//! Speed against error, offline: every integrator measured against trusted references.

mod timing;
mod verify;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "box_report", version, about)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run every reference trajectory of a folder under the integrators and print their errors
    Verify(verify::Options),
}

/// Everything was done.
const OK: u8 = 0;
/// A file could not be used; the others were.
const BAD_FILE: u8 = 1;
/// The command line makes no sense (clap's own code for it).
const USAGE: u8 = 2;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let result = match &cli.command {
        Command::Verify(options) => verify::run(options, &mut std::io::stdout().lock()),
    };
    match result {
        Ok(bad_files) if bad_files.is_empty() => ExitCode::from(OK),
        Ok(bad_files) => {
            for e in bad_files {
                eprintln!("error: {e}");
            }
            ExitCode::from(BAD_FILE)
        }
        // Who reads our output has seen enough (`… | head`).
        Err(verify::VerifyError::Output(e)) if e.kind() == std::io::ErrorKind::BrokenPipe => {
            ExitCode::from(OK)
        }
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::from(USAGE)
        }
    }
}
