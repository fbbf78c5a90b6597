//! The game's entry point: chooses between window, pictures without a window, and the comparison
//! without either.

use std::process::ExitCode;

use bevy::app::AppExit;
use box_game::app;
use box_game::cli::{self, Cli};
use box_game::compare::headless::Headless;
use box_game::platform::{self, Need};
use box_game::scene::library;
use box_game::scene::session::Session;
use box_physics::prelude::Integrator;
use clap::Parser;

fn main() -> ExitCode {
    let cli = match Cli::try_parse_from(platform::arguments()) {
        Ok(cli) => cli,
        Err(error) => return platform::refuse(&error),
    };
    if let Some(need) = cli.probe {
        return match platform::probe(need) {
            Ok(()) => ExitCode::SUCCESS,
            Err(reason) => fail(&reason, 1),
        };
    }
    if cli.list_scenes {
        return platform::say(&cli::scene_list());
    }
    if cli.list_integrators {
        return platform::say(&cli::integrator_list());
    }
    if cli.headless {
        return compare(&cli);
    }
    let need = if cli.offscreen {
        Need::Gpu
    } else {
        Need::Window
    };
    if let Err(missing) = platform::check(need) {
        platform::complain(&missing.to_string());
        if cli.offscreen || cli.screenshot.is_some() || cli.script.is_some() {
            return ExitCode::from(cli::NO_DISPLAY);
        }
        platform::complain(
            "\nRunning the comparison without a window instead (as with --headless):\n",
        );
        return compare(&cli);
    }
    match app::build(&cli) {
        Ok(mut app) => match app.run() {
            AppExit::Success => ExitCode::SUCCESS,
            AppExit::Error(code) => ExitCode::from(code.get()),
        },
        Err(error) => fail(&error.to_string(), 1),
    }
}

/// Prints the reason and returns the exit code.
fn fail(reason: &str, code: u8) -> ExitCode {
    platform::complain(reason);
    ExitCode::from(code)
}

fn compare(cli: &Cli) -> ExitCode {
    let headless = match headless(cli) {
        Ok(headless) => headless,
        Err(error) => return fail(&error, 2),
    };
    let table = match headless.run() {
        Ok(table) => table,
        Err(error) => return fail(&error.to_string(), 1),
    };
    let every = match table.every {
        1 => String::new(),
        n => format!(" (every {n} steps)"),
    };
    let said = platform::say(&format!(
        "{}\nFull time series: {}{every}\n",
        headless.report(&table),
        headless.log.display()
    ));
    let mut results = table.result.integrators.iter();
    if cli.fail_on_divergence && results.any(|r| r.status.is_diverged()) {
        return ExitCode::from(cli::DIVERGED);
    }
    said
}

/// The comparison on the command line: its scene, with the parameters of `--set`.
fn headless(cli: &Cli) -> Result<Headless, String> {
    let mut scenario = library::open(cli.scene.as_deref().unwrap_or("throw"))?;
    let mut session = Session::new(scenario.clone(), cli.seed);
    for (parameter, value) in cli.parameters() {
        session.parameters.set(parameter, value)?;
    }
    scenario.setup = session.setup();
    scenario.setup.duration = cli.duration.unwrap_or(scenario.setup.duration);
    let log = cli.log.clone();
    Ok(Headless {
        scenario,
        integrators: match &cli.integrator[..] {
            [] => Integrator::ALL.to_vec(),
            chosen => chosen.to_vec(),
        },
        dt: cli.dt,
        substeps: cli.substeps,
        log: log.unwrap_or_else(|| "comparison.csv".into()),
        seed: cli.seed,
    })
}
